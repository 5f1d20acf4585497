#include "capture_io/yaml_edit.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "capture_io/capture.h"
#include "capture_io/yaml_lines.h"
#include "core/text_file.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;
using Kind = YamlNode::Kind;

std::string blanks(int n) { return std::string(static_cast<size_t>(std::max(n, 0)), ' '); }

/// A key as people write it; in quotes where it would be none.
std::string key_text(const std::string& key) {
  static const std::set<std::string> taken{"y",   "n",    "yes",  "no",   "on",
                                           "off", "true", "null", "false"};
  const bool plain = std::all_of(key.begin(), key.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '.' || c == '-';
  });
  std::string low = key;
  for (char& c : low) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const bool word = !key.empty() && std::isalpha(static_cast<unsigned char>(key[0]));
  return plain && word && !taken.contains(low) ? key : nlohmann::json(key).dump();
}

size_t index_in(const YamlNode& list, const std::string& step) {
  const bool digits =
      !step.empty() && step.size() < 9 && step.find_first_not_of("0123456789") == std::string::npos;
  const size_t i = digits ? std::stoul(step) : list.items.size();
  return std::min(i, list.items.size());
}

const YamlNode* child_of(const YamlNode& node, const std::string& step) {
  if (node.kind != Kind::sequence) return node.find(step);
  const size_t i = index_in(node, step);
  return i < node.items.size() ? &node.items[i] : nullptr;
}

YamlNode empty_node(Kind kind) {
  YamlNode node;
  node.kind = kind;
  return node;
}

/// What an edit means, on the tree alone. The text that is written has to be read as this.
void apply(YamlNode& node, const YamlEdit& edit, const YamlNode* value, size_t depth) {
  const std::string& step = edit.path[depth];
  const bool last = depth + 1 == edit.path.size();
  if (node.kind == Kind::null) node = empty_node(step == "+" ? Kind::sequence : Kind::map);
  if (node.kind == Kind::sequence) {
    const size_t i = index_in(node, step);
    if (!value && last) {
      node.items.erase(node.items.begin() + static_cast<std::ptrdiff_t>(i));
      return;
    }
    if (i == node.items.size()) node.items.emplace_back();
    if (last)
      node.items[i] = *value;
    else
      apply(node.items[i], edit, value, depth + 1);
    return;
  }
  auto found = std::find_if(node.entries.begin(), node.entries.end(),
                            [&](const YamlNode::Entry& entry) { return entry.key == step; });
  if (!value && last) {
    node.entries.erase(found);
    return;
  }
  if (found == node.entries.end()) {
    const auto at =
        std::find_if(node.entries.begin(), node.entries.end(),
                     [&](const YamlNode::Entry& entry) { return entry.key == edit.above; });
    found = node.entries.insert(edit.first   ? node.entries.begin()
                                : depth == 0 ? at
                                             : node.entries.end(),
                                YamlNode::Entry{step, {}, {}});
  }
  if (last)
    found->value = *value;
  else
    apply(found->value, edit, value, depth + 1);
}

/// One edit of a text: walks down its path and rewrites at the end of it.
class Editing {
 public:
  Editing(const std::string& text, const YamlEdit& edit) : text_(text), edit_(edit) {}

  std::string set(const YamlNode& root) {
    const YamlNode::Entry* key = nullptr;
    const YamlNode* node = &root;
    bool flow = text_.begins(root, "{[");
    for (size_t depth = 0; depth < edit_.path.size(); ++depth) {
      const YamlNode* next = child_of(*node, edit_.path[depth]);
      if (!next) return added(*node, key, flow, depth);
      key = node->kind == Kind::map ? node->entry(edit_.path[depth]) : nullptr;
      node = next;
      if (depth + 1 < edit_.path.size()) flow = flow || text_.begins(*node, "{[");
    }
    return replaced(*node, key, flow);
  }

  std::string removed(const YamlNode& parent) {
    const bool flow = text_.begins(parent, "{[");
    const std::string& step = edit_.path.back();
    if (parent.kind == Kind::map) {
      const YamlNode::Entry& entry = *parent.entry(step);
      return flow ? out_of_brackets(text_.offset(entry.place), entry.value)
                  : without_lines(text_.offset(entry.place), entry.place.line,
                                  entry.place.column - 1, entry.value.kind == Kind::sequence);
    }
    const YamlNode& item = *child_of(parent, step);
    if (flow) return out_of_brackets(text_.offset(item.place), item);
    const size_t dash = text_.dash_before(text_.offset(item.place));
    const int line = text_.line_of(dash);
    return without_lines(dash, line, static_cast<int>(dash - text_.line(line)), false);
  }

