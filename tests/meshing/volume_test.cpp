#include <gmock/gmock.h>
#include <sys/resource.h>

#include <Eigen/Dense>

#include "meshing/body.h"
#include "meshing/detail.h"
#include "shapes.h"
#include "support/needs_helper.h"
#include "support/shared_data.h"

namespace hookeye {
namespace {

using test::box_surface;
using test::refusal;
using test::Scratch;
using ::testing::AllOf;
using ::testing::HasSubstr;

const Place kPlace{"capture.yaml", 5, 3};

TetMesh filled_box(double edge, int order, int cuts = 1) {
  FillOptions options;
  options.edge = edge;
  options.order = order;
  return fill(box_surface({3, 2, 1}, cuts), options, kPlace);
}

TEST(Fill, BoxIsFilledWithGoodElementsOfTheAskedSize) {
  for (const double edge : {0.5, 0.25}) {
    const TetMesh mesh = filled_box(edge, 2);
    const MeshQuality q = quality(mesh);
    EXPECT_NEAR(q.volume, 6.0, 1e-9);
    EXPECT_GT(q.min_dihedral_deg, 5.0);  // measured 5.5 to 11 over all bounds asked of TetGen
    EXPECT_GT(q.min_radius_ratio, 0.1);
    EXPECT_LT(q.max_dihedral_deg, 165.0);
    EXPECT_NEAR(q.mean_edge / edge, 1.0, 0.25) << edge;
  }
}

TEST(Fill, BoundaryLiesOnTheTriangleItNames) {
  const SurfaceMesh s = box_surface({3, 2, 1}, 2);
  FillOptions options;
  options.edge = 0.3;
  const TetMesh mesh = fill(s, options, kPlace);
  ASSERT_EQ(mesh.boundary_parent.size(), static_cast<size_t>(mesh.boundary.cols()));
  std::vector<double> area(s.triangles.size(), 0.0);
  for (Eigen::Index f = 0; f < mesh.boundary.cols(); ++f) {
    const int parent = mesh.boundary_parent[f];
    const auto& t = s.triangles[parent];
    const Vector3d a = s.X.col(t[0]), u = Vector3d(s.X.col(t[1])) - a,
                   v = Vector3d(s.X.col(t[2])) - a, n = u.cross(v);
    for (int k = 0; k < 6; ++k) {
      const Vector3d d = Vector3d(mesh.X.col(mesh.boundary(k, f))) - a;
      const double w1 = d.cross(v).dot(n) / n.squaredNorm(),
                   w2 = u.cross(d).dot(n) / n.squaredNorm();
      EXPECT_NEAR(d.dot(n.normalized()), 0.0, 1e-12);
      EXPECT_GT(std::min({w1, w2, 1 - w1 - w2}), -1e-9) << "outside its triangle";
    }
    const Vector3d x0 = mesh.X.col(mesh.boundary(0, f)), x1 = mesh.X.col(mesh.boundary(1, f)),
                   x2 = mesh.X.col(mesh.boundary(2, f));
    const Vector3d normal = 0.5 * (x1 - x0).cross(x2 - x0);
    EXPECT_GT(normal.dot(n), 0.0) << "turned inwards";
    area[parent] += normal.norm();
  }
  for (size_t t = 0; t < area.size(); ++t) {
    const Vector3d a = s.X.col(s.triangles[t][0]), b = s.X.col(s.triangles[t][1]),
                   c = s.X.col(s.triangles[t][2]);
    EXPECT_NEAR(area[t], 0.5 * (b - a).cross(c - a).norm(), 1e-12);
  }
}

TEST(Fill, AShellTurnedInwardsIsACavity) {
  SurfaceMesh s = box_surface({3, 2, 1}, 1);
  SurfaceMesh inner = box_surface({1, 0.5, 0.4}, 1);
  inner.X.colwise() += Vector3d(1.1, 0.7, 0.3);
  const int before = static_cast<int>(s.X.cols()), outer = static_cast<int>(s.triangles.size());
  Matrix3Xd X(3, s.X.cols() + inner.X.cols());
  X << s.X, inner.X;
  s.X = X;
  for (const auto& t : inner.triangles)
    s.triangles.push_back({t[0] + before, t[2] + before, t[1] + before});
  s.uv.clear();
  FillOptions options;
  options.edge = 0.25;
  const TetMesh mesh = fill(s, options, kPlace);
  EXPECT_NEAR(quality(mesh).volume, 6.0 - 0.2, 1e-9);
  double wall = 0.0;  // area of the cavity's boundary
  for (Eigen::Index f = 0; f < mesh.boundary.cols(); ++f) {
    if (mesh.boundary_parent[static_cast<size_t>(f)] < outer) continue;
    const Vector3d a = mesh.X.col(mesh.boundary(0, f)), b = mesh.X.col(mesh.boundary(1, f)),
                   c = mesh.X.col(mesh.boundary(2, f));
    const Vector3d n = (b - a).cross(c - a);
    EXPECT_LT(n.dot(a - Vector3d(1.6, 0.95, 0.5)), 0.0) << "turned into the material";
    wall += 0.5 * n.norm();
  }
  EXPECT_NEAR(wall, 2 * (1 * 0.5 + 1 * 0.4 + 0.5 * 0.4), 1e-9);
}

TEST(Fill, BrokenSurfacesAreRefusedWithPlace) {
  SurfaceMesh open = box_surface({3, 2, 1}, 1);
  open.triangles.pop_back();
  open.uv.pop_back();
  EXPECT_THAT(refusal([&] { fill(open, {}, kPlace); }), HasSubstr("there is a hole"));
  SurfaceMesh out = box_surface({3, 2, 1}, 1);
  for (auto& t : out.triangles) std::swap(t[0], t[1]);
  EXPECT_THAT(refusal([&] { fill(out, {}, kPlace); }), HasSubstr("inside out"));
  EXPECT_THAT(refusal([&] { fill({}, {}, kPlace); }), HasSubstr("capture.yaml:5:3"));
}

TEST(Fill, WhatTetGenCannotMeshIsRefusedNotACrash) {
  SurfaceMesh s = box_surface({3, 2, 1}, 1);
  s.X.row(2) *= 1e-13;  // a body without thickness
  EXPECT_THAT(refusal([&] { fill(s, {}, kPlace); }), HasSubstr("capture.yaml:5:3"));
}

/// 400,000 tetrahedra take TetGen several seconds.
TEST(Fill, AllAttemptsTogetherEndInTime) {
  const SurfaceMesh s = box_surface({60, 40, 20}, 1);
  FillOptions options;
  options.edge = 1.0;
  const auto computed = [] {
    rusage children{};
    getrusage(RUSAGE_CHILDREN, &children);
    return static_cast<double>(children.ru_utime.tv_sec + children.ru_stime.tv_sec);
  };
  const double before = computed();
  EXPECT_THAT(refusal([&] { detail::fill_within(s, options, kPlace, 1.0); }),
              AllOf(HasSubstr("could not fill the surface with tetrahedra in 1 attempt"),
                    HasSubstr("(limit 1 s)"), HasSubstr("It is tightest")));
  EXPECT_LE(computed() - before, 3.0);
}

TEST(Fill, TheTightestPlaceIsNamed) {
  // A fin of two sides a millionth apart on a box, a sliver, and a fold.
  SurfaceMesh s = box_surface({3, 2, 1}, 2);
  EXPECT_THAT(detail::tightest(s), HasSubstr("at "));
  SurfaceMesh near = box_surface({3, 2, 1}, 2);
  near.X.colwise() += Vector3d(0, 0, 1 + 1e-6);
  const int n = static_cast<int>(s.X.cols());
  s.X.conservativeResize(3, 2 * n);
  s.X.rightCols(n) = near.X;
  for (const auto& [a, b, c] : near.triangles) s.triangles.push_back({n + a, n + b, n + c});
  EXPECT_THAT(detail::tightest(s),
              AllOf(HasSubstr(", 1)"), HasSubstr("two parts pass at a distance of 1e-06")));
}

TEST(Fill, SameInputSameMesh) {
  const TetMesh a = filled_box(0.4, 2), b = filled_box(0.4, 2);
  EXPECT_EQ(a.X, b.X);
  EXPECT_EQ(a.elements, b.elements);
}

TEST(TetMeshes, OrdersRaiseAndLower) {
  const TetMesh two = filled_box(0.5, 2), one = with_order(two, 1), again = with_order(one, 2);
  EXPECT_EQ(one.elements.rows(), 4);
  EXPECT_EQ(again.X, two.X);
  EXPECT_EQ(again.elements, two.elements);
  EXPECT_EQ(again.boundary, two.boundary);
  const int edges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {2, 3}, {1, 3}};
  for (int e = 0; e < two.size(); ++e) {
    for (int k = 0; k < 6; ++k) {
      const Vector3d mid =
          0.5 * (two.X.col(two.elements(edges[k][0], e)) + two.X.col(two.elements(edges[k][1], e)));
      ASSERT_EQ(Vector3d(two.X.col(two.elements(4 + k, e))), mid);
    }
  }
}

TEST(TetMeshes, ShapeFunctionsAreOneAtTheirNodeAndSumToOne) {
  EXPECT_EQ(shape_functions(1, {0.1, 0.2, 0.3, 0.4}),
            VectorXd(Eigen::Vector4d(0.1, 0.2, 0.3, 0.4)));
  const int edges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {2, 3}, {1, 3}};
  for (int i = 0; i < 10; ++i) {
    Eigen::Vector4d L = Eigen::Vector4d::Zero();
    if (i < 4) {
      L[i] = 1;
    } else {
      L[edges[i - 4][0]] = L[edges[i - 4][1]] = 0.5;
    }
    EXPECT_LT((shape_functions(2, L) - VectorXd(VectorXd::Unit(10, i))).norm(), 1e-15);
  }
  EXPECT_NEAR(shape_functions(2, {0.1, 0.2, 0.3, 0.4}).sum(), 1.0, 1e-15);
}

