#include "estimation/output/field_output.h"

#include <cmath>

#include "capture_io/component_sigmas.h"
#include "capture_io/field_start.h"
#include "capture_io/strain_field.h"
#include "estimation/evaluation/started_field.h"
#include "estimation/fit/field_floor.h"
#include "estimation/model/field_points.h"

namespace hookeye {

using nlohmann::json;

namespace {

std::vector<double> sigmas_told(const MeasuredSpec& measured) {
  const VectorXd sigmas = component_sigmas(measured);
  return {sigmas.begin(), sigmas.end()};
}

}  // namespace

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
                     {"holds", told.field->strain ? "strains" : "displacements"},
                     {"unit", told.field->strain ? "strain" : scene.capture.units.length},
                     {"sigma", told.field->sigma},
                     {"sigmas", sigmas_told(told)},
                     {"rough", rough.count > 0.0 ? json(rough.chi()) : json()},
                     {"components", told.field->components},
                     {"points", told.field->X.cols()},
                     {"dropped", told.field->dropped},
                     {"numbers", one.numbers},
                     {"correlation", told.field->correlation}});
      if (const std::string& start = start_of(told); !start.empty()) {
        const Model model = fitted.form.realise(fitted.p);
        const FieldPoints points =
            field_points(mesh_below(model, fitted.evaluation, told), *told.field);
        all.back().update({{"from", start}, {"gap", points.gap.maxCoeff()}});
      }
      if (const auto& strain = told.field->strain)
        all.back().update({{"strain", name_of(strain->measure)}, {"gauge", strain->gauge}});
    }
  return all;
}

NodalField nodal_field(const Model& model, const Evaluation& evaluation,
                       const ExampleEvaluation& example) {
  const Scene& scene = *model.scene;
  const TetMesh& mesh = scene.body->mesh;
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(1, mesh.nodes());
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(3, mesh.nodes());
  NodalField out{zero, zero, none, none};
  Eigen::MatrixXd moved = none, strained = none;  // shares by kind
  for (const auto& one : example.measured) {
    const MeasuredSpec& told = scene.capture.examples[example.example].measured[one.index];
    if (!told.field) continue;
    const FieldSpec& field = *told.field;
    const FieldPoints points = field_points(mesh_below(model, evaluation, told), field);
    const VectorXd apart = one.predicted - told.value;
    const VectorXd over = apart.cwiseQuotient(told.sigma);
    const int components = field.components;
    (field.strain ? out.has_strains : out.has_motions) = true;
    for (Eigen::Index k = 0; k < points.N.rows(); ++k) {
      const VectorXd here = apart.segment(components * k, components);
      const double rms =
          field.alike[k] * over.segment(components * k, components).squaredNorm() / components;
      for (decltype(points.N)::InnerIterator it(points.N, k); it; ++it) {
        const double share = std::abs(it.value());
        if (field.strain)
          out.strain.col(it.col()).head(components) += share * here;
        else
          out.residual.col(it.col()) += share * field.axes.leftCols(components) * here;
        (field.strain ? strained : moved)(0, it.col()) += share;
        out.rms(0, it.col()) += share * rms;
      }
    }
  }
  out.share = moved + strained;
  for (Eigen::Index n = 0; n < mesh.nodes(); ++n) {
    if (moved(0, n) > 0.0) out.residual.col(n) /= moved(0, n);
    if (strained(0, n) > 0.0) out.strain.col(n) /= strained(0, n);
    if (out.share(0, n) > 0.0) out.rms(0, n) = std::sqrt(out.rms(0, n) / out.share(0, n));
  }
  return out;
}

}  // namespace hookeye
