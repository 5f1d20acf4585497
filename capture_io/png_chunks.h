// A PNG looked at before libpng sees it: what it would only find after allocating, or would tell on
// standard error by itself.
#pragma once

#include <filesystem>

namespace hookeye {

/// By the signature, whatever the name.
bool is_png(const std::filesystem::path& file);

/// Whether the chunks (length, name, data, checksum) can be followed from the header to the first
/// with pixels, and what stands before that is as it was written.
bool png_begins_well(const std::filesystem::path& file);

/// Whether all chunks up to the end are there, and those that decoding needs as they were written.
/// libpng would tell faults on standard error before it returns.
bool png_is_intact(const std::filesystem::path& file);

/// What the header claims that inflating gives, one filter byte a row included.
double png_claimed_bytes(const std::filesystem::path& file);

}  // namespace hookeye
