// The additive energy model: a sum of interpolated functions of strain components (Miguel, Miraut,
// Otaduy, "Modeling and Estimation of Energy-Based Hyperelastic Objects", Computer Graphics Forum
// 2016). A value: structure and control values; the law follows from it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "meshing/tet_mesh.h"
#include "simulation/energy_term.h"

namespace hookeye {

/// A strain component e(F), zero at rest. f_i = F a_i along the axes a_i of the material frame.
///   E11 ... E23   1/2 (f_i . f_j - delta_ij), components of the Green strain
///   trE           E11 + E22 + E33
///   I1bar         sqrt(I1bar - 3): in simple shear the amount of shear, never negative
///   J             det F - 1
///   fibreN        |F d| - 1, stretch along a direction d
struct StrainComponent {
  enum class Kind { e11, e22, e33, e12, e13, e23, trace, i1bar, volume, fibre };
  Kind kind = Kind::e11;
  std::string name;                    ///< as in the list above
  Eigen::Vector3d direction{1, 0, 0};  ///< fibre only: unit, rest axes
  bool shear() const { return kind == Kind::e12 || kind == Kind::e13 || kind == Kind::e23; }
};

/// At most this many control points along one component: evaluation needs no heap.
inline constexpr int kMostControlPoints = 64;

/// One function of one or two components. Its control values are second derivatives of the energy
/// at the control points [stress], so that the gauge holds for any values:
///   one component   Psi'' is linear between the control points and constant beyond the outer
///                   ones; Psi(0) = Psi'(0) = 0; Psi is a cubic C2 spline. Control points of I1bar,
///                   and those of a shear if none is negative, stand for |e|: an even function.
///   two components  d2Psi/dadb is bilinear between the control points, constant beyond; Psi = 0
///                   on both axes; stress is continuous. A single control point is lambda a b.
struct Addend {
  std::string name;            ///< "E11", "E11_E22", "E11.wall"
  int first = 0, second = -1;  ///< components; second = -1: one component
  std::vector<double> at, at_second;
  /// Control values; with two components row by row: [i * at_second.size() + j].
  Eigen::VectorXd stiffness;
  bool even = false;
  bool fixed = false;  ///< a wall: no parameters
};

struct AdditiveModel {
  Matrix3d frame = Matrix3d::Identity();  ///< columns a1 a2 a3, orthonormal, rest axes
  std::optional<CylinderFrame> cylinder;  ///< then the body's part carries the frames
  std::vector<StrainComponent> components;
  std::vector<Addend> addends;
  /// Barrier -modulus (J - below)^2 log(J / below) for J < below (Li et al. 2020, eq. 6): C2, and
  /// infinite at J = 0. modulus 0: none.
  double barrier_modulus = 0.0, barrier_below = 0.0;

