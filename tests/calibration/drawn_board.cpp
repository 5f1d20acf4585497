#include "calibration/drawn_board.h"

#include <Eigen/Geometry>
#include <cmath>

namespace hookeye::test {
namespace {

/// Rays of a pixel, on a lattice: an edge along rows or columns of pixels, too, falls between 34
/// places. (On 3 x 3 it would fall between 3, and its corners be drawn a sixth of a pixel off.)
constexpr int kRays = 34, kStep = 21;

void blur(Image& image, double sigma) {
  const int reach = static_cast<int>(std::ceil(3 * sigma));
  std::vector<float> weights;
  double sum = 0.0;
  for (int i = -reach; i <= reach; ++i) sum += std::exp(-i * i / (2 * sigma * sigma));
  for (int i = -reach; i <= reach; ++i)
    weights.push_back(static_cast<float>(std::exp(-i * i / (2 * sigma * sigma)) / sum));
  for (const bool along : {true, false}) {
    const Image before = image;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        float value = 0.0F;
        for (int i = -reach; i <= reach; ++i)
          value += weights[static_cast<size_t>(i + reach)] *
                   (along ? before.at(std::clamp(x + i, 0, image.width - 1), y)
                          : before.at(x, std::clamp(y + i, 0, image.height - 1)));
        image.at(x, y) = value;
      }
  }
}

}  // namespace

int DrawnBoard::white_before(int column, int row) const {
  const int first = white_first ? 0 : 1;  // column of the first white square of row 0
  int count = 0;
  for (int r = 0; r < row; ++r) count += (board.columns + 1 - (first + r) % 2) / 2;
  return count + (column + 1 - (first + row) % 2) / 2;
}

double DrawnBoard::at(double x, double y) const {
  const double p = board.pitch;
  const auto far = board.corner(board.corner_count() - 1);
  const double end_x = board.dots() ? far.x() + p : board.columns * p;
  const double end_y = board.dots() ? far.y() + p : board.rows * p;
  const double first = board.dots() ? -p : 0.0;
  if (x < first - p || y < first - p || x > end_x + p || y > end_y + p) return 0.45;
  if (x < first || y < first || x > end_x || y > end_y) return inverted ? 0.05 : 0.9;
  bool white = true;
  if (board.dots()) {
    const bool even = board.kind == Board::Kind::circles;
    // A dot of an asymmetric grid may reach beyond the middle between two rows.
    for (const double near : {std::floor(y / p), std::ceil(y / p)}) {
      const int row = std::clamp(static_cast<int>(near), 0, board.rows - 1);
      const double along = even ? x / p : (x / p - row % 2) / 2;
      const int column = std::clamp(static_cast<int>(std::lround(along)), 0, board.columns - 1);
      const auto middle = board.corner(row * board.columns + column);
      white = white && std::hypot(middle.x() - x, middle.y() - y) > board.diameter / 2;
    }
  } else {
    const int column = std::min(static_cast<int>(x / p), board.columns - 1);
    const int row = std::min(static_cast<int>(y / p), board.rows - 1);
    white = (column + row) % 2 == (white_first ? 0 : 1);
    if (white && !markers.empty()) {
      const int id = white_before(column, row);
      const double rim = (p - board.marker) / 2;
      const double u = (x - column * p - rim) / board.marker,
                   v = (y - row * p - rim) / board.marker;
      const auto& cells = markers.at(static_cast<size_t>(id));
      const int side = static_cast<int>(std::lround(std::sqrt(double(cells.size()))));
      if (u >= 0 && v >= 0 && u < 1 && v < 1)
        white = cells[static_cast<size_t>(int(v * side) * side + int(u * side))];
    }
  }
  return white != inverted ? 0.9 : 0.05;
}

BoardPhotographer::BoardPhotographer(const Camera& camera) : camera_(camera) {
  Camera still = camera;
  still.R.setIdentity();
  still.t.setZero();
  for (int y = 0; y <= camera.height; ++y)
    for (int x = 0; x <= camera.width; ++x)
      rays_.push_back(still.ray({x - 0.5, y - 0.5}).direction.hnormalized());
}

