// The floor: what misfit would remain if only noise, texture and shading errors were left.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "estimation/evaluation/evaluation.h"

namespace hookeye {

struct Floor {
  /// Of the scene that it was measured in.
  std::shared_ptr<const Limits> limits = std::make_shared<const Limits>();
  double chi = 1.0;
  /// The same for cells: variance of their standardised estimates (FlowCell::z) in the rest photos
  /// after smooth motions and brightness changes are taken out. Shading and texture errors of the
  /// renderer are in it; they are in every photo. At least 1, or chi^2 where noise was told too
  /// large.
  double cell_variance = 1.0;
  /// Variance of a smooth signature's score over that under white noise: the same errors, without
  /// smooth motion and brightness too, summed over their correlation from cell to cell
  /// (FlowStatistics::inflation).
  double cell_inflation = 1.0;
  /// Fall of chi^2 that one pixel of motion of the whole surface brings, mean over directions and
  /// the fitted photos: how sharp and how free of noise they are.
  double per_px2 = 0.0;
  /// "rest fields", "loaded fields" or "told noise" where no example has a photo; else
  /// "rest photos"; "loaded photos" where there are none of those: what no model could take from
  /// the fitted photos, or "noise model": what was told, where there are too few pixels of either.
  std::string source = "noise model";
  /// chi of the rest photos where they leave so little beside the loaded ones that they must repeat
  /// the noise of what they are compared with (stills of one video, a texture that is the photo).
  /// 0: they do not, or there are none.
  double copies = 0.0;
  /// chi of each camera whose photos are enough to tell it.
  std::map<std::string, double> by_camera;
  /// Fall of chi^2 by smooth motion of a camera's rest photos, where the model leaves the body as
  /// it was given: mesh, law and loads have no part in it but through a camera that is fitted to
  /// all photos. Cameras with no more of it than chance gives in 0.1 % of cases are not here.
  std::map<std::string, double> moved_at_rest;
};

/// From the rest photos, after motion and brightness that are smooth over a photo (up to cubic in
/// the place) are taken out of them: weight and swelling act at rest too, and what a renderer gets
/// wrong is rough. Moved by more than kLinearPx (fit.h) they give the middle cell of the aligned
/// pictures. Without compared rest photos, or where those are copies: from the fitted photos of the
/// loaded body, each cell of which may move, brighten and sharpen on its own; of masks, each piece
/// of the rim may move. Needs pictures.
Floor measure_floor(const Scene& scene, const Evaluation& evaluation);

/// Of measured values in a fit (Evaluation::measured_weight): what the rest photos' own error does
/// to the score of a smooth signature, over what as many independent pixels would do.
double measured_weight(const Floor& floor);
double measured_weight(const Scene& scene, const Evaluation& evaluation);

/// Fall of chi^2 that renderers and lenses may err by: a tenth of what the rest photos keep over
/// their noise after alignment (texture and shading that the renderer gets wrong, the same way in
/// every photo, so no null of independent noise knows it), and at least what 0.01 px of motion all
/// over the surface would bring. Below that two renderers of one scene disagree (bench/statistics
/// --other-renderer), let alone a lens and its calibration; image correlation trusts its matches no
/// further.
double renderers_err_by(const Floor& floor);

}  // namespace hookeye
