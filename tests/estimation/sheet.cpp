#include "estimation/sheet.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

#include "estimation/evaluation/photo_evaluation.h"
#include "simulation/equilibrium.h"

namespace hookeye::test {
namespace {

namespace fs = std::filesystem;

/// Matrix and fibres as they are usually written; derivatives by hand, checked in
/// additive_fit_test.cpp.
class Woven final : public EnergyTerm {
 public:
  Woven(double mu, double kappa, std::array<double, 2> k, std::array<double, 2> lock)
      : matrix_(neo_hookean(mu, kappa)), k_(k), lock_(lock) {}
  std::string name() const override { return "woven"; }
  std::vector<Parameter> parameters(const Units&) const override { return {}; }
  std::shared_ptr<const EnergyTerm> with(const VectorXd&) const override {
    return std::make_shared<Woven>(*this);
  }
  /// k/(2 b) (exp(b x^2) - 1) in tension (x = I4 - 1 > 0): value, first, second derivative by x.
  static Eigen::Vector3d fibre(double k, double b, double x) {
    if (x <= 0) return Eigen::Vector3d::Zero();
    const double e = std::exp(b * x * x);
    return {k / (2 * b) * (e - 1), k * x * e, k * e * (1 + 2 * b * x * x)};
  }
  double psi(const Matrix3d& F) const override {
    double sum = matrix_->psi(F);
    for (int i = 0; i < 2; ++i) sum += fibre(k_[i], lock_[i], F.col(i).squaredNorm() - 1)[0];
    return sum;
  }
  Matrix3d P(const Matrix3d& F) const override {
    Matrix3d P = matrix_->P(F);
    for (int i = 0; i < 2; ++i)
      P.col(i) += 2 * fibre(k_[i], lock_[i], F.col(i).squaredNorm() - 1)[1] * F.col(i);
    return P;
  }
  Matrix9d dP_dF(const Matrix3d& F) const override {
    Matrix9d D = matrix_->dP_dF(F);
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector3d w = fibre(k_[i], lock_[i], F.col(i).squaredNorm() - 1);
      D.block<3, 3>(3 * i, 3 * i) +=
          4 * w[2] * F.col(i) * F.col(i).transpose() + 2 * w[1] * Matrix3d::Identity();
    }
    return D;
  }
  Matrix3d dP_dtheta(const Matrix3d&, int) const override { return Matrix3d::Zero(); }

 private:
  std::shared_ptr<const EnergyTerm> matrix_;
  std::array<double, 2> k_, lock_;
};

constexpr double kLines[] = {0, 8.5, 17, 25.5, 34, 40};
constexpr int kCells = 5;

/// Rectangles between the lines, so that the corner's grip ends at edges of every mesh. A grip that
/// ends within elements is as large as the nodes in it: positions differ by a millimetre from mesh
/// to mesh then.
std::string surface() {
  std::string out;
  for (int z : {-1, 1})
    for (int j = 0; j <= kCells; ++j)
      for (int i = 0; i <= kCells; ++i) out += fmt::format("v {} {} {}\n", kLines[i], kLines[j], z);
  for (int j = 0; j <= kCells; ++j)
    for (int i = 0; i <= kCells; ++i)
      out += fmt::format("vt {} {}\n", kLines[i] / 40, kLines[j] / 40);
  constexpr int kSide = kCells + 1, kLayer = kSide * kSide;
  const auto corner = [](int k) { return fmt::format("{}/{}", k + 1, k % kLayer + 1); };
  const auto square = [&](int a, int b, int c, int d) {
    out += fmt::format("f {} {} {}\nf {} {} {}\n", corner(a), corner(b), corner(c), corner(a),
                       corner(c), corner(d));
  };
  const auto wall = [&](int a, int b) { square(a, b, b + kLayer, a + kLayer); };
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      const int a = j * kSide + i, up = a + kLayer;
      square(a, a + kSide, a + kSide + 1, a + 1);
      square(up, up + 1, up + kSide + 1, up + kSide);
    }
    wall(i, i + 1);
    wall(kCells * kSide + i + 1, kCells * kSide + i);
    wall((i + 1) * kSide, i * kSide);
    wall(i * kSide + kCells, (i + 1) * kSide + kCells);
  }
  return out;
}

std::string head(const SheetOptions& o) {
  return fmt::format(R"(hookeye: 1
title: sheet
units: {{length: mm, force: N}}
body:
  surface: sheet.obj
  mesh: {{edge: {}, order: 2}}
  texture: {{image: albedo.png, encoding: linear}}
model:
  material: {}
  fit: {}
cameras:
  above:
    size: [256, 256]
    projection: perspective
    intrinsics: {{fx: 900, fy: 900, cx: 127.5, cy: 127.5}}
    pose: {{rotation: [[1, 0, 0], [0, -1, 0], [0, 0, -1]], translation: [-23, 22, 200]}}
light: {{ambient: 0.7, sun: {{toward: [0.3, 0.2, 0.93], strength: 0.3}}}}
photos: {{encoding: linear, noise: 0.004}}
regions:
  left: {{box: [[-0.1, -1, -2], [0.1, 41, 2]]}}
  corner: {{box: [[34, 34, -2], [41, 41, 2]]}}
  lower: {{box: [[-1, -0.1, -2], [41, 0.1, 2]]}}
  right: {{box: [[39.9, -1, -2], [40.1, 41, 2]]}}
  upper: {{box: [[-1, 39.9, -2], [41, 40.1, 2]]}}
examples:
)",
                     o.edge, o.material, o.fit);
}

