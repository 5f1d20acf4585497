// The pixels of one photo beside the model's: which count, their residuals, and their sums.
#pragma once

#include "estimation/evaluation/brightness_sums.h"
#include "estimation/images/registration.h"
#include "estimation/model/photo_pyramid.h"
#include "render/condensed.h"

namespace hookeye {

struct Comparison {
  Image residual;  ///< over noise; NaN: does not count
  double r2 = 0.0, count = 0.0;
};

/// Sum of Huber's losses; huber 0: of squares.
double loss(const Image& residual, double huber);

/// sigma of a pixel that is compared with a texture from a photo: that photo's noise enters, and
/// what neither photo resolves (unresolved.h) times FitLimits::unresolved.
Image sigma_beside_photo(const Image& sigma, const Image& unresolved, double times);

/// A blurred picture of a photo has less of that photo's noise, so that sigma falls with the blur
/// [px^2]: else any blur would seem to fit, as it removes noise.
struct SigmaOfBlur {
  double factor;       ///< of sigma_beside_photo()
  double log_by_blur;  ///< derivative of its log [1/px^2]
};
SigmaOfBlur sigma_of_blur(double blur_variance_px2);
/// Adds what sigma's fall does to the residual's derivative by kBlur.
void add_sigma_of_blur(const SigmaOfBlur& sigma_falls, const Image& residual, const Image& sigma,
                       ImageDerivative* dI);

/// How a photo is compared. `silhouette`: what is behind the body is known, so that its rim counts;
/// `mask`: the photo is a silhouette.
struct ComparedAs {
  bool silhouette = false, mask = false;
};
Comparison compare_pixels(const Rendering& rendering, const PhotoPlane& photo, const Image& sigma,
                          ComparedAs as, const PhotoState& state);

/// Normal equations of the counted pixels, by the parameters of S. `brightness`: what the picture
/// followed, null: nothing.
CondensedPhoto condense(const Rendering& rendering, const Image& residuals, const Image& sigma,
                        const SurfaceMesh& surface, const PhotoState& state, double huber,
                        const Brightness* brightness, const VertexSensitivity& S);

}  // namespace hookeye
