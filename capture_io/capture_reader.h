// The sections of capture.yaml, one reader each; read_capture() calls them in this order, so that a
// section may refer to those before it. All throw InputError.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "capture_io/capture.h"
#include "capture_io/yaml_section.h"

namespace hookeye {

/// In the order of MeasuredSpec::Kind.
std::span<const MeasuredKind> measured_kinds();

/// Keys of the top level.
const std::vector<std::string>& capture_keys();
void check_version(const YamlSection& top);
/// On one line.
std::string read_title(const YamlNode& node);
/// What can only be checked once all sections are known.
void check_together(const Capture& capture);

Units read_units(const YamlNode& node);
BodySpec read_body(const YamlNode& node, const CaptureFolder& folder);
/// Fills materials, fit, fit_places and gravity.
void read_model(const YamlNode& node, Capture& capture);
std::vector<Camera> read_cameras(const YamlNode& node, const CaptureFolder& folder);
LightSpec read_light(const YamlNode& node);
/// Nine told numbers.
void read_harmonics(const YamlNode& node, LightSpec& light);
std::vector<RegionSpec> read_regions(const YamlNode& node, const CaptureFolder& folder);

/// The photo keys that may stand once for all.
struct PhotoDefaults {
  PhotoSpec photo;          ///< without camera and file
  bool kind_given = false;  ///< silhouettes by default: encoding and noise hold for them
};
PhotoDefaults read_photo_defaults(const YamlNode& node, const CaptureFolder& folder);
/// The photos of one example; sizes and channels are checked against the files' headers.
std::vector<PhotoSpec> read_photos(const YamlNode& node, const std::string& example,
                                   const Capture& capture, const PhotoDefaults& defaults,
                                   const CaptureFolder& folder);
/// An entry `{field: FILE, ...}` of `measured`; `of`: " of example `pull`". Reads the file.
MeasuredSpec read_field(const YamlNode& node, const std::string& of, const Capture& capture,
                        const CaptureFolder& folder);
std::vector<ExampleSpec> read_examples(const YamlNode& node, const Capture& capture,
                                       const PhotoDefaults& defaults, const CaptureFolder& folder);

/// None where `fit` is written, else the number that `read` makes of it; its faults name `fit` too.
std::optional<double> read_or_fit(const YamlNode& node, const std::string& what,
                                  double (*read)(const YamlNode&, const std::string&));
/// `linear`, `srgb` or a gamma number.
Encoding read_encoding(const YamlNode& node, const std::string& what);
/// The names of a capture's parts, for suggestions.
template <class Parts>
std::vector<std::string> names_of(const Parts& parts) {
  std::vector<std::string> names;
  for (const auto& part : parts) names.push_back(part.name);
  return names;
}
/// The header of a picture named in the capture; faults carry the yaml value's place and the name
/// as it is written there.
ImageHeader header_at(const YamlNode& node, const std::filesystem::path& file);

}  // namespace hookeye
