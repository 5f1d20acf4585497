// hookeye place: where the body lies in the cameras' frame, written into the capture.
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <optional>

#include "app/commands/commands.h"
#include "app/commands/describe.h"
#include "app/commands/place_look.h"
#include "app/commands/place_tags.h"
#include "app/progress.h"
#include "app/validators.h"
#include "capture_io/yaml_file.h"
#include "core/scope.h"
#include "placing/edit.h"
#include "placing/outlines.h"
#include "placing/pairs.h"
#include "placing/scan.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kRadians = EIGEN_PI / 180.0;  // in a degree

struct PlaceCommand {
  std::string capture, pairs_file, tags, dictionary = "4X4_50", scan, scan_unit, out;
  std::vector<std::string> pairs;
  double sigma = 0.0;  ///< [px]; 0: not told
  bool fit = false, dry = false;
};

InputError misused(const std::string& wrong, const std::string& right) {
  return {{"hookeye place"}, wrong, right};
}

/// The examples at rest, and the one that gives the texture: what the place is looked for in.
Capture at_rest(Capture capture) {
  const ExampleSpec first = capture.examples.front();
  std::erase_if(capture.examples, [&](const ExampleSpec& example) {
    return !is_rest(example) && example.name != capture.body.texture_example;
  });
  if (!capture.examples.empty()) return capture;
  capture.examples = {first};
  capture.examples.front().photos.clear();
  return capture;
}

/// Progress of the starts; none with --json.
class Starts {
 public:
  explicit Starts(const Session& session) : shown_(!session.json) {}
  std::function<void(size_t, size_t)> told() {
    return [this](size_t done, size_t of) {
      if (!shown_) return;
      if (!progress_) progress_.emplace("trying places", static_cast<int>(of));
      progress_->set(static_cast<int>(done), static_cast<int>(of));
    };
  }

 private:
  bool shown_;
  std::optional<Progress> progress_;
};

std::vector<PickedPair> picked(const PlaceCommand& options) {
  std::vector<PickedPair> all;
  if (!options.pairs_file.empty()) all = read_pairs(options.pairs_file);
  for (size_t i = 0; i < options.pairs.size(); ++i)
    all.push_back(read_pair(options.pairs[i], {fmt::format("--pair {}", i + 1)}));
  return all;
}

/// How well points are known in photos where nobody tells [px]: picked by eye; corners of a tag, by
/// the gradients around them.
constexpr double kPicked = 1.0, kTag = 0.3;

Placing by_pairs(const PlaceCommand& options, const Scene& at_rest, const Capture& capture,
                 const PlacedBody& body, Session& session) {
  std::vector<PickedPair> pairs = picked(options);
  const double usual = pairs.empty() ? kTag : kPicked;
  if (!options.tags.empty())
    for (PickedPair& one :
         pairs_of_tags(options.tags, options.dictionary, at_rest.capture, session))
      pairs.push_back(std::move(one));
  const PairFit found =
      place_by_pairs(pairs, capture, body, {options.sigma > 0.0 ? options.sigma : usual});
  Json& list = session.document["pairs"] = Json::array();
  std::vector<std::vector<std::string>> rows{
      {"camera", "pixel", "point of the body", "off px", ""}};
  size_t used = 0;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const PickedPair& pair = pairs[i];
    const Eigen::Vector2d& off = found.off_px[i];
    used += found.used[i] != 0;
    list.push_back({{"at", pair.place.str()},
                    {"camera", pair.camera},
                    {"pixel", {pair.pixel.x(), pair.pixel.y()}},
                    {"point", describe_vector(pair.point)},
                    {"off_px", off.allFinite() ? Json{off.x(), off.y()} : Json()},
                    {"used", found.used[i] != 0}});
    rows.push_back({pair.camera, fmt::format("({:g}, {:g})", pair.pixel.x(), pair.pixel.y()),
                    vector_text(pair.point, body.extent), fmt::format("{:.2f}", off.norm()),
                    found.used[i] ? "" : "left out"});
  }
  session.say("{}", table(rows));
  session.say("placed by {} of {} pairs; they are off by {:.3g} px (root mean square)\n", used,
              pairs.size(), found.placing.misfit);
  return found.placing;
}

