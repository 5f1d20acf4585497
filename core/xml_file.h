// XML files, read: names, attributes, texts, with their lines. The only file that touches pugixml
// is xml_file.cpp.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/input_error.h"

namespace hookeye {

/// A tag of an XmlFile, which must outlive it. One that is not there has no name, texts and
/// children.
class XmlNode {
 public:
  XmlNode() = default;
  explicit operator bool() const { return node_ != nullptr; }
  std::string_view name() const;
  std::string_view attribute(const char* name) const;  ///< "": not there
  bool has(const char* attribute) const;
  std::string_view text() const;  ///< the first text directly in it
  XmlNode child(const char* name) const;
  /// The child of that name whose attribute has that value.
  XmlNode child(const char* name, const char* attribute, const std::string& value) const;
  XmlNode next(const char* name) const;   ///< the next sibling of that name
  std::vector<XmlNode> children() const;  ///< tags alone
  /// All tags of that name below it, however deep, in the file's order.
  std::vector<XmlNode> all(const char* name) const;

 private:
  friend class XmlFile;
  void* node_ = nullptr;
};

class XmlFile {
 public:
  /// Throws InputError with the line of the fault; `right` is what is expected.
  XmlFile(std::string bytes, const std::string& file, const std::string& right);
  XmlFile(XmlFile&&) noexcept;
  ~XmlFile();
  XmlNode child(const char* name) const;  ///< the tag at the top of that name
  XmlNode top() const;                    ///< the first tag
  Place place(const XmlNode& node) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// For text and attributes.
std::string xml_escaped(std::string_view text);

}  // namespace hookeye