TEST(TetMeshes, QualityOfARegularTetrahedron) {
  TetMesh mesh;
  mesh.order = 1;
  mesh.X.resize(3, 4);
  mesh.X << 1, -1, -1, 1, 1, -1, 1, -1, 1, 1, -1, -1;
  mesh.elements = Eigen::Vector4i(0, 1, 2, 3);
  if (quality(mesh).volume < 0) std::swap(mesh.elements(2, 0), mesh.elements(3, 0));
  const MeshQuality q = quality(mesh);
  EXPECT_NEAR(q.volume, 8.0 / 3.0, 1e-14);
  EXPECT_NEAR(q.min_radius_ratio, 1.0, 1e-14);
  EXPECT_NEAR(q.min_dihedral_deg, 70.528779, 1e-6);
  EXPECT_NEAR(q.max_dihedral_deg, 70.528779, 1e-6);
  EXPECT_NEAR(q.mean_edge, 2 * std::sqrt(2.0), 1e-14);
}

TEST(Vtu, MeshAndArraysComeBackAsWritten) {
  const Scratch scratch;
  for (const int order : {1, 2}) {
    const TetMesh mesh = filled_box(0.5, order);
    const Eigen::MatrixXd u = Eigen::MatrixXd::Random(3, mesh.nodes());
    const Eigen::MatrixXd w = Eigen::MatrixXd::Random(1, mesh.size());
    write_vtu(scratch / "a.vtu", mesh, {{"displacement", u, true}, {"energy", w, false}});
    const TetMesh back = read_volume(scratch / "a.vtu", kPlace);
    EXPECT_EQ(back.X, mesh.X);
    EXPECT_EQ(back.elements, mesh.elements);
    EXPECT_EQ(back.boundary, mesh.boundary);
    EXPECT_EQ(read_vtu_array(scratch / "a.vtu", "displacement"), u);
    EXPECT_EQ(read_vtu_array(scratch / "a.vtu", "energy", false), w);
    EXPECT_THAT(refusal([&] { read_vtu_array(scratch / "a.vtu", "energy"); }),
                HasSubstr("one of displacement"));
  }
  EXPECT_FALSE(std::filesystem::exists(scratch / "a.vtu.part"));
  EXPECT_THAT(refusal([&] { write_vtu(scratch / "no/a.vtu", filled_box(1, 1), {}); }),
              HasSubstr("cannot be written"));
  std::filesystem::resize_file(scratch / "a.vtu", 3000);
  EXPECT_THAT(refusal([&] { read_volume(scratch / "a.vtu", kPlace); }), HasSubstr("a.vtu"));
}

