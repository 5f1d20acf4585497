// What the page (`report`, `studio`) needs of a step beyond its figures: the surface of the body
// with its fields, where its nodes lie in the photos, and the residual displacement cell by cell.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "estimation/diagnosis/free_form.h"
#include "estimation/fit/fit.h"

namespace hookeye {

/// Writes into `folder`:
///   body.json             rest positions of the boundary nodes, their triangles (quadratic faces
///                         as four flat ones), the nodes of every region
///   example-EXAMPLE.json  arrays on those nodes: displacement [length], residual (root mean square
///                         over noise of the pixels around the node), gap (the displacement that
///                         would remove the residual) [length], strain (largest principal Green
///                         strain), von_mises [stress], fitted_fields(); per photo the node's pixel
///                         and whether it is seen
///   photo-EXAMPLE-CAMERA.json  residual displacement of the photo's cells [px], length of one
///   pixel
/// Arrays are base64 of little-endian float32 (`{"components": 3, "float32": "..."}`).
void write_page_data(const std::filesystem::path& folder, const Scene& scene, const Model& model,
                     const Fitted& fitted);

/// Writes `folder`/free_form.json: fields as in a step's free_form.json, with their `forces` on the
/// nodes of body.json.
void write_page_free_form(const std::filesystem::path& folder, const Scene& scene,
                          const std::vector<FreeForm>& fields);

/// Length that one pixel covers at the body: from the depth of its rest centroid.
double length_per_px(const Scene& scene, const PhotoState& state);

/// EXAMPLE-CAMERA, with -r, -g, -b where the planes of a colour photo are compared one by one.
std::string photo_name(const Scene& scene, const PhotoEvaluation& photo);

}  // namespace hookeye
