// Fields of the surface: strains against formulas, motions that photos ask for, tables.
#include <cmath>
#include <map>

#include "capture_io/field_table.h"
#include "core/text_file.h"
#include "exporters/block.h"
#include "exporters/seen_motion.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

/// A stretch, a shear and a turn.
Eigen::Matrix3d some_gradient() {
  Eigen::Matrix3d F;
  F << 1.1, 0.05, 0.0, -0.02, 0.97, 0.1, 0.03, 0.0, 1.2;
  return F;
}

VectorXd deformed_by(const TetMesh& mesh, const Eigen::Matrix3d& F) {
  return Matrix3Xd(F * mesh.X).reshaped();
}

/// The block in one state in all its load cases, without photos.
class DicExport : public testing::Test {
 protected:
  SeenSurface seen_in(const VectorXd& q, const SeenOptions& options) const {
    Evaluation evaluation;
    const auto state = std::make_shared<Equilibrium>();
    state->q = q;
    for (size_t e = 0; e < model_.examples.size(); ++e) {
      evaluation.examples.emplace_back();
      evaluation.examples.back().example = static_cast<int>(e);
      evaluation.examples.back().equilibrium = state;
    }
    return seen_surface(model_, evaluation, options);
  }
  const Block block_;
  const Model model_ = block_.model();
};

TEST_F(DicExport, StrainsOfAnEvenDeformationAreThoseOfTheFormula) {
  const Eigen::Matrix3d F = some_gradient();
  const Eigen::Matrix3d E = 0.5 * (F.transpose() * F - Eigen::Matrix3d::Identity());
  SeenOptions options;
  options.along = Vector3d::UnitZ();
  options.grid_px = 4;
  const SeenSurface seen = seen_in(deformed_by(block_.mesh(), F), options);
  int points = 0;
  for (const SeenCase& one : seen.cases)
    for (const SeenPoints& view : one.views)
      for (int i = 0; i < view.size(); ++i, ++points) {
        const auto k = static_cast<size_t>(i);
        const Tangents& T = view.tangents[k];
        EXPECT_LT((T.transpose() * T - Eigen::Matrix2d::Identity()).norm(), 1e-12);
        const SurfaceStrain& e = view.strain[k];
        EXPECT_NEAR(e.xx, T.col(0).dot(E * T.col(0)), 1e-9);
        EXPECT_NEAR(e.yy, T.col(1).dot(E * T.col(1)), 1e-9);
        EXPECT_NEAR(e.xy, T.col(0).dot(E * T.col(1)), 1e-9);
        const double angle = e.angle() * EIGEN_PI / 180.0;
        const Vector3d first = std::cos(angle) * T.col(0) + std::sin(angle) * T.col(1);
        EXPECT_NEAR(first.dot(E * first), e.first(), 1e-9) << "e1 is along its angle";
        EXPECT_NEAR(e.first() + e.second(), e.xx + e.yy, 1e-12);
        EXPECT_LT((view.u.col(i) - (F - Eigen::Matrix3d::Identity()) * view.X.col(i)).norm(), 1e-6);
        EXPECT_FALSE(view.has_apart(i)) << "there is no photo";
      }
  EXPECT_GT(points, 100);
}

TEST_F(DicExport, ARigidTurnHasNoStrain) {
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (const SeenCase& one : seen_in(deformed_by(block_.mesh(), R), {}).cases)
    for (const Gauge& gauge : one.gauges) EXPECT_LT(gauge.strain.von_mises(), 1e-9) << gauge.name;
}

TEST_F(DicExport, GaugesAndLinesOfAnEvenDeformation) {
  const Eigen::Matrix3d F = Vector3d(0.9, 0.95, 1.3).asDiagonal();
  SeenOptions options;
  const Vector3d a(10, 0, 8), b(10, 0, 32);  // on the face x = 10
  options.lines = {{a, b}};
  options.gauges = {"grip"};
  const SeenSurface seen = seen_in(deformed_by(block_.mesh(), F), options);
  ASSERT_EQ(seen.cases[0].gauges.size(), 1u);
  const Gauge& grip = seen.cases[0].gauges[0];  // the face on top: x, y
  EXPECT_NEAR(grip.strain.xx, 0.5 * (0.81 - 1.0), 1e-9);
  EXPECT_NEAR(grip.strain.yy, 0.5 * (0.95 * 0.95 - 1.0), 1e-9);
  EXPECT_NEAR(grip.strain.xy, 0.0, 1e-9);
  EXPECT_FALSE(grip.seen);
  ASSERT_EQ(seen.cases[0].lines.size(), 1u);
  const Line& line = seen.cases[0].lines[0];
  EXPECT_NEAR(line.length / line.rest, 1.3, 1e-6);
  for (const SurfaceStrain& e : line.strain) EXPECT_NEAR(e.xx, 0.5 * (1.69 - 1.0), 1e-6);
  options.gauges = {"gripp"};
  EXPECT_THROW(seen_in(deformed_by(block_.mesh(), F), options), InputError);
}

