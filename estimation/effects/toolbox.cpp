#include "estimation/effects/toolbox.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <set>

#include "estimation/model/base_ingredients.h"
#include "meshing/extent.h"

namespace hookeye {

namespace {

class FunctionIngredient final : public Ingredient {
 public:
  explicit FunctionIngredient(IngredientSpec spec) : spec_(std::move(spec)) {
    null_.resize(spec_.parameters.size());
    for (size_t i = 0; i < spec_.parameters.size(); ++i) null_[i] = spec_.parameters[i].value;
  }
  std::string name() const override { return spec_.name; }
  std::string variant() const override { return spec_.variant; }
  std::vector<Parameter> parameters() const override { return spec_.parameters; }
  Touches touches() const override { return spec_.touches; }
  std::shared_ptr<const Ingredient> with_bounds(
      const std::vector<std::pair<double, double>>& bounds) const override {
    auto out = std::make_shared<FunctionIngredient>(spec_);
    set_bounds(out->spec_.parameters, bounds);
    return out;
  }
  void apply(const VectorXd& values, Model& model) const override {
    if (spec_.has_null && values == null_) return;
    spec_.apply(values, model);
  }
  bool mechanics_derivative(const VectorXd& values, const Model& model, int example,
                            const Equilibrium& equilibrium, int parameter,
                            MechanicsDerivative& out) const override {
    return spec_.derivative &&
           spec_.derivative(values, model, example, equilibrium, parameter, out);
  }

