// The page's only style, and the mark by which its security policy allows it.
#pragma once

namespace hookeye {

extern const char* const kFleetStyle;
/// SHA-256 of the style's bytes, in base64; tests/batch compares.
extern const char* const kFleetStyleHash;

}  // namespace hookeye
