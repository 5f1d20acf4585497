// Text for a terminal of 100 columns: tables, sentences, bars; and for HTML.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace hookeye {

constexpr size_t kColumns = 100;

/// Lines of columns, aligned: the first row is the head. Where a line would pass `width`, cells of
/// the widest columns go on below.
std::string table(const std::vector<std::vector<std::string>>& rows, size_t width = kColumns);

/// Lines of at most `width` columns, each ended; those after the first stand two columns further
/// in. A single word that is longer (a path) stays whole.
std::string wrapped(const std::string& text, size_t indent = 0, size_t width = kColumns);

/// "  83 % ########..": a share as a small bar.
std::string bar(double share, int width = 10);
/// "###|####....": `value` on a scale that ends at `most`, with a mark where `mark` is.
std::string marked_bar(double value, double mark, double most, int width = 14);

/// Text that may stand anywhere in HTML.
std::string html_text(const std::string& text);

}  // namespace hookeye
