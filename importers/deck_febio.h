// Decks of FEBio. For this folder alone.
#pragma once

#include "core/xml_file.h"
#include "importers/deck_split.h"

namespace hookeye::solver_deck {

/// febio_spec 3.0 or 4.0. Throws InputError with file and line.
Deck read_febio(const std::filesystem::path& file);

/// A <material> as a law here; what is not taken is said.
Law febio_law(const XmlFile& xml, const XmlNode& material, Deck& deck);

}  // namespace hookeye::solver_deck
