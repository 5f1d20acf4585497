// Decks of Abaqus, CalculiX and FEBio: the body, its material, supports and loads, as parts of a
// capture.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace hookeye {

struct ImportedDeck {
  /// Name and text: body.inp, body.yaml (sections to paste) and examples.yaml, without heads.
  std::vector<std::pair<std::string, std::string>> files;
  std::vector<std::string> said;  ///< what the user is to know, with file and line
  int nodes = 0, elements = 0;
  std::vector<std::string> regions;
  struct Case {
    std::string name;
    size_t supports = 0, loads = 0;
  };
  std::vector<Case> cases;
};

/// By its name.
bool is_deck(const std::filesystem::path& file);

/// One body, and load cases of all its decks. What comes out is accepted by a capture, which is
/// tried in the empty folder `scratch`. Throws InputError with file and line.
ImportedDeck import_decks(const std::vector<std::filesystem::path>& decks,
                          const std::filesystem::path& scratch);

}  // namespace hookeye
