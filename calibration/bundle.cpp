// The only file of this layer that touches Ceres.
#include "calibration/bundle.h"

#include <ceres/ceres.h>
#include <ceres/covariance.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "calibration/turns.h"

namespace hookeye {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Numbers of a camera in Ceres's block: fx, fy, cx, cy, lens. (Skew is none of them.)
std::vector<double> block_of(const Camera& camera) {
  std::vector<double> block{camera.fx, camera.fy, camera.cx, camera.cy};
  block.insert(block.end(), camera.distortion.begin(), camera.distortion.end());
  return block;
}

void set_block(Camera& camera, const double* block) {
  camera.fx = block[0], camera.fy = block[1], camera.cx = block[2], camera.cy = block[3];
  camera.distortion.assign(block + 4, block + 4 + camera.distortion.size());
}

/// Points whose mean, weighted by the area that the camera sees there, is where a corner is seen.
/// A dot's four stand for its area exactly up to cubes of its radius.
std::vector<Eigen::Vector3d> points_of(const Board& board, int id) {
  const Eigen::Vector3d x = board.corner(id);
  if (board.diameter == 0.0) return {x};
  const double r = board.diameter / 2 / std::sqrt(2.0);
  return {x + r * Eigen::Vector3d::UnitX(), x - r * Eigen::Vector3d::UnitX(),
          x + r * Eigen::Vector3d::UnitY(), x - r * Eigen::Vector3d::UnitY()};
}

/// Blocks: a camera's numbers; its pose; the board's pose (rotation vector, shift).
class CornerCost final : public ceres::CostFunction {
 public:
  CornerCost(const Camera& camera, std::vector<Eigen::Vector3d> points,
             const Eigen::Vector2d& pixel, double sigma)
      : camera_(camera), points_(std::move(points)), pixel_(pixel), sigma_(sigma) {
    camera_.R.setIdentity();
    camera_.t.setZero();
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = {static_cast<int>(4 + camera.distortion.size()), 6, 6};
  }

  bool Evaluate(double const* const* blocks, double* out, double** jacobians) const override {
    Camera camera = camera_;
    set_block(camera, blocks[0]);
    const auto lens = static_cast<Eigen::Index>(camera.distortion.size());
    Eigen::Matrix2Xd d_optics = Eigen::Matrix2Xd::Zero(2, 4 + lens);
    const Eigen::Map<const Eigen::Vector3d> rc(blocks[1]), tc(blocks[1] + 3), rb(blocks[2]),
        tb(blocks[2] + 3);
    const Eigen::Matrix3d Rc = detail::turn(rc), Rb = detail::turn(rb);
    Eigen::Matrix<double, 2, 6> d_camera = Eigen::Matrix<double, 2, 6>::Zero(), d_board = d_camera;
    std::vector<Seen> seen;
    double total = 0.0;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const Eigen::Vector3d& point : points_) {
      Seen s;
      s.turned_board = Rb * point;
      s.turned_world = Rc * (s.turned_board + tb);
      const Eigen::Vector3d x = s.turned_world + tc;
      s.pixel = camera.project(x, &s.d_dx, nullptr);
      if (!s.pixel.allFinite()) return false;
      s.weight = 1.0 / (x.z() * x.z() * x.z());
      s.depth = x.z();
      if (jacobians) s.d_optics = camera.d_dintrinsics(x);
      total += s.weight;
      mean += s.weight * s.pixel;
      seen.push_back(std::move(s));
    }
    mean /= total;
    Eigen::Map<Eigen::Vector2d>(out).noalias() = (mean - pixel_) / sigma_;
    if (!jacobians) return true;
    const Eigen::Matrix3d Jc = detail::left_jacobian(rc), Jb = detail::left_jacobian(rb);
    for (const Seen& s : seen) {
      const double share = s.weight / total;
      Eigen::Matrix<double, 2, 3> d_dx = share * s.d_dx;
      d_dx.col(2) -= 3.0 * share / s.depth * (s.pixel - mean);  // of the weight
      d_camera.leftCols<3>() -= d_dx * detail::cross(s.turned_world) * Jc;
      d_camera.rightCols<3>() += d_dx;
      d_board.leftCols<3>() -= d_dx * Rc * detail::cross(s.turned_board) * Jb;
      d_board.rightCols<3>() += d_dx * Rc;
      d_optics.leftCols<4>() += share * s.d_optics.leftCols<4>();
      d_optics.rightCols(lens) += share * s.d_optics.rightCols(lens);  // skew stands between
    }
    using RowMajor = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor>;
    if (jacobians[0]) Eigen::Map<RowMajor>(jacobians[0], 2, 4 + lens) = d_optics / sigma_;
    if (jacobians[1]) Eigen::Map<RowMajor>(jacobians[1], 2, 6) = d_camera / sigma_;
    if (jacobians[2]) Eigen::Map<RowMajor>(jacobians[2], 2, 6) = d_board / sigma_;
    return true;
  }