/// A camera that looks along -z' of its own, `turn` about y, from 300 away.
Camera camera_at(double turn) {
  Camera camera;
  camera.width = camera.height = 400;
  camera.fx = camera.fy = 1000;
  camera.cx = camera.cy = 199.5;
  camera.R = Eigen::AngleAxisd(turn, Vector3d::UnitY()).toRotationMatrix();
  camera.t = Vector3d(0, 0, 300);
  return camera;
}

FlowField even_flow(const Eigen::Vector2d& u) {
  FlowField flow;
  for (int i = 0; i < 25; ++i)
    for (int j = 0; j < 25; ++j)
      flow.cells.push_back({i, j, Eigen::Vector2d(16 * i + 7.5, 16 * j + 7.5), 256,
                            Vector3d(u.x(), u.y(), 0), Eigen::Matrix3d::Identity() * 1e4,
                            Vector3d::Zero(), 0, 0, true, 3});
  return flow;
}

TEST(SeenMotion, TwoCamerasTellItInSpaceAndOneAcrossItsView) {
  const Vector3d x(5, -3, 10), u(0.01, 0.02, -0.03);
  const std::array cameras = {camera_at(0.0), camera_at(0.5)};
  std::vector<std::pair<const Camera*, detail::MotionCells::Motion>> seen;
  for (const Camera& camera : cameras) {
    const Eigen::Vector2d px = camera.project(x);
    detail::MotionCells cells;
    cells.add(even_flow(camera.project(x + u) - px));
    const auto motion = cells.at(px);
    ASSERT_TRUE(motion);
    seen.emplace_back(&camera, *motion);
  }
  const auto both = detail::motion_in_space(seen, x);
  EXPECT_EQ(both.known, 3);
  EXPECT_LT((both.u - u).norm(), 1e-4);
  seen.pop_back();
  const auto one = detail::motion_in_space(seen, x);
  EXPECT_EQ(one.known, 2);
  const Vector3d ray = (x - cameras[0].centre()).normalized();
  EXPECT_LT((one.u - (u - u.dot(ray) * ray)).norm(), 1e-3);
  EXPECT_NEAR(one.u.dot(ray), 0.0, 1e-9);
  // A hundredth of a pixel at 310 mm and 1000 px.
  EXPECT_NEAR(one.sigma, 0.01 * 310.0 / 1000.0, 1e-4);
  detail::MotionCells none;
  none.add(even_flow({0, 0}));
  EXPECT_FALSE(none.at({900, 100})) << "outside of all cells";
}

TEST(SeenMotion, AGradientOfWhatIsAddedIsFoundInThePlane) {
  const Tangents T = tangents_of(Vector3d(0, 1, 1).normalized(), Vector3d::UnitX());
  Eigen::Matrix3d G = Eigen::Matrix3d::Random();
  Matrix3Xd X(3, 9), values(3, 9);
  for (int i = 0; i < 9; ++i)
    X.col(i) = Vector3d(7, 8, 9) + T * Eigen::Vector2d(i % 3 - 1, i / 3 - 1);
  values = (G * X).colwise() + Vector3d(1, 2, 3);
  const auto found = gradient_in_surface(X, values, X.col(4), T);
  ASSERT_TRUE(found);
  EXPECT_LT((*found - G * T).norm(), 1e-12);
  EXPECT_FALSE(gradient_in_surface(X.leftCols(3), values.leftCols(3), X.col(1), T)) << "on a line";
}

TEST_F(DicExport, TablesAreReadAgainAsAField) {
  const Eigen::Matrix3d F = some_gradient();
  SolverModel solver = solver_model(model_);
  SeenOptions options;
  options.lines = {{Vector3d(10, 0, 8), Vector3d(10, 0, 32)}};
  options.grid_px = 8;
  solver.seen = seen_in(deformed_by(block_.mesh(), F), options);
  const Exported out = export_model(*find_exporter("dic"), solver);
  const SeenPoints& view = solver.seen->cases[1].views.at(0);
  ASSERT_GE(view.size(), 10);
  const TemporaryFolder folder;
  const std::string name = solver.seen->cases[1].name + "-" + view.view + ".csv";
  write_text(folder / "u.csv", file_of(out, name));
  const FieldTable table = read_field_table(folder / "u.csv", "u.csv");
  EXPECT_EQ(table.unit, "mm");
  ASSERT_EQ(table.X.cols(), view.size());
  EXPECT_LT((table.X - view.X).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT((table.u - view.u).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_NE(file_of(out, "gauges.csv").find("grip"), std::string::npos);
  EXPECT_NE(file_of(out, "lines.csv").find("line1"), std::string::npos);
  const std::string& report = file_of(out, "reporting.csv");
  EXPECT_NE(report.find("aperture,not known"), std::string::npos);
  EXPECT_NE(report.find("virtual strain gauge,48 px"), std::string::npos);
  EXPECT_NE(file_of(out, "README.txt").find("Green-Lagrange"), std::string::npos);
}

}  // namespace
}  // namespace hookeye::test
