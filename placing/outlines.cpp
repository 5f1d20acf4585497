#include "placing/outlines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "placing/outline_match.h"

namespace hookeye {
namespace {

using Settled = OutlineMatch::Settled;

/// Same place to what a further step of the settling may bring.
constexpr double kSameTurn = 0.05;   // [rad]
constexpr double kSameShift = 0.02;  // of the body's diameter

/// The told place and turns of it about the body's middle; those shifted to where the body shows.
std::vector<Isometry3d> starts(const OutlineMatch& match, const PlacedBody& body,
                               const OutlineOptions& options) {
  std::vector<Isometry3d> all{Isometry3d::Identity(), match.centred(Isometry3d::Identity())};
  const auto add = [&](const Vector3d& axis, double degrees) {
    const Eigen::AngleAxisd turn(degrees * EIGEN_PI / 180.0, axis);
    const Isometry3d motion =
        Eigen::Translation3d(body.middle) * turn * Eigen::Translation3d(-body.middle);
    all.push_back(match.centred(motion));
  };
  for (int i = 0; i < 3; ++i)
    for (const double sign : {1.0, -1.0}) add(body.axes.col(i), sign * options.turn_degrees);
  return all;
}

/// As the body may lie any way round, where it is told nowhere near: its middle as the photos show
/// it.
std::vector<Isometry3d> starts_all_around(const OutlineMatch& match, const PlacedBody& body) {
  std::vector<Isometry3d> all;
  for (const Eigen::Matrix3d& turn : cube_turns()) {
    const Isometry3d about(body.axes * turn * body.axes.transpose());
    all.push_back(match.centred(Eigen::Translation3d(body.middle) * about *
                                Eigen::Translation3d(-body.middle)));
  }
  return all;
}

/// The best first, each place once.
void sort_out(const PlacedBody& body, std::vector<Settled>* found) {
  std::erase_if(*found, [](const Settled& one) { return !std::isfinite(one.misfit); });
  std::stable_sort(found->begin(), found->end(),
                   [](const Settled& a, const Settled& b) { return a.misfit < b.misfit; });
  std::vector<Settled> kept;
  for (const Settled& one : *found)
    if (std::none_of(kept.begin(), kept.end(), [&](const Settled& other) {
          return !apart(one.motion, other.motion, body.middle, kSameTurn, kSameShift * body.extent);
        }))
      kept.push_back(one);
  *found = std::move(kept);
}

[[noreturn]] void refuse(const Scene& scene, const std::vector<std::string>& why_not) {
  const bool rest = std::any_of(
      scene.capture.examples.begin(), scene.capture.examples.end(),
      [](const ExampleSpec& example) { return is_rest(example) && !example.photos.empty(); });
  throw InputError(scene.capture.body.place,
                   rest ? "no photo at rest shows where the body ends" +
                              (why_not.empty() ? std::string() : ": " + why_not.front())
                        : std::string("there is no photo of the body at rest"),
                   rest ? "`background: black`, `background: {photo: EMPTY}` or a photo of `kind: "
                          "silhouette`; or "
                          "place it by --pair or --scan"
                        : "an example without loads and motions that has photos; or place it by "
                          "--pair or --scan");
}

class Search {
 public:
  Search(const Scene& scene, const PlacedBody& body, const OutlineOptions& options,
         std::vector<std::string>* why_not)
      : body_(body), options_(options) {
    for (const int px : options.look_px) {
      std::vector<Outline> outlines = outlines_of(scene, px, why_not);
      why_not = nullptr;  // the same photos at each size
      if (outlines.empty()) continue;
      // Small photos are not drawn twice.
      if (levels_.empty() || levels_.back()->outlines().front().px != outlines.front().px)
        levels_.push_back(std::make_unique<OutlineMatch>(scene, body, std::move(outlines)));
    }
  }
  bool empty() const { return levels_.empty(); }
  OutlineMatch& finest() { return *levels_.back(); }

  /// From all starts at the coarsest size, the best of them further.
  std::vector<Settled> from(const std::vector<Isometry3d>& starts) {
    constexpr size_t kKept = 3;
    constexpr int kFarRounds = 20, kNearRounds = 12;
    std::vector<Settled> found;
    for (size_t i = 0; i < starts.size(); ++i) {
      found.push_back(levels_.front()->settle(starts[i], kFarRounds));
      if (options_.progress) options_.progress(i + 1, starts.size());
    }
    sort_out(body_, &found);
    for (size_t level = 1; level < levels_.size(); ++level) {
      if (found.size() > kKept) found.resize(kKept);
      for (Settled& one : found) one = levels_[level]->settle(one.motion, kNearRounds);
      sort_out(body_, &found);
    }
    return found;
  }

