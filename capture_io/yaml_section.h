// Typed, checked access to yaml values: every fault is an InputError with the value's place, what
// is wrong and what would be right.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "capture_io/yaml_tree.h"

namespace hookeye {

/// The folder of the capture, out of which no file may lead.
struct CaptureFolder {
  std::filesystem::path given;      ///< as the user gave it, for messages
  std::filesystem::path canonical;  ///< absolute, links resolved
};

/// One map of the yaml file. The constructor refuses everything that is not a map and every key
/// that is not in `known`; get() refuses to ask for a key that the list lacks (our own slip).
class YamlSection {
 public:
  YamlSection(const YamlNode& node, std::string what, std::vector<std::string> known);

  const YamlNode* find(const std::string& key) const;  ///< null: not given
  /// Throws where the key is missing; `right` says what to write.
  const YamlNode& need(const std::string& key, const std::string& right) const;
  bool has(const std::string& key) const { return find(key) != nullptr; }
  /// The one key given among `keys`; throws for none and for two.
  std::string one_of(const std::vector<std::string>& keys) const;
  const std::string& what() const { return what_; }
  const Place& place() const { return node_.place; }
  const YamlNode::Entry* entry(const std::string& key) const;

 private:
  const YamlNode& node_;
  std::string what_;
  std::vector<std::string> known_;
};

/// What stands there, for messages: "`abc`", "a list of 2", "a map", "empty".
std::string describe(const YamlNode& node);
/// "did you mean `x`?" where a known name is near, else "known here: a, b, c".
std::string suggest(const std::string& word, const std::vector<std::string>& known);
[[noreturn]] void unexpected(const YamlNode& node, const std::string& what,
                             const std::string& right);

/// The whole text as a number, whatever the locale; none where it is no number. yaml's .nan and
/// .inf come through so that they are refused by name.
std::optional<double> number_of(const YamlNode& node);
/// Readers of one value; `what` names it in messages ("fx of camera front").
double read_number(const YamlNode& node, const std::string& what);
double read_positive(const YamlNode& node, const std::string& what);
double read_not_negative(const YamlNode& node, const std::string& what);
int read_integer(const YamlNode& node, const std::string& what);
std::string read_string(const YamlNode& node, const std::string& what);
/// One of `choices`.
std::string read_choice(const YamlNode& node, const std::string& what,
                        const std::vector<std::string>& choices);
std::vector<double> read_numbers(const YamlNode& node, const std::string& what);
Eigen::Vector3d read_vector3(const YamlNode& node, const std::string& what);
/// The same, scaled to length one; zero is refused.
Eigen::Vector3d read_direction(const YamlNode& node, const std::string& what);
/// A list's items; refuses everything else.
const std::vector<YamlNode>& read_list(const YamlNode& node, const std::string& what,
                                       const std::string& right);
/// A map's entries whose keys are names that the user chose: they become file names.
const std::vector<YamlNode::Entry>& read_named(const YamlNode& node, const std::string& what);
/// An existing file inside the capture's folder, absolute with links resolved; where `extensions`
/// are given, one of them.
std::filesystem::path read_file_path(const YamlNode& node, const std::string& what,
                                     const CaptureFolder& folder,
                                     const std::vector<std::string>& extensions = {});

}  // namespace hookeye
