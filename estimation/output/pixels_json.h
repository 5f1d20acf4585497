// Which pixels of its photos a fit has seen, and what all of them say.
#pragma once

#include <nlohmann/json.hpp>

#include "estimation/fit/fit.h"

namespace hookeye {

/// `read` of metrics.json: by camera.
nlohmann::json readings_json(const PhotoReadings& readings);

/// `all_pixels` of metrics.json and of the step in run.json; needs Fitted::all_pixels.
nlohmann::json all_pixels_json(const Fitted& fitted);
/// The same back again, of a model with these parameters. Empty: it is of others, or none.
std::optional<AllPixels> all_pixels_in(const nlohmann::json& told,
                                       const std::vector<Parameter>& parameters);

/// A sentence or two. "": nothing is told.
std::string all_pixels_in_words(const nlohmann::json& told);

}  // namespace hookeye
