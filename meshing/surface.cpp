// Reads the triangle surface. The only file that touches tinyobjloader (its double variant).
#define TINYOBJLOADER_USE_DOUBLE
#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <vector>

#include "core/input_error.h"
#include "core/text_file.h"
#include "meshing/detail.h"
#include "meshing/surface_mesh.h"
#include "meshing/whole_numbers.h"

namespace hookeye {
namespace {

using detail::TriangleSoup;

/// Line of the n-th statement `word` of an obj file (0-based), 0 when there are fewer.
int line_of(const std::filesystem::path& file, const std::string& word, int n) {
  std::ifstream in(file);
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const size_t first = line.find_first_not_of(" \t");
    if (first == std::string::npos || line.compare(first, word.size(), word) != 0) continue;
    const size_t after = first + word.size();
    if (after < line.size() && (line[after] == ' ' || line[after] == '\t') && n-- == 0) {
      return number;
    }
  }
  return 0;
}

/// The library's own number parser is an ulp off and reads what it cannot parse as 0; so numbers
/// are read here, strictly and exactly, and the faces by the library.
void read_numbers(const std::filesystem::path& file, std::vector<Vector3d>& points,
                  std::vector<Vector2d>& uv) {
  std::ifstream in(file);
  std::string line, field;
  for (int number = 1; std::getline(in, line); ++number) {
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // a byte order mark
    if (line.find('\0') != std::string::npos)
      throw InputError({file.string(), number}, "there is a zero byte: this is no text",
                       "the file as it was written, in ASCII or UTF-8");
    std::istringstream fields(line);
    if (line.starts_with("f ")) detail::check_whole_numbers(line, {file.string(), number});
    if (!(fields >> field) || (field != "v" && field != "vt")) continue;
    const int needed = field == "v" ? 3 : 2;
    Vector3d values = Vector3d::Zero();
    for (int k = 0; k < needed; ++k) {
      char* end = nullptr;
      const bool there = static_cast<bool>(fields >> field);
      if (there) values[k] = std::strtod(field.c_str(), &end);
      if (!there || *end != '\0' || !std::isfinite(values[k])) {
        throw InputError({file.string(), number},
                         there ? fmt::format("'{}' is no finite number", field)
                               : fmt::format("fewer than {} numbers", needed),
                         fmt::format("{} finite numbers", needed));
      }
    }
    if (needed == 3) {
      points.push_back(values);
    } else {
      uv.push_back(values.head<2>());
    }
  }
}

/// Faces arrive through callbacks in file order; groups and objects do not matter here.
class ObjParser {
 public:
  explicit ObjParser(std::filesystem::path file) : file_(std::move(file)) {}

  TriangleSoup parse() {
    read_numbers(file_, points_, uv_);
    std::ifstream in(file_);
    if (!in) throw InputError({file_.string()}, "cannot be read", "a readable obj file");
    tinyobj::callback_t callback;
    callback.index_cb = [](void* self, tinyobj::index_t* corners, int n) {
      static_cast<ObjParser*>(self)->add_face(corners, n);
    };
    std::string warnings, errors;
    if (!tinyobj::LoadObjWithCallback(in, callback, this, nullptr, &warnings, &errors)) {
      throw InputError({file_.string()}, "is no valid obj file: " + errors,
                       "vertices `v x y z` and triangles `f a b c`");
    }
    if (with_uv_ > 0 && first_without_uv_ >= 0) {
      fault(first_without_uv_, "has no texture coordinates though other triangles have",
            "texture coordinates on all triangles (`f v/vt v/vt v/vt`) or on none");
    }
    return finished(with_uv_ > 0);
  }

 private:
  [[noreturn]] void fault(int face, const std::string& wrong, const std::string& right) const {
    throw InputError({file_.string(), line_of(file_, "f", face)},
                     fmt::format("face {} {}", face, wrong), right);
  }

  /// obj indices count from 1, negative ones from the end.
  template <class List>
  int resolve(int index, const List& list, const char* what) const {
    const int size = static_cast<int>(list.size());
    const int i = index > 0 ? index - 1 : size + index;
    if (index == 0 || i < 0 || i >= size) {
      fault(face_, fmt::format("names {} {}, but there are {}", what, index, size),
            fmt::format("an index from 1 to {}", size));
    }
    return i;
  }

  void add_face(const tinyobj::index_t* corners, int n) {
    if (n != 3) {
      fault(face_, fmt::format("has {} corners", n), "triangles only: triangulate the surface");
    }
    std::array<Vector2d, 3> uv;
    bool has_uv = true;
    for (int k = 0; k < 3; ++k) {
      corners_.push_back(resolve(corners[k].vertex_index, points_, "vertex"));
      if (corners[k].texcoord_index == 0) {
        has_uv = false;
      } else {
        uv[k] = uv_[resolve(corners[k].texcoord_index, uv_, "texture coordinate")];
      }
    }
    if (has_uv) {
      ++with_uv_;
    } else if (first_without_uv_ < 0) {
      first_without_uv_ = face_;
    }
    soup_.uv.push_back(uv);
    ++face_;
  }