/// A single tetrahedron with mid nodes, in three formats; changes make the faults.
std::string msh22(const std::string& tet = "1 2 3 4", const std::string& nodes = "4",
                  const std::string& extra = "") {
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 1 \"BODY\"\n2 2 \"FOOT\"\n"
         "$EndPhysicalNames\n$Nodes\n" +
         nodes + "\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n" + extra +
         "$EndNodes\n$Elements\n2\n1 2 2 2 1 1 2 3\n2 4 2 1 1 " + tet + "\n$EndElements\n";
}

TEST(ReadVolume, MshWithGroups) {
  HOOKEYE_NEEDS_GMSH();
  const Scratch scratch;
  const TetMesh mesh = read_volume(scratch.write("a.msh", msh22()), kPlace);
  EXPECT_EQ(mesh.order, 1);
  EXPECT_EQ(mesh.nodes(), 4);
  EXPECT_EQ(mesh.volume_groups.at("BODY"), std::vector<int>{0});
  ASSERT_EQ(mesh.boundary_groups.at("FOOT").size(), 1u);
  const int foot = mesh.boundary_groups.at("FOOT")[0];
  for (int k = 0; k < 3; ++k) EXPECT_EQ(mesh.X(2, mesh.boundary(k, foot)), 0.0);
}

