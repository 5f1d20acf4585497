// A texture that is a photo brings its light with it. Where the body turns in the lamp its picture
// keeps the old brightness. So the model's picture follows the photo's brightness, smoothly over
// each smooth patch of the surface, as correlation does within a subset (ZNSSD: Pan 2010).
#pragma once

#include <Eigen/SparseCholesky>
#include <array>
#include <memory>
#include <vector>

#include "capture_io/image.h"
#include "render/renderer.h"

namespace hookeye {

/// Number of the smooth patch of each triangle: joined over edges that bend by less than `degrees`
/// at rest.
std::vector<int> smooth_patches(const SurfaceMesh& surface, double degrees);

/// The gain of each pixel: bilinear between nodes of a square lattice, one lattice a patch, such
/// that picture and photo have the same weighted sum about each node. So motion that the model
/// lacks, which moves speckles and not their mean, hardly changes it.
class Brightness {
 public:
  /// `picture`: of the model (RenderOptions::centres); `valid`: of the photo, empty: all. Pixels
  /// that are wholly of the body follow. `cell`: between nodes [px].
  Brightness(const Rendering& picture, const Image& photo, const std::vector<unsigned char>& valid,
             const std::vector<int>& patch_of_triangle, double cell);

  const Image& unfollowed() const { return I_; }
  Image followed() const;  ///< gain times picture; as it was where nothing follows
  bool follows(size_t pixel) const { return patch_[pixel] >= 0; }
  float gain(size_t pixel) const { return gain_[pixel]; }

  /// A lattice node that a pixel lies by, and its weight there.
  struct Corner {
    int node;
    float weight;
  };
  /// Of a pixel that follows: its square's nodes, row by row.
  std::array<Corner, 4> corners(size_t pixel) const;
  int nodes() const { return static_cast<int>(gain_of_node_.size()); }
  /// -d(gain of nodes), of the weighted sums of gain times dI about them: nodes x any.
  Eigen::MatrixXd change(const Eigen::MatrixXd& sums) const { return solver_->solve(sums); }

  /// Symmetric sums of weights of two nodes, which are neighbours.
  class Products {
   public:
    explicit Products(Eigen::Index nodes) : rows_(static_cast<size_t>(nodes)) {}
    void add(const std::array<Corner, 4>& at, double weight);
    template <class F>  ///< f(node, other, sum)
    void for_each(const F& f) const {
      for (size_t n = 0; n < rows_.size(); ++n)
        for (int k = 0; k < rows_[n].count; ++k)
          f(static_cast<int>(n), rows_[n].entry[k].first, rows_[n].entry[k].second);
    }

   private:
    struct Row {
      std::array<std::pair<int, double>, 9> entry;
      int count = 0;
    };
    std::vector<Row> rows_;
  };

  /// K^T v, with d(followed) = K d(picture).
  Image adjoint(const Image& v) const;

 private:
  /// A patch's lattice: nodes first + (y - y0) width + (x - x0).
  struct Lattice {
    int x0, y0, x1, y1, first;
    int width() const { return x1 - x0 + 1; }
  };
  template <class F>
  void for_each(const F& f) const;
  int lay_lattices();  ///< returns how many nodes they have
  void balance(const Image& photo, double level);

  Image I_;
  double cell_;
  std::vector<int> patch_;   ///< by pixel; -1: does not follow
  std::vector<float> gain_;  ///< by pixel
  std::vector<Lattice> lattices_;
  Eigen::VectorXd gain_of_node_;
  /// Of M: sums of picture times both weights, node with node.
  std::shared_ptr<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>> solver_;
};

}  // namespace hookeye
