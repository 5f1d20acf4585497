// What a terminal may be given: text from files is shown there, never obeyed.
#pragma once

#include <string>

namespace hookeye {

/// `text` with every character that a terminal would obey instead of showing it (controls but for
/// line end and tab, C1 controls, and what turns the direction of writing) as its code: "\u001b";
/// bytes that are no UTF-8 as "\x9b". What was printable stays as it was. Of a JSON document it
/// makes the same document.
std::string printable(const std::string& text);

}  // namespace hookeye
