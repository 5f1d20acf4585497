// Files of yaml: the capture itself, and parts of it that stand in files of their own.
#pragma once

#include <filesystem>
#include <string>

#include "capture_io/yaml_section.h"

namespace hookeye {

/// Parses a file of honest size; `told` is the name to use in places. Throws InputError.
YamlNode load_yaml(const std::filesystem::path& file, const std::string& told,
                   const YamlLimits& limits = {});

/// FILE of a section {from: FILE}; null where the section is told in place. A camera may be called
/// `from`: its value is a map.
const YamlNode* file_of_section(const YamlNode& section);

/// The section `key` in a file of its own, which has that one key at its top.
YamlNode load_section(const std::filesystem::path& file, const std::string& told,
                      const std::string& key);
/// The same, of a section {from: FILE} in a capture's folder; another section is returned as it is.
YamlNode section_in_place(const YamlNode& section, const std::string& key,
                          const CaptureFolder& folder);

}  // namespace hookeye
