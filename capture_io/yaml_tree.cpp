#include "capture_io/yaml_tree.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <sstream>

namespace hookeye {
namespace {

size_t count_nodes(const YamlNode& node) {
  size_t count = 1;
  for (const YamlNode& item : node.items) count += count_nodes(item);
  for (const YamlNode::Entry& entry : node.entries) count += count_nodes(entry.value);
  return count;
}

int depth_of(const YamlNode& node) {
  int deepest = 0;
  for (const YamlNode& item : node.items) deepest = std::max(deepest, depth_of(item));
  for (const YamlNode::Entry& entry : node.entries)
    deepest = std::max(deepest, depth_of(entry.value));
  return deepest + 1;
}

/// Builds the tree from the parser's events: yaml-cpp's own Node would drop duplicate keys silently
/// and share aliased nodes, which loses both places and bounds.
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(const std::string& file, const YamlLimits& limits) : file_(file), limits_(limits) {}

  YamlNode take() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    add(leaf(YamlNode::Kind::null, mark), anchor);
  }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                const std::string& value) override {
    YamlNode node = leaf(YamlNode::Kind::scalar, mark);
    node.text = value;
    add(std::move(node), anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override;
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(YamlNode::Kind::sequence, mark, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(YamlNode::Kind::map, mark, anchor);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Level {
    YamlNode node;
    YAML::anchor_t anchor = 0;
    bool has_key = false;  ///< a map's key was read, its value not yet
    YamlNode::Entry entry;
    std::map<std::string, Place> key_places;
  };

  Place place(const YAML::Mark& mark) const { return {file_, mark.line + 1, mark.column + 1}; }
  YamlNode leaf(YamlNode::Kind kind, const YAML::Mark& mark) const {
    YamlNode node;
    node.kind = kind;
    node.place = place(mark);
    return node;
  }
  void open(YamlNode::Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor);
  void close();
  void add(YamlNode node, YAML::anchor_t anchor);
  void add_key(Level& level, const YamlNode& node);

  std::string file_;
  YamlLimits limits_;
  YamlNode root_;
  std::vector<Level> levels_;
  std::map<YAML::anchor_t, YamlNode> anchors_;
  size_t alias_nodes_ = 0;
};

void TreeBuilder::OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) {
  const auto found = anchors_.find(anchor);
  if (found == anchors_.end())
    throw InputError(place(mark), "an alias stands inside the value that it names",
                     "write the value out");
  alias_nodes_ += count_nodes(found->second);
  if (alias_nodes_ > limits_.alias_nodes)
    throw InputError(
        place(mark),
        fmt::format("aliases blow this file up to more than {} values", limits_.alias_nodes),
        "write the values out instead of nesting aliases");
  if (static_cast<int>(levels_.size()) + depth_of(found->second) > limits_.depth)
    throw InputError(place(mark), fmt::format("values are nested deeper than {}", limits_.depth),
                     "a capture needs fewer than ten levels");
  add(found->second, 0);
}

void TreeBuilder::open(YamlNode::Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor) {
  if (static_cast<int>(levels_.size()) >= limits_.depth)
    throw InputError(place(mark), fmt::format("values are nested deeper than {}", limits_.depth),
                     "a capture needs fewer than ten levels");
  if (!levels_.empty() && levels_.back().node.kind == YamlNode::Kind::map &&
      !levels_.back().has_key)
    throw InputError(place(mark), "a list or map stands where a key is expected",
                     "write `key: value`");
  Level level;
  level.node = leaf(kind, mark);
  level.anchor = anchor;
  levels_.push_back(std::move(level));
}

void TreeBuilder::close() {
  YamlNode node = std::move(levels_.back().node);
  const YAML::anchor_t anchor = levels_.back().anchor;
  levels_.pop_back();
  add(std::move(node), anchor);
}

void TreeBuilder::add_key(Level& level, const YamlNode& node) {
  if (node.kind != YamlNode::Kind::scalar)
    throw InputError(node.place, "a key is missing before the colon", "write `key: value`");
  const auto [first, is_new] = level.key_places.emplace(node.text, node.place);
  if (!is_new)
    throw InputError(
        node.place, fmt::format("`{}` is given twice", node.text),
        fmt::format("it already stands in line {}; keep one of the two", first->second.line));
  level.entry = {node.text, node.place, {}};
  level.has_key = true;
}

void TreeBuilder::add(YamlNode node, YAML::anchor_t anchor) {
  if (anchor) anchors_[anchor] = node;
  if (levels_.empty()) {
    root_ = std::move(node);
    return;
  }
  Level& level = levels_.back();
  if (level.node.kind == YamlNode::Kind::sequence) {
    level.node.items.push_back(std::move(node));
  } else if (!level.has_key) {
    add_key(level, node);
  } else {
    level.entry.value = std::move(node);
    level.node.entries.push_back(std::move(level.entry));
    level.has_key = false;
  }
}

/// A tab in the indentation is the commonest fault that the parser explains least: the first such
/// line up to the one after the fault, 0 for none.
int line_with_tab(const std::string& text, int last_line) {
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; number <= last_line && std::getline(lines, line); ++number) {
    const size_t tab = line.find('\t');
    if (tab != std::string::npos && line.find_first_not_of(" \t") > tab) return number;
  }
  return 0;
}

[[noreturn]] void syntax_error(const YAML::Exception& error, const std::string& text,
                               const std::string& file) {
  if (error.mark.is_null()) throw InputError({file}, "not yaml: " + error.msg, "");
  const int line = error.mark.line + 1;
  if (const int tab = line_with_tab(text, line + 1))
    throw InputError({file, tab, 1}, "not yaml: a tab stands in the indentation",
                     "indent with blanks only");
  throw InputError({file, line, error.mark.column + 1}, "not yaml: " + error.msg,
                   "look at the indentation, brackets and quotes here and just before");
}

/// Editors of Windows save "Unicode", two bytes a character; the parser finds nothing in it. Told
/// by the mark at its beginning or, since a capture begins with ASCII, by the zero bytes.
void check_bytes(const std::string& text, const std::string& file) {
  const bool marked = text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF");
  const size_t zero = text.find('\0');
  if (marked || zero < 2) throw InputError({file}, "the file is in UTF-16", "save it in UTF-8");
  if (zero == std::string::npos) return;
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(zero), '\n');
  throw InputError({file, static_cast<int>(line)}, "there is a zero byte: this is no text",
                   "the file as it was written, in UTF-8");
}

}  // namespace

const YamlNode::Entry* YamlNode::entry(const std::string& key) const {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&](const Entry& entry) { return entry.key == key; });
  return found == entries.end() ? nullptr : &*found;
}

const YamlNode* YamlNode::find(const std::string& key) const {
  const Entry* found = entry(key);
  return found ? &found->value : nullptr;
}

YamlNode parse_yaml(const std::string& text, const std::string& file, const YamlLimits& limits) {
  if (text.size() > limits.bytes)
    throw InputError({file}, fmt::format("{} bytes of yaml are too many", text.size()),
                     fmt::format("at most {} MiB are read", limits.bytes >> 20));
  check_bytes(text, file);
  TreeBuilder builder(file, limits);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(builder))
      throw InputError({file}, "the file is empty", limits.begins);
    YamlNode root = builder.take();
    TreeBuilder rest(file, limits);
    if (parser.HandleNextDocument(rest))
      throw InputError(rest.take().place, "a second yaml document begins here",
                       fmt::format("one file holds one {}: remove the line `---` and what follows",
                                   limits.holds));
    return root;
  } catch (const YAML::Exception& error) {
    syntax_error(error, text, file);
  }
}

}  // namespace hookeye