Placing by_outlines(const Scene& scene, const PlacedBody& body, Session& session) {
  OutlineOptions options;
  OutlineFit found;
  {
    Starts starts(session);
    options.progress = starts.told();
    found = place_by_outlines(scene, body, options);
  }
  session.document["outlines"] = found.cameras;
  for (const std::string& sentence : found.why_not) session.warn(sentence);
  session.say("{}", wrapped(fmt::format("placed by the outline of the body in the photos {}; "
                                        "outlines are off by {:.3g} px (root mean square)",
                                        fmt::join(found.cameras, ", "), found.placing.misfit)));
  return found.placing;
}

double in_metres(const std::string& unit) {
  return unit == "m" ? 1.0 : unit == "cm" ? 1e-2 : unit == "um" ? 1e-6 : 1e-3;
}

Placing by_scan(const PlaceCommand& told, const Capture& capture, const ToldPlacement& placement,
                const PlacedBody& body, Session& session) {
  ScanOptions options;
  if (!told.scan_unit.empty())
    options.scale = in_metres(told.scan_unit) / in_metres(capture.units.length);
  const SurfaceMesh scan = read_surface(told.scan);
  ScanFit found;
  {
    Starts starts(session);
    options.progress = starts.told();
    found = place_by_scan(scan, {told.scan}, placement, body, options);
  }
  session.document["scan"] = {{"file", told.scan},
                              {"triangles", scan.triangles.size()},
                              {"scale", options.scale},
                              {"on_body", found.used},
                              {"covered", found.covered}};
  session.say("{}",
              wrapped(fmt::format(
                  "placed by the scan {}: {:.0f} % of its points lie on the body, {:.3g} {} off "
                  "(root mean square), and cover {:.0f} % of its surface",
                  told.scan, 100.0 * found.used, found.placing.misfit, body.length,
                  100.0 * found.covered)));
  return found.placing;
}

/// Standard errors along the axes of the cameras' frame: of the turn [degrees], of the shift.
std::pair<Vector3d, Vector3d> errors_of(const Placing& placing, const ToldPlacement& told) {
  const Matrix6d& C = placing.covariance;
  const auto in_frame = [&](const Eigen::Matrix3d& block) -> Vector3d {
    return (told.R * block * told.R.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
  };
  return {in_frame(C.topLeftCorner<3, 3>()) / kRadians, in_frame(C.bottomRightCorner<3, 3>())};
}

Json rotation_rows(const Eigen::Matrix3d& R) {
  Json rows = Json::array();
  for (int i = 0; i < 3; ++i) rows.push_back(describe_vector(R.row(i).transpose()));
  return rows;
}

void tell_place(const Placing& placing, const ToldPlacement& told, const ToldPlacement& now,
                const PlacedBody& body, Session& session) {
  const auto [turn, shift] = errors_of(placing, told);
  const Vector3d middle = now.R * body.middle + now.t;
  const Eigen::AngleAxisd turned(told.R * placing.motion.linear() * told.R.transpose());
  const double by = shift_of(placing.motion, body.middle);
  session.document["placement"] = {{"rotation", rotation_rows(now.R)},
                                   {"translation", describe_vector(now.t)},
                                   {"fit", now.fit}};
  session.document["middle"] = describe_vector(middle);
  session.document["turned_degrees"] = turned.angle() / kRadians;
  session.document["moved"] = by;
  session.document["standard_errors"] = {{"turn_degrees", describe_vector(turn)},
                                         {"shift", describe_vector(shift)}};
  session.document["misfit"] = {{"rms", placing.misfit}, {"unit", placing.misfit_unit}};
  session.document["others"] = Json::array();
  for (const OtherPlace& other : placing.others) {
    const ToldPlacement there = placed(told, other.motion);
    session.document["others"].push_back({{"rotation", rotation_rows(there.R)},
                                          {"translation", describe_vector(there.t)},
                                          {"rms", other.misfit}});
  }
  const double size = std::max(middle.norm(), body.extent);
  session.say(
      "\n{}",
      table({{"in the cameras' frame", "", "+- along x, y, z", ""},
             {"middle of the body", vector_text(middle, size),
              fmt::format("{:.2g}, {:.2g}, {:.2g}", shift.x(), shift.y(), shift.z()), body.length},
             {"turned since told", fmt::format("{:.2f}", turned.angle() / kRadians),
              fmt::format("{:.2g}, {:.2g}, {:.2g}", turn.x(), turn.y(), turn.z()), "degrees"},
             {"moved since told", fmt::format("{:.4g}", by), "", body.length}}));
  for (const std::string& sentence : placing.said) session.say("{}", wrapped(sentence));
  for (const std::string& sentence : placing.warnings) session.warn(sentence);
}

/// A place out of outlines that the outlines contradict was not found. Pairs and scans are data of
/// their own, which may be meant as a rough start: of those it is said.
void judge(const std::vector<CaptureWarning>& against, bool by_outlines, const ToldPlacement& now,
           Session& session) {
  if (!by_outlines) {
    for (const CaptureWarning& one : against) session.warn(one.text());
    return;
  }
  if (against.empty()) return;
  for (size_t i = 1; i < against.size(); ++i) session.warn(against[i].text());
  const CaptureWarning& first = against.front();
  throw InputError(first.place, first.seen + "; nothing was written",
                   first.right + ".\n  The place that fits least badly is no answer: placement: " +
                       placement_text(now));
}

void run_place(const PlaceCommand& options, Session& session) {
  const bool tags = !options.tags.empty();
  const bool pairs = tags || !options.pairs.empty() || !options.pairs_file.empty();
  if (pairs && !options.scan.empty())
    throw misused(fmt::format("both {} and a scan are given", tags ? "tags" : "pairs"),
                  "place the body by one of them");
  if (!options.scan_unit.empty() && options.scan.empty())
    throw misused("--scan-unit stands without --scan", "--scan FILE --scan-unit mm");
  const Capture whole = read_capture(options.capture);
  const Scope scope(whole.file.string());
  if (whole.cameras.empty() && options.scan.empty())
    throw InputError({whole.file.string()}, "the capture has no cameras to place the body for",
                     "`cameras:`, as docs/capture.md says");
  const ToldPlacement told = placement_of_capture(load_yaml(whole.file, whole.body.place.file));
  const auto scene = load_scene(at_rest(whole));
  const PlacedBody body = placed_body(scene->body->surface.mesh, whole.units.length);
  session.document = {{"hookeye", 1}, {"command", "place"}, {"capture", whole.file.string()}};
  session.document["by"] = pairs ? "pairs" : options.scan.empty() ? "outlines" : "scan";
  const Placing placing = pairs                  ? by_pairs(options, *scene, whole, body, session)
                          : options.scan.empty() ? by_outlines(*scene, body, session)
                                                 : by_scan(options, whole, told, body, session);
  ToldPlacement now = placed(told, placing.motion);
  now.fit = told.fit || options.fit;
  tell_place(placing, told, now, body, session);
  const auto against = look_before_and_after(*scene, placing.motion, options.out, session);
  judge(against, !pairs && options.scan.empty(), now, session);
  store_placed(whole.file, now, options.dry);
  session.document["written"] = !options.dry;
  if (options.dry)
    session.say("\nnot written (--dry-run); in {} would stand\n  placement: {}\n",
                whole.file.string(), placement_text(now));
  else
    session.say("\nwritten to {}: `placement` of `body`{}\n", whole.file.string(),
                against.empty() ? "" : ", although the photos contradict it (above)");
}

}  // namespace

