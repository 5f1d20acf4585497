// What the questions look at: photos, the body in them, and where it would go. Everything is made
// when it is first asked for, and kept.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/freed_memory.h"
#include "estimation/inspection/body_view.h"
#include "estimation/inspection/first_guess.h"
#include "estimation/inspection/flip.h"
#include "estimation/inspection/options.h"
#include "estimation/inspection/patches.h"
#include "estimation/inspection/progress.h"
#include "estimation/inspection/small_photo.h"

namespace hookeye::inspection {

/// A photo by its example and its number there.
using PhotoIndex = std::pair<int, int>;

/// A photo seen otherwise than told, to be compared with the model.
struct Trial {
  const Flip* flip = &as_told();  ///< of the photo and its camera
  bool sources = true;            ///< the flip holds for the photos that give the texture, too
  std::map<PhotoIndex, PhotoIndex> swapped;  ///< photos in whose places others stand
  double least_overlap = 0.0;                ///< of the silhouettes: below it no texture is sought
  PhotoIndex picture(PhotoIndex photo) const {
    const auto found = swapped.find(photo);
    return found == swapped.end() ? photo : found->second;
  }
};

/// How well a photo and the model's picture agree. NaN: cannot be told.
struct Agreement {
  double overlap = NAN;      ///< of the silhouettes
  double correlation = NAN;  ///< of the pictures as they are, over the covered pixels
  double share = NAN;        ///< of the body's patches that are found in the photo
  double shift_px = NAN;     ///< rms by which those are off [px of the photo]
  PatchField patches;        ///< in px of the small photo
};

struct LoadCase;

/// What of a reference photo is sought in the others of its camera.
struct SoughtInReference {
  BodyPicture look;  ///< the body in its shown state, plain
  SoughtPatches patches;
};

class Sight {
 public:
  Sight(const Scene& scene, const InspectionOptions& options,
        const InspectionProgress& progress = {});
  ~Sight();

  const Scene& scene() const { return scene_; }
  const Model& model() const { return model_; }  ///< at its starting values
  const InspectionOptions& options() const { return options_; }
  const ExampleSpec& example(int e) const;
  const PhotoSpec& spec(PhotoIndex photo) const;
  std::vector<PhotoIndex> photos() const;

  const SmallPhoto& small(PhotoIndex photo);
  /// The camera of a photo as told, at the small photo's size.
  Camera camera(PhotoIndex photo) const;

  /// Null: not asked for (options.first_guess), or the coarse mesh was refused.
  const CoarseModel* coarse();
  std::string no_guess() const { return coarse_ ? coarse_->refused() : std::string(); }
  const FirstGuess* guess(int e);
  /// Positions that the model shows in example `e`: the first guess or, where there is none, rest.
  const Matrix3Xd& shown(int e);

  /// Patches of the body, up to options.moved_reach away; kept.
  const SoughtInReference& sought(PhotoIndex reference);

  /// How the body moved in the photos of example `e`, against its first guess.
  const LoadCase& load_case(int e);

  /// "`front` of example `pull`".
  std::string told(PhotoIndex photo) const;

  /// Cameras of which a question has said that they are told wrong: no other asks about them.
  void doubt(const std::string& camera) { doubted_.insert(camera); }
  bool doubted(const std::string& camera) const { return doubted_.count(camera) > 0; }

  /// The same of load cases.
  void doubt_load(int e) { doubted_loads_.insert(e); }
  bool load_doubted(int e) const { return doubted_loads_.count(e) > 0; }

  /// The photo that tells whether a camera is right: of the body at rest, or else its first one.
  std::optional<PhotoIndex> reference(const std::string& camera) const;
  /// The reference photo of every camera that has one, in the capture's order.
  std::vector<PhotoIndex> references() const;

  /// A photo against the body in the shown state of its example, seen as the trial says. Not kept.
  Agreement agreement(PhotoIndex photo, const Trial& trial);
  /// The same as told, kept.
  const Agreement& agreement(PhotoIndex photo);
  /// The model's picture with its told texture, in the shown state. Empty: none is told as a
  /// picture.
  std::optional<BodyPicture> told_picture(PhotoIndex photo);
  /// The model's outline alone, as told: per pixel of the small photo.
  std::vector<unsigned char> outline(PhotoIndex photo, const Matrix3Xd& x);
  BodyPicture plain_look(const Camera& camera, const Matrix3Xd& x);

 private:
  std::vector<Paint> paints(PhotoIndex photo, const Trial& trial);
  std::vector<Paint> paints_of_photos(PhotoIndex photo, const Trial& trial);

  const Scene& scene_;
  InspectionOptions options_;
  InspectionProgress progress_;
  FreedMemoryReturned freed_;
  Model model_;
  BodyView view_;
  std::set<std::string> doubted_;
  std::set<int> doubted_loads_;
  std::map<PhotoIndex, SmallPhoto> small_;
  std::map<PhotoIndex, Agreement> agreements_;
  std::map<PhotoIndex, SoughtInReference> sought_;
  std::unique_ptr<CoarseModel> coarse_;
  bool coarse_tried_ = false;
  std::vector<FirstGuess> guesses_;
  std::map<int, std::unique_ptr<LoadCase>> load_cases_;
};

}  // namespace hookeye::inspection