  int size() const;                ///< control values that are parameters
  Eigen::VectorXd values() const;  ///< addend by addend
  void set_values(const Eigen::VectorXd& values);
  const Addend* find(const std::string& name) const;
};

/// The law: parameters "E11.1" ... in the order of values(). `model` must be sound (fault()).
std::shared_ptr<const EnergyTerm> additive(const AdditiveModel& model);
/// The model of a law made by additive(); null for any other law.
const AdditiveModel* additive_model(const EnergyTerm& law);

/// What is wrong with a model, and what would be right; `key` names the value ("E11.at").
struct AdditiveFault {
  std::string key, wrong, right;
};
/// Structure, finite numbers, a right-handed orthonormal frame, unit directions, the barrier's
/// range.
std::optional<AdditiveFault> structure_fault(const AdditiveModel& model);
/// The energy is not convex, by more than rounding.
std::optional<AdditiveFault> convexity_fault(const AdditiveModel& model);
/// The same, and convexity, and stiffness against every strain at rest.
std::optional<AdditiveFault> fault(const AdditiveModel& model);
/// Reads `material: {law: additive, ...}`. Throws InputError with the place.
AdditiveModel read_additive(const MaterialSpec& spec);

/// Component and addend of a name ("E12", "fibre1", "E11_E22"); the component is appended to the
/// model if it is not there. Throws std::invalid_argument for an unknown name.
int component_index(AdditiveModel& model, const std::string& name);
/// Adds an addend; `at_second` empty for one component. The values may be zero.
void add_addend(AdditiveModel& model, const std::string& name, std::vector<double> at,
                std::vector<double> at_second, const Eigen::VectorXd& stiffness);

/// The energy of both: the addends of `a`, then those of `b`; values() one after the other. Empty
/// where the frames differ, both have a barrier, or a model cannot hold so many components.
std::optional<AdditiveModel> sum_of(const AdditiveModel& a, const AdditiveModel& b);

/// The same energy with a control point more at `x` (along the second component if `second`).
/// Where there is one already, or kMostControlPoints are, nothing changes.
AdditiveModel refined(const AdditiveModel& model, int addend, double x, bool second = false);

/// Frames of the elements by their centroids, for EnergyModel::Part::frames; 9 x elements.
Eigen::MatrixXd cylinder_frames(const CylinderFrame& cylinder, const Matrix3Xd& centroids);

/// Exact additive forms of textbook laws: neo-hookean and tied (I1bar, J), stvk (nine addends).
/// Empty for laws that have none.
std::optional<AdditiveModel> as_additive(const EnergyTerm& law);
AdditiveModel additive_stvk(double lambda, double mu);
AdditiveModel additive_neo_hookean(double mu, double kappa);

/// Values of the components at F (in the material frame already if the part has one).
Eigen::VectorXd strains(const AdditiveModel& model, const Matrix3d& F);
/// Per addend: the strains lie outside of its outer control points.
std::vector<bool> beyond_control_points(const AdditiveModel& model, const Eigen::VectorXd& strains);
/// Energy, first and second derivative of one addend of one component along it.
Eigen::Vector3d addend_curve(const AdditiveModel& model, int addend, double e);
/// The same for every control value of that addend (rows), which is linear in them.
Eigen::MatrixX3d addend_curve_basis(const AdditiveModel& model, int addend, double e);
/// dPsi/dvalue of an addend of two components at (a, b).
Eigen::VectorXd addend_energy_basis(const AdditiveModel& model, int addend, double a, double b);

/// An eigenvalue of the Hessian of the energy over a group of components that two-component addends
/// tie together (alone: one component). It is tested at all control points, one-sided where a cell
/// edge makes it jump, and in the middle of every cell.
struct ConvexityTest {
  double smallest = 0.0;     ///< eigenvalue [stress]
  Eigen::VectorXd gradient;  ///< of it by values(): v^T dH/dvalues v
  std::string where;         ///< "E11 = 0.2, E22 = 0"
};
/// The smallest eigenvalue over all tests. A model without addends: 0 at "".
ConvexityTest smallest_eigenvalue(const AdditiveModel& model);

/// A model that shall be convex, its control values linear in other numbers: values() = by_x * x.
struct ConvexPart {
  AdditiveModel model;
  Eigen::MatrixXd by_x;
};

/// The point x nearest to `target`, in the metric, at which every part is convex and resists every
/// strain at rest (1e-5 of the stiffest in its `model`) and which keeps x >= low (empty: no bounds;
/// -infinity: none for this one). H is linear in x, so a violated test bounds it by
/// v^T H(x) v >= 0, which every convex model satisfies: cutting planes along the eigenvalues'
/// gradients. metric: positive definite.
struct ConvexProjection {
  Eigen::VectorXd x;
  int cuts = 0;
  bool converged = false;  ///< false: x may violate convexity
};
ConvexProjection project_convex(const std::vector<ConvexPart>& parts, const Eigen::VectorXd& target,
                                const Eigen::MatrixXd& metric, const Eigen::VectorXd& low = {});

}  // namespace hookeye
