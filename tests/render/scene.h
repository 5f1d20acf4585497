// Scenes and directional derivatives for the tests of render.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <map>

#include "render/renderer.h"

namespace hookeye::test {

/// Sphere from an icosahedron, corners pushed out to `radius` and, by `bump`, a little beyond; uv
/// from x and y.
inline SurfaceMesh sphere(const Vector3d& centre, double radius, int subdivisions, double bump = 0,
                          const Vector2d& uv_shift = Vector2d::Zero()) {
  const double p = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vector3d> x = {{-1, p, 0}, {1, p, 0}, {-1, -p, 0}, {1, -p, 0},
                             {0, -1, p}, {0, 1, p}, {0, -1, -p}, {0, 1, -p},
                             {p, 0, -1}, {p, 0, 1}, {-p, 0, -1}, {-p, 0, 1}};
  std::vector<std::array<int, 3>> t = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                       {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                       {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                       {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int s = 0; s < subdivisions; ++s) {
    std::map<std::pair<int, int>, int> middle;
    const auto between = [&](int a, int b) {
      const auto [at, fresh] = middle.try_emplace(std::minmax(a, b), int(x.size()));
      if (fresh) x.push_back(((x[a].normalized() + x[b].normalized()) / 2).normalized());
      return at->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& f : t) {
      const int a = between(f[0], f[1]), b = between(f[1], f[2]), c = between(f[2], f[0]);
      finer.insert(finer.end(), {{f[0], a, c}, {a, f[1], b}, {c, b, f[2]}, {a, b, c}});
    }
    t = finer;
  }
  SurfaceMesh out;
  out.triangles = t;
  out.X.resize(3, Eigen::Index(x.size()));
  for (size_t i = 0; i < x.size(); ++i) {
    const Vector3d n = x[i].normalized();
    out.X.col(i) = centre + radius * (1 + bump * std::sin(3 * n.x() + 1) * n.y()) * n;
  }
  for (const auto& f : t) {
    auto& uv = out.uv.emplace_back();
    for (int k = 0; k < 3; ++k)
      uv[k] =
          0.5 * Vector2d::Ones() + uv_shift + (out.X.col(f[k]) - centre).head<2>() / (4 * radius);
  }
  return out;
}

inline SurfaceMesh both(const SurfaceMesh& a, const SurfaceMesh& b) {
  SurfaceMesh out = a;
  out.X.resize(3, a.X.cols() + b.X.cols());
  out.X << a.X, b.X;
  for (auto t : b.triangles) {
    for (int& v : t) v += int(a.X.cols());
    out.triangles.push_back(t);
  }
  out.uv.insert(out.uv.end(), b.uv.begin(), b.uv.end());
  return out;
}

/// A fisheye is near the body, which it sees beside its axis.
inline Camera camera(const std::string& model, bool distorted) {
  Camera c;
  c.width = 80, c.height = 64;
  c.model = &camera_model(model);
  const bool fisheye = model == "fisheye", central = c.model->central();
  c.fx = fisheye ? 45 : central ? 130 : 2.7, c.fy = fisheye ? 44 : central ? 128 : 2.6;
  c.cx = 40.3, c.cy = 31.2;
  if (distorted && fisheye)
    c.distortion = {-0.08, 0.03, -0.01, 0.002};
  else if (distorted && central)
    c.distortion = {-0.2, 0.05, 0.003, -0.002, 0.01};
  else if (distorted)  // by length
    c.distortion = {-4e-4, 2e-7, 3e-4, -2e-4};
  if (distorted) c.skew = 0.02 * c.fx;
  c.R = Eigen::AngleAxisd(0.3, Vector3d(0.2, 1, -0.4).normalized()).toRotationMatrix();
  c.t = fisheye ? Vector3d(6, -4, 22) : Vector3d(0.5, -0.3, 50);
  return c;
}

/// Turns the picture of camera() by a quarter of a pixel [rad].
inline double turning_step(const Camera& camera) {
  return camera.model->central() ? 0.26 / camera.fx : 0.002;
}

/// Smooth picture with values about 0.5.
inline std::shared_ptr<Image> waves(int width, int height, double periods) {
  auto image = std::make_shared<Image>(Image{width, height, 1, {}});
  image->values.resize(image->pixels());
  const double a = 2 * M_PI * periods / width;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image->at(x, y) = float(0.5 + 0.2 * std::sin(a * x + 0.4) * std::cos(0.7 * a * y) +
                              0.15 * std::cos(a * (0.5 * x + y)));
  return image;
}

/// A smooth displacement field.
inline Matrix3Xd field(const Matrix3Xd& X, double phase) {
  Matrix3Xd u(3, X.cols());
  for (int v = 0; v < X.cols(); ++v) {
    const Vector3d x = X.col(v) / 10;
    u.col(v) = Vector3d(std::sin(x.y() + phase) + 0.3 * x.z(), std::cos(x.x() - x.z() + phase),
                        std::sin(x.x() + 2 * x.y() - phase));
  }
  return u;
}

inline PhotoState state(const Camera& camera) {
  PhotoState s;
  s.camera = camera;
  s.gain = 1.1, s.ambient = 0.4;
  // From behind the camera, so that all that is seen is lit.
  s.sun = 0.7 * (camera.R.transpose() * Vector3d(0.1, -0.15, -1)).normalized();
  s.specular = 0.3, s.shininess = 8;
  s.background = 0.1;
  return s;
}

/// The photo with its camera turned, moved or zoomed by h along `column` (below kLogGain).
inline PhotoState with_camera(PhotoState s, int column, double h) {
  if (column < kMove)
    s.camera = s.camera.moved(h * Vector3d::Unit(column), Vector3d::Zero());
  else if (column < kZoom)
    s.camera = s.camera.moved(Vector3d::Zero(), h * Vector3d::Unit(column - kMove));
  else
    s.camera = s.camera.zoomed(h);
  return s;
}

/// All parts of a derivative as one, with the photo's numbers as columns.
struct Joined {
  std::vector<int> pixel, first = {0};
  std::vector<DerivativeSegment> segments;
  Eigen::Matrix<float, kPhotoColumns, Eigen::Dynamic> d_photo;
};
inline Joined joined(const ImageDerivative& dI) {
  Joined out;
  out.d_photo.resize(kPhotoColumns, Eigen::Index(dI.pixels()));
  for (const auto& part : dI.parts)
    for (size_t i = 0; i < part.pixel.size(); ++i) {
      auto d_photo = out.d_photo.col(Eigen::Index(out.pixel.size()));
      d_photo.setZero();
      d_photo.head<kUneven>() = part.photo[i].head<kUneven>();
      if (!part.uneven.empty()) d_photo.tail<kUnevenNumbers>() = part.uneven[i];
      out.pixel.push_back(part.pixel[i]);
      out.segments.insert(out.segments.end(), part.segments.begin() + part.first[i],
                          part.segments.begin() + part.first[i + 1]);
      out.first.push_back(int(out.segments.size()));
    }
  return out;
}

/// dI of every pixel for changes of positions (and by them normals), reference and photo numbers;
/// `dx_reference` belongs to photo textures and has to be told with them. Pixels without
/// derivative: NaN.
inline VectorXd directional(const Renderer& renderer, const Rendering& r, const Matrix3Xd& x,
                            const Matrix3Xd* dx, const Matrix3Xd* dx_reference,
                            const VectorXd& d_photo) {
  VectorXd out = VectorXd::Constant(Eigen::Index(r.I.pixels()), std::nan(""));
  Matrix3Xd dn = Matrix3Xd::Zero(3, x.cols());
  if (dx) dn.reshaped() = renderer.normal_derivative(x) * dx->reshaped();
  const Joined dI = joined(r.dI);
  for (size_t i = 0; i < dI.pixel.size(); ++i) {
    double d = dI.d_photo.col(i).cast<double>().dot(d_photo);
    for (int s = dI.first[i]; s < dI.first[i + 1]; ++s) {
      const DerivativeSegment& g = dI.segments[s];
      for (int k = 0; k < 3; ++k) {
        const int v = renderer.surface().triangles[g.triangle][k];
        if (dx) d += g.d_position().col(k).cast<double>().dot(dx->col(v));
        const Matrix3Xd* second = dx_reference ? dx_reference : dx ? &dn : nullptr;
        if (second) d += g.d_second().col(k).cast<double>().dot(second->col(v));
      }
    }
    out[dI.pixel[i]] = d;
  }
  return out;
}

/// Sums over blocks of 8 x 8 pixels, for edges: a finite ray pattern counts coverage in steps,
/// which sums along an edge even out. Values that are not finite count as zero.
inline VectorXd block_sums(const VectorXd& pixels, int width, int height) {
  constexpr int kBlockPx = 8;
  const int columns = (width + kBlockPx - 1) / kBlockPx, rows = (height + kBlockPx - 1) / kBlockPx;
  VectorXd out = VectorXd::Zero(columns * rows);
  for (int i = 0; i < pixels.size(); ++i)
    if (std::isfinite(pixels[i]))
      out[i / width / kBlockPx * columns + i % width / kBlockPx] += pixels[i];
  return out;
}

}  // namespace hookeye::test
