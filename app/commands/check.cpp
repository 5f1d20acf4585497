// hookeye check: reads everything a capture names, says what it was understood to mean, and looks
// whether the photos show it.
#include "app/commands/check.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "app/commands/check_covariance.h"
#include "app/commands/check_fields.h"
#include "app/commands/check_look.h"
#include "app/commands/check_words.h"
#include "app/commands/commands.h"
#include "app/commands/describe.h"
#include "app/commands/run_support.h"
#include "app/progress.h"
#include "capture_io/seen_in_words.h"
#include "core/scope.h"
#include "estimation/inspection/si.h"
#include "estimation/model/model.h"

namespace hookeye {
namespace {

using Json = nlohmann::ordered_json;

Json describe_camera(const Camera& camera) {
  Json intrinsics = Json::array();
  for (const Intrinsic& one : camera.intrinsics())
    intrinsics.push_back({{"name", one.name}, {"unit", one.unit}, {"value", one.value}});
  return {{"name", camera.name},
          {"size", {camera.width, camera.height}},
          {"projection", camera.model->name()},
          {"fx", camera.fx},
          {"fy", camera.fy},
          {"distortion", camera.distortion},
          {"intrinsics", intrinsics},
          {"centre", describe_vector(camera.centre())}};
}

Json describe_region(const Region& region) {
  return {{"name", region.name},
          {"area", region.area},
          {"nodes", region.nodes.size()},
          {"centroid", describe_vector(region.centroid)},
          {"normal", describe_vector(region.normal)}};
}

std::string joined(const Json& texts) {
  std::string line;
  for (const auto& text : texts) line += (line.empty() ? "" : "; ") + text.get<std::string>();
  return line.empty() ? "-" : line;
}

Json describe_photo(const Photo& photo, const PhotoSpec& spec) {
  const auto valid = std::count(photo.valid->begin(), photo.valid->end(), 1);
  double mean = 0.0;
  for (const float value : photo.planes.front()->values) mean += value;
  mean /= std::max<double>(1.0, static_cast<double>(photo.planes.front()->values.size()));
  return {{"camera", photo.camera},
          {"file", spec.file.string()},
          {"kind", photo.kind == PhotoSpec::Kind::image ? "image" : "silhouette"},
          {"planes", photo.planes.size()},
          {"encoding", encoding_text(spec)},
          {"behind", photo.kind == PhotoSpec::Kind::image ? background_text(spec.background) : "-"},
          {"mask", spec.mask.filename().string()},
          {"counted", valid / std::max(1.0, static_cast<double>(photo.valid->size()))},
          {"mean", mean},
          {"noise",
           {{"estimated", photo.noise.estimated},
            {"doubtful", photo.noise.doubtful},
            {"full_well", photo.noise.full_well},
            {"read", photo.noise.read},
            {"sigma_at_mean", photo.noise.sigma(mean)}}}};
}

Json describe_example(const Scene& scene, const Model& model, size_t e) {
  const ExampleSpec& example = scene.capture.examples[e];
  const Scope scope("example " + example.name);
  Json one{{"name", example.name}, {"use", example.use()}, {"rest", is_rest(example)}};
  for (const char* key : {"supports", "loads", "photos", "measured"}) one[key] = Json::array();
  for (const auto& support : example.supports) one["supports"].push_back(support_text(support));
  for (const auto& load : example.loads)
    one["loads"].push_back(load_text(load, scene.capture.units));
  for (size_t k = 0; k < example.photos.size(); ++k)
    one["photos"].push_back(describe_photo(scene.photos[e][k], example.photos[k]));
  for (const auto& measured : example.measured)
    if (is_on_body(measured)) one["measured"].push_back(measured_text(measured));
  one["free_rigid_motions"] = free_rigid_motions(scene.body->mesh, model.examples[e].loading);
  return one;
}

Json describe_parameter(const Parameter& parameter) {
  return {{"name", parameter.name},   {"unit", parameter.unit}, {"long_name", parameter.long_name},
          {"value", parameter.value}, {"low", parameter.low},   {"high", parameter.high}};
}

/// What the capture cannot tell, whatever its photos show.
void warn_of_gaps(const Capture& capture, const Json& examples, Session& session) {
  bool force_known = capture.gravity.has_value() && capture.body.density > 0.0;
  for (const auto& example : capture.examples) {
    force_known |= !example.loads.empty();
    for (const auto& measured : example.measured) force_known |= is_reaction(measured);
  }
  if (!force_known && !capture.fit.empty())
    session.warn(
        fmt::format("no force is known (no load, no measured force, no weight): the {} fix only "
                    "ratios of stiffness, not its size",
                    seen_in_words(capture)));
  bool held_out = false;
  for (size_t i = 0; i < examples.size(); ++i) {
    const auto& example = examples[i];
    held_out |= example["use"] == "validate";
    const auto& free = example["free_rigid_motions"];
    if (!free.empty() && !example["rest"].get<bool>())
      session.warn(fmt::format("{}: example {} leaves the body free: {}; tell its `supports`",
                               capture.examples[i].place.str(), capture.examples[i].name,
                               joined(free)));
  }
  if (!held_out && !capture.examples.empty())
    session.warn("no example is held out (use: validate): nothing will judge the fit from outside");
}

void say_capture(const Session& session, const Json& d, const Scene& scene) {
  const Capture& capture = scene.capture;
  session.say("{}{}\n", capture.file.string(), capture.title.empty() ? "" : ": " + capture.title);
  session.say("\nunits: length {}, force {}, stress {}\n", capture.units.length,
              capture.units.force, capture.units.stress());
  session.say("\nbody\n  {}\n{}", d["body"]["size"].get<std::string>(),
              mesh_lines(scene.body->mesh));
  session.say("{}", flat_tetrahedra_lines(
                        scene.body->mesh,
                        capture.body.volume.empty() ? MeshedFrom::surface : MeshedFrom::volume,
                        capture.body.surface.filename().string()));
  const bool photographed =
      std::ranges::any_of(scene.photos, [](const auto& photos) { return !photos.empty(); });
  session.say("  surface of {} triangles{}\n", scene.body->surface.mesh.triangles.size(),
              photographed ? ", as it is photographed" : "");
  session.say("  texture: {}\n  light: {}\n", d["texture"].get<std::string>(),
              d["light"].get<std::string>());
  std::vector<std::vector<std::string>> rows{{"law", "region", "parameters"}};
  for (const auto& material : d["materials"])
    rows.push_back({material["law"], material["where"], material["text"]});
  session.say("\nmaterial\n{}", table(rows));
  rows = {{"fitted", "unit", "start", "meaning"}};
  for (const auto& p : d["parameters"])
    rows.push_back(
        {p["name"], p["unit"], fmt::format("{:.6g}", p["value"].get<double>()), p["long_name"]});
  session.say("\nparameters of the base model\n{}", table(rows));
  if (capture.gravity)
    session.say("  gravity {} {}\n", vector_text(*capture.gravity), capture.units.acceleration());
  else
    session.say("{}", wrapped(capture.body.density > 0.0
                                  ? "gravity is not told: the body is taken to weigh nothing"
                                  : "neither gravity nor `density` is told: the body is taken to "
                                    "weigh nothing; a weight found missing is told by volume",
                              2));
  rows = {{"camera", "size", "projection", "fx", "centre [" + capture.units.length + "]"}};
  for (const auto& camera : capture.cameras)
    rows.push_back({camera.name, fmt::format("{} x {}", camera.width, camera.height),
                    camera.model->name(), fmt::format("{:.5g}", camera.fx),
                    vector_text(camera.centre())});
  if (!capture.cameras.empty()) session.say("\ncameras\n{}", table(rows));
  say_covariance(d["camera_covariance"], capture.units, session);
  rows = {{"region", "area [" + capture.units.length + "^2]", "nodes", "centroid", "normal"}};
  const double size = scene.body->mesh.X.cwiseAbs().maxCoeff();
  for (const auto& [name, region] : scene.body->regions.all())
    rows.push_back({name, fmt::format("{:.5g}", region.area), std::to_string(region.nodes.size()),
                    vector_text(region.centroid, size), vector_text(region.normal)});
  if (rows.size() > 1) session.say("\nregions\n{}", table(rows));
}

void say_examples(const Session& session, const Json& examples) {
  std::vector<std::vector<std::string>> rows{{"example", "use", "supports", "loads", "measured"}};
  for (const auto& e : examples)
    rows.push_back(
        {e["name"], e["use"], joined(e["supports"]), joined(e["loads"]), joined(e["measured"])});
  session.say("\nexamples\n{}", table(rows));
  rows = {{"example", "camera", "kind", "stored", "behind", "counted", "mean", "noise at mean",
           "noise is"}};
  for (const auto& e : examples)
    for (const auto& photo : e["photos"])
      rows.push_back({e["name"], photo["camera"],
                      photo["planes"] == 3 ? "rgb" : photo["kind"].get<std::string>(),
                      photo["encoding"], photo["behind"],
                      fmt::format("{:.1f} %", 100.0 * photo["counted"].get<double>()),
                      fmt::format("{:.4f}", photo["mean"].get<double>()),
                      fmt::format("{:.2g}", photo["noise"]["sigma_at_mean"].get<double>()),
                      photo["noise"]["estimated"].get<bool>() ? "estimated" : "told"});
  if (rows.size() > 1) session.say("\nphotos (linear intensity, full scale 1)\n{}", table(rows));
  for (const auto& e : examples)
    if (!e["free_rigid_motions"].empty())
      session.say("\n{}",
                  wrapped(fmt::format("example {} leaves free: {}", e["name"].get<std::string>(),
                                      joined(e["free_rigid_motions"]))));
}

Json describe_materials(const Capture& capture) {
  Json materials = Json::array();
  for (const auto& spec : capture.materials) {
    const auto law = make_law(spec);  // throws InputError with the place of an unknown law
    std::string text;
    Json values = Json::object();
    for (const auto& p : law->parameters(capture.units)) {
      values[p.name] = p.value;
      text += fmt::format("{}{} {:.6g} {}", text.empty() ? "" : ", ", p.name, p.value, p.unit);
    }
    materials.push_back({{"law", spec.law},
                         {"region", spec.region},
                         {"where", spec.region.empty() ? "whole body" : spec.region},
                         {"values", values},
                         {"text", text}});
    if (!spec.blend) continue;
    const auto& along = spec.blend->along;
    materials.back()["blend"] = {{"along", {along.x(), along.y(), along.z()}},
                                 {"at", spec.blend->at},
                                 {"weight", spec.blend->weight}};
    materials.back()["where"] =
        fmt::format("{}: weight {:.4g} at {:.4g} along ({:.2f}, {:.2f}, {:.2f})", spec.region,
                    fmt::join(spec.blend->weight, ", "), fmt::join(spec.blend->at, ", "), along.x(),
                    along.y(), along.z());
  }
  return materials;
}

struct CheckOptions {
  std::string capture, out;
  bool quick = false;
};

/// A bar for those who watch; null: nobody does.
std::shared_ptr<Progress> bar(const Session& session) {
  if (session.json || !Progress::on_terminal()) return {};
  return std::make_shared<Progress>("check", 0);
}

std::function<void(int, int)> told_by(const std::shared_ptr<Progress>& bar, const char* note) {
  if (!bar) return {};
  return [bar, note](int done, int of) { bar->set(done, of, note); };
}

/// Looks at the photos; draws where a folder is told.
void look(const Scene& scene, const CheckOptions& options, Session& session) {
  InspectionOptions how;
  how.first_guess = !options.quick;
  const auto shown = bar(session);
  const Inspection seen =
      inspect(scene, how, options.out,
              {told_by(shown, "load cases solved coarsely"), told_by(shown, "photos looked at"),
               told_by(shown, "load cases compared with the body at rest")});
  describe_inspection(scene, seen, session);
  say_inspection(scene, seen, session);
  if (!options.out.empty() && !seen.sheet.empty())
    session.say("\n{}\n{}\n", seen.sheet.string(),
                write_inspection_page(scene, seen, options.out).string());
  if (!session.json) std::fflush(stdout);
  for (const CaptureWarning& warning : seen.warnings) session.warn(warning.text());
}

void run_check(const CheckOptions& options, Session& session) {
  const Capture capture = read_capture(options.capture);
  const Scope scope(capture.file.string());
  auto& d = session.document;
  d["hookeye"] = 1;
  d["command"] = "check";
  d["capture"] = capture.file.string();
  d["title"] = capture.title;
  d["warnings"] = Json::array();
  d["units"] = {{"length", capture.units.length},
                {"force", capture.units.force},
                {"stress", capture.units.stress()}};
  d["materials"] = describe_materials(capture);
  const auto scene = load_scene_to_look_at(capture, InspectionOptions{}.look_px,
                                           told_by(bar(session), "photos read"));
  const ModelForm form = base_form(scene);
  const Model model = form.realise(form.initial());
  warn_of_doubts(*scene, session);
  d["body"] = describe_mesh(scene->body->mesh);
  d["body"]["size"] = inspection::size_in_words(scene->body->mesh, capture.units);
  d["texture"] = texture_text(capture.body);
  d["light"] = light_text(capture);
  d["body"]["surface_triangles"] = scene->body->surface.mesh.triangles.size();
  for (const char* key : {"parameters", "cameras", "regions", "examples"}) d[key] = Json::array();
  for (const auto& p : form.parameters()) d["parameters"].push_back(describe_parameter(p));
  for (const auto& camera : capture.cameras) d["cameras"].push_back(describe_camera(camera));
  d["camera_covariance"] = describe_covariance(capture);
  for (const auto& [name, region] : scene->body->regions.all())
    d["regions"].push_back(describe_region(region));
  for (size_t e = 0; e < capture.examples.size(); ++e)
    d["examples"].push_back(describe_example(*scene, model, e));
  say_capture(session, d, *scene);
  say_examples(session, d["examples"]);
  d["fields"] = describe_fields(*scene);
  say_fields(*scene, d["fields"], session);
  warn_of_fields(*scene, session);
  look(*scene, options, session);
  warn_of_gaps(capture, d["examples"], session);
}

}  // namespace

void check_capture(const std::string& capture, const std::string& out, Session& session) {
  run_check({capture, out}, session);
}

void add_check(CLI::App& app, CommandBody& chosen) {
  CLI::App* command =
      app.add_subcommand("check", "Read everything and say what is wrong or cannot be identified");
  const auto options = std::make_shared<CheckOptions>();
  command->add_option("CAPTURE", options->capture, "capture.yaml or its folder")->required();
  command->add_option("-o,--out", options->out,
                      "Folder for pictures of the model over every photo");
  command->add_flag("--quick", options->quick, "Without the coarse solve of every load case");
  command->callback([&chosen, options] {
    chosen = [options](Session& session) { run_check(*options, session); };
  });
}

}  // namespace hookeye
