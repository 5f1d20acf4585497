#include "runs/report/run_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "core/input_error.h"
#include "core/json_file.h"
#include "core/text_file.h"
#include "runs/decision_log.h"
#include "runs/report/answer.h"
#include "runs/report/encode_png.h"
#include "runs/report/facts.h"
#include "runs/report/inside.h"
#include "runs/report/rebuilt_timeline.h"
#include "runs/versions.h"
#include "runs/work_log.h"

namespace hookeye {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

/// The parsed file, or null and a fault that ends with what follows from it.
json read_json(const fs::path& run, const fs::path& file, const std::string& called,
               const std::string& so, json& faults) {
  std::string damage = "not there";
  if (fs::is_symlink(file) && !inside(run, file)) {
    damage = "a link out of this run";
  } else if (inside(run, file)) {
    try {
      if (auto found = parse_json(read_text(file), damage)) return *found;
    } catch (const InputError&) {
      damage = "not readable";
    }
  }
  faults.push_back(fmt::format("{} is {}: {}", called, damage, so));
  return {};
}

bool is_timeline(const json& found) {
  return found.is_object() && found.contains("steps") && found["steps"].is_array();
}

/// run.json, or what the steps tell where it is lost.
json timeline_of(const fs::path& run, const std::vector<fs::path>& steps, json& faults) {
  const std::string so =
      "steps and their figures are taken from the step folders; the verdict and the place of the "
      "capture are lost";
  json found = read_json(run, run / "run.json", "run.json", so, faults);
  if (is_timeline(found)) return found;
  if (!found.is_null()) faults.push_back("run.json is not a run's timeline: " + so);
  return rebuilt_timeline(steps);
}

/// What lies in a folder of the run; links out of the run do not, nor does what a folder that is
/// one holds.
std::vector<fs::path> entries_of(const fs::path& run, const fs::path& folder) {
  std::vector<fs::path> out;
  std::error_code ignored;
  if (!inside(run, folder)) return out;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (inside(run, entry.path())) out.push_back(entry.path());
  return out;
}

/// Steps in order: those on disk, whether the timeline knows them or not.
std::vector<fs::path> step_folders(const fs::path& run) {
  std::vector<fs::path> out;
  for (const auto& entry : entries_of(run, run / "steps"))
    if (fs::is_directory(entry) && entry.filename().string()[0] != '.') out.push_back(entry);
  std::sort(out.begin(), out.end());
  return out;
}

std::string at_factor(const std::string& name, int factor) {
  return factor > 1 ? fmt::format("{}@{}", name, factor) : name;
}

/// "name@2" -> "name", 2.
std::pair<std::string, int> split_factor(const std::string& name) {
  const size_t at = name.rfind('@');
  int factor = 1;
  if (at == std::string::npos) return {name, 1};
  const char* end = name.data() + name.size();
  if (std::from_chars(name.data() + at + 1, end, factor).ptr != end || factor < 1 || factor > 16)
    return {name, 1};
  return {name.substr(0, at), factor};
}

json quantum_json(const Quantised& quantum) {
  return {{"step", quantum.step}, {"zero", quantum.zero}};
}

/// How often photos were halved for the newest step, whose residuals are of that size.
PhotoReadings readings_in(const fs::path& run) {
  PhotoReadings out;
  const auto steps = step_folders(run);
  if (steps.empty()) return out;
  try {
    const json told =
        hookeye::read_json(steps.back() / "metrics.json").value("read", json::object());
    for (const auto& [camera, one] : told.items()) {
      const int over = one.at("width_over").get<int>();
      while (out[camera].halvings < 8 && 1 << (out[camera].halvings + 1) <= over)
        ++out[camera].halvings;
      if (!one.contains("window")) continue;
      const auto window = one.at("window").get<std::array<int, 4>>();
      out[camera].window = {window[0], window[1], window[2], window[3]};
    }
  } catch (const std::exception&) {  // the step's own fault is told where the step is
    return {};
  }
  return out;
}

/// Where the texture is a photo, its noise enters every residual too (photo_evaluation.cpp).
double noise_factor(const Capture& capture) {
  return capture.body.texture == BodySpec::Texture::rest ? std::sqrt(2.0) : 1.0;
}

/// A single file name, so that no part of a request can lead out of the run.
bool plain(const std::string& name) {
  return !name.empty() && name[0] != '.' && name.find_first_of("/\\") == std::string::npos &&
         name.find('\0') == std::string::npos;
}

}  // namespace

