#include "estimation/diagnosis/free_form.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "estimation/diagnosis/diagnosis_sums.h"
#include "estimation/effects/toolbox.h"
#include "estimation/fit/evidence.h"
#include "meshing/extent.h"
#include "simulation/loading.h"

namespace hookeye {

namespace {

constexpr int kBumps = 8;

/// Bumps over the body or its surface, each with what a unit density on it puts on the nodes.
struct Basis {
  std::string name, unit;
  double typical = 0.0;   ///< density that strains the body by a hundredth or so
  Eigen::MatrixXd bumps;  ///< nodes x kBumps, at the nodes
  VectorXd weight;        ///< volume or area of the nodes
};

/// `count` points spread over `points`, farthest first.
std::vector<Vector3d> spread(const Matrix3Xd& points, int count) {
  std::vector<Vector3d> out;
  VectorXd distance = (points.colwise() - points.rowwise().mean()).colwise().norm();
  Eigen::Index next = 0;
  distance.maxCoeff(&next);
  distance.setConstant(std::numeric_limits<double>::infinity());
  for (int i = 0; i < count; ++i) {
    out.push_back(points.col(next));
    distance = distance.cwiseMin((points.colwise() - out.back()).colwise().norm().transpose());
    distance.maxCoeff(&next);
  }
  return out;
}

void set_bumps(const Matrix3Xd& X, const std::vector<Vector3d>& centres, double radius,
               Basis* basis) {
  basis->bumps.resize(X.cols(), static_cast<Eigen::Index>(centres.size()));
  for (size_t i = 0; i < centres.size(); ++i)
    basis->bumps.col(static_cast<Eigen::Index>(i)) =
        (-(X.colwise() - centres[i]).colwise().squaredNorm().transpose().array() /
         (2.0 * radius * radius))
            .exp();
}

/// Neighbouring bumps overlap: the radius is that of equal shares.
Basis body_basis(const Model& model) {
  const Scene& scene = *model.scene;
  const TetMesh& mesh = scene.body->mesh;
  Basis out;
  out.name = "body_force";
  out.unit = fmt::format("{}/{}^3", scene.capture.units.force, scene.capture.units.length);
  out.typical = 0.01 * initial_shear_modulus(model.energy) / body_size(scene).size;
  out.weight = VectorXd::Zero(mesh.nodes());
  const VectorXd volume = element_volumes(mesh);
  for (int e = 0; e < mesh.size(); ++e)
    for (int a = 0; a < mesh.nodes_per_element(); ++a)
      out.weight[mesh.elements(a, e)] += volume[e] * (mesh.order == 1 ? 0.25 : a < 4 ? -0.05 : 0.2);
  set_bumps(mesh.X, spread_centres(scene, kBumps), 0.75 * std::cbrt(volume.sum() / kBumps), &out);
  return out;
}

Basis surface_basis(const Model& model) {
  const Scene& scene = *model.scene;
  const Region region = whole_boundary(scene.body->mesh);
  Basis out;
  out.name = "traction";
  out.unit = scene.capture.units.stress();
  out.typical = 0.01 * initial_shear_modulus(model.energy);
  out.weight = region.nodal_area;
  const Matrix3Xd points = scene.body->mesh.X(Eigen::all, region.nodes);
  set_bumps(scene.body->mesh.X, spread(points, kBumps), 0.75 * std::sqrt(region.area / kBumps),
            &out);
  VectorXd outside = VectorXd::Ones(out.weight.size());
  outside(region.nodes).setZero();
  out.bumps = (1.0 - outside.array()).matrix().asDiagonal() * out.bumps;
  return out;
}

/// Parameter 3 i + c: component c of bump i. `only`: the example it acts in, -1: all.
std::shared_ptr<const Ingredient> ingredient_of(std::shared_ptr<const Basis> basis, int only) {
  IngredientSpec spec;
  spec.name = basis->name;
  spec.variant = fmt::format("in {}", only);
  for (int k = 0; k < 3 * kBumps; ++k)
    spec.parameters.push_back({fmt::format("{}.{}", basis->name, k + 1), basis->unit, basis->name,
                               0.0, -1e6 * basis->typical, 1e6 * basis->typical, basis->typical,
                               false});
  spec.touches = {.loading = true};
  const auto nodal = [basis](int k) {
    VectorXd force = VectorXd::Zero(3 * basis->weight.size());
    for (Eigen::Index a = 0; a < basis->weight.size(); ++a)
      force[3 * a + k % 3] = basis->weight[a] * basis->bumps(a, k / 3);
    return force;
  };
  spec.apply = [basis, nodal, only](const VectorXd& values, Model& m) {
    VectorXd force = VectorXd::Zero(3 * basis->weight.size());
    for (int k = 0; k < values.size(); ++k) force += values[k] * nodal(k);
    for (size_t e = 0; e < m.examples.size(); ++e)
      if (only < 0 || only == static_cast<int>(e))
        m.examples[e].loading.forces.push_back(nodal_force(force));
  };
  spec.derivative = [nodal, only](const VectorXd&, const Model&, int example, const Equilibrium&,
                                  int k, MechanicsDerivative& out) {
    if (only < 0 || only == example) out.dR_dt = -nodal(k);
    return true;
  };
  return make_ingredient(std::move(spec));
}

struct Field {
  std::shared_ptr<const Basis> basis;
  int only;
  std::shared_ptr<const Ingredient> ingredient;
};

std::vector<Field> all_fields(const Model& model) {
  std::vector<Field> out;
  for (const auto& basis : {std::make_shared<const Basis>(body_basis(model)),
                            std::make_shared<const Basis>(surface_basis(model))}) {
    out.push_back({basis, -1, ingredient_of(basis, -1)});
    for (size_t e = 0; e < model.examples.size(); ++e) {
      const ExampleSpec& example = model.scene->capture.examples[e];
      const bool seen = !example.photos.empty() ||
                        std::any_of(example.measured.begin(), example.measured.end(),
                                    [](const MeasuredSpec& one) { return one.field != nullptr; });
      if (!example.validate && seen)
        out.push_back({basis, static_cast<int>(e), ingredient_of(basis, static_cast<int>(e))});
    }
  }
  return out;
}

}  // namespace

std::vector<std::shared_ptr<const Ingredient>> free_form_ingredients(const Model& model) {
  std::vector<std::shared_ptr<const Ingredient>> out;
  for (const Field& field : all_fields(model)) out.push_back(field.ingredient);
  return out;
}

namespace {

double share(const NormalEquations& sums, const VectorXd& step, double structured) {
  if (structured <= 0.0) return 0.0;
  return std::clamp(-(2.0 * step.dot(sums.Jtr) + step.dot(sums.JtJ * step)) / structured, -1.0,
                    1.0);
}

void say(const Scene& scene, FreeForm* field) {
  const VectorXd size = field->forces.colwise().norm();
  Eigen::Index most = 0;
  size.maxCoeff(&most);
  field->place = scene.body->mesh.X.col(most);
  const Vector3d towards = field->forces.col(most).normalized();
  field->sentence = fmt::format(
      "{} of up to {} {}, most around {} and there towards {}, {}, would remove {:.0f} % of the "
      "misfit",
      field->name == "traction" ? "a traction on the surface" : "a force in the body",
      figure(size[most]), field->unit, place_text(field->place, extent(scene.body->mesh.X)),
      vector_text(towards),
      field->example.empty() ? "the same in all examples" : "in '" + field->example + "' alone",
      100.0 * std::max(0.0, field->explains));
}

}  // namespace

namespace {

/// Scores fields [first, last) of one evaluation.
void score(const std::vector<Field>& fields, size_t first, size_t last, const Scene& scene,
           const Evaluation& evaluation, int base, std::vector<FreeForm>* out) {
  const DiagnosisSums sums = diagnosis_sums(evaluation, measure_floor(scene, evaluation));
  const double r2 = without_base(sums.effective, base, scene.limits->diagnosis);
  int column = base;
  for (size_t i = first; i < last; ++i, column += 3 * kBumps) {
    const Basis& basis = *fields[i].basis;
    const ProjectedHypothesis projected =
        project(sums.effective.H, base,
                {column, 3 * kBumps, VectorXd::Constant(3 * kBumps, basis.typical)});
    FreeForm one;
    one.name = basis.name, one.unit = basis.unit;
    if (fields[i].only >= 0) one.example = scene.capture.examples[fields[i].only].name;
    VectorXd values;
    one.evidence = log_evidence(projected, sums.effective.s, r2, sums.effective.count,
                                sums.effective.floor2, &values);
    if (one.evidence < scene.limits->diagnosis.nameable) continue;
    VectorXd step = VectorXd::Zero(evaluation.columns);
    step.head(base) = -projected.to_base * values;
    step.segment(column, values.size()) = values;
    const double left = sums.photo_r2 - sums.photo_count * sums.pixel_floor2;
    const double left_held_out = sums.held_r2 - sums.held_count * sums.pixel_floor2;
    one.explains = share(sums.seen, step, left);
    one.explains_held_out = share(sums.seen_held_out, step, left_held_out);
    one.forces = values.reshaped(3, kBumps) * basis.bumps.transpose();
    say(scene, &one);
    out->push_back(std::move(one));
  }
}

}  // namespace

Result<std::vector<FreeForm>> free_form(Workspace& workspace, const Fitted& fitted,
                                        const std::atomic<bool>* cancel) {
  constexpr size_t kAtOnce = 4;  // fields: a hundred columns
  const std::vector<Field> fields = all_fields(fitted.form.realise(fitted.p));
  EvaluationOptions options;
  options.pictures = options.held_out = true;
  options.cancel = cancel;
  std::vector<FreeForm> out;
  for (size_t first = 0; first < fields.size(); first += kAtOnce) {
    const size_t last = std::min(first + kAtOnce, fields.size());
    std::vector<std::shared_ptr<const Ingredient>> ingredients;
    for (size_t i = first; i < last; ++i) ingredients.push_back(fields[i].ingredient);
    auto result = workspace.evaluate(fitted.form, fitted.p, options, ingredients);
    if (!result) return failure_of(result);
    score(fields, first, last, *fitted.form.scene, *result, fitted.form.size(), &out);
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const auto& a, const auto& b) { return a.evidence > b.evidence; });
  return out;
}

void write_free_form(const std::filesystem::path& vtu, const Scene& scene,
                     const std::vector<FreeForm>& fields) {
  std::vector<VtuArray> arrays;
  for (const FreeForm& field : fields)
    arrays.push_back({field.example.empty() ? field.name : field.name + " in " + field.example,
                      field.forces, true});
  write_vtu(vtu, scene.body->mesh, arrays);
}

}  // namespace hookeye
