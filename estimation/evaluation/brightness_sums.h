// Normal equations of a photo whose brightness the model's picture follows (images/brightness.h):
// what the gains' own derivatives change in them.
#pragma once

#include "estimation/images/brightness.h"
#include "render/condensed.h"

namespace hookeye {

/// With K = (1 - I U M^-1 U^T) G (G: gains, U: weights of the nodes, M: Brightness::change) the
/// sums J^T W J of J = K dI are those of G dI, less E^T C + C^T E, plus C^T F C:
///   C = M^-1 U^T G dI, E = U^T I W G dI (nodes x parameters), F = U^T I W I U (nodes x nodes).
class BrightnessSums {
 public:
  /// `w`: per active pixel of `dI` the factor dr_i/d(followed picture)_i.
  BrightnessSums(const Brightness& brightness, const SurfaceMesh& surface,
                 const ImageDerivative& dI, const VectorXd& w, CondensedColumns columns);
  /// Adds that change to `sums`, which are of w_i gain_i.
  void add_to(CondensedPhoto* sums, const VertexSensitivity& S) const;

 private:
  class Run;
  /// Of one vertex at one node: rows of U^T G dI and of E by the vertex's six numbers.
  struct Slot {
    int vertex;
    Eigen::Matrix<double, 6, 2> by_vertex;
  };
  struct Node {
    std::vector<Slot> slots;
    Eigen::Matrix<double, kPhotoFloats, 2> by_photo =
        Eigen::Matrix<double, kPhotoFloats, 2>::Zero();
  };
  Slot& slot(int node, int vertex);

  const Brightness& brightness_;
  CondensedColumns columns_;
  std::vector<Node> nodes_;
  Brightness::Products products_;
};

}  // namespace hookeye
