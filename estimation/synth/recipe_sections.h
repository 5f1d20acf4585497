// Sections of a recipe, each by itself. Internal to synth.
#pragma once

#include <string>

#include "capture_io/capture_reader.h"
#include "estimation/synth/recipe.h"

namespace hookeye {

/// Reads an optional number; the default stays where the key is not given.
void maybe(const YamlSection& section, const std::string& key, double& value,
           double (*read)(const YamlNode&, const std::string&) = read_positive);
/// The same for an integer between `low` and `high`.
void maybe(const YamlSection& section, const std::string& key, int& value, int low, int high);
/// A number between `low` and `high`.
void maybe(const YamlSection& section, const std::string& key, double& value, double low,
           double high);

/// How pictures are taken and the truth is computed. `read_cameras` needs the recipe's shape.
void read_cameras(const YamlNode& node, Recipe& recipe);
void read_light(const YamlNode& node, Recipe& recipe);
void read_noise(const YamlNode& node, Recipe& recipe);
void read_photos(const YamlNode& node, Recipe& recipe);
void read_truth(const YamlNode& node, Recipe& recipe);

}  // namespace hookeye
