// The program that works on the captures of a batch, where another one has begun it: Python.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "batch/capture_list.h"

namespace hookeye {

/// What a verb may be told in a batch, by the long name of the option.
using VerbOptions = std::map<std::string, OptionKind>;

struct BatchProgram {
  std::filesystem::path file;
  std::string version;
  std::map<std::string, VerbOptions> verbs;

  /// Throws InputError for a verb that no batch is of.
  const VerbOptions& options_of(const std::string& verb) const;
  KindOfOption kind_in(const std::string& verb) const;
};

/// As `hookeye batch --verbs --json` prints it.
nlohmann::json to_json(const BatchProgram& program);

/// The program that this library was installed or built with, else the first on the path. Throws
/// InputError where there is none.
std::filesystem::path program_beside();
/// Asks it what it is. Throws InputError where it is no Hookeye, or another than `version`.
BatchProgram ask_program(const std::filesystem::path& file, const std::string& version);

/// Options of the verb as words of its command line; `values` of a flag: empty. Throws InputError
/// for what is none.
std::vector<std::string> option_words(const BatchProgram& program, const std::string& verb,
                                      const std::string& name,
                                      const std::vector<std::string>& values);

}  // namespace hookeye
