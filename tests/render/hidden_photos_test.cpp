// The pictures of another program (Blender Cycles), rendered again from the true positions: the
// residual over the known noise must look like noise.
#include <fmt/format.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "capture_io/capture.h"
#include "render/renderer.h"
#include "support/shared_data.h"

namespace hookeye {
namespace {

using test::shared_data;

SurfaceMesh read_obj(const std::filesystem::path& file) {
  SurfaceMesh out;
  std::ifstream in(file);
  std::vector<Vector3d> v;
  std::vector<Vector2d> vt;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "v") {
      Vector3d x;
      words >> x.x() >> x.y() >> x.z();
      v.push_back(x);
    } else if (key == "vt") {
      Vector2d x;
      words >> x.x() >> x.y();
      vt.push_back(x);
    } else if (key == "f") {
      auto& t = out.triangles.emplace_back();
      auto& uv = out.uv.emplace_back();
      for (int k = 0; k < 3; ++k) {
        char slash;
        int a, b;
        words >> a >> slash >> b;
        t[k] = a - 1, uv[k] = vt[b - 1];
      }
    }
  }
  out.X.resize(3, v.size());
  for (size_t i = 0; i < v.size(); ++i) out.X.col(i) = v[i];
  return out;
}

/// Nodes of a msh 2.2 file.
Matrix3Xd read_nodes(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string word;
  while (in >> word && word != "$Nodes") {
  }
  int n, id;
  in >> n;
  Matrix3Xd x(3, n);
  for (int i = 0; i < n; ++i) in >> id >> x(0, i) >> x(1, i) >> x(2, i);
  return x;
}

struct Case {
  Capture capture;
  SurfaceMesh surface;
  Texture texture;
  nlohmann::json truth;
  std::vector<int> node;  // of each surface vertex

  explicit Case(const std::string& name)
      : capture(read_capture(shared_data() / "hidden" / name)),
        surface(read_obj(capture.body.surface)) {
    texture.source = Texture::Source::image;
    texture.image = std::make_shared<Image>(
        luminance(read_image(capture.body.texture_image, capture.body.texture_encoding)));
    std::ifstream(shared_data() / "hidden" / "truth" / (name + ".json")) >> truth;
    const Matrix3Xd nodes = read_nodes(capture.body.volume);
    for (int v = 0; v < surface.X.cols(); ++v) {
      Eigen::Index at;
      EXPECT_LT((nodes.colwise() - surface.X.col(v)).colwise().norm().minCoeff(&at), 1e-3);
      node.push_back(int(at));
    }
  }
  Matrix3Xd positions(const std::string& example) const {
    Matrix3Xd x = surface.X;
    const auto& u = truth["nodal_displacements_mm"][example];
    for (int v = 0; v < x.cols(); ++v)
      for (int c = 0; c < 3; ++c) x(c, v) += u[node[v]][c].get<double>();
    return x;
  }
};

struct Score {
  double chi = 0, mean = 0, chi_inside = 0;
  size_t pixels = 0;
};

Score score(Case& c, Renderer& renderer, const ExampleSpec& example, const PhotoSpec& spec,
            const RenderOptions& options, const std::string& picture = "") {
  PhotoState state;
  state.camera = c.capture.camera(spec.camera);
  state.ambient = c.capture.light.ambient;
  state.sun = c.capture.light.sun;
  const Photo photo = read_photo(spec, state.camera);
  const Rendering r =
      renderer.render(c.positions(example.name), nullptr, c.texture, state, options, true);
  const Image& plane = photo.planes[0];
  Image model = plane, residual = plane;
  Score s;
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x) {
      model.at(x, y) = r.I.at(x, y);
      residual.at(x, y) = 0.5f;
      if (r.coverage.at(x, y) <= 0 || !photo.valid[size_t(y) * plane.width + x]) continue;
      const double z = (r.I.at(x, y) - plane.at(x, y)) / photo.sigma[0].at(x, y);
      residual.at(x, y) = float(std::clamp(0.5 + z / 10, 0.0, 1.0));
      s.chi += z * z, s.mean += z, ++s.pixels;
    }
  s.chi = std::sqrt(s.chi / s.pixels), s.mean /= s.pixels;
  if (!picture.empty()) {
    Image all;
    all.width = 3 * plane.width, all.height = plane.height, all.channels = 1;
    all.values.resize(all.pixels());
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) {
        all.at(x, y) = plane.at(x, y), all.at(x + plane.width, y) = model.at(x, y);
        all.at(x + 2 * plane.width, y) = residual.at(x, y);
      }
    write_image(picture, all);
  }
  return s;
}

void compare(const std::string& name) {
  Case c(name);
  Renderer renderer(c.surface);
  RenderOptions options;
  options.derivatives = false;
  if (const char* n = std::getenv("RAYS")) options.rays_per_axis = atoi(n);
  if (const char* n = std::getenv("WIDTH")) options.filter_width_px = atof(n);
  for (const ExampleSpec& e : c.capture.examples)
    for (const PhotoSpec& p : e.photos) {
      const char* folder = std::getenv("HOOKEYE_PICTURES");
      const Score s = score(c, renderer, e, p, options,
                            folder ? fmt::format("{}/{}_{}_{}.png", folder, name, e.name, p.camera)
                                   : "");
      fmt::print("{} {} {}: chi {:.3f} mean {:.3f} over {} px\n", name, e.name, p.camera, s.chi,
                 s.mean, s.pixels);
      EXPECT_LT(s.chi, 1.1) << name << " " << e.name << " " << p.camera;
    }
}

TEST(hidden_photos, case_b4_is_noise) {
  HOOKEYE_NEEDS_DATA("hidden/case_b4");
  compare("case_b4");
}

TEST(hidden_photos, case_a2_is_noise) {
  HOOKEYE_NEEDS_DATA("hidden/case_a2");
  compare("case_a2");
}

}  // namespace
}  // namespace hookeye
