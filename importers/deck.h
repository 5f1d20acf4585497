// Decks of Abaqus, CalculiX and FEBio: the body, its material, supports and loads, as parts of a
// capture.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/input_error.h"

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

/// The one law that a deck tells of its body.
struct LawInDeck {
  std::string yaml;                 ///< "{law: neo-hookean, mu: 0.05, kappa: 0.5}"
  std::vector<std::string> to_fit;  ///< parameters that a fit may move
  double density = 0;               ///< 0: not told
  Place place;                      ///< of the material
};

/// None where a deck tells no law that is known here. Throws InputError: what cannot be read, and
/// several laws in one body.
std::optional<LawInDeck> law_in_deck(const std::filesystem::path& deck);

}  // namespace hookeye
