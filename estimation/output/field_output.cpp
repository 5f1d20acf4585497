#include "estimation/output/field_output.h"

#include <cmath>

#include "estimation/fit/field_floor.h"
#include "estimation/model/field_points.h"

namespace hookeye {

using nlohmann::json;

json fields_json(const Scene& scene, const Fitted& fitted) {
  json all = json::array();
  for (const auto& example : fitted.evaluation.examples)
    for (const auto& one : example.measured) {
      const auto& spec = scene.capture.examples[example.example];
      const MeasuredSpec& told = spec.measured[one.index];
      if (!told.field) continue;
      const VectorXd apart = one.predicted - told.value;
      const RoughField rough = rough_field(*told.field, whole_residual(told, one));
      all.push_back({{"example", spec.name},
                     {"file", told.field->told},
                     {"use", example.held_out ? "validate" : "fit"},
                     {"chi", std::sqrt(one.r.squaredNorm() / one.size())},
                     {"rms", std::sqrt(apart.squaredNorm() / static_cast<double>(apart.size()))},
                     {"largest", apart.cwiseAbs().maxCoeff()},
                     {"unit", scene.capture.units.length},
                     {"sigma", told.field->sigma},
                     {"rough", rough.count > 0.0 ? json(rough.chi()) : json()},
                     {"components", told.field->components},
                     {"points", told.field->X.cols()},
                     {"dropped", told.field->dropped},
                     {"numbers", one.numbers},
                     {"correlation", told.field->correlation}});
    }
  return all;
}

NodalField nodal_field(const Scene& scene, const ExampleEvaluation& example) {
  const TetMesh& mesh = scene.body->mesh;
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(1, mesh.nodes());
  NodalField out{Eigen::MatrixXd::Zero(3, mesh.nodes()), none, none};
  for (const auto& one : example.measured) {
    const MeasuredSpec& told = scene.capture.examples[example.example].measured[one.index];
    if (!told.field) continue;
    const FieldPoints points = field_points(mesh, *told.field);
    const VectorXd apart = one.predicted - told.value;
    const int components = told.field->components;
    for (Eigen::Index k = 0; k < points.N.rows(); ++k) {
      const VectorXd here = apart.segment(components * k, components);
      for (decltype(points.N)::InnerIterator it(points.N, k); it; ++it) {
        const double share = std::abs(it.value());
        out.residual.col(it.col()) += share * told.field->axes.leftCols(components) * here;
        out.rms(0, it.col()) +=
            share * here.squaredNorm() / (components * std::pow(told.field->sigma, 2));
        out.share(0, it.col()) += share;
      }
    }
  }
  for (Eigen::Index n = 0; n < mesh.nodes(); ++n)
    if (out.share(0, n) > 0.0) {
      out.residual.col(n) /= out.share(0, n);
      out.rms(0, n) = std::sqrt(out.rms(0, n) / out.share(0, n));
    }
  return out;
}

}  // namespace hookeye