TEST(ReadVolume, GroupsOfMsh2BelongToTheElement) {
  HOOKEYE_NEEDS_GMSH();
  const Scratch scratch;
  // Two triangles of two groups, of one elementary tag; and a third that is in both groups.
  const TetMesh mesh = read_volume(
      scratch.write("a.msh",
                    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 2 \"FOOT\"\n"
                    "2 3 \"SIDE\"\n$EndPhysicalNames\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n"
                    "4 0 0 1\n$EndNodes\n$Elements\n5\n1 2 2 2 1 1 2 3\n2 2 2 3 1 1 2 4\n"
                    "3 2 2 2 1 1 3 4\n4 2 2 3 1 1 3 4\n5 4 2 1 1 1 2 3 4\n$EndElements\n"),
      kPlace);
  EXPECT_EQ(mesh.boundary_groups.at("FOOT").size(), 2u);
  EXPECT_EQ(mesh.boundary_groups.at("SIDE").size(), 2u);
}

TEST(ReadVolume, Msh41AndMedit) {
  HOOKEYE_NEEDS_GMSH();
  const Scratch scratch;
  const TetMesh msh = read_volume(
      scratch.write("a.msh",
                    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 7 \"BODY\"\n"
                    "$EndPhysicalNames\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 1 7 0\n$EndEntities\n"
                    "$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n"
                    "$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n"),
      kPlace);
  EXPECT_EQ(msh.volume_groups.at("BODY"), std::vector<int>{0});
  const TetMesh medit = read_volume(
      scratch.write("a.mesh",
                    "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 1\n1 0 0 1\n0 1 0 1\n"
                    "0 0 1 1\nTetrahedra\n1\n1 2 3 4 1\nEnd\n"),
      kPlace);
  EXPECT_EQ(medit.X, msh.X);
  EXPECT_EQ(medit.elements, msh.elements);
}

TEST(ReadVolume, AMeditFileThatEndsEarlyIsNoSmallerBody) {
  HOOKEYE_NEEDS_GMSH();
  const Scratch scratch;
  const auto cut = scratch.write(
      "cut.mesh",
      "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\n"
      "1 1 1 1\nTetrahedra\n2\n1 2 3 4 1\n");
  EXPECT_THAT(refusal([&] { read_volume(cut, kPlace); }),
              HasSubstr("announces 2 tetrahedra and holds 1"));
}

