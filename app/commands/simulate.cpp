// hookeye simulate: the equilibrium of every example.
#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/commands/describe.h"
#include "app/commands/run_support.h"
#include "app/commands/solve.h"

namespace hookeye {
namespace {

struct SimulateOptions {
  std::string capture, out, model;
};

using Json = nlohmann::ordered_json;

/// Writes OUT/deformed/EXAMPLE.vtu: points at rest, arrays in double precision.
std::filesystem::path write_state(const std::filesystem::path& out, const Model& model, int e,
                                  const Equilibrium& state) {
  const TetMesh& mesh = model.scene->body->mesh;
  const ElementState elements = element_state(mesh, model.energy_of(e), state.q);
  const auto by_node = [&](const VectorXd& v) -> Eigen::MatrixXd {
    return v.reshaped(3, mesh.nodes());
  };
  // Free unknowns carry what rounding left of the residual: they have no reaction.
  VectorXd reaction = VectorXd::Zero(state.R.size());
  for (const int i : model.examples[e].loading.prescribed) reaction[i] = state.R[i];
  const auto file = out / "deformed" / (model.scene->capture.examples[e].name + ".vtu");
  write_vtu(file, mesh,
            {{"displacement", by_node(state.q) - mesh.X, true},
             {"reaction", by_node(reaction), true},
             {"von_mises", elements.von_mises.transpose(), false},
             {"green_strain", elements.green_strain, false},
             {"cauchy_stress", elements.cauchy_stress, false},
             {"volume_ratio", elements.J.transpose(), false},
             {"energy_density", elements.energy_density.transpose(), false}});
  return file;
}

Json describe_state(const Model& model, int e, const Equilibrium& state) {
  const Scene& scene = *model.scene;
  const ExampleSpec& example = scene.capture.examples[e];
  const TetMesh& mesh = scene.body->mesh;
  const Eigen::MatrixXd u = state.q.reshaped(3, mesh.nodes()) - mesh.X;
  Json supports = Json::array();
  for (const auto& support : example.supports) {
    const Region& region = scene.body->regions.at(support.region);
    supports.push_back({{"region", support.region},
                        {"force", describe_vector(support_force(state, region))},
                        {"moment", describe_vector(support_moment(state, region, region.centroid))},
                        {"about", describe_vector(region.centroid)}});
  }
  return {{"name", example.name},
          {"max_displacement", u.colwise().norm().maxCoeff()},
          {"newton_iterations", state.newton_iterations},
          {"factorizations", state.factorizations},
          {"stable", state.stable},
          {"supports", supports}};
}

void say_states(Session& session, const Json& examples, const Units& units) {
  std::vector<std::vector<std::string>> rows{{"example", "max |u| [" + units.length + "]", "Newton",
                                              "support", "force [" + units.force + "]"}};
  for (const auto& example : examples) {
    rows.push_back({example["name"],
                    fmt::format("{:.5g}", example["max_displacement"].get<double>()),
                    std::to_string(example["newton_iterations"].get<int>())});
    for (size_t s = 0; s < example["supports"].size(); ++s) {
      if (s > 0) rows.push_back({"", "", ""});
      const auto& support = example["supports"][s];
      const auto f = support["force"].get<std::vector<double>>();
      rows.back().push_back(support["region"]);
      rows.back().push_back(vector_text({f[0], f[1], f[2]}));
    }
  }
  session.say("{}", table(rows));
}

void run_simulate(const SimulateOptions& options, Session& session) {
  const Capture capture = read_capture(options.capture);
  const auto scene = load_scene(capture, false);
  warn_of_doubts(*scene, session);
  const Model model = realise_model(options.model, scene);
  const std::filesystem::path out = options.out;
  std::filesystem::create_directories(out / "deformed");
  std::vector<Json> described(capture.examples.size());
  auto failures = solve_examples(model, "simulating", [&](int e, const Equilibrium& state) {
    described[e] = describe_state(model, e, state);
    described[e]["file"] = write_state(out, model, e, state).string();
  });
  auto& document = session.document;
  document["hookeye"] = 1;
  document["command"] = "simulate";
  document["capture"] = capture.file.string();
  document["units"] = {{"length", capture.units.length}, {"force", capture.units.force}};
  document["unknowns"] = 3 * scene->body->mesh.nodes();
  document["examples"] = Json::array();
  for (auto& example : described)
    if (!example.is_null()) document["examples"].push_back(std::move(example));
  for (const auto& example : document["examples"])
    if (!example["stable"].get<bool>())
      session.warn(fmt::format("example {}: this equilibrium is unstable, the body would buckle",
                               example["name"].get<std::string>()));
  say_states(session, document["examples"], capture.units);
  fail_on_first(failures);
  session.say("written to {}\n", (out / "deformed").string());
}

}  // namespace

void add_simulate(CLI::App& app, CommandBody& chosen) {
  CLI::App* command = app.add_subcommand("simulate", "Equilibrium of every example of a capture");
  const auto options = std::make_shared<SimulateOptions>();
  command->add_option("CAPTURE", options->capture, "capture.yaml or its folder")->required();
  command->add_option("-o,--out", options->out, "Folder: OUT/deformed/EXAMPLE.vtu")->required();
  command->add_option("-m,--model", options->model, "model.yaml of a run's step (default: base)");
  command->callback([&chosen, options] {
    chosen = [options](Session& session) { run_simulate(*options, session); };
  });
}

}  // namespace hookeye