struct Motion {
  std::string name, grip, text;  ///< grip: moved by a force that can be measured, "" where told
  bool validate;
};

std::vector<Motion> motions(const SheetOptions& o) {
  std::vector<Motion> all;
  for (int k = 1; k <= o.levels; ++k) {
    const double s = o.stretch * k / o.levels;
    // The middle level is held out of the fitted motion; the other motion is held out whole.
    const bool middle = o.levels > 1 && k == (o.levels + 1) / 2;
    all.push_back({fmt::format("corner_{}", k), "corner",
                   fmt::format("      - {{region: left, fix: [x, y, z]}}\n"
                               "      - {{region: corner, rigid: {{move: [{:g}, {:g}, {:g}]}}}}\n",
                               8.0 * s, 5.0 * s, 3.0 * s),
                   o.fitted != "corner" || middle});
    all.push_back(
        {fmt::format("shear_{}", k), "upper",
         fmt::format("      - {{region: lower, fix: [x, y, z]}}\n"
                     "      - {{region: upper, rigid: {{rotate: {{axis: [0, 0, 1], degrees: {:g}, "
                     "center: [20, 40, 0]}}, move: [{:g}, {:g}, 0]}}}}\n",
                     6.0 * s, 9.0 * s, 4.0 * s),
         o.fitted != "shear" || middle});
    all.push_back(
        {fmt::format("shear_side_{}", k), "right",
         fmt::format("      - {{region: left, fix: [x, y, z]}}\n"
                     "      - {{region: right, rigid: {{rotate: {{axis: [0, 0, 1], degrees: {:g}, "
                     "center: [40, 20, 0]}}, move: [{:g}, {:g}, 0]}}}}\n",
                     -6.0 * s, 4.0 * s, 9.0 * s),
         o.fitted != "shear" || middle});
  }
  if (o.dead_force)
    all.push_back({o.fitted + "_pull", "",
                   fmt::format("      - {{region: left, fix: [x, y, z]}}\n    loads:\n"
                               "      - {{region: right, force: [{:g}, {:g}, {:g}]}}\n",
                               o.dead_force->x(), o.dead_force->y(), o.dead_force->z()),
                   false});
  if (o.only_fitted)
    std::erase_if(all, [&](const Motion& m) { return m.name.rfind(o.fitted, 0) != 0; });
  return all;
}

std::string examples_text(const SheetOptions& o, const std::map<std::string, std::string>& measured,
                          bool photos) {
  std::string out = "  rest:\n    supports:\n      - {region: left, fix: [x, y, z]}\n";
  if (photos) out += "    photos: {above: photos/rest.exr}\n";
  for (const Motion& m : motions(o)) {
    out += fmt::format("  {}:\n    use: {}\n    supports:\n{}", m.name,
                       m.validate ? "validate" : "fit", m.text);
    const auto found = measured.find(m.name);
    if (found != measured.end() && !found->second.empty()) out += "    measured:\n" + found->second;
    if (photos) out += fmt::format("    photos: {{above: photos/{}.exr}}\n", m.name);
  }
  return out;
}

/// Grid of points on the face z = 1.
std::vector<Vector3d> markers() {
  std::vector<Vector3d> all;
  for (int j = 0; j < 7; ++j)
    for (int i = 0; i < 7; ++i) all.emplace_back(2.0 + 6.0 * i, 2.0 + 6.0 * j, 1.0);
  return all;
}

Vector3d moved(const TetMesh& mesh, const VectorXd& q, const Vector3d& X) {
  SurfacePoint point;
  locate_on_boundary(mesh, X, &point);
  const VectorXd N = shape_functions(mesh.order, point.barycentric);
  Vector3d x = Vector3d::Zero();
  for (int a = 0; a < N.size(); ++a) x += N[a] * q.segment<3>(3 * mesh.elements(a, point.element));
  return x;
}

void write_albedo(const fs::path& file) {
  Image albedo{512, 512, 1, std::vector<float>(512 * 512)};
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  std::vector<float> coarse(65 * 65);
  for (float& v : coarse) v = uniform(random);
  for (int y = 0; y < 512; ++y)
    for (int x = 0; x < 512; ++x) {
      const float u = static_cast<float>(x) / 8.0f, v = static_cast<float>(y) / 8.0f;
      const int i = static_cast<int>(u), j = static_cast<int>(v);
      const float a = u - static_cast<float>(i), b = v - static_cast<float>(j);
      const float* c = &coarse[static_cast<size_t>(65 * j + i)];
      albedo.values[static_cast<size_t>(512 * y + x)] =
          0.15f +
          0.7f * ((1 - b) * ((1 - a) * c[0] + a * c[1]) + b * ((1 - a) * c[65] + a * c[66]));
    }
  write_image(file, albedo);
}