RunView::RunView(fs::path folder) : folder_(std::move(folder)) {
  if (!fs::exists(folder_ / "run.json") && !fs::is_directory(folder_ / "steps"))
    throw InputError({folder_.string()}, "there is no run in this folder",
                     "make one with `hookeye fit CAPTURE -o RUN`");
  folder_ = fs::canonical(folder_);
  json ignored = json::array();
  const json timeline = read_json(folder_, folder_ / "run.json", "run.json", "", ignored);
  const std::string where =
      timeline.is_object() && timeline.contains("capture") && timeline["capture"].is_string()
          ? timeline["capture"].get<std::string>()
          : "";
  try {
    if (where.empty()) throw std::runtime_error("run.json does not tell where it is");
    capture_ = read_capture(where);
  } catch (const std::exception& error) {
    capture_fault_ = fmt::format(
        "the capture cannot be read, so photos and its facts are not "
        "here: {}",
        error.what());
  }
  if (!capture_) return;
  const PhotoReadings readings = readings_in(folder_);
  for (const auto& example : capture_->examples)
    for (const auto& photo : example.photos) {
      const std::string name = example.name + "-" + photo.camera;
      const int planes = photo.rgb ? read_image_header(photo.file).channels : 1;
      const auto found = readings.find(photo.camera);
      const PhotoReading reading = found == readings.end() ? PhotoReading{} : found->second;
      for (int k = 0; k < planes; ++k)
        planes_[planes > 1 ? name + "-" + "rgb"[k] : name] = {photo, capture_->camera(photo.camera),
                                                              reading, k};
    }
}

json RunView::photos_json(json& faults, int factor) {
  json all = json::array();
  if (!capture_) {
    faults.push_back(capture_fault_);
    return all;
  }
  // Order of the capture, not of the alphabet.
  for (const auto& example : capture_->examples)
    for (const auto& spec : example.photos)
      for (const auto& [name, plane] : planes_) {
        if (example.test) continue;  // no step has a residual of it
        if (name.rfind(example.name + "-" + spec.camera, 0) != 0 || plane.spec.file != spec.file)
          continue;
        json one = {{"name", name},
                    {"example", example.name},
                    {"camera", spec.camera},
                    {"use", example.use()},
                    {"width", as_read(plane.camera, plane.reading).width},
                    {"height", as_read(plane.camera, plane.reading).height},
                    {"file", spec.file.filename().string()}};
        one["photo"] = {{"blob", at_factor("photo/" + name, factor)},
                        {"shrink", factor},
                        {"quantum", quantum_json(intensity_quantum(1.25))}};
        // Told noise of one channel is a function of its intensity; else it takes a picture.
        const bool told = spec.noise && (spec.rgb || read_image_header(spec.file).channels == 1);
        if (told)
          one["noise"] = {{"read", spec.noise->read},
                          {"full_well", spec.noise->full_well},
                          {"factor", noise_factor(*capture_)}};
        else
          one["sigma"] = {{"blob", at_factor("sigma/" + name, factor)},
                          {"shrink", factor},
                          {"quantum", quantum_json(intensity_quantum(0.25))}};
        all.push_back(std::move(one));
      }
  return all;
}

namespace {

/// What was decided of the step's model; what cannot be read is a fault and left out.
json decisions_json(const fs::path& run, const fs::path& step, json& faults) {
  json all = json::array();
  if (!inside(run, step / "decisions.jsonl")) return all;
  try {
    for (const Decision& one : decisions_of(step)) all.push_back(to_json(one));
  } catch (const InputError& error) {
    faults.push_back(step.filename().string() + "/decisions.jsonl: " + error.wrong());
  }
  return all;
}

}  // namespace

json RunView::step_json(const fs::path& step, json& faults, int factor) {
  const std::string name = step.filename().string();
  json out = {{"folder", name},
              {"metrics", read_json(folder_, step / "metrics.json", name + "/metrics.json",
                                    "the figures of this step are not here", faults)},
              {"diagnosis", nullptr}};
  if (fs::exists(step / "diagnosis.json"))  // else it has not been diagnosed, which is no fault
    out["diagnosis"] = read_json(folder_, step / "diagnosis.json", name + "/diagnosis.json",
                                 "what this step lacks is not here", faults);
  out["decisions"] = decisions_json(folder_, step, faults);
  out["residuals"] = json::object();
  out["fields"] = json::object();
  out["files"] = json::array();
  for (const auto& entry : entries_of(folder_, step / "residuals"))
    if (entry.extension() == ".exr") {
      const std::string photo = entry.stem().string();
      out["residuals"][photo] = {{"blob", at_factor("residual/" + name + "/" + photo, factor)},
                                 {"shrink", factor},
                                 {"quantum", quantum_json(residual_quantum())}};
    }
  for (const auto& entry : entries_of(folder_, step / "page"))
    if (entry.extension() == ".json")
      out["fields"][entry.stem().string()] = "field/" + name + "/" + entry.filename().string();
  for (const auto& entry : entries_of(folder_, step / "removed"))
    if (entry.extension() == ".json")
      out["fields"]["removes-" + entry.stem().string()] =
          "field/" + name + "/removes-" + entry.filename().string();
  out["deformed"] = json::array();
  for (const auto& entry : entries_of(folder_, step / "deformed"))
    if (entry.extension() == ".vtu")
      out["deformed"].push_back({{"name", entry.filename().string()},
                                 {"blob", "deformed/" + name + "/" + entry.filename().string()}});
  std::sort(out["deformed"].begin(), out["deformed"].end());
  std::error_code none;
  for (const auto& entry : fs::recursive_directory_iterator(step, none))
    if (entry.is_regular_file() && entry.path().parent_path().filename() != "page" &&
        inside(folder_, entry.path()))
      out["files"].push_back(entry.path().lexically_relative(folder_).generic_string());
  std::sort(out["files"].begin(), out["files"].end());
  // Of fields and sensors alone there is no picture.
  const bool pictured =
      !out["metrics"].is_object() || !out["metrics"].value("photos", json::array()).empty();
  if (out["residuals"].empty() && pictured) faults.push_back(name + "/residuals is not there");
  if (out["fields"].empty())
    faults.push_back(name + "/page is not there, so its body and arrows cannot be drawn");
  return out;
}