 private:
  struct Seen {
    Eigen::Vector3d turned_board, turned_world;
    Eigen::Vector2d pixel;
    Camera::Jacobian3 d_dx;
    Eigen::Matrix2Xd d_optics;
    double weight, depth;
  };
  Camera camera_;
  std::vector<Eigen::Vector3d> points_;
  Eigen::Vector2d pixel_;
  double sigma_;
};

/// The bundle's numbers as blocks of Ceres.
struct Blocks {
  std::vector<std::vector<double>> optics;
  std::vector<Vector6d> cameras, boards;
  std::vector<char> seen;  ///< of boards
  ceres::Problem problem;

  explicit Blocks(const Bundle& bundle, bool robust) : seen(bundle.boards.size(), 0) {
    for (const Camera& camera : bundle.cameras) {
      optics.push_back(block_of(camera));
      cameras.emplace_back();
      cameras.back() << detail::rotation_vector(camera.R), camera.t;
    }
    for (const BoardPose& pose : bundle.boards) {
      boards.emplace_back();
      boards.back() << detail::rotation_vector(pose.R), pose.t;
    }
    // One loss for all; the problem deletes it once.
    ceres::LossFunction* loss = robust ? new ceres::CauchyLoss(2.0) : nullptr;
    for (const BoardView& view : bundle.views) {
      for (size_t i = 0; i < view.ids.size(); ++i) {
        if (!view.used[i]) continue;
        const double sigma = bundle.sigma.empty() ? 1.0 : bundle.sigma[view.camera];
        problem.AddResidualBlock(
            new CornerCost(bundle.cameras[view.camera], points_of(bundle.board, view.ids[i]),
                           view.pixels.col(static_cast<Eigen::Index>(i)), sigma),
            loss, optics[view.camera].data(), cameras[view.camera].data(),
            boards[view.board].data());
        seen[view.board] = 1;
      }
    }
    double* still = bundle.world_board ? boards[*bundle.world_board].data() : cameras[0].data();
    if (problem.HasParameterBlock(still)) problem.SetParameterBlockConstant(still);
  }

  void write_to(Bundle& bundle) const {
    for (size_t c = 0; c < cameras.size(); ++c) {
      set_block(bundle.cameras[c], optics[c].data());
      bundle.cameras[c].R = detail::turn(cameras[c].head<3>());
      bundle.cameras[c].t = cameras[c].tail<3>();
    }
    for (size_t b = 0; b < boards.size(); ++b)
      bundle.boards[b] = {detail::turn(boards[b].head<3>()), boards[b].tail<3>()};
  }
};

void fill_residuals(Bundle& bundle) {
  for (BoardView& view : bundle.views) {
    view.residuals.resize(2, view.pixels.cols());
    for (Eigen::Index i = 0; i < view.pixels.cols(); ++i)
      view.residuals.col(i) =
          seen_corner(bundle, view, view.ids[static_cast<size_t>(i)]) - view.pixels.col(i);
  }
}

/// Of each camera's used corners, from the median: a few wrong ones do not move it [px].
std::vector<double> robust_sigma(const Bundle& bundle) {
  constexpr double kUnseen = 1e6;  // [px], where the camera cannot see a corner at all
  std::vector<std::vector<double>> sizes(bundle.cameras.size());
  for (const BoardView& view : bundle.views)
    for (size_t i = 0; i < view.ids.size(); ++i)
      for (int k = 0; view.used[i] && k < 2; ++k) {
        const double size = std::abs(view.residuals(k, static_cast<Eigen::Index>(i)));
        sizes[view.camera].push_back(std::isfinite(size) ? size : kUnseen);
      }
  std::vector<double> sigma;
  for (auto& of : sizes) {
    if (of.empty()) of.push_back(1.0);
    const auto middle = of.begin() + static_cast<long>(of.size() / 2);
    std::ranges::nth_element(of, middle);
    sigma.push_back(std::max(1.4826 * *middle, 1e-6));
  }
  return sigma;
}

