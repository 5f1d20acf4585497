// hookeye doctor: what this installation has, what the machine gives it, and how fast that is.
#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/machine/machine.h"
#include "app/machine/speed.h"
#include "core/helper_check.h"
#include "core/own_file.h"
#include "render/processor.h"
#include "runs/report/page.h"
#include "runs/versions.h"
#include "simulation/blas.h"

namespace hookeye {
namespace {

using Json = nlohmann::ordered_json;

/// A program of libexec/hookeye, and where it comes from on Debian 12.
struct KnownHelper {
  const char* name;
  const char* serves;
  bool needed;        ///< a capture cannot do without
  const char* build;  ///< package that a build needs for it
  const char* run;    ///< package of its library
};
constexpr KnownHelper kHelpers[] = {
    {"pictures", "photos: PNG, TIFF, JPEG, EXR", true, "libopenimageio-dev", "libopenimageio2.4"},
    {"calibration", "OpenCV's calibration files", true, "libopencv-core-dev", "libopencv-core406"},
    {"tetgen", "filling a surface with tetrahedra", true, "libtet1.5-dev", "libtet1.5"},
    {"repair", "mesh --repair (CGAL)", false, "libcgal-dev", "libgmp10 libmpfr6"},
    {"gmsh", "msh and medit meshes", false, "libgmsh-dev", "libgmsh4.8"},
    {"boards", "calibrate (OpenCV's markers)", false, "libopencv-contrib-dev",
     "libopencv-contrib406"}};

struct DoctorCommand {
  bool fast = false;
};

Json describe(const KnownHelper& known) {
  const HelperCheck check = check_helper(known.name);
  Json out = {{"name", known.name},      {"serves", known.serves}, {"needed", known.needed},
              {"there", check.there},    {"loads", check.loads},   {"missing", check.missing},
              {"seconds", check.seconds}};
  if (!check.there)
    out["remedy"] = fmt::format("a build where {} is installed", known.build);
  else if (!check.loads)
    out["remedy"] = fmt::format("apt-get install {}", known.run);
  else
    out["remedy"] = "";
  return out;
}

std::string state_of(const Json& helper) {
  if (helper["loads"])
    return fmt::format("ready, starts in {:.2f} s", helper["seconds"].get<double>());
  const auto missing = helper["missing"].get<std::string>();
  const std::string what = !helper["there"].get<bool>() ? "is not there"
                           : missing.empty()            ? "does not start"
                                                        : "lacks " + missing;
  return fmt::format("{}{}: {}", what, helper["needed"].get<bool>() ? "" : " (optional)",
                     helper["remedy"].get<std::string>());
}

std::string amount(double bytes) { return fmt::format("{:.3g} GB", bytes / 1e9); }

Json describe_machine() {
  const Machine machine = this_machine();
  const LoadedBlas blas = loaded_blas();
  const Vectors vectors = vectors_in_use();
  return {{"processor", machine.processor},
          {"cores", machine.cores},
          {"threads", machine.threads},
          {"memory", machine.memory},
          {"memory_free", machine.memory_free},
          {"folder", machine.here.string()},
          {"folder_free", machine.disk_free},
          {"scratch", machine.scratch.string()},
          {"scratch_free", machine.scratch_free},
          {"blas", {{"version", blas.version}, {"kernels", blas.kernels}, {"file", blas.file}}},
          {"embree",
           {{"version", vectors.version}, {"isa", vectors.embree}, {"rays_at_once", vectors.rays}}},
          {"pixels", vectors.pixels}};
}

void say_machine(const Session& session, const Json& machine) {
  const auto text = [&](const char* key) { return machine[key].get<std::string>(); };
  const auto bytes = [&](const char* key) { return amount(machine[key].get<double>()); };
  const Json &blas = machine["blas"], &embree = machine["embree"];
  const auto version = blas["version"].get<std::string>();
  session.say(
      "\n{}",
      table({{"machine", ""},
             {"processor", fmt::format("{}: {} of {} cores", text("processor"),
                                       machine["threads"].get<int>(), machine["cores"].get<int>())},
             {"memory", fmt::format("{}, {} free", bytes("memory"), bytes("memory_free"))},
             {"disk", fmt::format("{} free in {}", bytes("folder_free"), text("folder"))},
             {"temporary files",
              fmt::format("{} free in {}", bytes("scratch_free"), text("scratch"))},
             {"BLAS", version.empty()
                          ? "not OpenBLAS, so factorizations are several times slower"
                          : fmt::format("{}, for {}", version, blas["kernels"].get<std::string>())},
             {"", blas["file"].get<std::string>()},
             {"rays",
              fmt::format("Embree {}, {} at once ({})", embree["version"].get<std::string>(),
                          embree["rays_at_once"].get<int>(), embree["isa"].get<std::string>())},
             {"pixels", text("pixels")}}));
}

Json describe(const Speed& speed) {
  return {{"unknowns", speed.unknowns},
          {"equilibria", speed.equilibria},
          {"equilibria_s", speed.equilibria_s},
          {"equilibria_per_minute", 60.0 * speed.equilibria / speed.equilibria_s},
          {"megapixels", speed.megapixels},
          {"pictures_s", speed.pictures_s},
          {"megapixels_per_second", speed.megapixels / speed.pictures_s},
          {"seconds", speed.seconds}};
}

void say_speed(const Session& session, const Json& speed) {
  session.say("\n{}",
              table({{"speed", ""},
                     {"equilibria", fmt::format("{:.3g} a minute, of {} unknowns",
                                                speed["equilibria_per_minute"].get<double>(),
                                                speed["unknowns"].get<int>())},
                     {"pictures", fmt::format("{:.3g} megapixels a second, with derivatives",
                                              speed["megapixels_per_second"].get<double>())}}));
}

/// Program and helpers; returns whether all is there that a capture cannot do without.
bool say_installation(const Session& session, const Json& document) {
  std::vector<std::vector<std::string>> rows{{"part", "serves", "state"}};
  bool sound = true;
  for (const Json& helper : document["helpers"]) {
    sound = sound && (helper["loads"].get<bool>() || !helper["needed"].get<bool>());
    rows.push_back({helper["name"], helper["serves"], state_of(helper)});
  }
  rows.push_back({"page", "report, studio",
                  document["page"].get<bool>()
                      ? "ready"
                      : "was not built in: nodejs with npm, or -DHOOKEYE_PAGE=FILE"});
  session.say("hookeye {}\n", document["version"].get<std::string>());
  session.say("{}\n{}", wrapped("program " + document["program"].get<std::string>(), 2),
              table(rows));
  return sound;
}

void run_doctor(const DoctorCommand& options, Session& session) {
  Json& document = session.document;
  document = {{"hookeye", 1},
              {"command", "doctor"},
              {"version", version_text()},
              {"program", own_file().string()},
              {"made_by", versions()},
              {"helpers", Json::array()},
              {"page", has_page()}};
  for (const KnownHelper& known : kHelpers) document["helpers"].push_back(describe(known));
  const bool sound = say_installation(session, document);
  document["machine"] = describe_machine();
  say_machine(session, document["machine"]);
  document["sound"] = sound;
  document["speed"] = nullptr;
  if (!options.fast && sound) {
    document["speed"] = describe(measure_speed());
    say_speed(session, document["speed"]);
  }
  session.say("\n{}\n", sound ? "all that a capture needs is there"
                              : "what is marked above has to be mended before a capture is read");
}

}  // namespace

void add_doctor(CLI::App& app, CommandBody& chosen) {
  CLI::App* command =
      app.add_subcommand("doctor", "What is installed, what this machine has, how fast it is");
  const auto options = std::make_shared<DoctorCommand>();
  command->add_flag("--fast", options->fast, "Measure no speed");
  command->callback([&chosen, options] {
    chosen = [options](Session& session) { run_doctor(*options, session); };
  });
}

}  // namespace hookeye
