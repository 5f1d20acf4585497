// The commands as CLI11 knows them, for man pages and completions.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace hookeye {

/// An option, or a word by its place.
struct Word {
  std::vector<std::string> names;  ///< "-o", "--out"; "CAPTURE" of a word by its place
  std::string description;
  std::string value;                 ///< what follows: "TEXT", "INT"; empty: a flag
  std::vector<std::string> choices;  ///< all that may follow; empty: anything
  bool required = false;
  bool many = false;  ///< of a word by its place: one or more
};

/// A command, or (with an empty name) what stands before one.
struct Verb {
  std::string name, description, footer;
  std::vector<Word> places, options;
};

/// The first is the program itself. Hidden commands are left out.
std::vector<Verb> verbs_of(const CLI::App& app);

/// hookeye.1, hookeye-fit.1 ...: {name of the file, content}.
std::vector<std::pair<std::string, std::string>> man_pages(const std::vector<Verb>& verbs,
                                                           const std::string& version);

std::string bash_completion(const std::vector<Verb>& verbs);
std::string zsh_completion(const std::vector<Verb>& verbs);
std::string fish_completion(const std::vector<Verb>& verbs);

}  // namespace hookeye
