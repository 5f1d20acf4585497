// Steps of a deck as examples of a capture. For this folder alone.
#pragma once

#include <string>

#include "importers/deck_patches.h"

namespace hookeye::solver_deck {

struct CaseText {
  std::string yaml;  ///< below the name of the example
  size_t supports = 0, loads = 0;
};

/// Supports and loads at the end of a step. Throws InputError with the line.
CaseText case_text(const DeckStep& step, Deck& deck, Patches& patches);

}  // namespace hookeye::solver_deck