  TriangleSoup finished(bool keep_uv) {
    soup_.corners.resize(3, static_cast<Eigen::Index>(corners_.size()));
    for (size_t i = 0; i < corners_.size(); ++i) {
      soup_.corners.col(static_cast<Eigen::Index>(i)) = points_[corners_[i]];
    }
    if (!keep_uv) soup_.uv.clear();
    return std::move(soup_);
  }

  std::filesystem::path file_;
  std::vector<Vector3d> points_;
  std::vector<Vector2d> uv_;
  std::vector<int> corners_;
  TriangleSoup soup_;
  int face_ = 0, with_uv_ = 0, first_without_uv_ = -1;
};

SurfaceMesh welded(const TriangleSoup& soup, const std::filesystem::path& file) {
  SurfaceMesh out;
  std::map<std::array<double, 3>, int> vertex_at;
  std::vector<Vector3d> points;
  const Eigen::Index triangles = soup.corners.cols() / 3;
  for (Eigen::Index t = 0; t < triangles; ++t) {
    std::array<int, 3> triangle;
    for (int k = 0; k < 3; ++k) {
      const Vector3d x = soup.corners.col(3 * t + k);
      if (!x.allFinite()) {
        throw InputError({file.string()},
                         fmt::format("corner {} of triangle {} is not a finite number", k, t),
                         "finite coordinates");
      }
      const std::array<double, 3> key{x.x() + 0.0, x.y() + 0.0, x.z() + 0.0};  // -0 is 0
      const auto [it, fresh] = vertex_at.try_emplace(key, static_cast<int>(points.size()));
      if (fresh) points.push_back(x);
      triangle[k] = it->second;
    }
    out.triangles.push_back(triangle);
  }
  out.X.resize(3, static_cast<Eigen::Index>(points.size()));
  for (size_t i = 0; i < points.size(); ++i) out.X.col(static_cast<Eigen::Index>(i)) = points[i];
  out.uv = soup.uv;
  for (size_t t = 0; t < out.uv.size(); ++t) {
    for (const Vector2d& uv : out.uv[t]) {
      if (!uv.allFinite()) {
        throw InputError({file.string()},
                         fmt::format("a texture coordinate of triangle {} is not finite", t),
                         "finite texture coordinates");
      }
    }
  }
  return out;
}

}  // namespace

SurfaceMesh read_surface(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) {
    throw InputError({file.string()}, "there is no such file", "a surface file: obj, ply or stl");
  }
  std::string kind = file.extension().string();
  std::transform(kind.begin(), kind.end(), kind.begin(),
                 [](unsigned char c) { return tolower(c); });
  TriangleSoup soup;
  if (kind == ".obj") {
    soup = ObjParser(file).parse();
  } else if (kind == ".ply") {
    soup = detail::read_ply(file);
  } else if (kind == ".stl") {
    soup = detail::read_stl(file);
  } else {
    throw InputError({file.string()}, fmt::format("surfaces of kind '{}' are not read", kind),
                     "obj, ply or stl");
  }
  if (soup.corners.cols() == 0) {
    throw InputError({file.string()}, "holds no triangles", "a closed surface of triangles");
  }
  return welded(soup, file);
}

void write_surface_obj(const std::filesystem::path& file, const SurfaceMesh& surface,
                       const Eigen::Matrix3Xd& normals) {
  std::string text;
  auto out = std::back_inserter(text);
  for (Eigen::Index i = 0; i < surface.X.cols(); ++i) {
    fmt::format_to(out, "v {} {} {}\n", surface.X(0, i), surface.X(1, i), surface.X(2, i));
  }
  for (const auto& triangle : surface.uv) {
    for (const Vector2d& uv : triangle) fmt::format_to(out, "vt {} {}\n", uv.x(), uv.y());
  }
  for (const auto& n : normals.colwise()) {
    fmt::format_to(out, "vn {} {} {}\n", n.x(), n.y(), n.z());
  }
  for (size_t t = 0; t < surface.triangles.size(); ++t) {
    fmt::format_to(out, "f");
    for (int k = 0; k < 3; ++k) {
      const int vertex = surface.triangles[t][k] + 1;
      fmt::format_to(out, " {}", vertex);
      if (!surface.uv.empty()) fmt::format_to(out, "/{}", 3 * t + k + 1);
      if (normals.cols() > 0) fmt::format_to(out, "{}/{}", surface.uv.empty() ? "/" : "", vertex);
    }
    fmt::format_to(out, "\n");
  }
  write_text(file, text);
}

}  // namespace hookeye
