// JSON that may be damaged, and what is wrong with it in words.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace hookeye {

/// The parsed text. Empty: `damage` says "damaged (cut short at byte 812)".
std::optional<nlohmann::json> parse_json(const std::string& text, std::string& damage);

}  // namespace hookeye
