// Regions: patches of the rest surface.
#include <fmt/format.h>

#include <charconv>
#include <climits>
#include <vector>

#include "capture_io/capture_reader.h"
#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye {
namespace {

/// Blank-separated 0-based indices; faults carry line and column of the file.
RegionSpec::Faces read_indices(const std::filesystem::path& file, const std::string& name) {
  const std::string text = read_text(file);
  RegionSpec::Faces faces{file, {}, name, {}};
  int line = 1;
  size_t line_start = 0, i = 0;
  while (i < text.size()) {
    if (text[i] == '\n') ++line, line_start = i + 1;
    if (std::isspace(static_cast<unsigned char>(text[i]))) {
      ++i;
      continue;
    }
    size_t end = i;
    while (end < text.size() && !std::isspace(static_cast<unsigned char>(text[end]))) ++end;
    const int column = static_cast<int>(i - line_start) + 1;
    long value = -1;
    const auto [stop, error] = std::from_chars(text.data() + i, text.data() + end, value);
    if (stop != text.data() + end || error != std::errc() || value < 0 || value > INT_MAX)
      throw InputError({name, line, column},
                       fmt::format("`{}` is no triangle of the surface",
                                   text.substr(i, std::min<size_t>(end - i, 40))),
                       "0-based indices of triangles are expected, separated by blanks");
    faces.triangles.push_back(static_cast<int>(value));
    faces.told_at.push_back({line, column});
    i = end;
  }
  if (faces.triangles.empty())
    throw InputError({name}, "the list of triangles is empty",
                     "0-based indices of triangles are expected, separated by blanks");
  return faces;
}

RegionSpec::Box read_box(const YamlNode& node, const std::string& of) {
  if (node.kind != YamlNode::Kind::sequence || node.items.size() != 2)
    unexpected(node, "box" + of, "two corners are expected: [[x, y, z], [x, y, z]]");
  RegionSpec::Box box{read_vector3(node.items[0], "low corner" + of),
                      read_vector3(node.items[1], "high corner" + of)};
  for (int i = 0; i < 3; ++i)
    if (box.low[i] > box.high[i])
      throw InputError(node.place,
                       fmt::format("box{} is empty: its {} runs from {} to {}", of, "xyz"[i],
                                   box.low[i], box.high[i]),
                       "the first corner holds the smaller coordinates");
  return box;
}

RegionSpec read_region(const YamlNode::Entry& entry, const CaptureFolder& folder) {
  const std::string what = fmt::format("region `{}`", entry.key);
  const std::string of = " of " + what;
  const std::vector<std::string> shapes{"box", "faces", "sphere", "halfspace", "group"};
  const YamlSection section(entry.value, what, shapes);
  const std::string shape = section.one_of(shapes);
  const YamlNode& value = *section.find(shape);
  RegionSpec region;
  region.name = entry.key;
  region.place = entry.place;
  if (shape == "box") {
    region.shape = read_box(value, of);
  } else if (shape == "faces") {
    const std::filesystem::path file = read_file_path(value, "faces" + of, folder);
    try {
      region.shape = read_indices(file, (folder.given / value.text).string());
    } catch (const InputError& error) {
      throw told_at(value.place, error);
    }
  } else if (shape == "sphere") {
    const YamlSection sphere(value, "sphere" + of, {"center", "radius"});
    const std::string right = "write `sphere: {center: [0, 0, 0], radius: 5}`";
    region.shape = RegionSpec::Sphere{read_vector3(sphere.need("center", right), "center" + of),
                                      read_positive(sphere.need("radius", right), "radius" + of)};
  } else if (shape == "halfspace") {
    const YamlSection half(value, "halfspace" + of, {"point", "normal"});
    const std::string right = "write `halfspace: {point: [0, 0, 80], normal: [0, 0, 1]}`";
    region.shape = RegionSpec::Halfspace{read_vector3(half.need("point", right), "point" + of),
                                         read_direction(half.need("normal", right), "normal" + of)};
  } else {
    region.shape = RegionSpec::Group{read_string(value, "group" + of)};
  }
  return region;
}

}  // namespace

std::vector<RegionSpec> read_regions(const YamlNode& node, const CaptureFolder& folder) {
  std::vector<RegionSpec> regions;
  for (const YamlNode::Entry& entry : read_named(node, "regions"))
    regions.push_back(read_region(entry, folder));
  return regions;
}

}  // namespace hookeye
