#include "estimation/inspection/sight.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "estimation/evaluation/evaluation.h"
#include "estimation/inspection/load_case.h"
#include "estimation/model/field_points.h"

namespace hookeye::inspection {

namespace {

template <class T>
const T& at(const std::vector<T>& values, int i) {
  return values[static_cast<size_t>(i)];
}

/// Load cases of which something was measured, or where a field begins: questions ask what the
/// nodes of the coarse mesh do there.
std::set<int> measured_somewhere(const Scene& scene) {
  std::set<int> out;
  for (size_t i = 0; i < scene.capture.examples.size(); ++i)
    for (const MeasuredSpec& measured : scene.capture.examples[i].measured) {
      out.insert(static_cast<int>(i));
      if (measured.field) out.insert(start_index(scene, measured));
    }
  return out;
}

}  // namespace

Sight::Sight(const Scene& scene, const InspectionOptions& options,
             const InspectionProgress& progress)
    : scene_(scene), options_(options), progress_(progress), view_(scene) {
  const ModelForm form = base_form(scene.shared_from_this());
  model_ = form.realise(form.initial());
}

Sight::~Sight() = default;

const ExampleSpec& Sight::example(int e) const { return at(scene_.capture.examples, e); }

const PhotoSpec& Sight::spec(PhotoIndex photo) const {
  return at(example(photo.first).photos, photo.second);
}

std::string Sight::told(PhotoIndex photo) const {
  return fmt::format("`{}` of example `{}`", spec(photo).camera, example(photo.first).name);
}

std::vector<PhotoIndex> Sight::photos() const {
  std::vector<PhotoIndex> out;
  for (size_t e = 0; e < scene_.photos.size(); ++e)
    for (size_t k = 0; k < scene_.photos[e].size(); ++k)
      out.emplace_back(static_cast<int>(e), static_cast<int>(k));
  return out;
}

const SmallPhoto& Sight::small(PhotoIndex photo) {
  const auto found = small_.find(photo);
  if (found != small_.end()) return found->second;
  return small_.emplace(photo, small_photo(scene_, photo.first, photo.second, options_))
      .first->second;
}

Camera Sight::camera(PhotoIndex photo) const {
  return at(at(model_.examples, photo.first).photos, photo.second).camera;
}

const CoarseModel* Sight::coarse() {
  if (!coarse_tried_ && options_.first_guess) {
    coarse_ = std::make_unique<CoarseModel>(scene_, options_);
    if (coarse_->refused().empty())
      guesses_ = coarse_->solve(measured_somewhere(scene_), progress_.solved);
  }
  coarse_tried_ = true;
  return coarse_ && coarse_->refused().empty() ? coarse_.get() : nullptr;
}

const FirstGuess* Sight::guess(int e) { return coarse() ? &at(guesses_, e) : nullptr; }

const SoughtInReference& Sight::sought(PhotoIndex reference) {
  const auto known = sought_.find(reference);
  if (known != sought_.end()) return known->second;
  const SmallPhoto& from = small(reference);
  const Camera camera = camera_at_level(this->camera(reference), from.level);
  BodyPicture look = plain_look(camera, shown(reference.first));
  std::vector<unsigned char> body = look.body;
  for (size_t i = 0; i < body.size(); ++i)
    body[i] = body[i] && (from.valid->empty() || (*from.valid)[i]);
  const double reach = options_.moved_reach * std::hypot(from.I->width, from.I->height);
  SoughtInReference out{std::move(look), SoughtPatches(from.I, body, reach, options_)};
  return sought_.emplace(reference, std::move(out)).first->second;
}

const LoadCase& Sight::load_case(int e) {
  auto& kept = load_cases_[e];
  if (!kept) {
    kept = std::make_unique<LoadCase>(inspection::load_case(*this, e));
    freed_.after_one();
    if (progress_.compared)
      progress_.compared(static_cast<int>(load_cases_.size()),
                         static_cast<int>(scene_.capture.examples.size()));
  }
  return *kept;
}

const Matrix3Xd& Sight::shown(int e) {
  const FirstGuess* first = guess(e);
  return first && first->x.size() > 0 ? first->x : scene_.body->surface.mesh.X;
}

std::optional<PhotoIndex> Sight::reference(const std::string& camera) const {
  std::optional<PhotoIndex> first;
  for (const PhotoIndex& photo : photos()) {
    if (spec(photo).camera != camera) continue;
    if (is_rest(example(photo.first))) return photo;
    if (!first) first = photo;
  }
  return first;
}

std::vector<PhotoIndex> Sight::references() const {
  std::vector<PhotoIndex> out;
  for (const Camera& camera : scene_.capture.cameras)
    if (const auto photo = reference(camera.name)) out.push_back(*photo);
  return out;
}

std::vector<Paint> Sight::paints(PhotoIndex photo, const Trial& trial) {
  if (spec(photo).kind == PhotoSpec::Kind::silhouette) return {};
  if (scene_.capture.body.texture == BodySpec::Texture::rest) return paints_of_photos(photo, trial);
  auto paint = told_paint(scene_, at(at(model_.examples, photo.first).photos, photo.second),
                          looked_at_plane(at(at(scene_.photos, photo.first), photo.second)),
                          small(photo).level);
  if (!paint) return {};
  if (trial.flip->texture_v && paint->texture.image)
    paint->texture.image =
        std::make_shared<Image>(turned(*paint->texture.image, Turn::upside_down));
  return {*paint};
}

/// Photos of the other cameras: a camera's own would fit wherever it is thought to stand.
std::vector<Paint> Sight::paints_of_photos(PhotoIndex photo, const Trial& trial) {
  std::vector<Paint> out;
  const int source = scene_.example_index(scene_.capture.body.texture_example);
  const Flip& flip = trial.sources ? *trial.flip : as_told();
  for (size_t k = 0; k < at(scene_.photos, source).size(); ++k) {
    const PhotoIndex other{source, static_cast<int>(k)};
    if (spec(other).camera == spec(photo).camera || spec(other).kind != PhotoSpec::Kind::image)
      continue;
    const SmallPhoto& from = small(trial.picture(other));
    Paint paint;
    paint.texture.source = Texture::Source::photo;
    paint.texture.photo = std::make_shared<Image>(turned(from.I, flip.turn));
    paint.texture.photo_valid = std::make_shared<std::vector<unsigned char>>(
        turned(from.valid, from.I->width, from.I->height, flip.turn));
    paint.texture.reference_camera = camera_at_level(flip.meant(camera(other)), from.level);
    out.push_back(std::move(paint));
  }
  return out;
}

std::optional<BodyPicture> Sight::told_picture(PhotoIndex photo) {
  if (scene_.capture.body.texture != BodySpec::Texture::image) return {};
  const auto painted = paints(photo, {});
  if (painted.empty()) return {};
  return view_.look(camera_at_level(camera(photo), small(photo).level), shown(photo.first),
                    painted.front());
}

BodyPicture Sight::plain_look(const Camera& camera, const Matrix3Xd& x) {
  return view_.look(camera, x, {});
}

std::vector<unsigned char> Sight::outline(PhotoIndex photo, const Matrix3Xd& x) {
  return plain_look(camera_at_level(camera(photo), small(photo).level), x).outline_of;
}

Agreement Sight::agreement(PhotoIndex photo, const Trial& trial) {
  const SmallPhoto& seen = small(trial.picture(photo));
  const Flip& flip = *trial.flip;
  const Camera camera = camera_at_level(flip.meant(this->camera(photo)), seen.level);
  const Image I = turned(seen.I, flip.turn);
  const auto straight = [&](const std::vector<unsigned char>& values) {
    return turned(values, seen.I->width, seen.I->height, flip.turn);
  };
  const auto valid = straight(seen.valid), inside = straight(seen.foreground.inside());
  const Matrix3Xd& x = shown(photo.first);
  Agreement out;
  // A told texture covers what the body does: its picture, which is wanted anyway, has its outline.
  const bool of_texture = scene_.capture.body.texture == BodySpec::Texture::image &&
                          spec(photo).kind == PhotoSpec::Kind::image && trial.least_overlap == 0.0;
  if (!inside.empty() && !of_texture)
    out.overlap = overlap(plain_look(camera, x).outline_of, inside, valid);
  if (out.overlap < trial.least_overlap) return out;
  const int source = scene_.example_index(scene_.capture.body.texture_example);
  const double reach = options_.still_reach * std::hypot(I.width, I.height);
  double correlated = 0.0, counted = 0.0;
  for (const Paint& paint : paints(photo, trial)) {
    const BodyPicture picture =
        view_.look(camera, x, paint, source >= 0 ? &shown(source) : nullptr);
    if (!inside.empty() && of_texture) out.overlap = overlap(picture.outline_of, inside, valid);
    std::vector<unsigned char> body = picture.body;
    for (size_t i = 0; i < body.size(); ++i) body[i] = body[i] && (valid.empty() || valid[i]);
    const double all = correlation(picture.I, I, body);
    const auto area = static_cast<double>(std::count(body.begin(), body.end(), 1));
    if (!std::isnan(all)) correlated += all * area, counted += area;
    const PatchField field = find_patches(picture.I, body, I, reach, options_);
    out.patches.patches.insert(out.patches.patches.end(), field.patches.begin(),
                               field.patches.end());
  }
  if (counted > 0.0) out.correlation = correlated / counted;
  if (static_cast<int>(out.patches.patches.size()) >= options_.least_patches) {
    out.share = out.patches.share();
    if (out.patches.found() > 0) out.shift_px = out.patches.shift_px() * seen.px();
  }
  return out;
}

const Agreement& Sight::agreement(PhotoIndex photo) {
  const auto found = agreements_.find(photo);
  if (found != agreements_.end()) return found->second;
  const Agreement& kept = agreements_.emplace(photo, agreement(photo, Trial{})).first->second;
  freed_.after_one();
  return kept;
}

}  // namespace hookeye::inspection
