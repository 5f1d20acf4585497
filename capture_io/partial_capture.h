// A capture that is still being written: what of it can be read, and all that cannot.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "capture_io/capture.h"
#include "capture_io/yaml_tree.h"

namespace hookeye {

struct PartialCapture {
  /// Without what has a fault. A region with one is there by its name, as a group "", so that what
  /// names it is no fault too.
  Capture capture;
  YamlNode root;  ///< of the text; null where it is no yaml
  /// In the order of reading: at most one for each section, camera, region, entry of an example.
  std::vector<InputError> faults;
};

/// Reads `text` as the capture `file`, which need not be there, beside whose folder the files that
/// it names lie. Faults are told in `file`. A text without faults is one that read_capture() takes.
PartialCapture read_partly(const std::filesystem::path& file, const std::string& text);

}  // namespace hookeye
