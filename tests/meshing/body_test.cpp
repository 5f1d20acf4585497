#include "meshing/body.h"

#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <map>

#include "meshing/interpolation.h"
#include "meshing/subdivide.h"
#include "shapes.h"
#include "support/shared_data.h"

namespace hookeye {
namespace {

using test::area_of;
using test::box_surface;
using test::refusal;
using test::Scratch;
using ::testing::HasSubstr;

RegionSpec spec(const std::string& name, decltype(RegionSpec::shape) shape) {
  return {name, {"capture.yaml", 9, 3}, std::move(shape)};
}

/// A capture of the box 30 x 20 x 10 with one region of each kind.
Capture box_capture(const std::filesystem::path& surface) {
  Capture c;
  c.body.surface = surface;
  c.body.edge = 3.0;
  c.body.mesh_given = true;
  RegionSpec::Faces top;
  for (int t = 8; t < 14; ++t) top.triangles.push_back(t);
  c.regions = {
      spec("base", RegionSpec::Box{{-1, -1, -0.03}, {31, 21, 0.03}}),
      spec("top", top),
      spec("corner", RegionSpec::Box{{-1, -1, 5}, {11, 7, 11}}),
      spec("ball", RegionSpec::Sphere{{15, 10, 10}, 6.5}),
      spec("end", RegionSpec::Halfspace{{22.3, 0, 0}, {1, 0, 0}}),
      spec("whole", RegionSpec::Sphere{{15, 10, 5}, 100}),
  };
  return c;
}

struct BoxBody {
  Scratch scratch;
  SurfaceMesh surface = box_surface({30, 20, 10}, 2);
  Capture capture;
  BoxBody() {
    write_surface_obj(scratch / "box.obj", surface);
    capture = box_capture(scratch / "box.obj");
  }
};

TEST(Regions, SamePatchOnEveryMesh) {
  const BoxBody box;
  double top = 0;
  for (int t = 8; t < 14; ++t) {
    SurfaceMesh one = box.surface;
    one.triangles = {box.surface.triangles[t]};
    top += area_of(one);
  }
  const double pi = std::numbers::pi;
  const std::map<std::string, double> area = {
      {"base", 600.0},
      {"top", top},
      {"corner", 11.0 * 7.0 + 11.0 * 5.0 + 7.0 * 5.0},
      {"ball", pi * 6.5 * 6.5},
      {"end", 2 * 7.7 * 30.0 + 200.0},
      {"whole", 2200.0},
  };
  const Body told = make_body(box.capture);
  for (const int order : {1, 2}) {
    for (const double factor : {1.3, 1.0, 0.7}) {
      const Body body = remesh(box.capture, told, factor, order);
      for (const auto& [name, expected] : area) {
        const Region& r = body.regions.at(name);
        const bool exact = name == "base" || name == "top" || name == "whole";
        EXPECT_NEAR(r.area, expected, exact ? 1e-9 * expected : 0.01 * expected)
            << name << " order " << order << " factor " << factor;
        EXPECT_NEAR(r.nodal_area.sum(), r.area, 1e-9 * r.area) << name;
      }
      EXPECT_LT((body.regions.at("base").normal - Vector3d(0, 0, -1)).norm(), 1e-12);
      EXPECT_LT((body.regions.at("base").centroid - Vector3d(15, 10, 0)).norm(), 1e-9);
      EXPECT_LT((body.regions.at("ball").centroid - Vector3d(15, 10, 10)).norm(), 0.15);
      EXPECT_EQ(body.regions.at("whole").normal, Vector3d::Zero());
    }
  }
}

TEST(Regions, ThinBoxSelectsExactlyTheBase) {
  const BoxBody box;
  const Body body = make_body(box.capture);
  const Region& base = body.regions.at("base");
  for (const auto& [face, share] : base.faces) {
    EXPECT_EQ(share, 1.0);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(body.mesh.X(2, body.mesh.boundary(k, face)), 0.0);
  }
  for (int i = 0; i < body.mesh.nodes(); ++i) {
    const bool in = std::ranges::find(base.nodes, i) != base.nodes.end();
    EXPECT_EQ(in, body.mesh.X(2, i) == 0.0);
  }
}

TEST(Regions, QuadraticNodalAreasAreConsistent) {
  const BoxBody box;
  const Body body = make_body(box.capture);
  const Region& base = body.regions.at("base");
  VectorXd expected = VectorXd::Zero(body.mesh.nodes());
  for (const auto& [face, share] : base.faces) {
    const auto n = body.mesh.boundary.col(face);
    const Vector3d a = body.mesh.X.col(n[0]), b = body.mesh.X.col(n[1]), c = body.mesh.X.col(n[2]);
    for (int k = 3; k < 6; ++k) expected[n[k]] += (b - a).cross(c - a).norm() / 6.0;
  }
  EXPECT_LT((base.nodal_area - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Regions, FacesOfAReadVolumeAreTheSamePatch) {
  const BoxBody box;
  const Body filled = make_body(box.capture);
  write_vtu(box.scratch / "box.vtu", filled.mesh, {});
  Capture both = box.capture;
  both.body.volume = box.scratch / "box.vtu";
  const Body read = make_body(both);
  ASSERT_TRUE(read.mesh.boundary_parent.empty());
  for (const char* name : {"top", "base"}) {
    const Region &a = filled.regions.at(name), &b = read.regions.at(name);
    EXPECT_EQ(a.nodes, b.nodes) << name;
    EXPECT_LT((a.nodal_area - b.nodal_area).cwiseAbs().maxCoeff(), 1e-9) << name;
  }
  // A mesh that knows nothing of the triangles: the patch cuts through its faces.
  Capture other = both;
  other.body.surface = box.scratch / "coarse.obj";
  write_surface_obj(box.scratch / "coarse.obj", box_surface({30, 20, 10}, 3));
  const Body cut = make_body(other);
  const double expected = 6 * 0.5 * (30.0 / 3) * (20.0 / 3);
  other.regions[1] = spec("top", RegionSpec::Faces{{}, {18, 19, 20, 21, 22, 23}, {}, {}});
  EXPECT_NEAR(make_body(other).regions.at("top").area, expected, 0.01 * expected);
}

TEST(Regions, FaultsAreRefusedWithPlaceAndNearestName) {
  const Scratch scratch;
  TetMesh mesh;
  mesh.order = 1;
  mesh.X.resize(3, 4);
  mesh.X << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  mesh.elements = Eigen::Vector4i(0, 1, 2, 3);
  find_boundary(mesh);
  mesh.boundary_groups["FOOT"] = {0};
  const auto fault = [&](const RegionSpec& region, const MendedSurface* surface) {
    Capture c;
    c.regions = {region};
    return refusal([&] { RegionSet(c, mesh, surface); });
  };
  const SurfaceMesh tri = box_surface({1, 1, 1}, 1);
  MendedSurface surface{tri, {}, {}};
  for (int t = 0; t < 12; ++t) surface.file_triangle.push_back(t);
  EXPECT_THAT(fault(spec("a", RegionSpec::Box{{5, 5, 5}, {6, 6, 6}}), nullptr),
              HasSubstr("capture.yaml:9:3: region 'a' selects no point"));
  EXPECT_THAT(
      fault(spec("a", RegionSpec::Box{{900, 0, 0}, {1000, 1000, 1000}}), nullptr),
      HasSubstr("the region's numbers are 1e+03 times the body's: is the body's file in m?"));
  EXPECT_THAT(fault(spec("a", RegionSpec::Group{"FOOD"}), nullptr), HasSubstr("'FOOT'"));
  EXPECT_THAT(fault(spec("a", RegionSpec::Faces{{}, {0}, {}, {}}), nullptr),
              HasSubstr("surface file"));
  EXPECT_THAT(
      fault(spec("a", RegionSpec::Faces{"/c/g.txt", {3, 12}, "g.txt", {{1, 1}, {2, 5}}}), &surface),
      HasSubstr("g.txt:2:5: there is no triangle 12"));
  Capture c;
  c.regions = {spec("foot", RegionSpec::Group{"FOOT"})};
  EXPECT_EQ(RegionSet(c, mesh, nullptr).at("foot").faces.size(), 1u);
}

TEST(MakeBody, FaultsOfWholeFilesAreToldWhereTheCaptureNamesThem) {
  const Scratch scratch;
  Capture c;
  c.body.surface_place = {"capture.yaml", 5, 12};
  c.body.volume_place = {"capture.yaml", 6, 11};
  const auto fault = [&] { return refusal([&] { make_body(c); }); };
  c.body.surface = scratch.write("empty.obj", "");
  EXPECT_EQ(fault(),
            "capture.yaml:5:12: empty.obj: holds no triangles\n"
            "  a closed surface of triangles");
  c.body.surface = scratch.write("bad.obj", "v 0 0 0\nv 1 0 x\n");
  EXPECT_THAT(fault(), HasSubstr("bad.obj:2: 'x' is no finite number"));
  c.body.surface.clear();
  c.body.volume = scratch.write("a.mesh", "4 1 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 2 1 3\n");
  EXPECT_THAT(fault(), HasSubstr("capture.yaml:6:11: a.mesh: element 0 at"));
}

void expect_watertight(const SurfaceMesh& s) {
  std::map<std::pair<int, int>, int> uses;
  for (const auto& t : s.triangles) {
    for (int k = 0; k < 3; ++k) ++uses[{t[k], t[(k + 1) % 3]}];
  }
  for (const auto& [edge, count] : uses) {
    ASSERT_EQ(count, 1);
    ASSERT_TRUE(uses.contains({edge.second, edge.first}));
  }
}

TEST(Subdivision, WatertightSameAreaShortEdgesSameTexture) {
  SurfaceMesh s = box_surface({30, 20, 10}, 2);
  s.X.col(0) += Vector3d(0.3, 0.1, -0.2);  // uneven edges: one, two and three splits
  for (const double longest : {12.0, 5.0, 2.1}) {
    const detail::Subdivided fine = detail::subdivide(s, longest);
    expect_watertight(fine.mesh);
    EXPECT_NEAR(area_of(fine.mesh), area_of(s), 1e-9);
    EXPECT_EQ(fine.mesh.cut_from, s.triangles);
    const Matrix3Xd between = (fine.mesh.cut_weights * s.X.transpose()).transpose();
    EXPECT_LT((between - fine.mesh.X).cwiseAbs().maxCoeff(), 1e-9);
    for (size_t t = 0; t < fine.mesh.triangles.size(); ++t) {
      const auto& parent = s.triangles[fine.parent[t]];
      Eigen::Matrix3d P;
      for (int k = 0; k < 3; ++k) P.col(k) = s.X.col(parent[k]) + Vector3d(1, 2, 3);
      for (int k = 0; k < 3; ++k) {
        const Vector3d x = fine.mesh.X.col(fine.mesh.triangles[t][k]);
        const Vector3d next = fine.mesh.X.col(fine.mesh.triangles[t][(k + 1) % 3]);
        EXPECT_LE((x - next).norm(), longest * (1 + 1e-12));
        const Vector3d w = P.fullPivLu().solve(x + Vector3d(1, 2, 3));
        const auto& uv = s.uv[fine.parent[t]];
        EXPECT_LT((w[0] * uv[0] + w[1] * uv[1] + w[2] * uv[2] - fine.mesh.uv[t][k]).norm(), 1e-9);
      }
    }
  }
}

TEST(RenderSurfaces, CarryAffineMotionExactly) {
  const BoxBody box;
  Capture volume_only = box.capture;
  const Body first = make_body(box.capture);
  write_vtu(box.scratch / "box.vtu", first.mesh, {});
  volume_only.body.surface.clear();
  volume_only.body.volume = box.scratch / "box.vtu";
  volume_only.regions.erase(volume_only.regions.begin() + 1);
  Eigen::Matrix3d A;
  A << 1.1, 0.2, -0.1, 0.05, 0.9, 0.3, -0.2, 0.1, 1.2;
  const Vector3d b(3, -2, 1);
  for (const Capture& capture : {box.capture, volume_only}) {
    for (const int order : {1, 2}) {
      const Body told = make_body(capture), body = remesh(capture, told, 1.0, order);
      EXPECT_EQ(body.surface.mesh.X, told.surface.mesh.X) << "what is photographed stays";
      const Matrix3Xd x = (A * body.mesh.X).colwise() + b;
      const VectorXd q = Eigen::Map<const VectorXd>(x.data(), x.size());
      const Matrix3Xd expected = (A * body.surface.mesh.X).colwise() + b;
      EXPECT_LT((body.surface.deformed(body.mesh, q) - expected).cwiseAbs().maxCoeff(), 1e-11);
      expect_watertight(body.surface.mesh);
      const VectorXd ones = VectorXd::Ones(body.mesh.nodes());
      EXPECT_LT(((body.surface.W * ones).array() - 1.0).abs().maxCoeff(), 1e-12);
      EXPECT_EQ(body.surface.file_triangle.size(), body.surface.mesh.triangles.size());
      EXPECT_EQ(body.surface.mesh.uv.empty(), capture.body.surface.empty());
    }
  }
}

TEST(RenderSurfaces, ACoarseSurfaceIsDividedSoThatItBends) {
  BoxBody box;  // all its vertices are corner nodes of what fills it
  for (const int order : {1, 2}) {
    box.capture.body.order = order;
    const Body body = make_body(box.capture);
    const SurfaceMesh& s = body.surface.mesh;
    for (const auto& t : s.triangles) {
      for (int k = 0; k < 3; ++k) {
        EXPECT_LT((s.X.col(t[k]) - s.X.col(t[(k + 1) % 3])).norm(), 3.0 * 1.4 / order);
      }
    }
    // Bent: the surface follows the elements.
    Matrix3Xd x = body.mesh.X;
    x.row(2) += 0.01 * x.row(0).cwiseAbs2();
    Matrix3Xd expected = s.X;
    expected.row(2) += 0.01 * s.X.row(0).cwiseAbs2();
    const VectorXd q = Eigen::Map<const VectorXd>(x.data(), x.size());
    const double error = (body.surface.deformed(body.mesh, q) - expected).cwiseAbs().maxCoeff();
    EXPECT_LT(error, order == 1 ? 0.05 : 1e-11);
  }
}

/// A drawn box lit as a pillow: the user hears what would light it as it is.
TEST(RenderSurfaces, PlaneFacesWithSharpEdgesAreAskedForTheirShading) {
  BoxBody box;
  const auto hears = [&] {
    for (const std::string& one : make_body(box.capture).said)
      if (one.find("`shading: flat`") != std::string::npos) return true;
    return false;
  };
  EXPECT_FALSE(hears()) << "without a texture nothing is lit";
  box.capture.body.texture = BodySpec::Texture::uniform;
  EXPECT_TRUE(hears());
  box.capture.body.flat_shading = true;
  EXPECT_FALSE(hears());
  box.capture.body.flat_shading = false;
  SurfaceMesh round = box.surface;  // no plane faces, like a scan
  for (Eigen::Index v = 0; v < round.X.cols(); ++v)
    round.X.col(v) += 1.5 * (round.X.col(v) - Vector3d(15, 10, 5)).normalized();
  write_surface_obj(box.capture.body.surface, round);
  box.capture.regions.clear();
  EXPECT_FALSE(hears());
}

/// Smooth normals depend on the vertices: a finer mesh must not change the shading.
TEST(RenderSurfaces, TheSameOnEveryMeshOfTheBody) {
  const BoxBody box;
  const Body told = make_body(box.capture), finer = remesh(box.capture, told, 0.7);
  ASSERT_GT(finer.mesh.nodes(), told.mesh.nodes());
  EXPECT_EQ(finer.surface.mesh.X, told.surface.mesh.X);
  EXPECT_EQ(finer.surface.mesh.triangles, told.surface.mesh.triangles);
  const VectorXd q = finer.mesh.X.reshaped();
  EXPECT_LT((finer.surface.deformed(finer.mesh, q) - told.surface.mesh.X).cwiseAbs().maxCoeff(),
            1e-12);
  Matrix3Xd x = finer.mesh.X;
  x.row(2) += 0.01 * x.row(0).cwiseAbs2();
  Matrix3Xd expected = told.surface.mesh.X;
  expected.row(2) += 0.01 * expected.row(0).cwiseAbs2();
  const VectorXd bent = x.reshaped();
  EXPECT_LT((finer.surface.deformed(finer.mesh, bent) - expected).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(RenderSurfaces, BodyWithoutSurfaceOrVolumeIsRefused) {
  EXPECT_THAT(refusal([] { make_body(Capture()); }), HasSubstr("neither a surface nor a volume"));
}

TEST(MakeBody, SaysTheDefaultsItTook) {
  BoxBody box;
  box.capture.body.mesh_given = false;
  box.capture.body.edge = 0;
  const Body body = make_body(box.capture);
  EXPECT_THAT(body.said, ::testing::Contains(HasSubstr("no `mesh:` given: edge")));
}

TEST(Locator, FindsBoundaryPoints) {
  FillOptions options;
  options.edge = 0.3;
  const TetMesh mesh = fill(box_surface({3, 2, 1}, 1), options, {});
  const BoundaryLocator locator(mesh);
  for (int i = 0; i < 3000; ++i) {
    Vector3d X = 0.5 * (Vector3d::Random() + Vector3d::Ones());
    X = X.cwiseProduct(Vector3d(3, 2, 1));
    X[i % 3] = i % 2 ? Vector3d(3, 2, 1)[i % 3] : 0.0;
    SurfacePoint p;
    ASSERT_LT(locator.locate(X, &p), 1e-12);
    const VectorXd N = shape_functions(2, p.barycentric);
    Vector3d back = Vector3d::Zero();
    for (int k = 0; k < 10; ++k) back += N[k] * mesh.X.col(mesh.elements(k, p.element));
    ASSERT_LT((back - X).norm(), 1e-12);
  }
  SurfacePoint p;
  EXPECT_NEAR(locate_on_boundary(mesh, {1.5, 1.0, 3.0}, &p), 2.0, 1e-12);
}

TEST(Interpolation, IsExactForWhatTheElementsHold) {
  FillOptions options;
  options.edge = 0.4;
  const TetMesh mesh = fill(box_surface({3, 2, 1}, 1), options, {});
  const auto field = [](const Vector3d& X) { return 1.0 + X[0] * X[1] - 2.0 * X[2] * X[2] + X[1]; };
  VectorXd nodal(mesh.nodes());
  for (int a = 0; a < mesh.nodes(); ++a) nodal[a] = field(mesh.X.col(a));
  Matrix3Xd X = (Matrix3Xd::Random(3, 500).array() * 0.5 + 0.5).matrix();
  X = Vector3d(3, 2, 1).asDiagonal() * X;
  X.col(0) = Vector3d(3.02, 1.0, 0.5);  // a little outside: the nearest element extrapolates
  const VectorXd values = interpolation(mesh, X) * nodal;
  for (int i = 0; i < X.cols(); ++i) EXPECT_NEAR(values[i], field(X.col(i)), 1e-10);
}

TEST(HiddenData, VerticesAreSelectedNodesAndRegionsMatchTheGroups) {
  HOOKEYE_NEEDS_DATA("hidden/case_a2");
  for (const std::string name : {"a2", "a3", "b2", "b3", "b4", "c4"}) {
    const Capture capture =
        read_capture(test::shared_data() / ("hidden/case_" + name) / "capture.yaml");
    const Body body = make_body(capture);
    EXPECT_EQ(body.surface.W.nonZeros(), body.surface.mesh.X.cols()) << name;
    EXPECT_EQ(body.surface.mesh.triangles.size(),
              read_surface(capture.body.surface).triangles.size());
    for (const auto& [region, group] :
         std::map<std::string, std::string>{{"base", "BASE"}, {"grip", "GRIP"}, {"side", "SIDE"}}) {
      const Region& r = body.regions.at(region);
      std::vector<int> faces;
      for (const auto& [face, share] : r.faces) {
        EXPECT_EQ(share, 1.0) << name << " " << region;
        faces.push_back(face);
      }
      EXPECT_EQ(faces, body.mesh.boundary_groups.at(group)) << name << " " << region;
    }
    Capture own = capture;  // as a user would: the surface meshed here
    own.body.volume.clear();
    own.body.edge = 8.0;
    const Body filled = make_body(own);
    for (const char* region : {"base", "grip", "side"}) {
      EXPECT_NEAR(filled.regions.at(region).area, body.regions.at(region).area,
                  0.01 * body.regions.at(region).area)
          << name << " " << region;
    }
  }
}

}  // namespace
}  // namespace hookeye
