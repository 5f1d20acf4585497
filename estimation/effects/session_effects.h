// Effects that a program adds to the catalogue while it runs: those written in Python.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "estimation/model/effect.h"

namespace hookeye {

/// Adds an effect behind those of catalogue.def, or puts it in the place of an added one of the
/// same name. It is kept as long as the program runs, for a model may still hold it. `code`: tells
/// one definition from another. Thread-safe; a work that is under way may see either catalogue.
/// Throws std::invalid_argument for a name of catalogue.def.
void add_to_catalogue(std::shared_ptr<const Effect> effect, const std::string& code);
/// Takes an added effect out again. False: there was none of this name.
bool take_from_catalogue(const std::string& name);
/// "NAME CODE" of each that was added: what was worked out under others may come out otherwise.
std::vector<std::string> added_to_catalogue();

}  // namespace hookeye
