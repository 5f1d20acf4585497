#include "runs/report/page.h"

#include <set>
#include <stdexcept>
#include <string_view>

#include "core/base64.h"
#include "core/json_file.h"

#ifdef HOOKEYE_HAS_PAGE
// Symbols that `ld -r -b binary` makes of page.html (runs/CMakeLists.txt).
extern "C" const char _binary_page_html_start[];  // NOLINT
extern "C" const char _binary_page_html_end[];    // NOLINT
#endif

namespace hookeye {

using nlohmann::json;

namespace {

std::string_view built_page() {
#ifdef HOOKEYE_HAS_PAGE
  return {_binary_page_html_start,
          static_cast<size_t>(_binary_page_html_end - _binary_page_html_start)};
#else
  throw InputError({"hookeye"},
                   "this program was built without its page, because Node.js or its npm "
                   "was not there",
                   "install nodejs (packages.txt), be online, and configure and build again; or "
                   "give a built page: -DHOOKEYE_PAGE=FILE");
#endif
}

/// JSON that may stand inside a script element.
std::string inside_script(const json& document) {
  const std::string text = document.dump(-1, ' ', false, json::error_handler_t::replace);
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  }
  return out;
}

std::string attribute(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '"')
      out += "&quot;";
    else if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else
      out += c;
  }
  return out;
}

void collect(const json& value, std::vector<std::string>& names, std::set<std::string>& known) {
  if (value.is_object() && value.contains("blob") && value["blob"].is_string())
    if (known.insert(value["blob"]).second) names.push_back(value["blob"]);
  for (const auto& inner : value)
    if (inner.is_structured()) collect(inner, names, known);
}

}  // namespace

bool has_page() {
#ifdef HOOKEYE_HAS_PAGE
  return true;
#else
  return false;
#endif
}

std::vector<std::string> blob_names(const json& document) {
  std::vector<std::string> names;
  std::set<std::string> known;
  collect(document.at("photos"), names, known);
  for (const auto& step : document.at("steps")) {
    collect(step.at("residuals"), names, known);
    for (const auto& field : step.at("fields"))
      if (known.insert(field).second) names.push_back(field);
    collect(step.at("deformed"), names, known);
  }
  return names;
}

std::string part(const std::string& name, const RunView::Blob& blob) {
  const std::string open = "<script type=\"text/plain\" data-part=\"" + attribute(name) + "\"";
  if (blob.text) {
    std::string damage;
    const auto found = parse_json(blob.bytes, damage);
    if (!found) throw DamagedPart(name + " is " + damage + ": it is left out");
    return open + ">" + inside_script(*found) + "</script>\n";
  }
  return open + " data-base64>" + base64(blob.bytes.data(), blob.bytes.size()) + "</script>\n";
}

std::string make_page(const json& document, const std::string& parts) {
  static constexpr std::string_view kDocument = "<!--hookeye:document-->";
  static constexpr std::string_view kParts = "<!--hookeye:parts-->";
  const std::string_view page = built_page();
  const size_t at = page.find(kDocument), end = page.rfind(kParts);
  if (at == std::string_view::npos || end == std::string_view::npos || end < at)
    throw std::logic_error("the built page has lost its marks");
  std::string out;
  out.reserve(page.size() + parts.size() + 100000);
  out += page.substr(0, at);
  out +=
      "<script type=\"application/json\" id=\"document\">" + inside_script(document) + "</script>";
  out += page.substr(at + kDocument.size(), end - at - kDocument.size());
  out += parts;
  out += page.substr(end + kParts.size());
  return out;
}

}  // namespace hookeye
