#include "estimation/inspection/inspection.h"

#include "estimation/inspection/apart.h"
#include "estimation/inspection/contact_sheet.h"
#include "estimation/inspection/field_motion.h"
#include "estimation/inspection/load_case.h"
#include "estimation/inspection/question.h"

namespace hookeye {

namespace inspection {

Warnings::Warnings(const Scene& scene) {
  const std::filesystem::path& file = scene.capture.file;
  std::error_code error;
  if (std::filesystem::is_regular_file(file, error))
    places_.emplace(file, scene.capture.body.place.file);
}

void Warnings::say(const Place& place, std::string seen, std::string right) {
  all.push_back({question, place, std::move(seen), std::move(right)});
}

bool Warnings::also(const std::string& right, const std::string& seen) {
  for (CaptureWarning& said : all) {
    if (said.question != question || said.right != right) continue;
    said.seen += "; " + seen;
    return true;
  }
  return false;
}

Place Warnings::place(std::initializer_list<std::string> path) const {
  return places_ ? places_->of(path) : Place{};
}

bool Warnings::has(std::initializer_list<std::string> path) const {
  return places_ && places_->has(path);
}

#define HOOKEYE_QUESTION(NAME) void ask_##NAME(Sight& sight, Warnings& warnings);
#include "estimation/inspection/questions.def"
#undef HOOKEYE_QUESTION

const std::vector<Question>& questions() {
  static const std::vector<Question> all = {
#define HOOKEYE_QUESTION(NAME) {#NAME, ask_##NAME},
#include "estimation/inspection/questions.def"
#undef HOOKEYE_QUESTION
  };
  return all;
}

namespace {

std::string no_correlation(const Sight& sight, PhotoIndex photo, const Agreement& agreement) {
  const BodySpec& body = sight.scene().capture.body;
  if (sight.spec(photo).kind == PhotoSpec::Kind::silhouette) return "a silhouette has no texture";
  if (body.texture == BodySpec::Texture::none) return "no texture is told";
  if (body.texture == BodySpec::Texture::uniform) return "the body has one colour";
  if (body.texture == BodySpec::Texture::rest && agreement.patches.patches.empty())
    return "no other camera's photo shows what this one shows";
  return "the photo shows too little of the body";
}

PhotoLook look_at(Sight& sight, PhotoIndex photo) {
  const Agreement& agreement = sight.agreement(photo);
  PhotoLook look;
  look.example = photo.first, look.photo = photo.second;
  look.at_rest = is_rest(sight.example(photo.first));
  look.overlap = agreement.overlap;
  look.correlation = agreement.correlation;
  look.share = agreement.share;
  look.shift_px = agreement.shift_px;
  if (std::isnan(look.overlap)) look.no_overlap = sight.small(photo).foreground.unknown;
  if (std::isnan(look.share)) look.no_correlation = no_correlation(sight, photo, agreement);
  return look;
}

double largest(const Matrix3Xd& u) {
  return u.size() > 0 ? u.colwise().norm().maxCoeff() : std::nan("");
}

GuessLook look_at_load(Sight& sight, int e) {
  const FirstGuess& guess = *sight.guess(e);
  GuessLook look;
  look.example = e;
  look.first_order = largest(guess.linear);
  if (guess.x.size() > 0) look.displacement = largest(guess.x - sight.scene().body->surface.mesh.X);
  look.failure = guess.failure;
  const MotionSums& sums = sight.load_case(e).first_order;
  if (sums.count == 0.0) return look;
  look.seen_px = sums.seen_px(), look.expected_px = sums.expected_px();
  look.cosine = sums.cosine();
  return look;
}

}  // namespace

}  // namespace inspection

Inspection inspect(const Scene& scene, const InspectionOptions& options,
                   const std::filesystem::path& folder, const InspectionProgress& progress) {
  using namespace inspection;
  Inspection out;
  Sight sight(scene, options, progress);
  const std::vector<PhotoIndex> photos = sight.photos();
  for (const PhotoIndex& photo : photos) {
    out.photos.push_back(look_at(sight, photo));
    if (progress.looked)
      progress.looked(static_cast<int>(out.photos.size()), static_cast<int>(photos.size()));
  }
  for (const PhotoIndex& photo : sight.references()) {
    out.cameras.push_back(look_at(sight, photo));
    if (out.cameras.back().overlap < options.usual_overlap)
      out.cameras.back().apart = apart(sight, photo);
  }
  Warnings warnings(scene);
  for (const Question& question : questions()) {
    warnings.question = question.name;
    question.ask(sight, warnings);
  }
  out.warnings = std::move(warnings.all);
  for (size_t e = 0; sight.coarse() && e < scene.capture.examples.size(); ++e) {
    out.guesses.push_back(look_at_load(sight, static_cast<int>(e)));
    for (FieldMotion& one : field_motions(sight, static_cast<int>(e)))
      out.fields.push_back(std::move(one));
  }
  out.no_guess = sight.no_guess();
  if (!folder.empty()) out.sheet = draw_pictures(sight, folder, &out.photos);
  return out;
}

}  // namespace hookeye
