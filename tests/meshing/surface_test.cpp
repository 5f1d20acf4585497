#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <fstream>
#include <set>
#include <sstream>

#include "meshing/surface_mesh.h"
#include "meshing/tet_mesh.h"
#include "shapes.h"
#include "support/shared_data.h"

namespace hookeye {
namespace {

using test::box_surface;
using test::refusal;
using test::Scratch;
using ::testing::HasSubstr;

const Place kPlace{"capture.yaml", 5, 3};

TEST(ReadSurface, ObjKeepsTrianglesPositionsAndSeams) {
  const SurfaceMesh box = box_surface({3, 2, 1}, 2);
  const Scratch scratch;
  write_surface_obj(scratch / "box.obj", box);
  const SurfaceMesh back = read_surface(scratch / "box.obj");
  ASSERT_EQ(back.triangles.size(), box.triangles.size());
  ASSERT_EQ(back.X.cols(), box.X.cols()) << "a uv seam must not split a vertex";
  ASSERT_EQ(back.uv.size(), box.uv.size());
  for (size_t t = 0; t < box.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(back.X.col(back.triangles[t][k]), box.X.col(box.triangles[t][k]));
      EXPECT_EQ(back.uv[t][k], box.uv[t][k]);
    }
  }
}

TEST(ReadSurface, ObjIsWrittenWithNormals) {
  SurfaceMesh box = box_surface({3, 2, 1}, 1);
  const Eigen::Matrix3Xd normals = box.X.colwise().normalized();
  const Scratch scratch;
  const auto lines_with = [&](const std::string& start) {
    write_surface_obj(scratch / "box.obj", box, normals);
    EXPECT_EQ(read_surface(scratch / "box.obj").triangles.size(), box.triangles.size());
    std::ifstream file(scratch / "box.obj");
    Eigen::Index count = 0;
    for (std::string line; std::getline(file, line);) count += line.starts_with(start);
    return count;
  };
  EXPECT_EQ(lines_with("vn "), box.X.cols());
  const int corner = box.triangles[0][0] + 1;
  EXPECT_EQ(lines_with(fmt::format("f {}/1/{} ", corner, corner)), 1);
  box.uv.clear();
  EXPECT_GE(lines_with(fmt::format("f {}//{} ", corner, corner)), 1);
}

TEST(ReadSurface, ObjWeldsAndCountsFromTheEndAndAcrossGroups) {
  const Scratch scratch;
  const auto file = scratch.write("a.obj",
                                  "o one\nv 0 0 0\nv 1 0 0\nv 0 1 0\ng left\nf 1 2 3\n"
                                  "g right\nv 0 0 0\nv 1 0 0\nv 0 0 1\nf -3 -2 -1\n");
  const SurfaceMesh s = read_surface(file);
  EXPECT_EQ(s.X.cols(), 4);
  ASSERT_EQ(s.triangles.size(), 2u);
  EXPECT_EQ(s.triangles[0][0], s.triangles[1][0]);
  EXPECT_TRUE(s.uv.empty());
}

TEST(ReadSurface, ObjFaultsHaveTheirLine) {
  const Scratch scratch;
  const std::string points = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  const auto fault = [&](const std::string& text) {
    return refusal([&] { read_surface(scratch.write("bad.obj", text)); });
  };
  EXPECT_THAT(fault(points + "f 1 2 3 4\n"), HasSubstr("bad.obj:5: face 0 has 4 corners"));
  EXPECT_THAT(fault(points + "f 1 2 9\n"), HasSubstr("bad.obj:5: face 0 names vertex 9"));
  EXPECT_THAT(fault("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"), HasSubstr("bad.obj:2: 'nan'"));
  EXPECT_THAT(fault("v 0 0 0\nv 1 zero 0\nv 0 1 0\nf 1 2 3\n"), HasSubstr("bad.obj:2: 'zero'"));
  EXPECT_THAT(fault("v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n"), HasSubstr("bad.obj:2: fewer"));
  EXPECT_THAT(fault(points + "vt 0 0\nf 1/1 2/1 3/1\nf 1 3 4\n"), HasSubstr("bad.obj:7: face 1"));
  EXPECT_THAT(fault(points + std::string("f 1 2\0 3\n", 9)),
              HasSubstr("bad.obj:5: there is a zero"));
  EXPECT_NO_THROW(read_surface(scratch.write("mark.obj", "\xEF\xBB\xBF" + points + "f 1 2 4\n")));
  EXPECT_THAT(fault(points), HasSubstr("holds no triangles"));
  EXPECT_THAT(fault(""), HasSubstr("holds no triangles"));
  EXPECT_THAT(refusal([&] { read_surface(scratch / "none.obj"); }), HasSubstr("no such file"));
  EXPECT_THAT(refusal([&] { read_surface(scratch.write("a.off", "OFF")); }), HasSubstr(".off"));
}

TEST(ReadSurface, StlKeepsDegenerateTrianglesInOrder) {
  const Scratch scratch;
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex {} 1 0\nendloop\n"
      "endfacet\n";
  std::string text = "solid a\n";
  for (const char* third :
       {"vertex 0 1 0", "vertex 1 0 0", "vertex 1 1 0"}) {  // the second has no area
    text += std::string("facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n") + third +
            "\nendloop\nendfacet\n";
  }
  const SurfaceMesh s = read_surface(scratch.write("a.stl", text + "endsolid a\n"));
  ASSERT_EQ(s.triangles.size(), 3u) << "triangle indices must not shift";
  EXPECT_EQ(s.X.cols(), 4);
  EXPECT_EQ(Vector3d(s.X.col(s.triangles[2][2])), Vector3d(1, 1, 0));
}

TEST(ReadSurface, PlyAsciiAndItsFaults) {
  const Scratch scratch;
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  const SurfaceMesh s = read_surface(scratch.write("a.ply", head + "3 0 1 2\n3 0 2 3\n"));
  ASSERT_EQ(s.triangles.size(), 2u);
  EXPECT_EQ(Vector3d(s.X.col(s.triangles[1][2])), Vector3d(0, 1, 0));
  EXPECT_THAT(refusal([&] { read_surface(scratch.write("b.ply", head + "4 0 1 2 3\n3 0 2 3\n")); }),
              HasSubstr("face 0 has 4 corners"));
  EXPECT_THAT(refusal([&] { read_surface(scratch.write("c.ply", head + "3 0 1 7\n3 0 2 3\n")); }),
              HasSubstr("vertex 7"));
  // What ends VTK's reader by a signal, or without memory, is told like any other fault.
  EXPECT_THAT(refusal([&] { read_surface(scratch.write("e.ply", head + "200 0 2 3\n3 0 2 3\n")); }),
              HasSubstr("e.ply"));
  std::string claims = head;
  claims.replace(claims.find("vertex 4"), 8, "vertex 8000000000");
  EXPECT_THAT(refusal([&] { read_surface(scratch.write("f.ply", claims)); }), HasSubstr("f.ply"));
  EXPECT_THAT(refusal([&] { read_surface(scratch.write("d.ply", "nothing")); }),
              HasSubstr("d.ply"));
}

TEST(Inspect, ASoundBoxIsClean) {
  const SurfaceFaults faults = inspect(box_surface({3, 2, 1}, 3));
  EXPECT_TRUE(faults.clean()) << faults.describe(box_surface({3, 2, 1}, 3));
}

TEST(Inspect, HoleIsNamedWithItsPlaceAndRefused) {
  SurfaceMesh s = box_surface({3, 2, 1}, 1);
  s.triangles.erase(s.triangles.begin() + 2);
  s.uv.erase(s.uv.begin() + 2);
  const SurfaceFaults faults = inspect(s);
  EXPECT_EQ(faults.open_edges.size(), 3u);
  EXPECT_THAT(faults.describe(s), HasSubstr("there is a hole: the edge from ("));
  EXPECT_THAT(refusal([&] { mend(s, kPlace); }), HasSubstr("capture.yaml:5:3"));
}

TEST(Inspect, APatchThatIsTurnedIsPlacedAtItsRim) {
  SurfaceMesh s = box_surface({3, 2, 1}, 4);
  s.uv.clear();
  // All of the bottom but its rim; the first of them lies inside the patch.
  std::vector<std::array<int, 3>> inside, rest;
  for (const auto& t : s.triangles) {
    bool within = true;
    for (const int v : t) within = within && s.X(2, v) == 0.0 && s.X(0, v) < 3.0 && s.X(1, v) < 2.0;
    (within ? inside : rest).push_back(t);
  }
  std::ranges::stable_sort(inside, {}, [&](const auto& t) {
    return (s.X.col(t[0]) + s.X.col(t[1]) + s.X.col(t[2]) - 3 * Vector3d(1.1, 0.7, 0)).norm();
  });
  for (auto& t : inside) std::swap(t[0], t[1]);
  s.triangles = inside;
  s.triangles.insert(s.triangles.end(), rest.begin(), rest.end());
  const SurfaceFaults faults = inspect(s);
  ASSERT_EQ(faults.inverted.size(), inside.size());
  const std::string told = faults.describe(s);
  Vector3d at;
  ASSERT_EQ(std::sscanf(told.substr(told.find('(')).c_str(), "(%lf, %lf, %lf)", &at.x(), &at.y(),
                        &at.z()),
            3)
      << told;
  EXPECT_TRUE(at.x() == 0.0 || at.y() == 0.0 || at.x() == 2.25 || at.y() == 1.5) << told;
}

TEST(Inspect, InsideOutIsMended) {
  SurfaceMesh s = box_surface({3, 2, 1}, 2);
  const SurfaceMesh right = s;
  for (auto& t : s.triangles) std::swap(t[0], t[1]);
  for (auto& uv : s.uv) std::swap(uv[0], uv[1]);
  EXPECT_TRUE(inspect(s).inside_out);
  EXPECT_TRUE(inspect(s).inverted.empty());
  const MendedSurface mended = mend(s, kPlace);
  EXPECT_TRUE(inspect(mended.surface).clean());
  ASSERT_EQ(mended.said.size(), 1u);
  for (size_t t = 0; t < s.triangles.size(); ++t) {  // uv goes with its vertex
    for (int k = 0; k < 3; ++k) {
      const auto& original = right.triangles[t];
      const auto at =
          std::ranges::find(original, mended.surface.triangles[t][k]) - original.begin();
      EXPECT_EQ(mended.surface.uv[t][k], right.uv[t][at]);
    }
  }
}

TEST(Inspect, DuplicatesAndDegeneratesAreDroppedAndIndicesKept) {
  SurfaceMesh s = box_surface({3, 2, 1}, 1);
  const auto triangle = s.triangles[4];
  s.triangles.insert(s.triangles.begin() + 5, {triangle[1], triangle[2], triangle[0]});
  s.triangles.insert(s.triangles.begin() + 2, {triangle[1], triangle[1], triangle[0]});
  s.uv.insert(s.uv.begin(), 2, s.uv[0]);
  const MendedSurface mended = mend(s, kPlace);
  EXPECT_EQ(mended.surface.triangles.size(), 12u);
  EXPECT_EQ(mended.said.size(), 2u);
  for (size_t t = 0; t < mended.file_triangle.size(); ++t) {
    EXPECT_EQ(s.triangles[mended.file_triangle[t]], mended.surface.triangles[t]);
  }
}

TEST(Inspect, ATriangleWithoutAreaAlongAnEdgeCutsItsNeighbour) {
  // The edge from 0 to 1 of a box has a vertex more on the lower side than on the other: there the
  // file has a triangle without area between the two.
  SurfaceMesh s = box_surface({4, 2, 1}, 1);
  const int p = s.triangles[0][0], q = s.triangles[0][1], b = s.triangles[0][2];
  s.X.conservativeResize(3, s.X.cols() + 1);
  const int middle = static_cast<int>(s.X.cols()) - 1;
  s.X.col(middle) = 0.75 * s.X.col(p) + 0.25 * s.X.col(q);
  const std::array<Vector2d, 3> uv = s.uv[0];
  const Vector2d uv_middle = 0.75 * uv[0] + 0.25 * uv[1];
  s.triangles[0] = {p, middle, b};
  s.uv[0] = {uv[0], uv_middle, uv[2]};
  s.triangles.insert(s.triangles.begin() + 1, {middle, q, b});
  s.uv.insert(s.uv.begin() + 1, {uv_middle, uv[1], uv[2]});
  s.triangles.push_back({p, q, middle});
  s.uv.push_back(uv);
  ASSERT_EQ(inspect(s).degenerate, std::vector<int>{13});
  const MendedSurface mended = mend(s, kPlace);
  EXPECT_TRUE(inspect(mended.surface).clean()) << inspect(mended.surface).describe(mended.surface);
  ASSERT_EQ(mended.said.size(), 1u);
  EXPECT_THAT(mended.said[0], HasSubstr("the first being 13, lay along an edge"));
  EXPECT_NEAR(test::area_of(mended.surface), 2 * (8 + 4 + 2), 1e-12);
  ASSERT_EQ(mended.surface.triangles.size(), 14u);
  // The neighbour's two parts are of its own texture.
  for (size_t t = 0; t < 14; ++t) {
    const int from = mended.file_triangle[t];
    const Vector2d centre =
        (mended.surface.uv[t][0] + mended.surface.uv[t][1] + mended.surface.uv[t][2]) / 3;
    Vector3d at = Vector3d::Zero();
    for (const int v : mended.surface.triangles[t]) at += mended.surface.X.col(v) / 3;
    const auto& corner = s.triangles[from];
    Eigen::Matrix3d x;
    for (int k = 0; k < 3; ++k) x.col(k) = s.X.col(corner[k]) + Vector3d(9, 9, 9);
    const Vector3d w = x.colPivHouseholderQr().solve(at + Vector3d(9, 9, 9));
    EXPECT_LT((w[0] * s.uv[from][0] + w[1] * s.uv[from][1] + w[2] * s.uv[from][2] - centre).norm(),
              1e-9);
  }
}

TEST(Inspect, OneTurnedTriangleIsRefused) {
  SurfaceMesh s = box_surface({3, 2, 1}, 2);
  std::swap(s.triangles[7][0], s.triangles[7][1]);
  EXPECT_EQ(inspect(s).inverted, std::vector<int>{7});
  EXPECT_THAT(refusal([&] { mend(s, kPlace); }), HasSubstr("triangle 7"));
}

TEST(Inspect, CrowdedEdgeIsRefused) {
  SurfaceMesh s = box_surface({3, 2, 1}, 1);
  s.X.conservativeResize(3, s.X.cols() + 1);
  s.X.col(s.X.cols() - 1) = Vector3d(9, 9, 9);
  s.triangles.push_back({s.triangles[0][0], s.triangles[0][1], static_cast<int>(s.X.cols()) - 1});
  s.uv.push_back(s.uv[0]);
  EXPECT_EQ(inspect(s).crowded_edges.size(), 1u);
}

SurfaceMesh joined(const SurfaceMesh& a, SurfaceMesh b, const Vector3d& shift) {
  SurfaceMesh s = a;
  s.X.resize(3, a.X.cols() + b.X.cols());
  s.X << a.X, b.X.colwise() + shift;
  for (auto t : b.triangles) {
    for (int& i : t) i += static_cast<int>(a.X.cols());
    s.triangles.push_back(t);
  }
  s.uv.insert(s.uv.end(), b.uv.begin(), b.uv.end());
  return s;
}

TEST(Inspect, SelfIntersectionsAreFoundAndTouchingPartsApartAreNot) {
  const SurfaceMesh box = box_surface({1, 1, 1}, 2);
  EXPECT_TRUE(inspect(joined(box, box, {3, 0, 0})).clean());
  const SurfaceMesh crossing = joined(box, box, {0.6, 0.3, 0.2});
  EXPECT_FALSE(inspect(crossing).self_intersections.empty());
  EXPECT_THAT(refusal([&] { mend(crossing, kPlace); }), HasSubstr("intersect near ("));
  // Sliding along a shared plane: coplanar overlap.
  EXPECT_FALSE(inspect(joined(box, box, {0.6, 0.3, 0.0})).self_intersections.empty());
  EXPECT_FALSE(inspect(joined(box, box, {0.25, 0.25, 1.0})).self_intersections.empty());
}

SurfaceMesh inside_out(SurfaceMesh s) {
  for (auto& t : s.triangles) std::swap(t[0], t[1]);
  for (auto& uv : s.uv) std::swap(uv[0], uv[1]);
  return s;
}

TEST(Inspect, PartsWithinPartsAreCavitiesOrAFault) {
  const SurfaceMesh outer = box_surface({4, 4, 4}, 2), inner = box_surface({1, 1, 1}, 1);
  const Vector3d within(1.5, 1.5, 1.5), beside(9, 0, 0);
  EXPECT_TRUE(inspect(joined(outer, inside_out(inner), within)).clean()) << "a cavity";
  const SurfaceMesh filled = joined(outer, inner, within);
  EXPECT_THAT(refusal([&] { mend(filled, kPlace); }),
              HasSubstr("(1.5, 1.5, 1.5) lies within another and is turned outwards"));
  // Of two bodies side by side the one that is inside out is turned.
  const MendedSurface mended = mend(joined(outer, inside_out(inner), beside), kPlace);
  EXPECT_TRUE(inspect(mended.surface).clean());
  EXPECT_THAT(mended.said, ::testing::ElementsAre(HasSubstr("turned 12 triangles")));
  // A body in a cavity.
  const SurfaceMesh shell = joined(outer, inside_out(box_surface({2, 2, 2}, 1)), {1, 1, 1});
  EXPECT_TRUE(inspect(joined(shell, inner, within)).clean());
}

TEST(Inspect, WhatCrossesByRoundingAloneIsPassedBy) {
  // Two parallel edges of a plane face, one of which rounding has pushed past the other.
  SurfaceMesh s = box_surface({60, 40, 20}, 2);
  s.uv.clear();
  for (const double crossing : {1e-4, 1.0}) {
    SurfaceMesh bad = s;
    for (Eigen::Index v = 0; v < bad.X.cols(); ++v)
      if (bad.X.col(v) == Vector3d(30, 20, 20)) bad.X.col(v) = Vector3d(60 + crossing, 39, 20);
    EXPECT_FALSE(inspect(bad).self_intersections.empty());
    if (crossing == 1.0) {
      EXPECT_THAT(refusal([&] { mend(bad, kPlace); }), HasSubstr("intersect near"));
      continue;
    }
    const MendedSurface mended = mend(bad, kPlace);
    EXPECT_THAT(mended.said, ::testing::ElementsAre(HasSubstr("cross by no more than rounding")));
    EXPECT_EQ(mended.surface.triangles, bad.triangles);
    EXPECT_NEAR(quality(fill(mended.surface, {}, kPlace)).volume, 48000, 1);
  }
}

TEST(HiddenData, SurfaceAgreesWithAPlainRead) {
  HOOKEYE_NEEDS_DATA("hidden/case_a2");
  const auto file = test::shared_data() / "hidden/case_a2/surface.obj";
  std::ifstream in(file);
  std::vector<Vector3d> v;
  std::vector<Vector2d> vt;
  std::vector<std::array<std::array<int, 2>, 3>> faces;
  std::string line, word;
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    if (!(fields >> word)) continue;
    if (word == "v") {
      v.emplace_back();
      fields >> v.back()[0] >> v.back()[1] >> v.back()[2];
    } else if (word == "vt") {
      vt.emplace_back();
      fields >> vt.back()[0] >> vt.back()[1];
    } else if (word == "f") {
      faces.emplace_back();
      char slash;
      for (auto& c : faces.back()) fields >> c[0] >> slash >> c[1];
    }
  }
  const SurfaceMesh s = read_surface(file);
  ASSERT_EQ(v.size(), 599u);
  ASSERT_EQ(s.X.cols(), 599);
  ASSERT_EQ(s.triangles.size(), faces.size());
  ASSERT_EQ(s.uv.size(), faces.size());
  for (size_t t = 0; t < faces.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      ASSERT_EQ(Vector3d(s.X.col(s.triangles[t][k])), v[faces[t][k][0] - 1]);
      ASSERT_EQ(s.uv[t][k], vt[faces[t][k][1] - 1]);
    }
  }
  EXPECT_TRUE(inspect(s).clean()) << inspect(s).describe(s);
}

}  // namespace
}  // namespace hookeye
