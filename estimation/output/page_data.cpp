#include "estimation/output/page_data.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>
#include <map>
#include <vector>

#include "core/base64.h"
#include "core/text_file.h"
#include "estimation/diagnosis/diagnosis_json.h"
#include "estimation/fit/energy_curves.h"
#include "estimation/model/fitted_fields.h"
#include "estimation/output/step_json.h"
#include "meshing/extent.h"
#include "render/renderer.h"

namespace hookeye {

using nlohmann::json;

double length_per_px(const Scene& scene, const PhotoState& state) {
  return state.camera.length_per_px(scene.body->mesh.X.rowwise().mean());
}

std::string photo_name(const Scene& scene, const PhotoEvaluation& photo) {
  const auto& spec = scene.capture.examples[photo.example];
  std::string name = spec.name + "-" + spec.photos[photo.photo].camera;
  if (scene.photos[photo.example][photo.photo].planes.size() > 1)
    name += std::string("-") + "rgb"[photo.plane];
  return name;
}

namespace {

/// Columns are nodes.
json array_json(const Eigen::MatrixXd& values) {
  const Eigen::MatrixXf out = values.cast<float>();
  return {{"components", out.rows()},
          {"float32", base64(out.data(), sizeof(float) * static_cast<size_t>(out.size()))}};
}

/// The boundary as flat triangles over its own, densely numbered nodes.
struct Shell {
  std::vector<int> nodes;     ///< node of the mesh of each shell node
  std::vector<int> shell_of;  ///< the inverse, -1: inside
  std::vector<std::array<int, 3>> triangles;
};

Shell make_shell(const TetMesh& mesh) {
  Shell shell;
  shell.shell_of.assign(mesh.nodes(), -1);
  auto own = [&](int node) {
    if (shell.shell_of[node] < 0) {
      shell.shell_of[node] = static_cast<int>(shell.nodes.size());
      shell.nodes.push_back(node);
    }
    return shell.shell_of[node];
  };
  // Corners 0 1 2, mids of 01 12 20.
  static constexpr int kFlat[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};
  for (int f = 0; f < mesh.boundary.cols(); ++f) {
    const auto face = mesh.boundary.col(f);
    if (mesh.order == 1) shell.triangles.push_back({own(face[0]), own(face[1]), own(face[2])});
    if (mesh.order == 2)
      for (const auto& t : kFlat)
        shell.triangles.push_back({own(face[t[0]]), own(face[t[1]]), own(face[t[2]])});
  }
  return shell;
}

json body_json(const Scene& scene, const Shell& shell) {
  const TetMesh& mesh = scene.body->mesh;
  Eigen::MatrixXd X(3, shell.nodes.size());
  for (size_t i = 0; i < shell.nodes.size(); ++i) X.col(i) = mesh.X.col(shell.nodes[i]);
  json regions = json::object();
  for (const auto& [name, region] : scene.body->regions.all()) {
    json inside = json::array();
    for (int node : region.nodes)
      if (shell.shell_of[node] >= 0) inside.push_back(shell.shell_of[node]);
    regions[name] = std::move(inside);
  }
  return {{"rest", array_json(X)}, {"triangles", shell.triangles}, {"regions", regions}};
}

/// Where the shell's nodes lie in one photo, and which of them nothing hides.
struct Sight {
  Eigen::MatrixXd pixel;  ///< 2 x shell nodes
  VectorXd seen;          ///< 1 or 0
  std::vector<Camera::Jacobian3> d_pixel;
};

/// Depth of what the camera sees at a pixel centre; infinite where it sees no body.
Eigen::MatrixXd depth_picture(Renderer& renderer, const PhotoState& state, const Matrix3Xd& x) {
  RenderOptions options;
  options.derivatives = options.cast_shadows = false;
  options.visibility_rays = 0;
  options.rays_per_axis = 1;
  const Rendering rendering = renderer.render(x, nullptr, Texture{}, state, options, true);
  const int width = state.camera.width, height = state.camera.height;
  Eigen::MatrixXd depth = Eigen::MatrixXd::Constant(width, height, HUGE_VAL);
  for (int y = 0; y < height; ++y)
    for (int px = 0; px < width; ++px) {
      const int i = y * width + px;
      if (rendering.triangle[i] < 0) continue;
      const auto& t = renderer.surface().triangles[rendering.triangle[i]];
      const Eigen::Vector2d b = rendering.uv[i].cast<double>();
      depth(px, y) = state.camera.depth((1.0 - b[0] - b[1]) * x.col(t[0]) + b[0] * x.col(t[1]) +
                                        b[1] * x.col(t[2]));
    }
  return depth;
}

Sight look(const Shell& shell, const VectorXd& q, const Camera& camera,
           const Eigen::MatrixXd& depth, double tolerance) {
  Sight sight;
  const size_t n = shell.nodes.size();
  sight.pixel.resize(2, n);
  sight.seen = VectorXd::Zero(n);
  sight.d_pixel.resize(n);
  for (size_t i = 0; i < n; ++i) {
    const Vector3d x = q.segment<3>(3 * shell.nodes[i]);
    sight.pixel.col(i) = camera.project(x, &sight.d_pixel[i], nullptr);
    if (!sight.pixel.col(i).allFinite()) continue;
    const auto cx = std::lround(sight.pixel(0, i)), cy = std::lround(sight.pixel(1, i));
    for (auto y = std::max(0l, cy - 1); y <= std::min<long>(depth.cols() - 1, cy + 1); ++y)
      for (auto px = std::max(0l, cx - 1); px <= std::min<long>(depth.rows() - 1, cx + 1); ++px)
        if (camera.depth(x) < depth(px, y) + tolerance && depth(px, y) < HUGE_VAL)
          sight.seen[i] = 1.0;
  }
  return sight;
}

/// Residual displacement at a pixel: that of its cell.
const FlowCell* cell_at(const FlowField& flow, const Eigen::Vector2d& pixel) {
  const int column = static_cast<int>(std::floor(pixel.x() / flow.cell_px));
  const int row = static_cast<int>(std::floor(pixel.y() / flow.cell_px));
  for (const FlowCell& cell : flow.cells)
    if (cell.column == column && cell.row == row) return cell.reliable ? &cell : nullptr;
  return nullptr;
}

struct ShellFields {
  VectorXd residual;
  Eigen::MatrixXd gap;  ///< 3 x shell nodes
};

/// Each photo that sees a node tells two components of the displacement that would remove its
/// residual; the smallest motion in space that agrees best with all of them.
ShellFields photo_fields(const std::vector<PhotoEvaluation>& photos,
                         const std::vector<Sight>& sights, size_t nodes) {
  ShellFields out{VectorXd::Zero(nodes), Eigen::MatrixXd::Zero(3, nodes)};
  for (size_t i = 0; i < nodes; ++i) {
    double sum = 0.0, count = 0.0;
    std::vector<Eigen::Matrix<double, 2, 3>> A;
    std::vector<Eigen::Vector2d> b;
    for (size_t k = 0; k < photos.size(); ++k) {
      if (sights[k].seen[i] == 0.0) continue;
      const Image& r = photos[k].residual;
      const int cx = static_cast<int>(std::lround(sights[k].pixel(0, i)));
      const int cy = static_cast<int>(std::lround(sights[k].pixel(1, i)));
      for (int y = std::max(0, cy - 4); y <= std::min(r.height - 1, cy + 4); ++y)
        for (int x = std::max(0, cx - 4); x <= std::min(r.width - 1, cx + 4); ++x)
          if (!std::isnan(r.at(x, y))) sum += r.at(x, y) * r.at(x, y), count += 1.0;
      if (const FlowCell* cell = cell_at(photos[k].flow, sights[k].pixel.col(i))) {
        A.push_back(sights[k].d_pixel[i]);
        b.push_back(cell->estimate.head<2>());
      }
    }
    out.residual[i] = count > 0.0 ? std::sqrt(sum / count) : std::nan("");
    if (A.empty()) {
      out.gap.col(i).setConstant(std::nan(""));
      continue;
    }
    Eigen::MatrixXd stacked(2 * A.size(), 3);
    VectorXd wanted(2 * A.size());
    for (size_t k = 0; k < A.size(); ++k)
      stacked.middleRows<2>(2 * k) = A[k], wanted.segment<2>(2 * k) = b[k];
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    solver.setThreshold(1e-3);
    out.gap.col(i) = solver.compute(stacked).solve(wanted);
  }
  return out;
}

/// Mean over the elements that share the node.
VectorXd on_shell(const Scene& scene, const Shell& shell, const VectorXd& of_element) {
  VectorXd sum = VectorXd::Zero(shell.nodes.size()), count = sum;
  const Eigen::MatrixXi& elements = scene.body->mesh.elements;
  for (int e = 0; e < elements.cols(); ++e)
    for (int a = 0; a < elements.rows(); ++a) {
      const int i = shell.shell_of[elements(a, e)];
      if (i >= 0) sum[i] += of_element[e], count[i] += 1.0;
    }
  return sum.array() / count.array().max(1.0);
}

VectorXd largest_principal(const Eigen::MatrixXd& strain) {
  VectorXd out(strain.cols());
  for (int e = 0; e < strain.cols(); ++e) {
    const auto s = strain.col(e);  // xx yy zz xy yz xz
    Eigen::Matrix3d E;
    E << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
    const Eigen::Vector3d eigen = E.selfadjointView<Eigen::Lower>().eigenvalues();
    out[e] = std::abs(eigen[0]) > std::abs(eigen[2]) ? eigen[0] : eigen[2];
  }
  return out;
}

json flow_json(const Scene& scene, const Model& model, const PhotoEvaluation& photo) {
  const auto& flow = photo.flow;
  Eigen::MatrixXd cells(5, flow.cells.size());
  for (size_t c = 0; c < flow.cells.size(); ++c) {
    const FlowCell& cell = flow.cells[c];
    cells.col(c) << cell.centre_px, cell.estimate.head<2>(), cell.reliable ? 1.0 : 0.0;
  }
  return {
      {"cell_px", flow.cell_px},
      {"rms_px", flow.rms_px()},
      {"length_per_px", length_per_px(scene, model.examples[photo.example].photos[photo.photo])},
      {"cells", array_json(cells)}};
}

json example_json(const Scene& scene, const Model& model, const Shell& shell,
                  const ExampleEvaluation& example, Renderer& renderer,
                  const std::map<std::string, VectorXd>& fitted) {
  const TetMesh& mesh = scene.body->mesh;
  const VectorXd& q = example.equilibrium->q;
  Eigen::MatrixXd u(3, shell.nodes.size());
  for (size_t i = 0; i < shell.nodes.size(); ++i)
    u.col(i) = q.segment<3>(3 * shell.nodes[i]) - mesh.X.col(shell.nodes[i]);
  const double size = extent(mesh.X);
  const Matrix3Xd x = scene.body->surface.deformed(mesh, q);
  std::vector<Sight> sights;
  json views = json::array();
  for (const auto& photo : example.photos) {
    const PhotoState& state = model.examples[example.example].photos[photo.photo];
    sights.push_back(look(shell, q, state.camera, depth_picture(renderer, state, x), 0.01 * size));
    views.push_back({{"photo", photo_name(scene, photo)},
                     {"pixel", array_json(sights.back().pixel)},
                     {"seen", array_json(sights.back().seen.transpose())}});
  }
  const ShellFields fields = photo_fields(example.photos, sights, shell.nodes.size());
  const ElementState state = element_state(mesh, model.energy_of(example.example), q);
  json out = {
      {"displacement", array_json(u)},
      {"residual", array_json(fields.residual.transpose())},
      {"gap", array_json(fields.gap)},
      {"strain",
       array_json(on_shell(scene, shell, largest_principal(state.green_strain)).transpose())},
      {"von_mises", array_json(on_shell(scene, shell, state.von_mises).transpose())},
      {"views", std::move(views)}};
  for (const auto& [name, values] : fitted)
    out[name] = array_json(on_shell(scene, shell, values).transpose());
  const VectorXd beyond = addends_beyond(scene, model, q);
  if (beyond.size()) out["beyond"] = array_json(on_shell(scene, shell, beyond).transpose());
  return out;
}

}  // namespace

void write_page_data(const std::filesystem::path& folder, const Scene& scene, const Model& model,
                     const Fitted& fitted) {
  std::filesystem::create_directories(folder);
  const Shell shell = make_shell(scene.body->mesh);
  write_text(folder / "body.json", body_json(scene, shell).dump());
  Renderer renderer(scene.body->surface.mesh);
  const auto fields = fitted_fields(fitted.form, model);
  for (const auto& example : fitted.evaluation.examples) {
    write_text(folder / ("example-" + scene.capture.examples[example.example].name + ".json"),
               example_json(scene, model, shell, example, renderer, fields).dump());
    for (const auto& photo : example.photos)
      write_text(folder / ("photo-" + photo_name(scene, photo) + ".json"),
                 flow_json(scene, model, photo).dump());
  }
}

void write_page_free_form(const std::filesystem::path& folder, const Scene& scene,
                          const std::vector<FreeForm>& fields) {
  const Shell shell = make_shell(scene.body->mesh);
  json out = to_json(fields);
  for (size_t i = 0; i < fields.size(); ++i)
    out[i]["forces"] = array_json(fields[i].forces(Eigen::all, shell.nodes));
  write_text(folder / "free_form.json", out.dump());
}

}  // namespace hookeye
