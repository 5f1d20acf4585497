#include "placing/edit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "capture_io/yaml_edit.h"
#include "core/text_file.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

/// Ten digits; what rounding makes of zero is 0.
std::string number(double x, double scale) {
  return std::abs(x) < 1e-10 * scale ? "0" : fmt::format("{:.10g}", x);
}

std::string list(const Eigen::Vector3d& v, double scale) {
  return fmt::format("[{}, {}, {}]", number(v.x(), scale), number(v.y(), scale),
                     number(v.z(), scale));
}

}  // namespace

std::string placement_text(const ToldPlacement& placement) {
  std::string rows;
  for (int i = 0; i < 3; ++i) rows += (i ? ", " : "") + list(placement.R.row(i).transpose(), 1.0);
  const double size = std::max(placement.t.norm(), 1e-3);  // what is left of zero is zero
  return fmt::format("{{rotation: [{}], translation: {}{}}}", rows, list(placement.t, size),
                     placement.fit ? ", fit: true" : "");
}

std::string placed_text(const std::string& text, const std::string& file,
                        const ToldPlacement& placement) {
  const YamlNode before = parse_yaml(text, file);
  const YamlNode::Entry* body = before.entry("body");
  const std::string value = placement_text(placement);
  if (body && body->value.kind == YamlNode::Kind::map && !body->value.entries.empty()) {
    try {
      // Right below `body:`, so that comments stay with the keys that they stand above.
      const std::string out =
          edited_yaml(text, file, {.path = {"body", "placement"}, .value = value, .first = true});
      const ToldPlacement got = placement_of_capture(parse_yaml(out, file));
      const double size = std::max(placement.t.norm(), 1e-3);
      if (got.fit == placement.fit && (got.R - placement.R).norm() < 1e-8 &&
          (got.t - placement.t).norm() <= 1e-8 * size)
        return out;
    } catch (const InputError&) {
      // told below
    }
  }
  throw InputError(body ? body->place : Place{file},
                   "the placement cannot be written into this file without changing more of it",
                   "write it below `body:` by hand: `placement: " + value + "`");
}

std::string store_placed(const fs::path& file, const ToldPlacement& placement, bool dry) {
  const std::string text = placed_text(read_text(file), file.string(), placement);
  store_capture(file, text, dry);
  return text;
}

}  // namespace hookeye