void add_place(CLI::App& app, CommandBody& chosen) {
  CLI::App* command = app.add_subcommand(
      "place", "Where the body lies for the cameras: by outline, pairs, tags or scan");
  const auto options = std::make_shared<PlaceCommand>();
  command->add_option("CAPTURE", options->capture, "capture.yaml or its folder")->required();
  command
      ->add_option("--pair", options->pairs,
                   "A pixel and the point of the body that it shows; once for each")
      ->type_name("CAMERA:u,v=x,y,z")
      ->allow_extra_args(false);
  command->add_option("--pairs", options->pairs_file, "A file of them: CAMERA u v x y z a line");
  command->add_option("--tags", options->tags,
                      "A file of ArUco or AprilTag markers on the body: docs/place.md");
  command->add_option("--dictionary", options->dictionary, "Theirs (default: 4X4_50)");
  command
      ->add_option("--sigma", options->sigma,
                   "How well pixels were picked [px] (default: 1; of tags 0.3)")
      ->check(above_zero());
  command->add_option("--scan", options->scan,
                      "A scan in the cameras' frame, of the body or a part: obj, ply or stl");
  command->add_option("--scan-unit", options->scan_unit, "Its unit (default: the capture's)")
      ->check(CLI::IsMember({"mm", "cm", "m", "um"}));
  command->add_flag("--fit", options->fit,
                    "Writes `fit: true` too: every fit refines the place by six numbers");
  command->add_flag("--dry-run", options->dry, "Tells the place and writes nothing");
  command->add_option("-o,--out", options->out,
                      "Folder for pictures of the placed model over the photos at rest");
  command->callback([&chosen, options] {
    chosen = [options](Session& session) { run_place(*options, session); };
  });
}

}  // namespace hookeye
