// JSON that may be damaged or another's: what is wrong with it in words, before anything believes
// it.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace hookeye {

/// The parsed text. Empty: `damage` says "damaged (cut short at byte 812)", or that it is nested
/// deeper than any that this program writes.
std::optional<nlohmann::json> parse_json(const std::string& text, std::string& damage);

/// Of a file. Throws InputError.
nlohmann::json read_json(const std::filesystem::path& file);

/// Throws InputError unless `value` is as `shape` shows:
///   "number", "text", "flag", "list", "map", "null", "any", or several: "number|null"
///   [SHAPE]: a list, each of its items so; [SHAPE, SHAPE]: a list of two
///   {"name": SHAPE, "?other": SHAPE, "*": SHAPE}: a map with `name`; `other` and all else if there
/// The message names the value that is not: `steps/2/chi_fit`.
void expect_shape(const nlohmann::json& value, const nlohmann::json& shape,
                  const std::filesystem::path& file);

}  // namespace hookeye
