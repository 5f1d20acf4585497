// Supports and forces of one example.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <string>
#include <vector>

#include "meshing/regions.h"
#include "meshing/tet_mesh.h"

namespace hookeye {

using Triplets = std::vector<Eigen::Triplet<double>>;

/// A force on the nodes with its derivative. q: 3n deformed positions, X likewise.
/// R += -force (residual = internal - external). d(-force)/dq comes in two parts: the symmetric
/// one, which is factored, and the skew one of forces without a potential (follower pressure on an
/// open patch).
class ForceTerm {
 public:
  virtual ~ForceTerm() = default;
  /// Potential energy at load fraction s in [0,1]; terms without one return 0 and has_potential() =
  /// false.
  virtual double potential(const TetMesh& mesh, const VectorXd& q, double s) const = 0;
  virtual bool has_potential() const { return true; }
  virtual void add_residual(const TetMesh& mesh, const VectorXd& q, double s,
                            VectorXd& R) const = 0;
  /// K += symmetric part of d(-force)/dq.
  virtual void add_tangent(const TetMesh& mesh, const VectorXd& q, double s, Triplets& K) const = 0;
  /// W += skew part of d(-force)/dq, W^T = -W.
  virtual void add_skew_tangent(const TetMesh&, const VectorXd& /*q*/, double /*s*/,
                                Triplets& /*W*/) const {}
  /// True when add_tangent adds nothing (dead loads): keeps the symbolic pattern.
  virtual bool dead() const { return false; }
};

/// Total dead force spread over the region's rest area [force].
std::shared_ptr<const ForceTerm> dead_force(const Region& region, const Vector3d& force);
/// Arbitrary constant nodal force (3n) [force].
std::shared_ptr<const ForceTerm> nodal_force(VectorXd force);
/// Pressure on the deformed faces, inwards [stress].
std::shared_ptr<const ForceTerm> follower_pressure(const Region& region, double pressure);
/// density * gravity on the reference volume, consistent nodal loads. `density` [force
/// s^2/length^4], gravity [length/s^2].
std::shared_ptr<const ForceTerm> self_weight(const TetMesh& mesh, double density,
                                             const Vector3d& gravity);
/// Elastic foundation on the region: traction -k_n (u.n)n - k_t (u - (u.n)n), u = q - target, rest
/// normal n, integrated over the faces. k [stress/length]. `target` 3n: where the springs are at
/// rest.
std::shared_ptr<const ForceTerm> elastic_foundation(const Region& region, double k_normal,
                                                    double k_tangent, VectorXd target);
/// Rigid floor, half space (x - point).normal >= 0 is free. Penalty traction k * depth, smoothed
/// (C1) over `smoothing` [length] of depth, on the rest area of all boundary faces.
/// k [stress/length].
std::shared_ptr<const ForceTerm> floor_contact(const TetMesh& mesh, const Vector3d& point,
                                               const Vector3d& normal, double k, double smoothing);

/// Prescribed unknowns and forces. Unknown i of node a: 3 a + i.
struct Loading {
  std::string name;
  std::vector<int> prescribed;  ///< ascending, unique unknowns
  VectorXd displacement;        ///< of each prescribed unknown at full load [length]
  std::vector<std::shared_ptr<const ForceTerm>> forces;
  /// Regions that turn: on the way from rest they go round by the angle, not straight through the
  /// axis; a whole turn ends where it began.
  struct Turn {
    std::vector<int> nodes;  ///< ascending
    RigidMotion motion;
  };
  std::vector<Turn> turns;

  /// Displacement of prescribed[i] at the share s of the load, coming from the body at rest X.
  double displacement_at(const Matrix3Xd& X, size_t i, double s) const;
  /// A support turns by half a turn or more: where it ends does not tell the way there.
  bool winds() const;
  /// Share of the load that turns no support by more than 30 degrees, 1 at most.
  double first_step() const;
  /// Prescribes component i of all nodes of a region (later calls override).
  void prescribe(const TetMesh& mesh, const Region& region, int component, double displacement);
  /// Prescribes all components so that the region moves rigidly.
  void prescribe_rigid(const TetMesh& mesh, const Region& region, const RigidMotion& motion);
  /// Removes what holds the region (for supports that an effect softens).
  void release(const Region& region);
};

/// Supports and loads of a capture's example (rigid: fit starts at zero motion), without gravity.
Loading make_loading(const Capture& capture, const ExampleSpec& example, const TetMesh& mesh,
                     const RegionSet& regions);

/// Names of rigid motions a loading leaves free ("rotation about (0, 0, 1) through ..."), from the
/// null space of the prescribed unknowns' rigid modes; empty: none.
std::vector<std::string> free_rigid_motions(const TetMesh& mesh, const Loading& loading);

}  // namespace hookeye
