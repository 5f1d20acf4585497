// Are stored values linear where that is told, sRGB where that is? Two kinds of evidence: codes
// that can only come of 8 bits put from one into the other, and how bright and dark speckles
// compare with the told texture.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "estimation/inspection/codes.h"
#include "estimation/inspection/question.h"

namespace hookeye::inspection {

namespace {

double from_srgb(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }
double to_srgb(double l) {
  return l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1.0 / 2.4) - 0.055;
}

/// As read_photo() reads it.
Encoding encoding_of(const PhotoSpec& spec, int bits) {
  if (spec.encoding) return *spec.encoding;
  return {bits == 8 ? Encoding::Kind::srgb : Encoding::Kind::linear, 1.0};
}

bool linear(const Encoding& encoding) {
  return encoding.kind == Encoding::Kind::linear ||
         (encoding.kind == Encoding::Kind::gamma && encoding.gamma == 1.0);
}

/// Whether all codes of [low, high), of which there are many, are among those that `map` makes of
/// 8 bits, which leaves gaps there.
bool made_by(const Codes& codes, double (*map)(double), int low, int high) {
  constexpr int kMany = 12;
  std::vector<unsigned char> can(256, 0);
  for (int k = 0; k < 256; ++k) can[static_cast<size_t>(std::lround(255.0 * map(k / 255.0)))] = 1;
  for (int code = low; code < high; ++code)
    if (codes.used[static_cast<size_t>(code)] && !can[static_cast<size_t>(code)]) return false;
  return codes.used_between(low, high) >= kMany;
}

/// -1: linear values were put into sRGB, 1: sRGB into linear ones, 0: neither is known.
int put_through(const Codes& codes) {
  if (codes.bits != 8) return 0;
  if (made_by(codes, to_srgb, 1, 90)) return -1;
  if (made_by(codes, from_srgb, 130, 256)) return 1;
  return 0;
}

/// A linear intensity of the photo, read as told, if it were stored the other way.
double read_otherwise(double value, bool told_linear) {
  return told_linear ? from_srgb(std::clamp(value, 0.0, 1.0)) : to_srgb(std::max(value, 0.0));
}

/// The photo at a place between pixels; NaN: off the picture.
double between_pixels(const Image& photo, double x, double y) {
  const int u = static_cast<int>(std::floor(x)), v = static_cast<int>(std::floor(y));
  if (u < 0 || v < 0 || u + 1 >= photo.width || v + 1 >= photo.height) return NAN;
  const double fx = x - u, fy = y - v;
  return (1 - fy) * ((1 - fx) * photo.at(u, v) + fx * photo.at(u + 1, v)) +
         fy * ((1 - fx) * photo.at(u, v + 1) + fx * photo.at(u + 1, v + 1));
}

/// What is left of photo = gain times model over the found patches, each with its own gain, as a
/// share of the photo's squares: as read, and read otherwise. The light varies little in a patch,
/// so that nothing but the texture's bright and dark is compared.
struct Misfits {
  double as_told = 0.0, otherwise = 0.0, patches = 0.0;
};

Misfits misfits(const Image& model, const Image& photo, const PatchField& field, int side,
                bool told_linear) {
  Misfits out;
  const int half = side / 2;
  for (const Patch& patch : field.patches) {
    if (!patch.found) continue;
    double mm = 0.0, pp[2] = {}, pm[2] = {};
    for (int y = int(patch.at.y()) - half; y <= int(patch.at.y()) + half; ++y)
      for (int x = int(patch.at.x()) - half; x <= int(patch.at.x()) + half; ++x) {
        const double value = between_pixels(photo, x + patch.shift.x(), y + patch.shift.y());
        if (std::isnan(value)) continue;
        const double m = model.at(x, y), p[2] = {value, read_otherwise(value, told_linear)};
        mm += m * m;
        for (int k = 0; k < 2; ++k) pp[k] += p[k] * p[k], pm[k] += p[k] * m;
      }
    if (!(mm > 0.0 && pp[0] > 0.0 && pp[1] > 0.0)) continue;
    out.as_told += 1.0 - pm[0] * pm[0] / (pp[0] * mm);
    out.otherwise += 1.0 - pm[1] * pm[1] / (pp[1] * mm);
    out.patches += 1.0;
  }
  return out;
}

}  // namespace

void ask_encoding(Sight& sight, Warnings& warnings) {
  std::set<std::string> said;
  const auto told_at = [&](const PhotoSpec& spec) {
    return warnings.has({"photos", "encoding"}) ? warnings.place({"photos", "encoding"})
                                                : spec.place;
  };
  const auto all = stored_codes(sight);
  for (const Codes& codes : all) {
    const PhotoSpec& spec = sight.spec(codes.first);
    const bool told_linear = linear(encoding_of(spec, codes.bits));
    const int through = put_through(codes);
    if (through == 0 || (through > 0) == told_linear) continue;
    said.insert(spec.camera);
    warnings.say(
        told_at(spec),
        fmt::format(
            "the photos of camera `{}` are read as {}, but their values have the gaps of 8 bits "
            "that were put from {}",
            spec.camera, told_linear ? "linear" : "sRGB",
            told_linear ? "linear to sRGB" : "sRGB to linear"),
        told_linear ? "`encoding: srgb`" : "`encoding: linear`");
  }
  for (const Codes& codes : all) {
    const PhotoSpec& spec = sight.spec(codes.first);
    if (said.count(spec.camera) > 0 || sight.doubted(spec.camera)) continue;
    const PhotoIndex photo = *sight.reference(spec.camera);
    const auto picture = sight.told_picture(photo);
    const Agreement& agreement = sight.agreement(photo);
    if (!picture || !(agreement.share >= sight.options().found_share)) continue;
    const bool told_linear = linear(encoding_of(spec, codes.bits));
    const Misfits left = misfits(picture->I, sight.small(photo).I, agreement.patches,
                                 sight.options().patch_px, told_linear);
    if (left.as_told < sight.options().times_better_read * left.otherwise) continue;
    const double better = std::sqrt(left.as_told / left.otherwise);
    const std::string right =
        fmt::format("`encoding: {}` (or the texture's is wrong)", told_linear ? "srgb" : "linear");
    if (!warnings.also(right,
                       fmt::format("those of camera `{}` {:.1f} times", spec.camera, better)))
      warnings.say(
          told_at(spec),
          fmt::format("the photos of camera `{}` are read as {}; read as {} their bright and "
                      "dark speckles fit the texture {:.1f} times better",
                      spec.camera, told_linear ? "linear" : "sRGB", told_linear ? "sRGB" : "linear",
                      better),
          right);
  }
}

}  // namespace hookeye::inspection
