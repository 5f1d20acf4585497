// A photo that a fit reads halved or in part of its tiles, compared in every pixel that the camera
// took, tile by tile: memory follows the tile. Internal to the folder.
#pragma once

#include <functional>
#include <optional>

#include "estimation/evaluation/compared_pixels.h"
#include "estimation/evaluation/photo_view.h"

namespace hookeye {

/// For bodies that hold a photo of many megapixels each.
void few_at_once(size_t count, const std::function<void(size_t)>& body);

/// The model's picture takes the photo's brightness where the texture brought its light along.
class FollowedBrightness {
 public:
  explicit FollowedBrightness(const Scene& scene) : scene_(scene) {}
  /// `pixels`: of `photo`, along the side of one of the read photo.
  std::optional<Brightness> by(const PhotoPlane& photo, const Texture& texture, double pixels,
                               Rendering* rendering);

 private:
  const Scene& scene_;
  std::vector<int> patches_;  ///< smooth_patches(); empty: not asked for yet
};

/// Motion between model and photo, and the residual made linear in it.
Registration registration(const Image& model, const PhotoPlane& photo, const Image& residual,
                          const Image& sigma, bool mask);
/// Flow, aligned flow and what they leave (EvaluationOptions::pictures).
void add_flow(const Image& model, const Registration& registered, const Image& sigma, bool mask,
              PhotoEvaluation* out);

/// A photo as the camera took it, cut to what is read of it; and the one that gives its texture,
/// where that is a photo.
struct TakenPhotos {
  std::optional<Photo> photo, texture;
  bool empty() const { return !photo; }
};
/// Throws InputError where a file has gone or changed since it was read.
TakenPhotos taken_photos(const ExampleView& view, int photo);

/// One plane. Sums are of all pixels of the photo as it was taken; r2, count and pictures of all
/// pixels of the size that is read, where chi means what it does in the fit.
PhotoEvaluation compare_taken(ExampleView& view, int photo, int plane, const TakenPhotos& taken,
                              const PhotoPlane& read, const Image& read_sigma, Texture texture,
                              FollowedBrightness& followed, const EvaluationOptions& options,
                              Rendering* rendering);

}  // namespace hookeye
