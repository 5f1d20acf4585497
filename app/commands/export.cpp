// hookeye export: the model of a run's step, for another program.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "app/commands/commands.h"
#include "app/commands/export_seen.h"
#include "app/commands/run_support.h"
#include "app/commands/solve.h"
#include "app/validators.h"
#include "core/text_file.h"
#include "estimation/effects/catalogue.h"
#include "exporters/exporter.h"
#include "runs/run_limits.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct ExportOptions {
  std::string run, to, out;
  int step = -1;
  SeenArguments seen;
};

/// The folder itself: a trailing slash has no name.
fs::path folder_of(const std::string& told) {
  fs::path out = fs::absolute(told).lexically_normal();
  if (out.filename().empty()) out = out.parent_path();
  return out;
}

void refuse_full_folder(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) return;
  if (fs::is_directory(folder, error) && fs::is_empty(folder, error)) return;
  throw InputError({folder.string()}, "there is something at this place already",
                   "an empty folder behind -o, or one that does not exist");
}

/// Whole or not at all: into a folder beside it first.
void write_folder(const fs::path& folder, const Exported& exported) {
  const fs::path part =
      folder.parent_path() / fmt::format(".{}.part-{}", folder.filename().string(), ::getpid());
  std::error_code error;
  fs::create_directories(part, error);
  if (error) throw cannot_write(folder.string(), error.message());
  try {
    for (const auto& [name, text] : exported.files) write_text(part / name, text);
  } catch (...) {
    fs::remove_all(part, error);
    throw;
  }
  fs::rename(part, folder, error);  // replaces an empty folder
  if (!error) return;
  const std::string why = error.message();
  fs::remove_all(part, error);
  throw cannot_write(folder.string(), why);
}

/// Index of the step that is asked for, the newest if none is.
size_t step_index(const Run& run, int asked) {
  const size_t count = run.steps().size();
  if (count == 0)
    throw InputError({run.folder().string()}, "the run has no finished step",
                     "run 'hookeye fit CAPTURE -o RUN' first");
  if (asked < 0) return count - 1;
  if (static_cast<size_t>(asked) < count) return static_cast<size_t>(asked);
  throw InputError({run.folder().string()}, fmt::format("the run has no step {}", asked),
                   fmt::format("--step from 0 to {}, the newest", count - 1));
}

/// The ingredients that a search or a user added, with the sentence that each says.
std::vector<Added> added_to(const ModelForm& form, const VectorXd& p) {
  std::vector<Added> out;
  Eigen::Index at = 0;
  Model model = form.start;
  for (const auto& ingredient : form.ingredients) {
    auto parameters = ingredient->parameters();
    const VectorXd values = p.segment(at, static_cast<Eigen::Index>(parameters.size()));
    at += values.size();
    if (const Effect* effect = catalogue().find(ingredient->name())) {
      for (size_t k = 0; k < parameters.size(); ++k)
        parameters[k].value = values[static_cast<Eigen::Index>(k)];
      const Touches touches = ingredient->touches();
      out.push_back({ingredient->name(), ingredient->variant(),
                     effect->sentence(model, *ingredient, values),
                     touches.energy || touches.loading, parameters});
    }
    ingredient->apply(values, model);
  }
  return out;
}

/// Equilibria of all load cases; what has none is told.
void find_equilibria(const Model& model, SolverModel& out, Session& session) {
  std::vector<VectorXd> found(model.examples.size());
  const auto failures = solve_examples(model, "solving", [&](int e, const Equilibrium& state) {
    found[static_cast<size_t>(e)] = state.q;
  });
  for (size_t e = 0; e < found.size(); ++e) {
    if (found[e].size()) set_found(out, static_cast<int>(e), found[e]);
    if (!failures[e] && cancelled(failures[e].error())) fail(failures[e].error());
    if (!failures[e])
      session.warn(fmt::format("load case {}: no equilibrium to compare with ({})",
                               out.cases[e].name, failures[e].error().reason));
  }
}

