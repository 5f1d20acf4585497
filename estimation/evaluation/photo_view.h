// How one photo sees an example: its texture, its camera, how its pixels are rendered, and how all
// of that moves with the parameters. Internal to the folder.
#pragma once

#include "estimation/evaluation/photo_evaluation.h"

namespace hookeye {

/// Which pixels of a photo are meant: those that are read, at a pyramid level, or those that the
/// camera took (photo_reading.h).
struct PhotoSize {
  int level = 0;
  bool as_taken = false;
  int rays_per_axis = 0;  ///< EvaluationOptions
};

/// Photos of coarse levels are means over squares of pixels: a wider filter with rays enough to see
/// every speckle once (a box has 2.5 times the variance of the 1.5 px window). A texture that is a
/// photo went through the camera's aperture once already: one ray a pixel, or the model would be
/// blurred twice and every motion come out too long. `halvings`: of the read photo.
/// `rays_per_axis`: EvaluationOptions.
RenderOptions at_level(RenderOptions options, int level, int halvings, const Texture& texture,
                       int rays_per_axis = 0);

PhotoState state_at_level(const PhotoState& state, int level);

/// Whether the photo is compared by its colours, a plane each.
bool by_colour(const Scene& scene, int example, int photo);
/// The camera as the plane has it.
Camera camera_of_plane(const Scene& scene, int example, int photo, int plane, const Camera& camera);

bool is_silhouette(const Scene& scene, int example, int photo);

/// Index of the reference example's photo by the same camera, -1: none.
int reference_photo(const Scene& scene, int reference, const std::string& camera);

/// Colour source of one photo. False: this photo cannot be compared (no reference photo). Where it
/// is a photo, that is the read one.
bool choose_texture(const Scene& scene, const Model& model, int example, int photo, int plane,
                    PhotoSize size, Texture& texture);

/// Silhouettes are rendered as plain coverage: no light, and no sky that concave parts miss.
PhotoState coverage_state(PhotoState state);

/// One example as all of its photos see it.
class ExampleView {
 public:
  /// All but `S` outlive it. `columns`: null where no derivative is asked for.
  ExampleView(const Scene& scene, Renderer& renderer, const Model& model,
              const ExampleEvaluation& example, const ReferenceState& reference,
              const ExampleColumns* columns);

  const Scene& scene() const { return scene_; }
  const Model& model() const { return model_; }
  const SurfaceMesh& mesh() const { return scene_.body->surface.mesh; }
  int example() const { return example_; }
  bool derivatives() const { return columns_ != nullptr; }
  bool is_mask(int photo) const { return is_silhouette(scene_, example_, photo); }
  /// What is behind the body is known, so that its rim counts.
  bool shows_rim(int photo) const;

  RenderOptions rendering(int photo, const Texture& texture, PhotoSize size,
                          const EvaluationOptions& options) const;
  void render(const Texture& texture, const PhotoState& state, const RenderOptions& options,
              bool rim, const std::vector<unsigned char>* count, Rendering* out) const;
  /// Of one plane of a photo; holds until the next is asked for. `scale`: side of a pixel in pixels
  /// of the read photo.
  const VertexSensitivity& sensitivity(int photo, int plane, const Texture& texture, double scale);

 private:
  const Scene& scene_;
  Renderer& renderer_;
  const Model& model_;
  const ReferenceState& reference_;
  const ExampleColumns* columns_;
  int example_;
  Matrix3Xd x_, x_reference_;
  VertexSensitivity S_;
  RowMatrix second_on_vertices_;
};

}  // namespace hookeye
