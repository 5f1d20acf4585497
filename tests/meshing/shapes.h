// Surfaces and folders for the tests of meshing.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "meshing/surface_mesh.h"
#include "meshing/tet_mesh.h"
#include "support/temporary_folder.h"

namespace hookeye::test {

/// Box from the origin to `size`, every side cut into cuts x cuts squares; each side has its own
/// uv square, so edges are seams. Triangles 2 cuts^2 a side, sides -z +z -y +y -x +x.
inline SurfaceMesh box_surface(const Vector3d& size, int cuts) {
  SurfaceMesh s;
  std::map<std::array<int, 3>, int> index;
  std::vector<Vector3d> points;
  const auto vertex = [&](std::array<int, 3> at) {
    const auto [it, fresh] = index.try_emplace(at, static_cast<int>(points.size()));
    if (fresh) points.push_back(Vector3d(at[0], at[1], at[2]).cwiseProduct(size) / cuts);
    return it->second;
  };
  for (int axis = 2; axis >= 0; --axis) {
    for (const int top : {0, 1}) {
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      for (int i = 0; i < cuts; ++i) {
        for (int j = 0; j < cuts; ++j) {
          std::array<int, 4> v;
          std::array<Vector2d, 4> uv;
          for (int c = 0; c < 4; ++c) {
            std::array<int, 3> at;
            at[axis] = top * cuts;
            at[a] = i + (c == 1 || c == 2);
            at[b] = j + (c >= 2);
            v[c] = vertex(at);
            uv[c] = Vector2d(at[a], at[b]) / cuts;
          }
          if (top == 0) {
            std::swap(v[1], v[3]);
            std::swap(uv[1], uv[3]);
          }
          s.triangles.push_back({v[0], v[1], v[2]});
          s.uv.push_back({uv[0], uv[1], uv[2]});
          s.triangles.push_back({v[0], v[2], v[3]});
          s.uv.push_back({uv[0], uv[2], uv[3]});
        }
      }
    }
  }
  s.X.resize(3, static_cast<Eigen::Index>(points.size()));
  for (size_t i = 0; i < points.size(); ++i) s.X.col(static_cast<Eigen::Index>(i)) = points[i];
  return s;
}

/// Triangles from the first corner of a convex polygon to all others.
inline std::vector<std::array<int, 3>> fan(int corners) {
  std::vector<std::array<int, 3>> t;
  for (int i = 1; i + 1 < corners; ++i) t.push_back({0, i, i + 1});
  return t;
}

/// Prism over a polygon (counter-clockwise) whose inside is given as triangles; from z = 0 up.
inline SurfaceMesh extruded(const std::vector<Vector2d>& polygon,
                            const std::vector<std::array<int, 3>>& inside, double height) {
  const int n = static_cast<int>(polygon.size());
  SurfaceMesh s;
  s.X.resize(3, 2 * n);
  for (int i = 0; i < n; ++i) {
    s.X.col(i) << polygon[static_cast<size_t>(i)], 0.0;
    s.X.col(n + i) << polygon[static_cast<size_t>(i)], height;
    const int next = (i + 1) % n;
    s.triangles.push_back({i, next, n + next});
    s.triangles.push_back({i, n + next, n + i});
  }
  for (const auto& [a, b, c] : inside) {
    s.triangles.push_back({a, c, b});
    s.triangles.push_back({n + a, n + b, n + c});
  }
  return s;
}

/// A square plate of side `side` from z = 0 up, and a bore of 8 n corners through its middle.
inline SurfaceMesh bored_plate(double side, double radius, double height, int n) {
  const int m = 8 * n;
  SurfaceMesh s;
  s.X.resize(3, 4 * m);
  for (int i = 0; i < m; ++i) {
    const double angle = 2.0 * 3.14159265358979 * i / m;
    const Vector2d way(std::cos(angle), std::sin(angle));
    const Vector2d bore = radius * way, rim = 0.5 * side / way.cwiseAbs().maxCoeff() * way;
    s.X.col(i) << bore, 0.0;
    s.X.col(m + i) << rim, 0.0;
    s.X.col(2 * m + i) << bore, height;
    s.X.col(3 * m + i) << rim, height;
  }
  const auto square = [&](int a, int b, int c, int d) {
    s.triangles.push_back({a, b, c});
    s.triangles.push_back({a, c, d});
  };
  for (int i = 0; i < m; ++i) {
    const int j = (i + 1) % m;
    square(i, j, m + j, m + i);                          // below
    square(2 * m + i, 3 * m + i, 3 * m + j, 2 * m + j);  // above
    square(m + i, m + j, 3 * m + j, 3 * m + i);          // outside
    square(i, 2 * m + i, 2 * m + j, j);                  // bore
  }
  return s;
}

inline double area_of(const SurfaceMesh& s) {
  double sum = 0;
  for (const auto& t : s.triangles) {
    const Vector3d a = s.X.col(t[0]), b = s.X.col(t[1]), c = s.X.col(t[2]);
    sum += 0.5 * (b - a).cross(c - a).norm();
  }
  return sum;
}

/// A folder that goes away with the test, and files in it.
class Scratch : public TemporaryFolder {
 public:
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(*this / name, std::ios::binary) << text;
    return *this / name;
  }
};

/// The message of the InputError that `action` throws; a failure when it throws none.
template <class Action>
std::string refusal(Action action) {
  try {
    action();
  } catch (const InputError& e) {
    EXPECT_FALSE(e.wrong().empty());
    EXPECT_FALSE(e.right().empty());
    return e.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return "";
}

}  // namespace hookeye::test
