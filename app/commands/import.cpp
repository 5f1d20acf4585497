// hookeye import: cameras that another program calibrated, as a capture takes them.
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/commands/commands.h"
#include "app/commands/import_files.h"
#include "app/validators.h"
#include "capture_io/cameras_file.h"
#include "core/input_error.h"
#include "core/scope.h"
#include "core/text_file.h"
#include "importers/deck.h"
#include "importers/importer.h"
#include "importers/scan.h"

namespace hookeye {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

struct ImportCommand {
  std::vector<std::string> words;  ///< [KIND] SOURCE...
  std::string folder, size, lens;
  ImportOptions options;
  FrameChoice frames;
  bool frames_told = false;  ///< any of the options that choose frames
};

/// "1280x1024".
CLI::Validator picture_size() {
  return CLI::Validator(
      [](std::string& text) {
        int sides[2] = {0, 0};
        const char* at = text.data();
        const char* const end = at + text.size();
        for (int i = 0; i < 2; ++i) {
          const auto [stop, error] = std::from_chars(at, end, sides[i]);
          const bool ends = i == 0 ? stop != end && *stop == 'x' : stop == end;
          if (error != std::errc() || !ends || sides[i] < 1 || sides[i] > 100000)
            return "a size like 1280x1024 is expected, not " + text;
          at = stop + (i == 0);
        }
        return std::string();
      },
      "WIDTHxHEIGHT");
}

/// The sources, and the importer that is named before them or recognises them.
std::pair<const Importer*, Importer::Sources> chosen_importer(const ImportCommand& options) {
  Importer::Sources sources(options.words.begin(), options.words.end());
  std::error_code error;
  const std::string& first = options.words.front();
  const Importer* named = find_importer(first);
  if (!named && sources.size() > 1 && !fs::exists(sources.front(), error)) {
    std::vector<std::string> kinds;
    for (const Importer* importer : importers()) kinds.push_back(importer->name());
    const std::string near = nearest_name(first, kinds);
    throw InputError({first}, "this is neither a kind of source nor a file",
                     near.empty() ? fmt::format("one of {}", fmt::join(kinds, ", "))
                                  : fmt::format("did you mean `{}`?", near));
  }
  if (!named) return {&recognise(sources), sources};
  sources.erase(sources.begin());
  if (sources.empty())
    throw InputError({first}, "there is no source behind the kind",
                     fmt::format("hookeye import {} SOURCE -o FOLDER", first));
  for (const fs::path& source : sources)
    if (!fs::exists(source, error))
      throw InputError({source.string()}, "there is no such file or folder",
                       "name what the other program wrote");
  return {named, sources};
}

void describe(const Imported& imported, const std::vector<Reprojection>& seen, Json& document) {
  document["cameras"] = Json::array();
  for (size_t i = 0; i < imported.cameras.size(); ++i) {
    const Camera& camera = imported.cameras[i];
    const Eigen::Vector3d centre = camera.centre(), axis = camera.R.row(2).transpose();
    Json one = {{"name", camera.name},
                {"projection", camera.model->name()},
                {"size", {camera.width, camera.height}},
                {"fx", camera.fx},
                {"fy", camera.fy},
                {"centre", {centre.x(), centre.y(), centre.z()}},
                {"looks_along", {axis.x(), axis.y(), axis.z()}},
                {"points", seen[i].points},
                {"rms_px", seen[i].points ? Json(seen[i].rms_px) : Json(nullptr)}};
    document["cameras"].push_back(std::move(one));
  }
  document["said"] = imported.said;
}

std::string cameras_table(const Imported& imported, const std::vector<Reprojection>& seen) {
  const bool points = !imported.seen.empty();
  std::vector<std::vector<std::string>> rows{
      {"camera", "projection", "size", "focal px", "stands at", "looks along"}};
  if (points) rows[0].insert(rows[0].end(), {"points", "rms px"});
  for (size_t i = 0; i < imported.cameras.size(); ++i) {
    const Camera& camera = imported.cameras[i];
    rows.push_back({camera.name, camera.model->name(),
                    fmt::format("{} x {}", camera.width, camera.height),
                    fmt::format("{:.1f}", camera.fx), yaml_vector(camera.centre()),
                    yaml_vector(camera.R.row(2).transpose())});
    if (!points) continue;
    rows.back().push_back(std::to_string(seen[i].points));
    rows.back().push_back(seen[i].points ? fmt::format("{:.3f}", seen[i].rms_px) : "-");
  }
  return table(rows);
}

/// Videos hold photos. False: the words name none.
bool import_videos_if_any(const ImportCommand& options, Session& session) {
  Importer::Sources sources(options.words.begin(), options.words.end());
  std::error_code error;
  const bool named = options.words.front() == "video" && !fs::exists(sources.front(), error);
  if (named) sources.erase(sources.begin());
  if (!named && !is_video(sources.front())) {
    if (options.frames_told)
      throw InputError({sources.front().string()}, "--frames, --every and --at are of videos",
                       "leave them out");
    return false;
  }
  if (sources.empty())
    throw InputError({"video"}, "there is no source behind the kind",
                     "hookeye import video VIDEO... -o FOLDER");
  if (!options.size.empty() || !options.lens.empty() || options.options.scale != 1)
    throw InputError({sources.front().string()}, "--size, --lens and --scale are of cameras",
                     "leave them out");
  for (const fs::path& source : sources)
    if (!fs::is_regular_file(source, error))
      throw InputError({source.string()}, "there is no such file", "name a video of each camera");
  run_import_videos(sources, options.frames, options.folder, session);
  return true;
}

/// Decks hold a body and load cases in place of cameras, scans a body. False: the words name none.
bool import_body_if_any(const ImportCommand& options, Session& session) {
  Importer::Sources sources(options.words.begin(), options.words.end());
  std::error_code error;
  const std::string kind = options.words.front();
  const bool named = (kind == "deck" || kind == "scan") && !fs::exists(sources.front(), error);
  if (named) sources.erase(sources.begin());
  const bool deck = named ? kind == "deck" : is_deck(sources.front());
  if (!deck && !named && !is_scan(sources.front())) return false;
  if (sources.empty())
    throw InputError({kind}, "there is no source behind the kind",
                     fmt::format("hookeye import {} SOURCE -o FOLDER", kind));
  if (!options.size.empty() || !options.lens.empty() || (deck && options.options.scale != 1))
    throw InputError({sources.front().string()},
                     fmt::format("--size, --lens{} are of cameras", deck ? " and --scale" : ""),
                     deck ? "leave them out: a deck keeps its own units" : "leave them out");
  for (const fs::path& source : sources)
    if (!fs::is_regular_file(source, error))
      throw InputError({source.string()}, "there is no such file",
                       deck ? "name a deck of one body" : "name an obj or ply file");
  if (!deck && sources.size() > 1)
    throw InputError({sources[1].string()}, "there is a second source", "one scan alone");
  if (deck)
    run_import_decks(sources, options.folder, session);
  else
    run_import_scan(sources.front(), options.options.scale, options.folder, session);
  return true;
}

void run_import(const ImportCommand& options, Session& session) {
  if (import_videos_if_any(options, session) || import_body_if_any(options, session)) return;
  const auto [importer, sources] = chosen_importer(options);
  const Scope scope("source " + sources.front().string());
  const fs::path file = fs::path(options.folder) / "cameras.yaml";
  refuse_to_overwrite_cameras(file);
  const Imported imported = import_cameras(*importer, sources, options.options);
  const std::vector<Reprojection> seen = reproject(imported);
  std::string told;
  for (const fs::path& source : sources) told += " " + source.filename().string();
  session.document = {{"hookeye", 1},
                      {"command", "import"},
                      {"kind", importer->name()},
                      {"sources", options.words},
                      {"file", file.string()},
                      {"world", imported.world}};
  describe(imported, seen, session.document);
  std::error_code error;
  fs::create_directories(options.folder, error);
  if (error) throw cannot_write(options.folder, error.message());
  write_text(
      file, cameras_yaml(imported, head_line(kCamerasMark + ("import " + importer->name() + told)) +
                                       head_line("# the world is " + imported.world)));
  session.say("{}: {}\n{}", sources.front().string(), importer->title(),
              cameras_table(imported, seen));
  session.say("{}", wrapped("the world is " + imported.world, 2));
  for (const std::string& said : imported.said) session.say("{}", wrapped(said, 2));
  session.say("written to {}; a capture takes it by `cameras: {{from: cameras.yaml}}`\n",
              file.string());
}

}  // namespace

