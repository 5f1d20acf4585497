#include "runs/report/write_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/interrupted.h"
#include "core/text_file.h"
#include "runs/report/page.h"

namespace hookeye {
namespace {

/// A page that may be mailed.
constexpr size_t kMostBytes = 30'000'000;

/// What is left out of a page that would grow too large, the least needed first.
struct Reduction {
  int earlier, newest;  ///< by how much the pictures of earlier steps, and all others, are shrunk
  bool volumes;         ///< whether the deformed bodies (.vtu) are in the page
  bool all_effects;     ///< whether what effects that do not lead would change is drawn too
  bool between;         ///< whether the steps between the first and the newest are drawn as bodies
};
constexpr Reduction kReductions[] = {{1, 1, true, true, true},    {1, 1, false, true, true},
                                     {1, 1, false, false, true},  {2, 1, false, false, true},
                                     {2, 2, false, false, false}, {4, 4, false, false, false},
                                     {8, 8, false, false, false}, {16, 16, false, false, false}};

std::string said(const Reduction& reduction, size_t steps, size_t left_out) {
  std::vector<std::string> parts;
  if (reduction.newest > 1)
    parts.push_back(fmt::format("pictures are shrunk to 1/{} of their width", reduction.newest));
  else if (reduction.earlier > 1)
    parts.push_back("residuals of earlier steps are at half size");
  if (!reduction.volumes) parts.push_back(".vtu files are left out");
  if (!reduction.all_effects)
    parts.push_back("what an effect would change is drawn for the leading ones only");
  if (!reduction.between && steps > 2)
    parts.push_back("steps between the first and the newest come without body and arrows");
  if (left_out > 0) parts.push_back(fmt::format("{} pictures or bodies are left out", left_out));
  if (parts.empty()) return {};
  return fmt::format("To keep this file under {} MB, {}. The run folder holds everything.",
                     kMostBytes / 1'000'000, fmt::join(parts, "; "));
}

/// Fields of what an effect would change, but for the effects with pictures at full size.
void keep_leading(nlohmann::json& step) {
  const nlohmann::json& diagnosis = step["diagnosis"];
  if (!diagnosis.is_object() || !diagnosis.contains("effects")) return;
  for (const auto& effect : diagnosis["effects"])
    if (!effect.contains("pictures")) step["fields"].erase("removes-" + effect.value("effect", ""));
}

nlohmann::json reduced_document(RunView& run, const Reduction& reduction) {
  nlohmann::json document = run.document(reduction.earlier, reduction.newest);
  auto& steps = document["steps"];
  for (size_t i = 0; i < steps.size(); ++i) {
    if (!reduction.volumes) steps[i]["deformed"] = nlohmann::json::array();
    if (!reduction.all_effects) keep_leading(steps[i]);
    if (!reduction.between && i > 0 && i + 1 < steps.size())
      steps[i]["fields"] = nlohmann::json::object();
  }
  return document;
}

/// Elements of the page by name; pictures that a smaller page needs again are not made again.
class Parts {
 public:
  Parts(RunView& run, const WriteReport& told) : run_(run), told_(told) {}

  /// The elements of `names` in at most `most` bytes. Where they are more: nothing, or, with
  /// `left_out`, those that fit and the number of the others.
  std::optional<std::string> collect(const std::vector<std::string>& names, size_t most,
                                     size_t* left_out, nlohmann::json& faults) {
    std::string out;
    int done = 0;
    for (const auto& name : names) {
      if (told_.cancel && *told_.cancel) throw Interrupted{};
      const std::string element = element_of(name, faults);
      if (told_.progress) told_.progress(++done, static_cast<int>(names.size()));
      if (out.size() + element.size() <= most)
        out += element;
      else if (left_out)
        ++*left_out;
      else
        return std::nullopt;
    }
    return out;
  }

 private:
  std::string element_of(const std::string& name, nlohmann::json& faults) {
    const auto known = made_.find(name);
    if (known != made_.end()) return known->second;
    try {
      if (const auto blob = run_.blob(name))
        return made_.emplace(name, part(name, *blob)).first->second;
      faults.push_back(name + " is not there");
    } catch (const DamagedPart& error) {
      faults.push_back(error.what());
    } catch (const std::exception& error) {
      faults.push_back(name + ": " + error.what());
    }
    return {};
  }

  RunView& run_;
  const WriteReport& told_;
  std::map<std::string, std::string> made_;
};

}  // namespace

nlohmann::json write_report(const std::filesystem::path& folder, const std::filesystem::path& out,
                            const WriteReport& told) {
  RunView run(folder);
  Parts parts(run, told);
  for (const Reduction& reduction : kReductions) {
    const bool last = &reduction == std::end(kReductions) - 1;
    nlohmann::json document = reduced_document(run, reduction);
    // Room for what is said of the reduction, and for faults found while the parts are made.
    const size_t frame = make_page(document).size() + 100'000;
    size_t left_out = 0;
    const auto elements =
        parts.collect(blob_names(document), kMostBytes - std::min(kMostBytes, frame),
                      last ? &left_out : nullptr, document["faults"]);
    if (!elements) continue;
    const std::string reduced = said(reduction, document["steps"].size(), left_out);
    document["reduction"] = reduced;
    const std::string page = make_page(document, *elements);
    write_text(out, page);
    return {{"hookeye", 1},         {"report", out.string()},       {"bytes", page.size()},
            {"reduction", reduced}, {"faults", document["faults"]}, {"answer", document["answer"]}};
  }
  throw std::logic_error("the last reduction leaves out what does not fit");
}

}  // namespace hookeye
