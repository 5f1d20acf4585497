// What a capture consisted of when something was made from it.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace hookeye {

/// Fingerprints of a capture's yaml and of the files of its folder that its values name, by their
/// names there, in a file of cameras or of examples too: XXH3 of all bytes. A yaml that cannot be
/// read has none, and nor has what it would name.
std::map<std::string, std::string> fingerprints(const std::filesystem::path& yaml);

/// The first name whose fingerprints differ, or that one of them lacks; empty: none. Fingerprints
/// of another kind, those of older programs, are not compared.
std::string changed_since(const std::map<std::string, std::string>& then,
                          const std::map<std::string, std::string>& now);

}  // namespace hookeye
