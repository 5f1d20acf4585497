// The pictures of one example against its photos.
#pragma once

#include <memory>
#include <vector>

#include "estimation/evaluation/columns.h"
#include "estimation/evaluation/evaluation.h"
#include "estimation/model/photo_pyramid.h"
#include "render/renderer.h"

namespace hookeye {

/// The example that gives the texture (texture: {from: NAME}); example -1: none.
struct ReferenceState {
  int example = -1;
  const ExampleEvaluation* state = nullptr;
  const ExampleColumns* columns = nullptr;  ///< its photos move with the parameters too
};

/// Keeps renderer and pyramids of one example.
class PhotoComparer {
 public:
  PhotoComparer(std::shared_ptr<const Scene> scene, int example);
  PhotoComparer(PhotoComparer&&) noexcept;
  PhotoComparer& operator=(PhotoComparer&&) noexcept;
  ~PhotoComparer();

  std::vector<PhotoEvaluation> compare(const Model& model, const ExampleEvaluation& example,
                                       const ReferenceState& reference,
                                       const ExampleColumns* columns,
                                       const EvaluationOptions& options);

  /// The model's picture of photo `photo`, plane `plane`, without comparing (render, synth).
  Rendering render(const Model& model, const VectorXd& q, const VectorXd* q_reference, int photo,
                   int plane, const RenderOptions& options);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Rendering settings that `shading:` and defaults give.
RenderOptions render_options(const Scene& scene);

}  // namespace hookeye