 private:
  IngredientSpec spec_;
  VectorXd null_;
};

bool same(const EnergyModel& a, const EnergyModel& b) {
  if (a.parts.size() != b.parts.size()) return false;
  if (a.swelling.size() != b.swelling.size() || a.swelling != b.swelling) return false;
  for (size_t i = 0; i < a.parts.size(); ++i) {
    const auto &x = a.parts[i], &y = b.parts[i];
    if (x.term != y.term || x.weight.size() != y.weight.size() || x.weight != y.weight)
      return false;
  }
  return true;
}

}  // namespace

std::shared_ptr<const Ingredient> make_ingredient(IngredientSpec spec) {
  return std::make_shared<FunctionIngredient>(std::move(spec));
}

BodySize body_size(const Scene& scene) {
  const Matrix3Xd& X = scene.body->mesh.X;
  BodySize out;
  out.low = X.rowwise().minCoeff();
  out.high = X.rowwise().maxCoeff();
  const VectorXd volumes = element_volumes(scene.body->mesh);
  out.centre = element_centres(scene.body->mesh) * volumes / volumes.sum();
  out.size = extent(X);
  return out;
}

Matrix3Xd element_centres(const TetMesh& mesh) {
  Matrix3Xd centres = Matrix3Xd::Zero(3, mesh.size());
  for (int e = 0; e < mesh.size(); ++e)
    for (int a = 0; a < 4; ++a) centres.col(e) += 0.25 * mesh.X.col(mesh.elements(a, e));
  return centres;
}

VectorXd element_volumes(const TetMesh& mesh) {
  VectorXd volume(mesh.size());
  for (int e = 0; e < mesh.size(); ++e) {
    const Vector3d o = mesh.X.col(mesh.elements(0, e));
    const Vector3d a = mesh.X.col(mesh.elements(1, e)) - o;
    const Vector3d b = mesh.X.col(mesh.elements(2, e)) - o;
    const Vector3d c = mesh.X.col(mesh.elements(3, e)) - o;
    volume[e] = a.dot(b.cross(c)) / 6.0;
  }
  return volume;
}

std::vector<Vector3d> spread_centres(const Scene& scene, int count) {
  const Matrix3Xd centres = element_centres(scene.body->mesh);
  const BodySize body = body_size(scene);
  std::vector<Vector3d> out;
  VectorXd distance = (centres.colwise() - body.centre).colwise().norm();
  int next = 0;
  distance.minCoeff(&next);  // the element nearest to the middle comes first
  distance.setConstant(std::numeric_limits<double>::infinity());
  while (static_cast<int>(out.size()) < std::min(count, static_cast<int>(centres.cols()))) {
    const Vector3d c = centres.col(next);
    distance = distance.cwiseMin((centres.colwise() - c).colwise().norm().transpose());
    out.push_back(rounded(c, body.size));
    distance.maxCoeff(&next);
  }
  return out;
}

Region whole_boundary(const TetMesh& mesh) {
  Region region;
  region.name = "surface";
  region.nodal_area = VectorXd::Zero(mesh.nodes());
  std::set<int> nodes;
  for (int f = 0; f < mesh.boundary.cols(); ++f) {
    const auto face = mesh.boundary.col(f);
    const Vector3d a = mesh.X.col(face[0]), b = mesh.X.col(face[1]), c = mesh.X.col(face[2]);
    const double area = 0.5 * (b - a).cross(c - a).norm();
    // integrals of the shape functions: linear A/3 each; quadratic 0 at corners, A/3 at middles
    const int first = mesh.order == 1 ? 0 : 3;
    for (int k = 0; k < 3; ++k) region.nodal_area[face[first + k]] += area / 3.0;
    for (int k = 0; k < face.size(); ++k) nodes.insert(face[k]);
    region.faces.emplace_back(f, 1.0);
    region.centroid += area / 3.0 * (a + b + c);
    region.area += area;
  }
  region.centroid /= region.area;
  region.nodes.assign(nodes.begin(), nodes.end());
  return region;
}

VectorXd gaussian_bump(const TetMesh& mesh, const Vector3d& centre, double radius) {
  const Matrix3Xd X = element_centres(mesh);
  return (-(X.colwise() - centre).colwise().squaredNorm().transpose().array() /
          (2.0 * radius * radius))
      .exp();
}

double bump_radius(const Scene& scene, int count) {
  const double volume = element_volumes(scene.body->mesh).sum();
  return std::stod(fmt::format("{:.3g}", 0.75 * std::cbrt(volume / count)));
}

double initial_shear_modulus(const EnergyModel& energy) {
  if (energy.parts.empty()) return 1.0;
  // Parts that share elements add up; parts of different regions do not, so the first tells.
  double mu = 0.0;
  for (const auto& part : energy.parts) {
    const double here = part.term->dP_dF(Eigen::Matrix3d::Identity())(3, 3);
    if (part.weight.size() == 0 || &part == &energy.parts.front()) mu += here;
  }
  return mu > 0.0 ? mu : 1.0;
}

double rounded(double value) { return std::stod(fmt::format("{:.5g}", value)) + 0.0; }

Vector3d rounded(const Vector3d& x, double size) {
  const double step = std::pow(10.0, std::floor(std::log10(size)) - 3.0);
  return x.unaryExpr([step](double value) {
    return std::stod(fmt::format("{:g}", std::round(value / step) * step)) + 0.0;
  });
}

std::pair<Vector3d, Vector3d> normal_axes(const Vector3d& direction) {
  const Vector3d d = direction.normalized();
  int smallest = 0;
  d.cwiseAbs().minCoeff(&smallest);
  const Vector3d first = d.cross(Vector3d::Unit(smallest)).normalized();
  return {first, d.cross(first)};
}

Eigen::Matrix3d rotation_of(const Vector3d& rotation_vector) {
  return pose_about(Vector3d::Zero(), rotation_vector, Vector3d::Zero()).linear();
}

const AdditiveModel* additive_base(const Model& model) {
  const size_t materials = model.scene->capture.materials.size();
  for (size_t i = 0; i < materials; ++i)
    if (!additive_model(*model.energy.parts.at(i).term)) return nullptr;
  return materials > 0 ? additive_model(*model.energy.parts[0].term) : nullptr;
}

AdditiveModel in_frame_of(const AdditiveModel& base) {
  AdditiveModel out;
  out.frame = base.frame;
  out.cylinder = base.cylinder;
  return out;
}

std::vector<double> ramp_in(const std::string& variant) {
  std::vector<double> at = numbers_in(variant);
  const bool rising = std::adjacent_find(at.begin(), at.end(), std::greater_equal<>()) == at.end();
  if (at.empty() || at.size() >= kMostControlPoints || !(at[0] > 0.0) || !rising ||
      !std::isfinite(at.back()))
    return {};
  return at;
}

std::vector<double> refined_ramp(const std::vector<double>& at, VectorXd& values) {
  if (at.size() != 1) return at;
  values = Eigen::Vector2d(0.5 * values[0], values[0]);
  return {0.5 * at[0], at[0]};
}

void add_part(EnergyModel& energy, std::shared_ptr<const EnergyTerm> term) {
  energy.parts.push_back({std::move(term), {}});
}

VectorXd part_force(const Model& model, int example, const VectorXd& q,
                    std::shared_ptr<const EnergyTerm> term) {
  const TetMesh& mesh = model.scene->body->mesh;
  EnergyModel alone;
  alone.swelling = model.energy.swelling;
  add_part(alone, std::move(term));
  return model.examples[example].stiffness * residual(mesh, alone, Loading{}, q);
}

VectorXd scatter(const TetMesh& mesh, const Eigen::MatrixXd& element_columns,
                 const VectorXd& factor) {
  VectorXd sum = VectorXd::Zero(3 * mesh.nodes());
  for (int e = 0; e < mesh.size(); ++e) {
    if (factor[e] == 0.0) continue;
    for (int a = 0; a < mesh.elements.rows(); ++a)
      sum.segment<3>(3 * mesh.elements(a, e)) +=
          factor[e] * element_columns.col(e).segment<3>(3 * a);
  }
  return sum;
}

std::shared_ptr<const Eigen::MatrixXd> ElementForces::at(const Model& model, int example,
                                                         const VectorXd& q) {
  EnergyModel energy = model.energy_of(example);
  {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(example);
    if (found != entries_.end() && found->second.q == q && same(found->second.energy, energy))
      return found->second.forces;
  }
  auto forces = std::make_shared<const Eigen::MatrixXd>(compute_(model, example, q));
  const std::lock_guard lock(mutex_);
  entries_[example] = {std::move(energy), q, forces};
  return forces;
}

std::vector<double> numbers_in(const std::string& text) {
  std::vector<double> numbers;
  for (const char* at = text.c_str(); *at;) {
    const bool starts = std::isdigit(static_cast<unsigned char>(*at)) ||
                        ((*at == '-' || *at == '.') &&
                         (std::isdigit(static_cast<unsigned char>(at[1])) || at[1] == '.'));
    char* end = nullptr;
    const double value = starts ? std::strtod(at, &end) : 0.0;
    if (starts && end != at) {
      numbers.push_back(value);
      at = end;
    } else {
      ++at;
    }
  }
  return numbers;
}

std::string vector_text(const Vector3d& v, int digits) {
  return fmt::format("({:.{}f}, {:.{}f}, {:.{}f})", v.x() + 0.0, digits, v.y() + 0.0, digits,
                     v.z() + 0.0, digits);
}

std::string place_text(const Vector3d& X, double size) {
  const int whole = size > 0.0 ? static_cast<int>(std::floor(std::log10(size))) : 2;
  const double step = std::pow(10.0, whole - 2);
  std::string out;
  for (int i = 0; i < 3; ++i)
    out += (i == 0 ? "" : ", ") +
           (std::isnan(X[i]) ? fmt::format("somewhere along {}", "xyz"[i])
                             : fmt::format("{:.{}f}", std::round(X[i] / step) * step + 0.0,
                                           std::max(0, 2 - whole)));
  return "(" + out + ")";
}

std::string figure(double value) { return fmt::format("{:.3g}", value); }

std::string parameter_prefix(const std::string& effect, const std::string& what,
                             const std::string& when) {
  const std::string added = when == "from the start" ? "" : when;
  const std::string name = what + (what.empty() || added.empty() ? "" : " ") + added;
  return effect + "." + (name.empty() ? "" : name + ".");
}

std::string examples_quoted(const Scene& scene, std::string variant) {
  for (const auto& example : scene.capture.examples)
    for (const auto& [before, behind] : {std::pair("from ", " on"), std::pair("in ", "")}) {
      const std::string told = before + example.name + behind;
      const size_t at = variant.rfind(told);
      if (at == std::string::npos || at + told.size() != variant.size()) continue;
      return variant.replace(at, told.size(),
                             fmt::format("{}'{}'{}", before, example.name, behind));
    }
  return variant;
}

bool starts_with(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}

std::vector<FirstExample> first_examples(const Scene& scene,
                                         const std::function<bool(int)>& concerned) {
  std::vector<FirstExample> out;
  const auto& examples = scene.capture.examples;
  for (size_t e = 0; e < examples.size(); ++e) {
    if (examples[e].validate || !concerned(static_cast<int>(e))) continue;
    if (out.empty())
      out.push_back({0, "from the start"});
    else
      out.push_back({static_cast<int>(e), fmt::format("from {} on", examples[e].name)});
  }
  return out;
}

bool has_photo_of(const Scene& scene, int example, const std::string& camera) {
  for (const auto& photo : scene.capture.examples[example].photos)
    if (photo.camera == camera) return true;
  return false;
}

Ingredients per_camera(
    const Scene& scene, std::string* why_not,
    const std::function<std::shared_ptr<const Ingredient>(const Camera&, const FirstExample&)>&
        make) {
  Ingredients all;
  for (const Camera& camera : scene.capture.cameras)
    for (const FirstExample& first :
         first_examples(scene, [&](int e) { return has_photo_of(scene, e, camera.name); }))
      all.push_back(make(camera, first));
  if (all.empty() && why_not) *why_not = "no photo is fitted";
  return all;
}

std::string blob_text(const Blob& blob) {
  return fmt::format("blob around ({:g}, {:g}, {:g}), radius {:g}", blob.centre.x(),
                     blob.centre.y(), blob.centre.z(), blob.radius);
}

std::optional<Blob> blob_in(const std::string& variant) {
  const auto n = numbers_in(variant);
  if (!starts_with(variant, "blob") || n.size() != 4) return std::nullopt;
  return Blob{{n[0], n[1], n[2]}, n[3]};
}

VectorXd freed(const Blob& blob, double amplitude) {
  VectorXd values(5);
  values << amplitude, blob.centre, blob.radius;
  return values;
}

Blob blob_of(const Ingredient& ingredient, const VectorXd& values) {
  if (values.size() == 5) return {values.segment<3>(1), values[4]};
  return blob_in(ingredient.variant()).value();
}

}  // namespace hookeye
