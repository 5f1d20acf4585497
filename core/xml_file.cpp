#include "core/xml_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <pugixml.hpp>

namespace hookeye {
namespace {

pugi::xml_node node_of(void* node) {
  return pugi::xml_node(static_cast<pugi::xml_node_struct*>(node));
}

void collect(const pugi::xml_node& from, const std::string& name, std::vector<void*>& out) {
  struct Walker : pugi::xml_tree_walker {
    Walker(const std::string& wanted, std::vector<void*>& found) : wanted_(wanted), found_(found) {}
    bool for_each(pugi::xml_node& node) override {
      if (node.type() == pugi::node_element && wanted_ == node.name())
        found_.push_back(node.internal_object());
      return true;
    }
    const std::string& wanted_;
    std::vector<void*>& found_;
  } walker(name, out);
  pugi::xml_node(from).traverse(walker);
}

}  // namespace

struct XmlFile::Impl {
  std::string file, bytes;  ///< the document points into the bytes
  std::vector<size_t> ends_of_lines;
  pugi::xml_document document;

  int line_at(std::ptrdiff_t offset) const {
    if (offset < 0) return 0;
    const auto at =
        std::lower_bound(ends_of_lines.begin(), ends_of_lines.end(), static_cast<size_t>(offset));
    return 1 + static_cast<int>(at - ends_of_lines.begin());
  }
};

std::string_view XmlNode::name() const { return node_of(node_).name(); }
std::string_view XmlNode::attribute(const char* name) const {
  return node_of(node_).attribute(name).value();
}
bool XmlNode::has(const char* attribute) const { return node_of(node_).attribute(attribute); }
std::string_view XmlNode::text() const { return node_of(node_).text().get(); }

XmlNode XmlNode::child(const char* name) const {
  XmlNode out;
  out.node_ = node_of(node_).child(name).internal_object();
  return out;
}

XmlNode XmlNode::child(const char* name, const char* attribute, const std::string& value) const {
  XmlNode out;
  out.node_ =
      node_of(node_).find_child_by_attribute(name, attribute, value.c_str()).internal_object();
  return out;
}

XmlNode XmlNode::next(const char* name) const {
  XmlNode out;
  out.node_ = node_of(node_).next_sibling(name).internal_object();
  return out;
}

std::vector<XmlNode> XmlNode::children() const {
  std::vector<XmlNode> out;
  for (const pugi::xml_node& node : node_of(node_).children())
    if (node.type() == pugi::node_element) out.emplace_back().node_ = node.internal_object();
  return out;
}

std::vector<XmlNode> XmlNode::all(const char* name) const {
  std::vector<void*> found;
  collect(node_of(node_), name, found);
  std::vector<XmlNode> out(found.size());
  for (size_t i = 0; i < found.size(); ++i) out[i].node_ = found[i];
  return out;
}

XmlFile::XmlFile(std::string bytes, const std::string& file, const std::string& right)
    : impl_(std::make_unique<Impl>()) {
  impl_->file = file;
  impl_->bytes = std::move(bytes);
  for (size_t at = impl_->bytes.find('\n'); at != std::string::npos;
       at = impl_->bytes.find('\n', at + 1))
    impl_->ends_of_lines.push_back(at);
  const pugi::xml_parse_result parsed =
      impl_->document.load_buffer_inplace(impl_->bytes.data(), impl_->bytes.size());
  if (!parsed)
    throw InputError(
        {file,
         parsed.status == pugi::status_no_document_element ? 0 : impl_->line_at(parsed.offset)},
        fmt::format("cannot be read: {}", parsed.description()), right);
}

XmlFile::XmlFile(XmlFile&&) noexcept = default;
XmlFile::~XmlFile() = default;

XmlNode XmlFile::child(const char* name) const {
  XmlNode out;
  out.node_ = impl_->document.child(name).internal_object();
  return out;
}

XmlNode XmlFile::top() const {
  XmlNode out;
  out.node_ = impl_->document.document_element().internal_object();
  return out;
}

Place XmlFile::place(const XmlNode& node) const {
  return {impl_->file, impl_->line_at(node_of(node.node_).offset_debug())};
}

std::string xml_escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const char* const entity = c == '&'   ? "&amp;"
                               : c == '<' ? "&lt;"
                               : c == '>' ? "&gt;"
                               : c == '"' ? "&quot;"
                                          : nullptr;
    if (entity)
      out += entity;
    else
      out += c;
  }
  return out;
}

}  // namespace hookeye
