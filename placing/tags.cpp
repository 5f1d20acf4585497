#include "placing/tags.h"

#include <fmt/format.h>

#include <cmath>

#include "placing/field_lines.h"

namespace hookeye {

namespace {

constexpr const char* kRightTag =
    "ID SIZE  x y z of the centre  to the right  down, as `7 12  0 -10 40  1 0 0  0 0 -1`";
/// Cosine of what two sides may be off right angles: a degree, as typed directions are.
constexpr double kSkew = 0.0175;

BodyTag tag_in(const FieldLine& line) {
  const std::vector<double> all = numbers_in(line.fields, 0, 11);
  if (all.empty()) throw InputError(line.place, "this line is no tag of eleven numbers", kRightTag);
  BodyTag tag;
  tag.place = line.place;
  if (all[0] < 0.0 || all[0] > 1e6 || all[0] != std::floor(all[0]))
    throw InputError(line.place, fmt::format("{:g} is no number of a tag", all[0]), kRightTag);
  if (!(all[1] > 0.0))
    throw InputError(line.place, fmt::format("the tag is {:g} wide", all[1]),
                     "the side of its black square, in the unit of the body's file");
  tag.id = static_cast<int>(all[0]), tag.size = all[1];
  tag.centre = Vector3d(all[2], all[3], all[4]);
  tag.right = Vector3d(all[5], all[6], all[7]), tag.down = Vector3d(all[8], all[9], all[10]);
  for (Vector3d* side : {&tag.right, &tag.down}) {
    if (!(side->norm() > 0.0))
      throw InputError(line.place, "a direction of the tag is (0, 0, 0)", kRightTag);
    side->normalize();
  }
  if (std::abs(tag.right.dot(tag.down)) > kSkew)
    throw InputError(line.place, "`to the right` and `down` are not at right angles", kRightTag);
  return tag;
}

}  // namespace

Vector3d BodyTag::corner(int k) const {
  const double x = k == 1 || k == 2 ? 0.5 : -0.5, y = k >= 2 ? 0.5 : -0.5;
  return centre + size * (x * right + y * down);
}

std::vector<BodyTag> read_tags(const std::filesystem::path& file) {
  std::vector<BodyTag> out;
  for (const FieldLine& line : field_lines(file)) {
    out.push_back(tag_in(line));
    for (size_t i = 0; i + 1 < out.size(); ++i)
      if (out[i].id == out.back().id)
        throw InputError(line.place,
                         fmt::format("tag {} stands in line {}, too", out[i].id, out[i].place.line),
                         "tags with different numbers: two alike cannot be told apart");
  }
  if (out.empty()) throw InputError({file.string()}, "there is no tag in this file", kRightTag);
  return out;
}

}  // namespace hookeye
