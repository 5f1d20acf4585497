#include "app/commands/place_look.h"

#include <algorithm>
#include <cmath>

#include "app/commands/check_look.h"
#include "capture_io/placement.h"
#include "estimation/inspection/outline_gap.h"
#include "estimation/inspection/sight.h"

namespace hookeye {
namespace {

using Json = nlohmann::ordered_json;

Json share_json(double value) { return std::isnan(value) ? Json() : Json(value); }

std::string share_text(double value) {
  return std::isnan(value) ? "-" : fmt::format("{:.3f}", value);
}

std::shared_ptr<Scene> with_body_moved(const Scene& scene, const Eigen::Isometry3d& motion) {
  auto out = std::make_shared<Scene>(scene);
  ToldPlacement placement;
  placement.R = motion.linear(), placement.t = motion.translation();
  take_to_body(placement, out->capture.cameras);
  // Judged as it was found, also where a fit is to refine it.
  out->capture.body.fit_placement = false;
  return out;
}

}  // namespace

std::vector<CaptureWarning> look_before_and_after(const Scene& scene,
                                                  const Eigen::Isometry3d& motion,
                                                  const std::string& out, Session& session) {
  constexpr double kWorse = 0.02;
  InspectionOptions options;
  options.first_guess = false;
  inspection::Sight before(scene, options);
  const auto after = with_body_moved(scene, motion);
  const Inspection seen = inspect(*after, options, out);
  Json& looks = session.document["looks"] = Json::array();
  std::vector<std::vector<std::string>> rows{
      {"camera", "example", "overlap before", "after", "texture found before", "after"}};
  for (const PhotoLook& look : seen.cameras) {
    const inspection::Agreement& then = before.agreement({look.example, look.photo});
    const ExampleSpec& example = scene.capture.examples[static_cast<size_t>(look.example)];
    const std::string& camera = example.photos[static_cast<size_t>(look.photo)].camera;
    looks.push_back({{"camera", camera},
                     {"example", example.name},
                     {"overlap_before", share_json(then.overlap)},
                     {"overlap_after", share_json(look.overlap)},
                     {"texture_found_before", share_json(then.share)},
                     {"texture_found_after", share_json(look.share)}});
    rows.push_back({camera, example.name, share_text(then.overlap), share_text(look.overlap),
                    share_text(then.share), share_text(look.share)});
    if (look.overlap < then.overlap - kWorse)
      session.warn(
          fmt::format("the model's outline fits the photo of camera `{}` worse than before "
                      "({:.3f}, before {:.3f}): look at it (-o DIR) before you believe it",
                      camera, look.overlap, then.overlap));
  }
  if (rows.size() > 1) session.say("\n{}", table(rows));
  std::vector<CaptureWarning> against;
  for (const CaptureWarning& warning : seen.warnings)
    if (warning.question == "flips") against.push_back(warning);
  inspection::Sight sight(*after, options);
  if (auto doubt = inspection::outline_doubt(sight)) against.push_back(*std::move(doubt));
  session.document["contradicted"] = Json::array();
  for (const CaptureWarning& warning : against)
    session.document["contradicted"].push_back(warning.text());
  if (!out.empty() && !seen.sheet.empty())
    session.say("\n{}\n{}\n", seen.sheet.string(),
                write_inspection_page(*after, seen, out).string());
  return against;
}

}  // namespace hookeye