Image BoardPhotographer::photo(const DrawnBoard& board, const BoardPose& pose,
                               const PhotoLook& look, std::mt19937& random) const {
  // x_in_camera = H (x, y, 1) for points of the board.
  Eigen::Matrix3d H;
  H.col(0) = camera_.R * pose.R.col(0);
  H.col(1) = camera_.R * pose.R.col(1);
  H.col(2) = camera_.R * pose.t + camera_.t;
  const Eigen::Matrix3d back = H.inverse();
  Image image;
  image.width = camera_.width, image.height = camera_.height, image.channels = 1;
  image.values.assign(image.pixels(), 0.45F);
  const auto seen = [&](const Eigen::Vector2d& ray) {
    const Eigen::Vector3d at = back * ray.homogeneous();
    return board.at(at.x() / at.z(), at.y() / at.z());
  };
  std::vector<double> at_corners;
  for (const Eigen::Vector2d& ray : rays_) at_corners.push_back(seen(ray));
  const size_t stride = size_t(camera_.width + 1);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const size_t a = size_t(y) * stride + size_t(x), b = a + 1, c = a + stride, d = c + 1;
      const double value = at_corners[a];
      image.at(x, y) = static_cast<float>(value);
      if (at_corners[b] == value && at_corners[c] == value && at_corners[d] == value) continue;
      double sum = 0.0;
      for (int i = 0; i < kRays; ++i) {
        const double u = (i + 0.5) / kRays, v = (i * kStep % kRays + 0.5) / kRays;
        sum += seen((1 - v) * ((1 - u) * rays_[a] + u * rays_[b]) +
                    v * ((1 - u) * rays_[c] + u * rays_[d]));
      }
      image.at(x, y) = static_cast<float>(sum / kRays);
    }
  blur(image, look.blur);
  std::normal_distribution<float> noise(0.0F, static_cast<float>(look.noise));
  for (float& value : image.values) value = std::clamp(value + noise(random), 0.0F, 1.0F);
  return image;
}

std::vector<BoardPose> spread_poses(const Camera& camera, const Board& board, int count,
                                    double distance, double tilt, std::mt19937& random) {
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  const Eigen::Vector3d middle = 0.5 * (board.corner(0) + board.corner(board.corner_count() - 1));
  std::vector<BoardPose> poses;
  for (int i = 0; i < count; ++i) {
    // Where the middle of the board is seen: eight places around and the middle of the picture.
    const double places[9][2] = {{0, 0}, {-1, -1}, {1, 1}, {-1, 1}, {1, -1},
                                 {0, 1}, {0, -1},  {1, 0}, {-1, 0}};
    const double z = distance * (1.0 + 0.25 * share(random));
    const Eigen::Vector3d at(places[i % 9][0] * 0.2 * camera.width * z / camera.fx,
                             places[i % 9][1] * 0.2 * camera.height * z / camera.fy, z);
    const double toward = 2 * M_PI * (i * 0.381966 + 0.05 * share(random));
    const Eigen::Vector3d axis(std::cos(toward), std::sin(toward), 0);
    BoardPose pose;
    pose.R = (Eigen::AngleAxisd(tilt * M_PI / 180 * (0.6 + 0.4 * share(random)), axis) *
              Eigen::AngleAxisd(0.3 * share(random), Eigen::Vector3d::UnitZ()))
                 .toRotationMatrix();
    pose.t = at - pose.R * middle;
    poses.push_back(pose);
  }
  return poses;
}

Camera true_camera(const std::string& name) {
  Camera camera;
  camera.name = name;
  camera.width = 640, camera.height = 480;
  camera.fx = 801.5, camera.fy = 803.0, camera.cx = 316.2, camera.cy = 243.9;
  camera.distortion = {-0.12, 0.06, 0.001, -0.0007, 0.0};
  return camera;
}

Camera second_camera(const std::string& name, double roll) {
  Camera camera = true_camera(name);
  camera.fx = 784.0, camera.fy = 783.2, camera.cx = 325.0, camera.cy = 236.4;
  camera.distortion = {-0.09, 0.03, -0.0008, 0.0005, 0.0};
  camera.R = (Eigen::AngleAxisd(roll * M_PI / 180, Eigen::Vector3d::UnitZ()) *
              Eigen::AngleAxisd(0.25, Eigen::Vector3d::UnitY()))
                 .toRotationMatrix();
  camera.t = -camera.R * Eigen::Vector3d(95, 6, 8);
  return camera;
}

}  // namespace hookeye::test
