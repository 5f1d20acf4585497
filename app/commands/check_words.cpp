#include "app/commands/check_words.h"

#include <fmt/format.h>

#include "app/commands/describe.h"
#include "capture_io/field_start.h"
#include "capture_io/strain_field.h"

namespace hookeye {

namespace {

std::string motion_text(const SupportSpec& support) {
  const RigidMotion& rigid = support.rigid;
  std::string text = "rigid";
  if (rigid.degrees != 0.0)
    text += fmt::format(" {:+.4g} degrees about {}", rigid.degrees, vector_text(rigid.axis));
  if (!rigid.move.isZero(0.0)) text += " moved " + vector_text(rigid.move);
  return text;
}

}  // namespace

std::string support_text(const SupportSpec& support) {
  if (support.kind == SupportSpec::Kind::rigid_fit) return support.region + ": rigid, fitted";
  if (support.kind == SupportSpec::Kind::rigid) return support.region + ": " + motion_text(support);
  std::string text = support.region + ":";
  for (int i = 0; i < 3; ++i)
    if (support.displacement[i])
      text += fmt::format(" {} {:+.4g}", "xyz"[i], *support.displacement[i]);
  return text;
}

std::string load_text(const LoadSpec& load, const Units& units) {
  if (load.force)
    return fmt::format("{}: {} {}", load.region, vector_text(*load.force), units.force);
  return fmt::format("{}: pressure {:.4g} {}", load.region, load.pressure.value_or(0.0),
                     units.stress());
}

std::string measured_text(const MeasuredSpec& measured) {
  if (measured.field) {
    const FieldSpec& field = *measured.field;
    const std::string& start = start_of(measured);
    const std::string from = start.empty() ? "" : " from " + start;
    if (field.strain)
      return fmt::format("field of {} strains at {} points{}{}", name_of(field.strain->measure),
                         field.X.cols(), field.components == 2 ? " (exx, eyy)" : "", from);
    return fmt::format("field of {} points{}{}", field.X.cols(),
                       field.components == 2 ? " (in plane)" : "", from);
  }
  if (measured.kind == MeasuredSpec::Kind::strain_of)
    return fmt::format("strain from {} to {}", vector_text(measured.point),
                       vector_text(measured.direction));
  return fmt::format("{} {}", kind_of(measured).words,
                     measured.region.empty() ? vector_text(measured.point) : measured.region);
}

std::string texture_text(const BodySpec& body) {
  const std::string normals = body.flat_shading ? "flat facets" : "smooth normals";
  switch (body.texture) {
    case BodySpec::Texture::none:
      return "none told";
    case BodySpec::Texture::image:
      return body.texture_image.path.filename().string() + ", " + normals;
    case BodySpec::Texture::rest:
      return "the photos of example " + body.texture_example;
    case BodySpec::Texture::uniform:
      return (body.uniform_albedo ? fmt::format("uniform albedo {:.4g}", *body.uniform_albedo)
                                  : "uniform albedo, fitted") +
             ", " + normals;
  }
  return {};
}

std::string light_text(const Capture& capture) {
  if (capture.body.texture == BodySpec::Texture::none) return "none needed";
  if (capture.body.texture == BodySpec::Texture::rest) return "in the photos";
  const LightSpec& light = capture.light;
  if (!light.given && !light.fit_harmonics) return "not told: fitted";
  const std::string sun = light.sun.isZero(0.0)
                              ? "no sun"
                              : fmt::format("sun {:.4g} from {}", light.sun.norm(),
                                            vector_text(light.sun.normalized()));
  if (light.fit_harmonics) return "harmonics, fitted; " + sun;
  if (light.uneven.isZero(0.0)) return fmt::format("ambient {:.4g}, {}", light.ambient, sun);
  const Irradiance E(light.ambient, light.uneven);
  return fmt::format("harmonics, {:.4g} in the mean, {:.4g} at most, {:.4g} at least{}; {}",
                     light.ambient, E.most(), E.least(),
                     E.least() < 0.0 ? " (below 0 is black)" : "", sun);
}

std::string background_text(const BackgroundSpec& background) {
  switch (background.kind) {
    case BackgroundSpec::Kind::ignore:
      return "ignored";
    case BackgroundSpec::Kind::level:
      return background.level == 0.0 ? "black" : fmt::format("{:.4g}", background.level);
    case BackgroundSpec::Kind::fit:
      return "fitted";
    case BackgroundSpec::Kind::photo:
      return background.photo.filename().string();
  }
  return {};
}

std::string encoding_text(const PhotoSpec& spec) {
  if (!spec.encoding) return spec.kind == PhotoSpec::Kind::silhouette ? "linear" : "by format";
  switch (spec.encoding->kind) {
    case Encoding::Kind::linear:
      return "linear";
    case Encoding::Kind::srgb:
      return "srgb";
    case Encoding::Kind::gamma:
      return fmt::format("gamma {:.4g}", spec.encoding->gamma);
  }
  return {};
}

}  // namespace hookeye
