// Does a camera see the body where its photo shows it? Where not, which of the usual slips explains
// it: a pose or a photo the wrong way round, cameras or photos in one another's places.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "estimation/inspection/apart.h"
#include "estimation/inspection/question.h"

namespace hookeye::inspection {

namespace {

/// A way to see a camera's photo that fits.
struct Explanation {
  std::string name, seen, right;
  std::string key;  ///< below the camera: where it is told; "": at the photo
  Agreement agreement;
};

/// One number to compare explanations of one camera by.
double score(const Agreement& a) {
  return (std::isnan(a.share) ? 0.0 : 2.0 * a.share) + (std::isnan(a.overlap) ? 0.0 : a.overlap);
}

/// Photos that are each other's texture show it in other places: no load moves it between them.
bool far_off(const Sight& sight, PhotoIndex photo, const Agreement& a) {
  const InspectionOptions& options = sight.options();
  const BodySpec& body = sight.scene().capture.body;
  if (body.texture != BodySpec::Texture::rest ||
      photo.first != sight.scene().example_index(body.texture_example))
    return false;
  const Camera camera = sight.camera(photo);
  return a.share >= options.found_share &&
         a.shift_px > options.lost_shift * std::hypot(camera.width, camera.height);
}

/// A clamp or a table in view lowers the overlap, but says nothing of the camera.
bool astray(Sight& sight, PhotoIndex photo) {
  const InspectionOptions& options = sight.options();
  const Agreement& a = sight.agreement(photo);
  if (far_off(sight, photo, a)) return true;
  if (!std::isnan(a.share)) return a.share < options.lost_share;
  if (!sight.small(photo).foreground.told || !(a.overlap < options.lost_overlap)) return false;
  const auto parted = apart(sight, photo);
  return !parted || parted->without_still < options.lost_overlap;
}

bool fits(const Agreement& a, const Agreement& as_told, const InspectionOptions& options) {
  if (!std::isnan(a.share))
    return a.share >= options.found_share && !(a.overlap < as_told.overlap - 0.1);
  return std::isnan(as_told.share) && a.overlap >= options.found_overlap &&
         a.overlap >= as_told.overlap + 0.1;
}

std::string numbers(const Agreement& a) {
  std::string text;
  if (!std::isnan(a.overlap)) text = fmt::format("overlap {:.2f}", a.overlap);
  if (!std::isnan(a.share))
    text +=
        fmt::format("{}{:.0f} % of its texture found", text.empty() ? "" : ", ", 100.0 * a.share);
  if (a.shift_px >= 1.0) text += fmt::format(", {:.0f} px off", a.shift_px);
  return text;
}

const char* key_of(Flip::Of of) {
  switch (of) {
    case Flip::Of::pose:
      return "pose";
    case Flip::Of::intrinsics:
      return "intrinsics";
    default:
      return "";
  }
}

bool same_size(const Sight& sight, PhotoIndex one, PhotoIndex other) {
  const Camera a = sight.camera(one), b = sight.camera(other);
  return a.width == b.width && a.height == b.height;
}

/// Photos of other cameras and of other examples in the place of this one.
void try_swaps(Sight& sight, PhotoIndex photo, std::vector<Explanation>* out) {
  for (const PhotoIndex& other : sight.photos()) {
    if (other == photo || !same_size(sight, photo, other)) continue;
    const bool same_example = other.first == photo.first;
    const bool same_camera = sight.spec(other).camera == sight.spec(photo).camera;
    if (same_example == same_camera) continue;
    Trial trial;
    trial.swapped = {{photo, other}, {other, photo}};
    trial.least_overlap = sight.options().lost_overlap;
    const Agreement agreement = sight.agreement(photo, trial);
    out->push_back({same_example ? "photos_swapped" : "photo_of_another_example",
                    fmt::format("the photo {} stands here", sight.told(other)),
                    same_example ? "swap the photos, or the cameras' calibrations"
                                 : "hand over the photo of this example",
                    "", agreement});
  }
}

void try_flips(Sight& sight, PhotoIndex photo, const std::vector<Flip>& flips,
               std::vector<Explanation>* out) {
  const bool from_photos = sight.scene().capture.body.texture == BodySpec::Texture::rest;
  for (const bool sources : {true, false})
    for (const Flip& flip : flips) {
      if (!sources && !from_photos) continue;
      Trial trial;
      trial.flip = &flip, trial.sources = sources;
      trial.least_overlap = sight.options().lost_overlap;
      out->push_back(
          {flip.name, flip.seen, flip.right, key_of(flip.of), sight.agreement(photo, trial)});
      if (flip.of == Flip::Of::texture) out->back().key = "texture";
    }
}

/// Those that fit, the best first. Two slips at once are sought where no single one is enough.
std::vector<Explanation> explanations(Sight& sight, PhotoIndex photo) {
  std::vector<Explanation> all, out;
  const Agreement& told = sight.agreement(photo);
  const auto keep_what_fits = [&] {
    for (Explanation& one : all)
      if (fits(one.agreement, told, sight.options()) && !far_off(sight, photo, one.agreement))
        out.push_back(std::move(one));
    all.clear();
  };
  try_flips(sight, photo, usual_flips(), &all);
  try_swaps(sight, photo, &all);
  keep_what_fits();
  if (out.empty()) {
    try_flips(sight, photo, paired_flips(), &all);
    keep_what_fits();
  }
  std::stable_sort(out.begin(), out.end(), [](const Explanation& a, const Explanation& b) {
    return score(a.agreement) > score(b.agreement);
  });
  return out;
}

Place place_of(const Sight& sight, const Warnings& warnings, PhotoIndex photo,
               const std::string& key) {
  if (key.empty()) return sight.spec(photo).place;
  if (key == "texture") return sight.scene().capture.body.texture_place;
  return warnings.place({"cameras", sight.spec(photo).camera, key});
}

}  // namespace

void ask_flips(Sight& sight, Warnings& warnings) {
  if (sight.scene().capture.body.fit_placement) return;  // nobody knows yet where the body stands
  for (const PhotoIndex& photo : sight.references()) {
    const Agreement& told = sight.agreement(photo);
    if (!astray(sight, photo)) continue;
    const auto all = explanations(sight, photo);
    const std::string camera = sight.spec(photo).camera;
    sight.doubt(camera);
    const std::string right =
        all.empty()
            ? "look at the drawn photos (`check -o DIR`): at pose, intrinsics and the body's place"
            : all.front().right;
    const std::string but = all.empty() ? ""
                                        : fmt::format(", but does if {} ({})", all.front().seen,
                                                      numbers(all.front().agreement));
    if (all.empty() && !is_rest(sight.example(photo.first))) continue;
    if (warnings.also(right,
                      fmt::format("nor does camera `{}` ({}){}", camera, numbers(told), but)))
      continue;
    warnings.say(
        all.empty() ? warnings.place({"cameras", camera})
                    : place_of(sight, warnings, photo, all.front().key),
        fmt::format(
            "camera `{}` does not see the body where its photo of example `{}` shows it ({}){}",
            camera, sight.example(photo.first).name, numbers(told), but),
        right);
  }
}

}  // namespace hookeye::inspection