TEST(ReadVolume, MshFaults) {
  HOOKEYE_NEEDS_GMSH();
  const Scratch scratch;
  const auto fault = [&](const std::string& text) {
    return refusal([&] { read_volume(scratch.write("a.msh", text), kPlace); });
  };
  EXPECT_THAT(fault(msh22("1 3 2 4")), HasSubstr("element 2 at (0, 0, 0) is inverted"));
  EXPECT_THAT(fault(msh22("1 2 2 4")), HasSubstr("element 2 names a node twice"));
  EXPECT_THAT(fault(msh22("1 2 3 4", "5", "5 0.2 0.7 0\n")),
              HasSubstr("1 nodes belong to no tetrahedron"));
  EXPECT_THAT(fault(msh22("1 2 3 9")), HasSubstr("a.msh"));
  const std::string whole = msh22();
  for (const size_t length : {40u, 120u, 170u, 186u}) {
    EXPECT_THAT(fault(whole.substr(0, length)), HasSubstr("a.msh")) << length;
  }
  EXPECT_THAT(fault("Point(1) = {0,0,0};\n"), HasSubstr("$MeshFormat"));
  EXPECT_THAT(fault(""), HasSubstr("$MeshFormat"));
  EXPECT_THAT(refusal([&] { read_volume(scratch / "none.msh", kPlace); }), HasSubstr("none.msh"));
  EXPECT_THAT(refusal([&] { read_volume(scratch.write("a.xyz", "1"), kPlace); }),
              HasSubstr(".xyz"));
}

TEST(ReadVolume, LooseNodesAreDroppedAndSaid) {
  const Scratch scratch;
  std::vector<std::string> said;
  const auto file = scratch.write("a.mesh", "5 1 4\n0 0 0\n9 9 9\n1 0 0\n0 1 0\n0 0 1\n0 2 3 4\n");
  const TetMesh mesh = read_volume(file, kPlace, &said);
  EXPECT_EQ(mesh.nodes(), 4);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_THAT(said[0], HasSubstr("the first being 2"));
  EXPECT_NEAR(quality(mesh).volume, 1.0 / 6.0, 1e-15);
}

TEST(ReadVolume, TextMeshFaultsHaveTheirLine) {
  const Scratch scratch;
  const auto fault = [&](const std::string& text) {
    return refusal([&] { read_volume(scratch.write("a.mesh", text), kPlace); });
  };
  EXPECT_THAT(fault("4 1 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 1 2 7\n"), HasSubstr("a.mesh:6"));
  EXPECT_THAT(fault("4 1 4\n0 0 0\n1 0 nan\n0 1 0\n0 0 1\n0 1 2 3\n"), HasSubstr("node 2"));
  EXPECT_THAT(fault("4 1 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1 3 4 5 6\n"), HasSubstr("a.mesh:5"));
  EXPECT_THAT(fault("1000000000 1000000000 4\n"), HasSubstr("a.mesh:1"));
  EXPECT_THAT(fault("hello\n"), HasSubstr("a.mesh:1"));
  EXPECT_THAT(fault("4 2 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 1 2 3\n"), HasSubstr("a.mesh"));
}

TEST(ReadVolume, ElementThereTwiceIsRefused) {
  const Scratch scratch;
  const auto file =
      scratch.write("a.mesh", "4 3 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 1 2 3\n0 1 2 3\n0 1 2 3\n");
  EXPECT_THAT(refusal([&] { read_volume(file, kPlace); }), HasSubstr("shares a face"));
}

TEST(ReferenceData, InpAndTextMeshAreTheSameMesh) {
  HOOKEYE_NEEDS_DATA("reference");
  for (const std::string name : {"b10k", "q10k", "q30k"}) {
    const auto folder = test::shared_data() / "reference";
    const TetMesh text = read_volume(folder / (name + ".mesh"), kPlace);
    const TetMesh inp = read_volume(folder / (name + "_A.inp"), kPlace);
    EXPECT_EQ(text.elements, inp.elements) << name;
    EXPECT_LT((text.X - inp.X).cwiseAbs().maxCoeff(), 1e-4) << name;
    EXPECT_NEAR(quality(text).volume, 60000.0, 1e-3) << name;
    EXPECT_FALSE(inp.boundary_groups.at("NFIX").empty());
  }
}

}  // namespace
}  // namespace hookeye
