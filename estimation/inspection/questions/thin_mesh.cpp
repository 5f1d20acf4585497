// Do linear tetrahedra lock: is the body so thin that the capture's own mesh can hardly bend?
#include <fmt/format.h>

#include <algorithm>

#include "estimation/inspection/question.h"

namespace hookeye::inspection {

namespace {

double largest_motion(const Matrix3Xd& u) {
  return u.size() > 0 ? u.colwise().norm().maxCoeff() : 0.0;
}

}  // namespace

/// Asked where the first guess was solved on quadratic tetrahedra, as the linear ones of the
/// capture lie less than twice across the body.
void ask_thin_mesh(Sight& sight, Warnings& warnings) {
  const Scene& scene = sight.scene();
  const InspectionOptions& options = sight.options();
  const TetMesh& mesh = scene.body->mesh;
  constexpr int kTimesAsMany = 4;  // nodes of the coarse solve: 2 CPU-seconds a load case
  if (!sight.coarse() || mesh.order != 1 || sight.coarse()->scene().body->mesh.order != 2 ||
      mesh.nodes() > kTimesAsMany * options.coarse_nodes)
    return;
  const CoarseModel as_told(scene.shared_from_this(), options);
  double most = 0.0, linear = 0.0, quadratic = 0.0;
  size_t worst = 0;
  for (size_t i = 0; i < scene.capture.examples.size(); ++i) {
    const int e = static_cast<int>(i);
    const double here = largest_motion(sight.guess(e)->linear);
    const double told =
        largest_motion(as_told.answer(e, as_told.model().examples[i].loading).linear);
    if (told == 0.0 || here / told <= most) continue;
    most = here / told, linear = told, quadratic = here, worst = i;
  }
  if (most < options.most_locked) return;
  const bool filled = scene.capture.body.volume.empty();
  warnings.say(warnings.has({"body", "mesh", "order"}) ? warnings.place({"body", "mesh", "order"})
                                                       : scene.capture.body.place,
               fmt::format("the body is less than two linear tetrahedra thick, and they lock: "
                           "example `{}` moves it by {:.2g} {} on the capture's mesh and by "
                           "{:.2g} {} on quadratic ones, to first order",
                           scene.capture.examples[worst].name, linear, scene.capture.units.length,
                           quadratic, scene.capture.units.length),
               filled ? "`mesh: {order: 2}`" : "a volume of quadratic tetrahedra");
}

}  // namespace hookeye::inspection
