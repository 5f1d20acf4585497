#include "core/json_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string restore = "restore the file, or repeat what made it";

constexpr int kDeepest = 100;

/// Brackets that are open at once, outside of strings.
int depth_of(const std::string& text) {
  int depth = 0, deepest = 0;
  bool quoted = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') quoted = !quoted;
    if (quoted) {
      if (c == '\\') ++i;
    } else if (c == '[' || c == '{') {
      deepest = std::max(deepest, ++depth);
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return deepest;
}

std::string kind_of(const json& value) {
  if (value.is_number()) return "number";
  if (value.is_string()) return "text";
  if (value.is_boolean()) return "flag";
  if (value.is_array()) return "list";
  return value.is_object() ? "map" : "null";
}

bool is_one_of(const std::string& kind, const std::string& kinds) {
  return kinds == "any" || ("|" + kinds + "|").find("|" + kind + "|") != std::string::npos;
}

/// A value on its way down, and where it stands.
struct At {
  const json& value;
  std::string path;
  const fs::path& file;

  At item(const json& inner, const std::string& name) const {
    return {inner, path.empty() ? name : path + "/" + name, file};
  }
  [[noreturn]] void fail(const std::string& wanted) const {
    const std::string what = path.empty() ? "it" : "`" + path + "`";
    throw InputError(
        {file.string()},
        fmt::format("{} is a {}, where a {} is expected", what, kind_of(value), wanted), restore);
  }
};

void expect(const At& at, const json& shape);

void expect_map(const At& at, const json& shape) {
  if (!at.value.is_object()) at.fail("map");
  for (const auto& [key, inner] : shape.items()) {
    const bool optional = key[0] == '?';
    const std::string name = optional ? key.substr(1) : key;
    if (name == "*") {
      for (const auto& [own, value] : at.value.items())
        if (!shape.contains(own) && !shape.contains("?" + own)) expect(at.item(value, own), inner);
    } else if (at.value.contains(name)) {
      expect(at.item(at.value.at(name), name), inner);
    } else if (!optional) {
      throw InputError(
          {at.file.string()},
          fmt::format("{} lacks `{}`", at.path.empty() ? "it" : "`" + at.path + "`", name),
          restore);
    }
  }
}

void expect(const At& at, const json& shape) {
  if (shape.is_object()) return expect_map(at, shape);
  if (shape.is_array()) {
    if (!at.value.is_array()) at.fail("list");
    if (shape.size() > 1 && at.value.size() != shape.size())
      at.fail(fmt::format("list of {}", shape.size()));
    for (size_t i = 0; i < at.value.size(); ++i)
      expect(at.item(at.value[i], std::to_string(i)), shape.front());
    return;
  }
  const auto& kinds = shape.get_ref<const std::string&>();
  if (!is_one_of(kind_of(at.value), kinds)) at.fail(kinds);
}

}  // namespace

std::optional<json> parse_json(const std::string& text, std::string& damage) {
  if (depth_of(text) > kDeepest) {
    damage = fmt::format("damaged (nested deeper than {})", kDeepest);
    return {};
  }
  try {
    return json::parse(text);
  } catch (const json::parse_error& error) {
    // The parser counts from one; where the text ended too early, one beyond it.
    damage = error.byte > text.size()
                 ? fmt::format("damaged (cut short at byte {})", text.size())
                 : fmt::format("damaged (not JSON from byte {} on)", error.byte);
    return {};
  } catch (const json::exception&) {
    damage = "damaged (it holds a number that is none)";
    return {};
  }
}

json read_json(const fs::path& file) {
  std::string damage;
  if (auto found = parse_json(read_text(file), damage)) return *std::move(found);
  throw InputError({file.string()}, "the file is " + damage, restore);
}

void expect_shape(const json& value, const json& shape, const fs::path& file) {
  expect({value, "", file}, shape);
}

}  // namespace hookeye