void describe(const SolverModel& model, const Exported& exported, Json& document) {
  document["step"] = model.step;
  document["files"] = Json::array();
  for (const auto& [name, text] : exported.files) document["files"].push_back(name);
  document["load_cases"] = Json::array();
  for (const SolverCase& one : model.cases)
    document["load_cases"].push_back({{"name", one.name},
                                      {"file", one.file},
                                      {"use", one.use},
                                      {"strains", one.strains},
                                      {"volume_ratio", {one.lowest_J, one.highest_J}}});
  document["notes"] = exported.notes;
  document["lacks"] = exported.lacks;
}

void run_export(const ExportOptions& options, Session& session) {
  const Exporter& exporter = *find_exporter(options.to);
  const fs::path folder = folder_of(options.out);
  refuse_full_folder(folder);
  const SeenOptions seen = seen_options(options.seen);
  if (options.seen.told() && !exporter.of_pictures())
    throw InputError({"--to " + exporter.name()},
                     "--grid, --window, --gauge, --line and --along are of pictures",
                     "--to dic, or leave them out");
  const Run run = open_run(options.run, false);
  const fs::path step = run.steps().at(step_index(run, options.step));
  const auto scene = load_scene(without_tests(read_capture(run.capture())), exporter.of_pictures(),
                                limits_of(run.timeline()));
  const auto [form, p] = read_model(step / "model.yaml", scene, catalogue());
  const Model model = form.realise(p);
  SolverModel solver = solver_model(model);
  solver.step = step.filename().string();
  solver.added = added_to(form, p);
  if (exporter.of_pictures())
    solver.seen = look_at(form, p, seen);
  else
    find_equilibria(model, solver, session);
  const Exported exported = export_model(exporter, solver);
  write_folder(folder, exported);
  session.document = {{"hookeye", 1},
                      {"command", "export"},
                      {"run", run.folder().string()},
                      {"to", options.to},
                      {"folder", folder.string()}};
  describe(solver, exported, session.document);
  session.say("{}\n", wrapped(fmt::format("step {} for {}: {}", solver.step, exporter.name(),
                                          exporter.title())));
  for (const std::string& note : exported.notes) session.say("{}", wrapped(note, 2));
  for (const std::string& lack : exported.lacks) session.warn(lack);
  session.say("written to {} ({} files; README.txt says what they hold)\n", folder.string(),
              exported.files.size());
}

}  // namespace

void add_export(CLI::App& app, CommandBody& chosen) {
  CLI::App* command =
      app.add_subcommand("export", "The found model, supports and loads for another program");
  const auto options = std::make_shared<ExportOptions>();
  std::vector<std::string> names;
  std::string kinds = "\nPrograms:\n";
  for (const Exporter* exporter : exporters()) {
    names.push_back(exporter->name());
    kinds += fmt::format("  {:<12} {}\n", exporter->name(), exporter->title());
  }
  command->footer(kinds);
  command->add_option("RUN", options->run, "Run folder")->required();
  command->add_option("--to", options->to, "The program")->required()->check(CLI::IsMember(names));
  command->add_option("--step", options->step, "Number of the step (default: the newest)")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--grid", options->seen.grid_px, "dic: from point to point [px] (16)")
      ->check(counting_number());
  command->add_option("--window", options->seen.window, "dic: points across a strain window (5)")
      ->check(CLI::Range(3, 99));
  command->add_option("--gauge", options->seen.gauges, "dic: mean over this region (default: all)");
  command->add_option("--line", options->seen.lines,
                      "dic: extensometer between points of the body at rest, x,y,z:x,y,z");
  command->add_option("--along", options->seen.along,
                      "dic: what exx is along, x,y,z (default: the picture's right)");
  command->add_option("-o,--out", options->out, "Folder that is empty or does not exist")
      ->required();
  command->callback([&chosen, options] {
    chosen = [options](Session& session) { run_export(*options, session); };
  });
}

}  // namespace hookeye
