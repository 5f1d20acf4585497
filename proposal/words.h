// Small words on text; for this folder alone.
#pragma once

#include <string>
#include <vector>

namespace hookeye {

/// Without blanks at its ends.
std::string trimmed(const std::string& text);
/// ASCII letters in lower case.
std::string lower(std::string text);
/// The pieces between commas, trimmed.
std::vector<std::string> between_commas(const std::string& text);
/// Whether one of `pieces` stands in the text.
bool has_any(const std::string& text, const std::vector<std::string>& pieces);
/// "1 photo", "2 photos".
std::string counted(size_t n, const std::string& one);

}  // namespace hookeye
