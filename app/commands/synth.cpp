// hookeye synth: synthetic photos with a hidden effect.
#include "estimation/synth/synth.h"

#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "runs/failed.h"

namespace hookeye {
namespace {

struct SynthCommand {
  std::string recipe, out, photographer;
};

void run_synth(const SynthCommand& options, Session& session) {
  const Recipe recipe = read_recipe(options.recipe);
  const int photos = static_cast<int>(recipe.examples.size()) * recipe.cameras.count;
  SynthOptions synth;
  synth.cancel = &interrupted();
  synth.photographer = options.photographer;
  Synthesis made;
  {
    Progress progress("photographing", photos + 1);
    synth.progress = [&](const std::string& note) { progress.advance(note); };
    auto result = synthesize(recipe, options.out, synth);
    if (!result) fail(std::move(result.error()));
    made = *std::move(result);
  }
  auto& document = session.document;
  document = {{"hookeye", 1},
              {"command", "synth"},
              {"capture", made.capture.string()},
              {"truth", made.truth.string()},
              {"nodes", made.nodes},
              {"photos", made.photos}};
  // What is hidden stays out of sight: it stands in the truth file alone.
  session.say("{} photos of {} examples, solved on {} nodes\ncapture: {}\ntruth:   {}\n",
              made.photos, recipe.examples.size(), made.nodes, options.out, made.truth.string());
}

}  // namespace

void add_synth(CLI::App& app, CommandBody& chosen) {
  CLI::App* command =
      app.add_subcommand("synth", "Synthetic photos with a hidden effect, from a recipe");
  const auto options = std::make_shared<SynthCommand>();
  command->add_option("RECIPE", options->recipe, "recipe.yaml (docs/synth.md)")->required();
  command
      ->add_option("-o,--out", options->out,
                   "New capture folder; the truth goes to CAPTURE.truth.json")
      ->required();
  command->add_option("--photographer", options->photographer,
                      "A command that takes the pictures in our place (docs/synth.md)");
  command->callback([&chosen, options] {
    chosen = [options](Session& session) { run_synth(*options, session); };
  });
}

}  // namespace hookeye