std::shared_ptr<const Scene> truth_scene(const SheetOptions& o) {
  Capture capture = read_capture(o.folder);
  for (auto& example : capture.examples) {
    PhotoSpec photo;
    photo.camera = "above";
    photo.place = example.place;
    example.photos.push_back(photo);
  }
  return remeshed(*load_scene(capture, false), o.finer, 0, true);
}

}  // namespace

std::shared_ptr<const EnergyTerm> woven_sheet(double mu, double kappa, double stiff1, double lock1,
                                              double stiff2, double lock2) {
  return std::make_shared<Woven>(mu, kappa, std::array<double, 2>{stiff1, stiff2},
                                 std::array<double, 2>{lock1, lock2});
}

std::shared_ptr<const Scene> make_sheet(const SheetOptions& o) {
  fs::create_directories(o.folder / "photos");
  std::ofstream(o.folder / "sheet.obj") << surface();
  write_albedo(o.folder / "albedo.png");
  std::ofstream(o.folder / "capture.yaml") << head(o) << examples_text(o, {}, false);
  const auto scene = truth_scene(o);
  Model model = base_form(scene).start;
  model.energy.parts = {{o.truth, {}, {}}};
  std::map<std::string, std::string> measured;
  std::mt19937 random(o.seed);
  std::normal_distribution<double> normal;
  const auto noisy = [&](const Vector3d& v, double sigma) {
    return fmt::format("[{:.9g}, {:.9g}, {:.9g}]", v.x() + sigma * normal(random),
                       v.y() + sigma * normal(random), v.z() + sigma * normal(random));
  };
  const std::vector<Motion> all = motions(o);
  EquilibriumSolver solver(scene->mesh());
  for (size_t e = 0; e < scene->capture.examples.size(); ++e) {
    const ExampleSpec& example = scene->capture.examples[e];
    const auto solved = solver.solve(model.energy, model.examples[e].loading);
    if (!solved) throw std::runtime_error(example.name + ": " + solved.error().reason);
    const Equilibrium& state = *solved;
    std::string& text = measured[example.name];
    if (o.kinds.count("positions") && example.name != "rest")
      for (const Vector3d& X : markers())
        text += fmt::format(
            "      - {{position_of: [{:g}, {:g}, {:g}], value: {}, sigma: {:g}}}\n", X.x(), X.y(),
            X.z(), noisy(moved(scene->body->mesh, state.q, X), o.position_sigma), o.position_sigma);
    const auto motion = std::find_if(all.begin(), all.end(),
                                     [&](const Motion& m) { return m.name == example.name; });
    if (o.kinds.count("forces") && motion != all.end() && !motion->grip.empty()) {
      const Vector3d force = support_force(state, scene->body->regions.at(motion->grip));
      const double sigma = std::max(o.force_sigma, o.force_share * force.norm());
      text += fmt::format("      - {{force_on: {}, value: {}, sigma: {:g}}}\n", motion->grip,
                          noisy(force, sigma), sigma);
    }
    if (o.kinds.count("photos")) {
      RenderOptions options = render_options(*scene);
      options.derivatives = false;
      options.rays_per_axis = 5;
      PhotoComparer comparer(scene, static_cast<int>(e));
      Image picture = comparer.render(model, state.q, nullptr, 0, 0, options).I;
      for (float& v : picture.values) v += 0.004f * static_cast<float>(normal(random));
      write_image(o.folder / "photos" / (example.name + ".exr"), picture);
    }
  }
  std::ofstream(o.folder / "capture.yaml")
      << head(o) << examples_text(o, measured, o.kinds.count("photos") > 0);
  return load_scene(read_capture(o.folder));
}

MarkerErrors marker_errors(const Scene& scene, const Fitted& fitted) {
  double sum[2] = {0, 0}, count[2] = {0, 0};
  for (const auto& example : fitted.evaluation.examples) {
    const auto& spec = scene.capture.examples[example.example];
    const int motion = spec.name.rfind("shear", 0) == 0;
    for (const auto& one : example.measured) {
      const MeasuredSpec& told = spec.measured[one.index];
      if (told.kind != MeasuredSpec::Kind::position_of) continue;
      sum[motion] += (one.predicted - told.value).squaredNorm();
      count[motion] += 1;
    }
  }
  return {std::sqrt(sum[0] / count[0]), std::sqrt(sum[1] / count[1])};
}

Result<Fitted> shown_on(const std::shared_ptr<const Scene>& scene, const Fitted& fitted) {
  ModelForm form = fitted.form;
  form.scene = scene;
  form.start = base_form(scene).start;
  Workspace workspace(scene);
  return assess(workspace, form, fitted.p);
}

}  // namespace hookeye::test