/// From the sum of squares and what the fit took of it: all cameras share that by their corners.
std::vector<double> sigma_of_fit(const Bundle& bundle) {
  std::vector<double> squares(bundle.cameras.size(), 0.0), count = squares;
  std::vector<char> seen(bundle.boards.size(), 0);
  double all = 0.0, numbers = -6.0;  // the world's frame is given
  for (const BoardView& view : bundle.views)
    for (size_t i = 0; i < view.ids.size(); ++i)
      if (view.used[i]) {
        squares[view.camera] += view.residuals.col(static_cast<Eigen::Index>(i)).squaredNorm();
        count[view.camera] += 2, all += 2;
        seen[view.board] = 1;
      }
  for (const Camera& camera : bundle.cameras) numbers += 10.0 + double(camera.distortion.size());
  numbers += 6.0 * static_cast<double>(std::ranges::count(seen, 1));
  const double left = std::max(1.0 - numbers / std::max(all, 1.0), 0.05);
  for (size_t c = 0; c < squares.size(); ++c)
    squares[c] = std::max(std::sqrt(squares[c] / std::max(count[c], 1.0) / left), 1e-6);
  return squares;
}

/// Takes corners out, and back in where they have come near. True where anything changed.
bool drop_far(Bundle& bundle, const std::vector<double>& sigma) {
  constexpr double kFar = 4.0;
  constexpr long kFewest = 6;
  bool changed = false;
  for (BoardView& view : bundle.views) {
    const std::vector<char> before = view.used;
    for (size_t i = 0; i < view.ids.size(); ++i)
      view.used[i] =
          view.residuals.col(static_cast<Eigen::Index>(i)).norm() < kFar * sigma[view.camera];
    if (std::ranges::count(view.used, 1) < kFewest) view.used.assign(view.ids.size(), 0);
    changed = changed || view.used != before;
  }
  return changed;
}

}  // namespace

Eigen::Vector2d seen_corner(const Bundle& bundle, const BoardView& view, int id) {
  const Camera& camera = bundle.cameras[view.camera];
  const BoardPose& pose = bundle.boards[view.board];
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  double total = 0.0;
  for (const Eigen::Vector3d& point : points_of(bundle.board, id)) {
    const Eigen::Vector3d x = pose.R * point + pose.t;
    const double weight = std::pow(camera.depth(x), -3.0);
    mean += weight * camera.project(x);
    total += weight;
  }
  return mean / total;
}

bool adjust(Bundle& bundle, bool robust) {
  Blocks blocks(bundle, robust);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-12;
  options.gradient_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &blocks.problem, &summary);
  if (!summary.IsSolutionUsable()) return false;
  blocks.write_to(bundle);
  fill_residuals(bundle);
  return true;
}

bool settle(Bundle& bundle) {
  bundle.sigma.clear();
  fill_residuals(bundle);
  // Far from the answer a corner is not wrong because it is off: the loss only weighs it less.
  for (int i = 0; i < 2; ++i) {
    bundle.sigma = robust_sigma(bundle);
    if (!adjust(bundle, true)) return false;
  }
  constexpr int kMostRounds = 8;
  for (int i = 0; i < kMostRounds; ++i) {
    bundle.sigma = robust_sigma(bundle);
    if (!drop_far(bundle, bundle.sigma) && i > 0) break;
    if (!adjust(bundle, false)) return false;
  }
  bundle.sigma = sigma_of_fit(bundle);
  return true;
}

std::optional<BundleCovariance> covariance(const Bundle& bundle) {
  Blocks blocks(bundle, false);
  std::vector<const double*> wanted;
  BundleCovariance out;
  std::vector<Eigen::MatrixXd> to_motion;
  for (size_t c = 0; c < bundle.cameras.size(); ++c) {
    const Camera& camera = bundle.cameras[c];
    for (const Intrinsic& number : camera.intrinsics())
      if (number.name != "skew")
        out.parameters.push_back({c, number.name, number.unit, number.value});
    for (const char* name : {"rotation_x", "rotation_y", "rotation_z"})
      out.parameters.push_back({c, name, "rad", 0.0});
    for (const char* name : {"shift_x", "shift_y", "shift_z"})
      out.parameters.push_back({c, name, "length", 0.0});
    wanted.push_back(blocks.optics[c].data());
    wanted.push_back(blocks.cameras[c].data());
    to_motion.push_back(detail::motion_of_pose(blocks.cameras[c]));
  }
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::SPARSE_QR;
  ceres::Covariance solver(options);
  if (!solver.Compute(wanted, &blocks.problem)) return {};
  const auto size = static_cast<Eigen::Index>(out.parameters.size());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> C(size, size);
  if (!solver.GetCovarianceMatrix(wanted, C.data())) return {};
  Eigen::MatrixXd to = Eigen::MatrixXd::Identity(size, size);
  Eigen::Index at = 0;
  for (size_t c = 0; c < bundle.cameras.size(); ++c) {
    at += static_cast<Eigen::Index>(blocks.optics[c].size());
    to.block(at, at, 6, 6) = to_motion[c];
    at += 6;
  }
  out.covariance = to * C * to.transpose();
  if (!out.covariance.allFinite()) return {};
  return out;
}

}  // namespace hookeye
