#include "estimation/evaluation/columns.h"

#include <Eigen/Geometry>
#include <stdexcept>

namespace hookeye {

namespace {

Vector3d rotation_vector(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis();
}

/// Second order everywhere; one-sided where a bound leaves no room.
Stencil make_stencil(const Parameter& parameter, double value) {
  // A step of 1e-4 of what matters: round-off 1e-16/1e-4, truncation 1e-8 of the third derivative.
  const double h =
      1e-4 * (parameter.positive ? std::max(std::abs(value), 1e-300) : parameter.typical);
  if (value - h < parameter.low) return {{0.0, h, 2 * h}, {-1.5 / h, 2.0 / h, -0.5 / h}};
  if (value + h > parameter.high) return {{0.0, -h, -2 * h}, {1.5 / h, -2.0 / h, 0.5 / h}};
  return {{h, -h}, {0.5 / h, -0.5 / h}};
}

VectorXd placement_numbers(const Model& model) {
  VectorXd numbers(12);
  numbers.head<9>() =
      Eigen::Map<const Eigen::Matrix<double, 9, 1>>(model.placement.linear().eval().data());
  numbers.tail<3>() = model.placement.translation();
  return numbers;
}

}  // namespace

VectorXd photo_difference(const PhotoState& a, const PhotoState& b) {
  VectorXd d = VectorXd::Zero(kPhotoNumbers);
  const Eigen::Matrix3d turn = b.camera.R * a.camera.R.transpose();
  // acos loses small angles; the skew part does not.
  const Eigen::Matrix3d skew = 0.5 * (turn - turn.transpose());
  const Vector3d small(skew(2, 1), skew(0, 2), skew(1, 0));
  d.segment<3>(kRotate) = small.norm() < 1e-3 ? small : rotation_vector(turn);
  d.segment<3>(kMove) = b.camera.t - turn * a.camera.t;
  d[kZoom] = std::log(b.camera.fx / a.camera.fx);
  d[kLogGain] = std::log(b.gain / a.gain);
  d[kAmbient] = b.ambient - a.ambient;
  d.segment<3>(kSun) = b.sun - a.sun;
  d[kSpecular] = b.specular - a.specular;
  d[kBlur] = b.blur_variance - a.blur_variance;
  d[kBackground] = b.background - a.background;
  d[kVignetting] = b.camera.vignetting - a.camera.vignetting;
  d.segment<kUnevenNumbers>(kUneven) = b.uneven - a.uneven;
  d.segment<2>(kColourZoom) = b.camera.colour_zoom - a.camera.colour_zoom;
  return d;
}

ColumnSet::ColumnSet(const ModelForm& form, const VectorXd& p,
                     const std::vector<std::shared_ptr<const Ingredient>>& candidates) {
  const auto base = std::make_shared<ModelForm>(form);
  for (size_t i = 0; i < form.ingredients.size(); ++i) add(base, p, i);
  for (const auto& candidate : candidates) {
    auto extended = std::make_shared<ModelForm>(form);
    extended->ingredients.push_back(candidate);
    const auto declared = candidate->parameters();
    VectorXd q(p.size() + declared.size());
    q.head(p.size()) = p;
    for (size_t k = 0; k < declared.size(); ++k) q[p.size() + k] = declared[k].value;
    add(extended, q, form.ingredients.size());
  }
}

void ColumnSet::add(std::shared_ptr<const ModelForm> form, const VectorXd& p, size_t ingredient) {
  const ParameterLayout at = form->layout();
  const Ingredient& owner = *form->ingredients[ingredient];
  const auto declared = owner.parameters();
  for (size_t k = 0; k < declared.size(); ++k) {
    Column column;
    column.ingredient = &owner;
    column.local = static_cast<int>(k);
    column.values = at.of(p, ingredient);
    column.touches = owner.touches();
    column.stencil = make_stencil(declared[k], column.values[k]);
    for (double shift : column.stencil.shift) {
      VectorXd q = p;
      q[at[ingredient].first + static_cast<Eigen::Index>(k)] += shift;
      column.neighbours.push_back(form->realise(q));
    }
    columns_.push_back(std::move(column));
  }
  forms_.push_back(std::move(form));
}

namespace {

void difference_mechanics(const Model& neighbour, double weight, bool energy, int example,
                          const Equilibrium& equilibrium, const Loading& loading,
                          Eigen::Ref<VectorXd> dR, Eigen::Ref<VectorXd> dqc) {
  const TetMesh& mesh = neighbour.scene->body->mesh;
  const Loading& shifted = neighbour.examples[example].loading;
  if (shifted.prescribed != loading.prescribed)
    throw std::logic_error(
        "a parameter changes which unknowns are prescribed; its ingredient "
        "must give mechanics_derivative()");
  // Without a touch of the energy only the forces differ: an empty energy spares the elements.
  const EnergyModel shifted_energy = energy ? neighbour.energy_of(example) : EnergyModel{};
  dR += weight * residual(mesh, shifted_energy, shifted, equilibrium.q);
  dqc += weight * shifted.displacement;
}

}  // namespace

ExampleColumns ColumnSet::of_example(const Model& model, int example,
                                     const Equilibrium& equilibrium) const {
  const ExampleModel& present = model.examples[example];
  const int m = size();
  ExampleColumns out;
  out.dR.setZero(equilibrium.q.size(), m);
  out.dqc.setZero(static_cast<int>(present.loading.prescribed.size()), m);
  out.dphoto.assign(present.photos.size(), Eigen::MatrixXd::Zero(kPhotoNumbers, m));
  out.d_offset.setZero(3, m);
  out.d_placement.setZero(12, m);
  out.d_calibration.setZero(model.calibration.size(), m);
  for (int j = 0; j < m; ++j) {
    const Column& column = columns_[j];
    MechanicsDerivative own;
    const bool known = (column.touches.energy || column.touches.loading) &&
                       column.ingredient->mechanics_derivative(column.values, model, example,
                                                               equilibrium, column.local, own);
    if (known && own.dR_dt.size() != 0) out.dR.col(j) = own.dR_dt;
    if (known && own.dqc_dt.size() != 0) out.dqc.col(j) = own.dqc_dt;
    for (size_t i = 0; i < column.neighbours.size(); ++i) {
      const Model& neighbour = column.neighbours[i];
      const double weight = column.stencil.weight[i];
      const ExampleModel& shifted = neighbour.examples[example];
      if (!known && (column.touches.energy || column.touches.loading))
        difference_mechanics(neighbour, weight, column.touches.energy, example, equilibrium,
                             present.loading, out.dR.col(j), out.dqc.col(j));
      if (column.touches.photos)
        for (size_t k = 0; k < shifted.photos.size(); ++k)
          out.dphoto[k].col(j) += weight * photo_difference(present.photos[k], shifted.photos[k]);
      if (column.touches.measured) {
        out.d_offset.col(j) += weight * shifted.force_offset;
        out.d_placement.col(j) += weight * placement_numbers(neighbour);
        out.d_calibration.col(j) += weight * neighbour.calibration;
      }
    }
  }
  return out;
}

}  // namespace hookeye
