// Energy densities: one interface for all laws.
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "capture_io/capture.h"
#include "core/parameter.h"

namespace hookeye {

using Eigen::Matrix3d;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

/// A frame that varies over the body, a tube's: a1 away from the axis, a2 around it, a3 along it.
struct CylinderFrame {
  Eigen::Vector3d axis, center;
};

/// W(F) per rest volume [stress]. 9-vectors and 9x9 stack F column by column (Eigen's order).
/// Frame: rest axes; an anisotropic law keeps its own directions as parameters.
class EnergyTerm {
 public:
  virtual ~EnergyTerm() = default;
  virtual std::string name() const = 0;
  /// Names, units, bounds and the present values; order = order of `with`.
  virtual std::vector<Parameter> parameters(const Units& units) const = 0;
  /// A copy with other values.
  virtual std::shared_ptr<const EnergyTerm> with(const Eigen::VectorXd& values) const = 0;

  /// psi(F). +infinity where F is not admissible (det F <= 0 for laws with J).
  virtual double psi(const Matrix3d& F) const = 0;
  /// First Piola-Kirchhoff stress P = dpsi/dF.
  virtual Matrix3d P(const Matrix3d& F) const = 0;
  /// d vec(P) / d vec(F), symmetric 9x9.
  virtual Matrix9d dP_dF(const Matrix3d& F) const = 0;
  /// dP / dtheta_k.
  virtual Matrix3d dP_dtheta(const Matrix3d& F, int k) const = 0;
  /// All of them: column k is vec(dP / dtheta_k). A law with many parameters overrides it.
  virtual Eigen::Matrix<double, 9, Eigen::Dynamic> all_dP_dtheta(const Matrix3d& F) const;
  /// Where the law is told in the frames of a tube: then the body's part carries them. Else null.
  virtual const CylinderFrame* cylinder() const { return nullptr; }
  /// Number of parameters.
  virtual int size() const { return static_cast<int>(parameters(Units{}).size()); }
};

/// dP/dF in rest axes of D told in a frame: P = P'(F A) A^T, A orthonormal with columns a1 a2 a3.
Matrix9d stiffness_from_frame(const Matrix9d& D, const Matrix3d& A);

/// Builds a law from a capture's `material:`; names the fault with its place (unknown law or
/// parameter with the nearest known one, missing, wrong count, out of range). Throws InputError.
std::shared_ptr<const EnergyTerm> make_law(const MaterialSpec& spec);
std::vector<std::string> law_names();

/// The laws, one file each in simulation/laws/. Formulas: docs/capture.md, "Laws".
std::shared_ptr<const EnergyTerm> neo_hookean(double mu, double kappa);
/// kappa = ratio * mu: one parameter "mu" (the ratio is kept).
std::shared_ptr<const EnergyTerm> neo_hookean_tied(double mu, double kappa_over_mu);
std::shared_ptr<const EnergyTerm> stvk(double lambda, double mu);
std::shared_ptr<const EnergyTerm> mooney_rivlin(double c10, double c01, double kappa);
std::shared_ptr<const EnergyTerm> yeoh(double c1, double c2, double c3, double kappa);
std::shared_ptr<const EnergyTerm> ogden(const std::vector<double>& mu,
                                        const std::vector<double>& alpha, double kappa);
/// b = b11 b22 b33 b12 b23 b13 g12 g23 g13.
std::shared_ptr<const EnergyTerm> fung(double c, const Eigen::Matrix<double, 9, 1>& b,
                                       double kappa);
/// Matrix and families of fibres. `angles` [degrees], measured in the plane of the frame's columns
/// 1 and 2 from the first, are parameters; or fixed unit `directions` in rest axes.
struct HolzapfelValues {
  double mu = 0, k1 = 0, k2 = 0, kappa = 0;
  double dispersion = 0, toe = 0.01;
  Matrix3d frame = Matrix3d::Identity();
  std::vector<double> angles;
  std::vector<Eigen::Vector3d> directions;
  std::optional<CylinderFrame> cylinder;
};
std::shared_ptr<const EnergyTerm> holzapfel(const HolzapfelValues& values);
/// Fibre term stiffness/2 (I4bar - 1)^2, I4bar = J^(-2/3) a.C a, a unit, along a (all strains).
std::shared_ptr<const EnergyTerm> fibre(double stiffness, const Eigen::Vector3d& direction);
/// Fibres that only pull and stiffen exponentially: k1/(2 k2) (exp(k2 (I4bar - 1)^2) - 1) in
/// tension, of I4 itself where the volume counts.
struct PullingFibreValues {
  double k1 = 0, k2 = 0;
  Eigen::Vector3d direction{1, 0, 0};
  bool volume_counts = false;
  double toe = 0.01;
};
std::shared_ptr<const EnergyTerm> pulling_fibre(const PullingFibreValues& values);
/// 1/2 sum c_ij E_ii E_jj + 2 sum_{i<j} g_ij E_ij^2 of the Green strain in `frame` (columns: axes).
struct OrthotropicValues {
  Matrix3d c = Matrix3d::Zero(), g = Matrix3d::Zero();  ///< symmetric; the diagonal of g is 0
  Matrix3d frame = Matrix3d::Identity();
};
std::shared_ptr<const EnergyTerm> orthotropic(const OrthotropicValues& values);
/// Of c11 c22 c33 c12 c13 c23 g12 g13 g23.
OrthotropicValues orthotropic_values(const Eigen::VectorXd& stiffnesses, const Matrix3d& frame);
/// Stiffnesses by Voigt's order of strains (E11, E22, E33, 2 E23, 2 E13, 2 E12), symmetric.
using Stiffness6 = Eigen::Matrix<double, 6, 6>;
/// 1/2 e.C e of the Green strain in rest axes: 21 constants.
std::shared_ptr<const EnergyTerm> anisotropic(const Stiffness6& C);
/// Told in rest axes.
Stiffness6 voigt_stiffness(const OrthotropicValues& values);
/// C told in the axes that are the columns of A.
Stiffness6 stiffness_in_frame(const Stiffness6& C, const Matrix3d& A);
/// sum_i k_i W_i: with (s, -s) beside W_2 itself, the share s of W_2 goes over into W_1.
struct WeightedTerm {
  double coefficient;
  std::shared_ptr<const EnergyTerm> term;
};
std::shared_ptr<const EnergyTerm> combination(std::vector<WeightedTerm> terms);

}  // namespace hookeye
