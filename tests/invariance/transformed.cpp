#include "tests/invariance/transformed.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "core/text_file.h"
#include "meshing/body.h"

namespace hookeye::test {

namespace fs = std::filesystem;

namespace {

const char* const kVolume = "body.vtu";

double uniform(std::mt19937& random) { return random() / 4294967296.0; }

/// Places of 0 .. n - 1 in another order; the order itself for seed 0.
std::vector<int> shuffled(size_t n, unsigned seed) {
  std::vector<int> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(seed);
  if (seed)
    for (size_t i = n; i > 1; --i) std::swap(order[i - 1], order[random() % i]);
  return order;
}

std::vector<int> inverse(const std::vector<int>& order) {
  std::vector<int> place(order.size());
  for (size_t i = 0; i < order.size(); ++i) place[order[i]] = static_cast<int>(i);
  return place;
}

std::string text(double x) { return fmt::format("{}", x); }  // reads back as the very same

YAML::Node node_of(double x) { return YAML::Node(text(x)); }
YAML::Node node_of(const Vector3d& v) {
  YAML::Node node(YAML::NodeType::Sequence);
  for (int i = 0; i < 3; ++i) node.push_back(text(v[i]));
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}
Vector3d vector_of(const YAML::Node& node) {
  return {node[0].as<double>(), node[1].as<double>(), node[2].as<double>()};
}

template <class Change>
void change(YAML::Node parent, const char* key, const Change& by) {
  if (parent[key]) parent[key] = node_of(by(vector_of(parent[key])));
}
void scale(YAML::Node parent, const char* key, double factor) {
  if (parent[key]) parent[key] = node_of(factor * parent[key].as<double>());
}

YAML::Node reordered(const YAML::Node& map, unsigned seed) {
  std::vector<std::pair<std::string, YAML::Node>> entries;
  for (const auto& entry : map) entries.emplace_back(entry.first.as<std::string>(), entry.second);
  YAML::Node out(YAML::NodeType::Map);
  for (const int i : shuffled(entries.size(), seed)) out[entries[i].first] = entries[i].second;
  return out;
}

/// The triangle of the old surface that stands at each place of the new one.
std::vector<int> write_surface(const SurfaceMesh& told, const fs::path& file, const Frame& frame,
                               unsigned seed) {
  const auto vertices = shuffled(told.X.cols(), seed);
  const auto vertex_at = inverse(vertices);
  const auto triangles = shuffled(told.triangles.size(), seed);
  std::mt19937 random(seed);
  SurfaceMesh out;
  out.X.resize(3, told.X.cols());
  for (Eigen::Index v = 0; v < out.X.cols(); ++v)
    out.X.col(v) = frame.point(told.X.col(vertices[v]));
  for (const int t : triangles) {
    const int first = seed ? static_cast<int>(random() % 3) : 0;
    std::array<int, 3> corners;
    std::array<Vector2d, 3> uv = {Vector2d::Zero(), Vector2d::Zero(), Vector2d::Zero()};
    for (int k = 0; k < 3; ++k) {
      corners[k] = vertex_at[told.triangles[t][(first + k) % 3]];
      if (!told.uv.empty()) uv[k] = told.uv[t][(first + k) % 3];
    }
    out.triangles.push_back(corners);
    if (!told.uv.empty()) out.uv.push_back(uv);
  }
  write_surface_obj(file, out);
  return triangles;
}

void write_volume(const TetMesh& told, const fs::path& file, const Frame& frame, unsigned seed) {
  const auto nodes = shuffled(told.nodes(), seed);
  const auto node_at = inverse(nodes);
  const auto elements = shuffled(told.size(), seed);
  TetMesh out;
  out.order = told.order;
  out.X.resize(3, told.nodes());
  for (int a = 0; a < told.nodes(); ++a) out.X.col(a) = frame.point(told.X.col(nodes[a]));
  out.elements.resize(told.elements.rows(), told.size());
  for (int e = 0; e < told.size(); ++e)
    for (Eigen::Index k = 0; k < told.elements.rows(); ++k)
      out.elements(k, e) = node_at[told.elements(k, elements[e])];
  find_boundary(out);
  write_vtu(file, out, {});
}

/// A region's triangles, numbered as in the new surface.
YAML::Node region_of(const RegionSpec& region, const SurfaceMesh& surface,
                     const std::vector<int>& triangle_at, const fs::path& folder) {
  std::vector<int> triangles;
  if (const auto* faces = std::get_if<RegionSpec::Faces>(&region.shape)) {
    for (const int t : faces->triangles) triangles.push_back(triangle_at[t]);
  } else {
    const auto& box = std::get<RegionSpec::Box>(region.shape);
    for (size_t t = 0; t < surface.triangles.size(); ++t) {
      const auto& corners = surface.triangles[t];
      const bool inside = std::all_of(corners.begin(), corners.end(), [&](int v) {
        return (surface.X.col(v).array() >= box.low.array()).all() &&
               (surface.X.col(v).array() <= box.high.array()).all();
      });
      if (inside) triangles.push_back(triangle_at[t]);
    }
  }
  const std::string file = region.name + "_faces.txt";
  write_text(folder / file, fmt::format("{}\n", fmt::join(triangles, "\n")));
  YAML::Node node(YAML::NodeType::Map);
  node["faces"] = file;
  return node;
}

void transform_example(YAML::Node example, const Frame& frame) {
  const auto point = [&](const Vector3d& x) { return frame.point(x); };
  const auto step = [&](const Vector3d& u) { return frame.step(u); };
  const auto turn = [&](const Vector3d& d) { return Vector3d(frame.R * d); };
  const auto force = [&](const Vector3d& f) { return Vector3d(frame.force * (frame.R * f)); };
  for (YAML::Node support : example["supports"]) {
    YAML::Node rigid = support["rigid"];
    if (!rigid || !rigid.IsMap()) continue;
    change(rigid, "move", step);
    if (!rigid["rotate"]) continue;
    change(rigid["rotate"], "axis", turn);
    change(rigid["rotate"], "center", point);
  }
  for (YAML::Node load : example["loads"]) {
    change(load, "force", force);
    scale(load, "pressure", frame.stress());
  }
  for (YAML::Node measured : example["measured"]) {
    const double arm = measured["moment_on"] ? frame.length : 1.0;
    change(measured, "about", point);
    change(measured, "value", [&](const Vector3d& v) { return Vector3d(arm * force(v)); });
    scale(measured, "sigma", arm * frame.force);
  }
}

/// x_camera' = length x_camera: R' = R R_frame^T, t' = length (t - R' move).
void transform_camera(YAML::Node camera, const Camera& told, const Frame& frame) {
  const Eigen::Matrix3d R = told.R * frame.R.transpose();
  YAML::Node rows(YAML::NodeType::Sequence);
  for (int i = 0; i < 3; ++i) rows.push_back(node_of(Vector3d(R.row(i).transpose())));
  camera["pose"]["rotation"] = rows;
  camera["pose"]["translation"] = node_of(Vector3d(frame.length * (told.t - R * frame.move)));
}

void transform_body(YAML::Node root, const Capture& told, const Frame& frame) {
  YAML::Node body = root["body"];
  scale(body["mesh"], "edge", frame.length);
  scale(body, "density", frame.density());
  YAML::Node material = root["model"]["material"];
  for (const auto& [name, value] : told.materials.at(0).parameters)
    if (name != "kappa_over_mu") scale(material, name.c_str(), frame.stress());
  change(root["model"], "gravity", [&](const Vector3d& g) { return frame.step(g); });
  change(root["light"]["sun"], "toward", [&](const Vector3d& d) { return Vector3d(frame.R * d); });
  root["units"]["length"] = frame.length_unit;
  root["units"]["force"] = frame.force_unit;
}

}  // namespace

Frame in_metres() {
  Frame frame;
  frame.length = 1e-3;
  frame.length_unit = "m";
  return frame;
}

Frame in_micrometres() {
  Frame frame;
  frame.length = 1e3;
  frame.force = 1e3;
  frame.length_unit = "um";
  frame.force_unit = "mN";
  return frame;
}

Frame turned(unsigned seed) {
  std::mt19937 random(seed);
  Eigen::Vector4d q;  // uniform in the ball is uniform in direction
  do
    for (int i = 0; i < 4; ++i) q[i] = 2.0 * uniform(random) - 1.0;
  while (q.squaredNorm() > 1.0 || q.squaredNorm() < 0.01);
  Frame frame;
  frame.R = Eigen::Quaterniond(q).normalized().toRotationMatrix();
  return frame;
}

Frame moved(const Vector3d& by) {
  Frame frame;
  frame.move = by;
  return frame;
}

void write_transformed(const fs::path& from, const fs::path& to, const Frame& frame,
                       const Order& order) {
  const Capture told = read_capture(from);
  fs::create_directories(to);
  fs::copy(from, to, fs::copy_options::recursive);
  YAML::Node root = YAML::LoadFile(told.file);
  const SurfaceMesh surface = read_surface(told.body.surface);
  root["body"]["surface"] = "surface.obj";
  const auto triangle_at =
      inverse(write_surface(surface, to / "surface.obj", frame, order.vertices));
  if (!told.body.volume.empty()) {
    root["body"]["volume"] = kVolume;
    write_volume(hookeye::read_volume(told.body.volume, {}), to / kVolume, frame, order.nodes);
  }
  transform_body(root, told, frame);
  for (const Camera& camera : told.cameras)
    transform_camera(root["cameras"][camera.name], camera, frame);
  for (const RegionSpec& region : told.regions)
    root["regions"][region.name] = region_of(region, surface, triangle_at, to);
  for (const auto& example : root["examples"]) {
    transform_example(example.second, frame);
    if (example.second["photos"])
      root["examples"][example.first.as<std::string>()]["photos"] =
          reordered(example.second["photos"], order.cameras);
  }
  root["cameras"] = reordered(root["cameras"], order.cameras);
  root["examples"] = reordered(root["examples"], order.examples);
  root["regions"] = reordered(root["regions"], order.regions);
  YAML::Emitter out;
  out << root;
  write_text(to / "capture.yaml", std::string(out.c_str()) + "\n");
}

void keep_own_mesh(const fs::path& folder) {
  const Capture capture = read_capture(folder);
  const Body body = make_body(capture);
  write_vtu(folder / kVolume, body.mesh, {});
  YAML::Node root = YAML::LoadFile(capture.file);
  root["body"]["volume"] = kVolume;
  YAML::Emitter out;
  out << root;
  write_text(capture.file, std::string(out.c_str()) + "\n");
}

}  // namespace hookeye::test
