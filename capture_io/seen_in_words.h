// What a capture is fitted to, as a word of the sentences that users read. One rule for terminal,
// decisions and page.
#pragma once

#include <string>

#include "capture_io/capture.h"

namespace hookeye {

/// What residuals are of: "photos"; where there are none "fields", and where there are none of
/// those "values" (forces, positions).
inline const char* seen_in_words(bool photos, bool fields) {
  return photos ? "photos" : fields ? "fields" : "values";
}

inline const char* seen_in_words(const Capture& capture) {
  bool photos = false, fields = false;
  for (const ExampleSpec& example : capture.examples) {
    photos |= !example.photos.empty();
    for (const auto& measured : example.measured) fields |= measured.field != nullptr;
  }
  return seen_in_words(photos, fields);
}

/// " on half-size photos", what a screening looks at; "" where there are none to be made smaller.
inline std::string on_half_size(const Capture& capture) {
  return seen_in_words(capture) == std::string("photos") ? " on half-size photos" : "";
}

}  // namespace hookeye