void add_import(CLI::App& app, CommandBody& chosen) {
  CLI::App* command =
      app.add_subcommand("import", "Cameras, a deck, a scan or videos, for a capture");
  const auto options = std::make_shared<ImportCommand>();
  std::string kinds = "\nKinds of sources:\n";
  for (const Importer* importer : importers())
    kinds += fmt::format("  {:<12} {}\n", importer->name(), importer->title());
  kinds +=
      fmt::format("  {:<12} {}\n", "deck", "body, supports and loads of Abaqus, CalculiX, FEBio");
  kinds += fmt::format("  {:<12} {}\n", "scan", "textured surface, obj with mtl or ply");
  kinds +=
      fmt::format("  {:<12} {}\n", "video", "frames of a video a camera, as photos with times");
  command->footer(kinds);
  command
      ->add_option("SOURCE", options->words,
                   "What the other program wrote; before it, if not recognised, its kind")
      ->required();
  command->add_option("-o,--out", options->folder, "Folder for what is written")->required();
  command->add_option("--size", options->size, "Size of the photos, where the source lacks it")
      ->check(picture_size());
  command
      ->add_option("--scale", options->options.scale,
                   "Length units of the capture in one of the source (metres to mm: 1000)")
      ->check(above_zero());
  command
      ->add_option("--lens", options->lens,
                   "opencv: read lenses of unpublished formula as OpenCV's k1 k2 k3 p1 p2")
      ->check(CLI::IsMember({"opencv"}));
  auto* count = command
                    ->add_option("--frames", options->frames.count,
                                 "Of a video: so many photos, evenly over its time (100)")
                    ->check(CLI::Range(1, 100000));
  auto* every =
      command
          ->add_option("--every", options->frames.every, "Of a video: a photo each so many seconds")
          ->check(above_zero())
          ->excludes(count);
  auto* at =
      command
          ->add_option("--at", options->frames.at,
                       "Of a video: photos at these seconds from its first frame, as 0,2.5,5")
          ->delimiter(',')
          ->excludes(count)
          ->excludes(every);
  command->callback([&chosen, options, count, every, at] {
    options->frames_told = count->count() + every->count() + at->count() > 0;
    options->options.lens_as_opencv = options->lens == "opencv";
    if (!options->size.empty())
      std::sscanf(options->size.c_str(), "%dx%d", &options->options.width,
                  &options->options.height);
    chosen = [options](Session& session) { run_import(*options, session); };
  });
}

}  // namespace hookeye