  std::vector<Isometry3d> starts() const {
    return hookeye::starts(*levels_.front(), body_, options_);
  }
  std::vector<Isometry3d> starts_all_around() const {
    return hookeye::starts_all_around(*levels_.front(), body_);
  }
  /// Of the body in the photos, placed [px of them].
  double extent_px(const Isometry3d& motion) const {
    const Outline& outline = levels_.back()->outlines().front();
    return outline.px * body_.extent / outline.view.length_per_px(motion * body_.middle);
  }

 private:
  const PlacedBody& body_;
  const OutlineOptions& options_;
  std::vector<std::unique_ptr<OutlineMatch>> levels_;
};

void set_outline_errors(OutlineMatch& match, const PlacedBody& body, Placing* placing) {
  // Neighbours on a rim err alike [px of the small photo]. In photos shading and speckle pull whole
  // edges: measured on sample_scenes/sample.yaml, where errors were seven times those of 12 px.
  constexpr double kAlikePx = 12.0, kAlikeInPhotosPx = 500.0;
  const std::vector<RimPull> pulls = match.pulls(placing->motion);
  double px = 0.0;
  double count = 0.0;
  for (const Outline& outline : match.outlines()) {
    px = std::max(px, outline.px);
    // Both ways tell the same rims.
    count += double(outline.rim.size()) / (outline.image ? kAlikeInPhotosPx : kAlikePx);
  }
  const double least = 0.25 * px;  // pixels of a mask are known no better
  const double sigma = std::max(placing->misfit, least);
  const double share = std::max(count, 6.0) / double(pulls.size());
  set_errors(
      information_of(placing->motion, match.terms(pulls), 2.0 * sigma) * share / (sigma * sigma),
      body, placing);
}

}  // namespace

OutlineFit place_by_outlines(const Scene& scene, const PlacedBody& body,
                             const OutlineOptions& options) {
  constexpr double kAsWell = 1.25;     // times the misfit: the photos' outlines vary by as much
  constexpr double kOtherTurn = 0.25;  // [rad]: nearer ones are the same place, less well settled
  constexpr double kOtherShift = 0.1;  // of the body's diameter
  // Right places have a third of this and less; beyond it a better one costs seconds to look for.
  constexpr double kDoubtful = 0.005;  // of the body in the photos
  OutlineFit out;
  Search search(scene, body, options, &out.why_not);
  if (search.empty()) refuse(scene, out.why_not);
  std::vector<Settled> found = search.from(search.starts());
  if (found.empty() || found.front().misfit > kDoubtful * search.extent_px(found.front().motion)) {
    for (const Settled& one : search.from(search.starts_all_around())) found.push_back(one);
    sort_out(body, &found);
  }
  if (found.empty())
    throw InputError(scene.capture.body.place,
                     "none of the cameras gets the body into its picture, wherever it is tried",
                     "look at poses, focal lengths and units (`hookeye check`); or place the body "
                     "by --pair");
  std::vector<Isometry3d> alike;
  for (const Isometry3d& turn : likely_symmetries(body))
    alike.push_back(found.front().motion * turn);
  for (const Settled& one : search.from(alike)) found.push_back(one);
  sort_out(body, &found);
  OutlineMatch& match = search.finest();
  const double px = match.outlines().front().px;
  std::vector<Settled> fitting;
  for (const Settled& one : found) {
    const bool other = std::all_of(fitting.begin(), fitting.end(), [&](const Settled& known) {
      return apart(one.motion, known.motion, body.middle, kOtherTurn, kOtherShift * body.extent);
    });
    if (other && one.misfit <= kAsWell * found.front().misfit + 0.1 * px) fitting.push_back(one);
  }
  std::stable_sort(fitting.begin(), fitting.end(), [](const Settled& a, const Settled& b) {
    return angle_of(a.motion) < angle_of(b.motion);
  });
  Placing& placing = out.placing;
  placing.motion = fitting.front().motion;
  placing.misfit = fitting.front().misfit, placing.misfit_unit = "px";
  for (size_t i = 1; i < fitting.size(); ++i)
    placing.others.push_back({fitting[i].motion, fitting[i].misfit});
  set_outline_errors(match, body, &placing);
  warn_of_others(body, &placing);
  for (const Outline& outline : match.outlines())
    out.cameras.push_back(fmt::format("`{}` of example `{}`", outline.camera, outline.example));
  return out;
}

}  // namespace hookeye