 private:
  /// Of what is missing from `depth` on, in brackets.
  std::string in_brackets(size_t depth) const {
    std::string out = *edit_.value;
    for (size_t i = edit_.path.size(); i-- > depth;) {
      const std::string& step = edit_.path[i];
      const bool item = step == "+";
      out = item ? out : key_text(step) + ": " + out;
      if (i > depth) out = item ? "[" + out + "]" : "{" + out + "}";
    }
    return out;
  }
  /// The same on lines of their own.
  std::string on_lines(size_t depth, int indent) const {
    std::string out;
    for (size_t i = depth; i < edit_.path.size(); ++i, indent += 2) {
      const bool last = i + 1 == edit_.path.size();
      out += blanks(indent) + (edit_.path[i] == "+" ? "-" : key_text(edit_.path[i]) + ":");
      out += (last ? " " + *edit_.value : "") + text_.line_end();
    }
    return out;
  }
  std::string insert_lines(int line, const std::string& lines) const {
    const size_t at = text_.line(line);
    const std::string& raw = text_.str();
    const bool open = at > 0 && at == raw.size() && raw.back() != '\n';
    return text_.replaced(at, at, (open ? text_.line_end() : "") + lines);
  }

  std::string added(const YamlNode& node, const YamlNode::Entry* key, bool flow, size_t depth) {
    if (node.kind == Kind::null && key && !flow) {
      const int below = text_.line_of(text_.offset(key->place)) + 1;
      return insert_lines(below, on_lines(depth, key->place.column + 1));
    }
    const size_t begin = text_.offset(node.place);
    if (text_.begins(node, "{[")) {
      const bool empty = node.items.empty() && node.entries.empty();
      if (edit_.first)
        return text_.replaced(begin + 1, begin + 1, in_brackets(depth) + (empty ? "" : ", "));
      size_t end = text_.end_of(begin, true) - 1;
      while (end > begin + 1 && std::isspace(static_cast<unsigned char>(text_.str()[end - 1])))
        --end;
      return text_.replaced(end, end, (empty ? "" : ", ") + in_brackets(depth));
    }
    if (node.kind == Kind::map) {
      const int indent = node.entries.front().place.column - 1;
      if (edit_.first && key) return insert_lines(key->place.line + 1, on_lines(depth, indent));
      if (const YamlNode::Entry* next = depth == 0 ? node.entry(edit_.above) : nullptr)
        return insert_lines(text_.above_comments(next->place.line), on_lines(depth, indent));
      const YamlNode::Entry& last = node.entries.back();
      return insert_lines(text_.block_end(last.place.line + 1, last.place.column - 1,
                                          last.value.kind == Kind::sequence),
                          on_lines(depth, indent));
    }
    if (node.kind != Kind::sequence) return text_.str();  // a value: refused by what is read
    const size_t dash = text_.dash_before(text_.offset(node.items.back().place));
    const int line = text_.line_of(dash), indent = static_cast<int>(dash - text_.line(line));
    return insert_lines(text_.block_end(line + 1, indent, false), on_lines(depth, indent));
  }

  std::string replaced(const YamlNode& node, const YamlNode::Entry* key, bool flow) const {
    const std::string& value = *edit_.value;
    if (node.kind == Kind::null && key) {
      const size_t colon = text_.str().find(':', text_.offset(key->place));
      return text_.replaced(colon + 1, colon + 1, " " + value);
    }
    const size_t begin = text_.offset(node.place);
    const bool block =
        (node.kind == Kind::map || node.kind == Kind::sequence) && !text_.begins(node, "{[");
    if (!block) return text_.replaced(begin, text_.end_of(begin, flow), value);
    if (key) {  // what stands behind the key's colon is a comment
      const size_t at = text_.offset(key->place), colon = text_.str().find(':', at) + 1;
      const int end =
          text_.block_end(key->place.line + 1, key->place.column - 1, node.kind == Kind::sequence);
      const size_t below = text_.line(key->place.line + 1);
      const std::string head = text_.str().substr(colon, below - colon);
      return text_.replaced(colon, text_.line(end), " " + value + head);
    }
    const size_t dash = text_.dash_before(begin);
    const int line = text_.line_of(dash), indent = static_cast<int>(dash - text_.line(line));
    const int end = text_.block_end(line + 1, indent, false);
    return text_.replaced(begin, text_.line(end), value + text_.line_end());
  }

