// Triangles of an stl file, text or binary. CGAL 5.5 merges corners that are not finite with
// others, and no other library in Debian 12 reads the format without hundreds of packages (VTK) or
// an ulp beside it (assimp).
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "meshing/detail.h"
#include "meshing/file_cursor.h"

namespace hookeye::detail {
namespace {

constexpr const char* kRight = "a complete stl file of triangles";

/// Bytes of the head of a binary file, and of a triangle: normal, corners, two bytes more.
constexpr size_t kHead = 80, kTriangle = 50;

/// "solid" begins a text, or a binary file whose author did not know that.
bool is_text(std::string_view bytes) {
  const std::string_view head = bytes.substr(0, kHead + 64);
  return lower(head.substr(0, 5)) == "solid" && head.find('\0') == std::string_view::npos;
}

TriangleSoup soup_of(const std::vector<Vector3d>& corners) {
  TriangleSoup soup;
  soup.corners.resize(3, static_cast<Eigen::Index>(corners.size()));
  for (size_t i = 0; i < corners.size(); ++i)
    soup.corners.col(static_cast<Eigen::Index>(i)) = corners[i];
  return soup;
}

TriangleSoup read_binary(FileCursor& in) {
  const size_t size = in.rest().size();
  if (size < kHead + sizeof(uint32_t))
    in.fault("is neither a text that begins with 'solid' nor a binary file with a head", kRight,
             true);
  in.skip(kHead);
  const auto count = in.number<uint32_t>();
  const size_t room = in.rest().size() / kTriangle;
  if (count > room)
    in.fault(fmt::format("the header tells {} triangles, the file has room for {}", count, room),
             kRight, true);
  std::vector<Vector3d> corners;
  corners.reserve(3 * static_cast<size_t>(count));
  for (uint32_t t = 0; t < count; ++t) {
    in.skip(3 * sizeof(float));  // the normal
    for (int k = 0; k < 3; ++k) {
      const float x = in.number<float>(), y = in.number<float>(), z = in.number<float>();
      corners.emplace_back(x, y, z);
    }
    in.skip(2);
  }
  return soup_of(corners);
}

/// Single precision, as a binary file has it: what differs beyond is one corner.
Vector3d corner(FileCursor& in) {
  Vector3d x;
  for (double& value : x) {
    value = in.real();
    if (std::abs(value) > std::numeric_limits<float>::max())
      in.fault(fmt::format("{} is beyond single precision", value), "coordinates below 3e38");
    value = static_cast<float>(value);
  }
  return x;
}

TriangleSoup read_text_stl(FileCursor& in) {
  std::vector<Vector3d> corners;
  bool open = false;
  size_t begun = 0;  // facets
  for (std::string word; !(word = lower(in.word())).empty();) {
    if (word == "solid" || word == "endsolid") {
      open = word == "solid";
      in.line();  // its name
    } else if (word == "facet") {
      ++begun;
    } else if (word == "normal") {
      for (int k = 0; k < 3; ++k) in.word();  // computed anew: some are no numbers
    } else if (word == "vertex") {
      corners.push_back(corner(in));
    } else if (word == "endfacet") {
      const long has = static_cast<long>(corners.size()) - 3 * (static_cast<long>(begun) - 1);
      if (has != 3)
        in.fault(fmt::format("face {} has {} corners", static_cast<long>(begun) - 1, has),
                 "triangles only: triangulate the surface");
    } else if (word != "outer" && word != "loop" && word != "endloop") {
      in.fault(fmt::format("'{}' is no word of an stl file", word), kRight);
    }
  }
  if (open || corners.size() != 3 * begun) in.fault("ends before 'endsolid'", kRight);
  return soup_of(corners);
}

}  // namespace

TriangleSoup read_stl(const std::filesystem::path& file) {
  FileCursor in(file);
  return is_text(in.rest()) ? read_text_stl(in) : read_binary(in);
}

}  // namespace hookeye::detail
