#include "app/report/parse_json.h"

#include <fmt/format.h>

namespace hookeye {

std::optional<nlohmann::json> parse_json(const std::string& text, std::string& damage) {
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    // The parser counts from one; where the text ended too early, one beyond it.
    damage = error.byte > text.size()
                 ? fmt::format("damaged (cut short at byte {})", text.size())
                 : fmt::format("damaged (not JSON from byte {} on)", error.byte);
    return {};
  }
}

}  // namespace hookeye