json RunView::document(int shrink_old, int shrink_new) {
  const std::lock_guard lock(mutex_);
  json faults = json::array();
  const auto folders = step_folders(folder_);
  const json timeline = timeline_of(folder_, folders, faults);
  json steps = json::array();
  for (size_t i = 0; i < folders.size(); ++i)
    steps.push_back(
        step_json(folders[i], faults, i + 1 < folders.size() ? shrink_old : shrink_new));
  if (steps.empty()) faults.push_back("no step is finished yet");
  if (timeline["steps"].size() != steps.size())
    faults.push_back(fmt::format("run.json tells of {} steps, the folder holds {}",
                                 timeline["steps"].size(), steps.size()));
  json out = {{"hookeye", 1},
              {"page", 1},
              {"version", version_text()},
              {"run", folder_.string()},
              {"timeline", timeline},
              {"steps", std::move(steps)},
              {"photos", photos_json(faults, shrink_new)},
              {"capture", capture_ ? capture_facts(*capture_) : json()},
              {"practice", capture_ ? reporting_table(*capture_) : json::array()}};
  if (inside(folder_, folder_ / "work.jsonl")) out["work"] = work_json(work_of(folder_));
  out["faults"] = std::move(faults);
  const json none;
  out["answer"] = answer_of(timeline, out["steps"].empty() ? none : out["steps"].back()["metrics"],
                            out["steps"].empty() ? none : out["steps"].back()["diagnosis"]);
  out["answer"]["text"] = material_text(out["answer"]["material"]);
  return out;
}

size_t RunView::step_count() const { return step_folders(folder_).size(); }

std::optional<RunView::Blob> RunView::photo_blob(const std::string& kind, const std::string& name,
                                                 int factor) {
  const auto found = planes_.find(name);
  if (found == planes_.end()) return {};
  const fs::path& file = found->second.spec.file;
  if (!inside(capture_->folder, file)) return {};  // it has become a link since it was named
  Photo photo =
      as_read(read_photo(found->second.spec, found->second.camera), found->second.reading, name);
  if (kind == "photo")
    return Blob{
        encode_png16(shrink(photo.planes[found->second.plane], factor), intensity_quantum(1.25)),
        "image/png"};
  Image& sigma = photo.sigma[found->second.plane].own();
  for (float& s : sigma.values) s *= static_cast<float>(noise_factor(*capture_));
  return Blob{encode_png16(shrink(sigma, factor), intensity_quantum(0.25)), "image/png"};
}

std::optional<RunView::Blob> RunView::residual_blob(const std::string& step,
                                                    const std::string& name, int factor) {
  const fs::path file = folder_ / "steps" / step / "residuals" / (name + ".exr");
  if (!inside(folder_, file)) return {};
  return Blob{encode_png16(shrink(read_image_with_holes(file), factor), residual_quantum()),
              "image/png"};
}

std::optional<RunView::Blob> RunView::blob(const std::string& request) {
  const auto [path, factor] = split_factor(request);
  const size_t first = path.find('/');
  if (first == std::string::npos) return {};
  const std::string kind = path.substr(0, first), rest = path.substr(first + 1);
  if (kind == "photo" || kind == "sigma")
    return plain(rest) ? photo_blob(kind, rest, factor) : std::nullopt;
  const size_t second = rest.find('/');
  if (second == std::string::npos) return {};
  const std::string step = rest.substr(0, second), name = rest.substr(second + 1);
  if (!plain(step) || !plain(name)) return {};
  if (kind == "residual") return residual_blob(step, name, factor);
  if (kind == "deformed") {
    const fs::path body = folder_ / "steps" / step / "deformed" / name;
    if (body.extension() != ".vtu" || !fs::is_regular_file(body) || !inside(folder_, body))
      return {};
    return Blob{read_text(body), "application/octet-stream"};
  }
  if (kind != "field") return {};
  const std::string removes = "removes-";
  const fs::path file = name.rfind(removes, 0) == 0
                            ? folder_ / "steps" / step / "removed" / name.substr(removes.size())
                            : folder_ / "steps" / step / "page" / name;
  if (!fs::is_regular_file(file) || !inside(folder_, file)) return {};
  return Blob{read_text(file), "application/json", true};
}

}  // namespace hookeye