  std::string out_of_brackets(size_t begin, const YamlNode& value) const {
    const std::string& raw = text_.str();
    size_t end = text_.end_of(text_.offset(value.place), true);
    const size_t next = raw.find_first_not_of(" \t\r\n", end);
    if (next != std::string::npos && raw[next] == ',') {
      end = std::min(raw.find_first_not_of(" \t", next + 1), raw.size());
    } else {
      const size_t before = raw.find_last_not_of(" \t\r\n", begin - 1);
      if (before != std::string::npos && raw[before] == ',') begin = before;
    }
    return text_.replaced(begin, end, "");
  }
  std::string without_lines(size_t begin, int line, int indent, bool holds_list) const {
    if (text_.str().find_first_not_of(' ', text_.line(line)) != begin) return text_.str();
    return text_.replaced(text_.line(line),
                          text_.line(text_.block_end(line + 1, indent, holds_list)), "");
  }

  YamlLines text_;
  const YamlEdit& edit_;
};

/// Of a value that goes: where it is the last of its list the list goes; of its map, it becomes {}.
YamlEdit settled(const YamlNode& root, YamlEdit edit) {
  while (!edit.value) {
    const YamlNode* parent = &root;
    for (size_t i = 0; parent && i + 1 < edit.path.size(); ++i)
      parent = child_of(*parent, edit.path[i]);
    if (!parent || !child_of(*parent, edit.path.back()))
      throw InputError(root.place, fmt::format("there is no `{}`", fmt::join(edit.path, ": ")), "");
    if (parent->items.size() + parent->entries.size() != 1 || edit.path.size() == 1) break;
    edit.path.pop_back();
    if (parent->kind == Kind::map) edit.value = "{}";
  }
  return edit;
}

const YamlNode* parent_of(const YamlNode& root, const YamlEdit& edit, Place* near) {
  const YamlNode* node = &root;
  for (size_t i = 0; i + 1 < edit.path.size(); ++i) {
    const YamlNode::Entry* entry = node->entry(edit.path[i]);
    const YamlNode* next = child_of(*node, edit.path[i]);
    if (!next) break;
    *near = entry ? entry->place : next->place;
    node = next;
  }
  return node;
}

}  // namespace

bool same_yaml(const YamlNode& a, const YamlNode& b) {
  const auto same_entry = [](const YamlNode::Entry& x, const YamlNode::Entry& y) {
    return x.key == y.key && same_yaml(x.value, y.value);
  };
  return a.kind == b.kind && a.text == b.text &&
         std::equal(a.items.begin(), a.items.end(), b.items.begin(), b.items.end(), same_yaml) &&
         std::equal(a.entries.begin(), a.entries.end(), b.entries.begin(), b.entries.end(),
                    same_entry);
}

std::string edited_yaml(const std::string& text, const std::string& file, const YamlEdit& wanted) {
  const YamlNode before = parse_yaml(text, file);
  const YamlEdit edit = settled(before, wanted);
  Place near = before.place;
  const YamlNode* parent = parent_of(before, edit, &near);
  if (edit.value && edit.value->find_first_of("\r\n") == std::string::npos) {
    const YamlNode value = parse_yaml(*edit.value, "the new value");
    try {
      Editing editing(text, edit);
      const std::string out = editing.set(before);
      YamlNode expected = before;
      apply(expected, edit, &value, 0);
      if (same_yaml(parse_yaml(out, file), expected)) return out;
    } catch (const InputError&) {
      // told below
    }
  } else if (!edit.value) {
    try {
      const std::string out = Editing(text, edit).removed(*parent);
      YamlNode expected = before;
      apply(expected, edit, nullptr, 0);
      if (same_yaml(parse_yaml(out, file), expected)) return out;
    } catch (const InputError&) {
      // told below
    }
  }
  const std::string path = fmt::format("{}", fmt::join(edit.path, ": "));
  throw InputError(
      near, fmt::format("`{}` cannot be changed in this file without changing more of it", path),
      edit.value ? fmt::format("write it by hand: `{}: {}`", edit.path.back(), *edit.value)
                 : "remove it by hand");
}

void store_capture(const fs::path& file, const std::string& text, bool dry) {
  const fs::path tried =
      file.parent_path() / fmt::format(".tried-{}-{}", ::getpid(), file.filename().string());
  struct Removed {
    fs::path file;
    ~Removed() {
      std::error_code ignored;
      fs::remove(file, ignored);
    }
  } const removed{tried};
  write_text(tried, text);
  try {
    read_capture(tried);
  } catch (const InputError& fault) {
    if (fault.place().file != tried.string()) throw;
    throw InputError({file.string(), fault.place().line, fault.place().column}, fault.wrong(),
                     fault.right());
  }
  if (!dry) write_text(file, text);
}

}  // namespace hookeye
