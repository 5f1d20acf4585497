// hookeye render: what the cameras would see of every example.
#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/commands/run_support.h"
#include "app/commands/solve.h"
#include "app/interrupt.h"
#include "core/scope.h"
#include "runs/look.h"

namespace hookeye {
namespace {

struct RenderCommand {
  std::string capture, out, model, format = "exr";
};

using Json = nlohmann::ordered_json;

void run_render(const RenderCommand& options, Session& session) {
  Capture capture = read_capture(options.capture);
  if (capture.cameras.empty())
    throw InputError({capture.file.string()}, "the capture has no cameras",
                     "cameras: {front: {size: [800, 600], intrinsics: ..., pose: ...}}");
  const bool from_photos = capture.body.texture == BodySpec::Texture::rest;
  if (!from_photos) look_with_all_cameras(capture);
  Limits whole;
  whole.fit.pixels = 0.0;  // pictures of the size that the capture tells
  const auto scene = load_scene(capture, from_photos, whole);
  warn_of_doubts(*scene, session);
  const Model model = realise_model(options.model, scene);

  std::vector<VectorXd> q(capture.examples.size());
  auto failures =
      solve_examples(model, "simulating", [&](int e, const Equilibrium& state) { q[e] = state.q; });
  fail_on_first(failures);
  const int reference = from_photos ? scene->example_index(capture.body.texture_example) : -1;
  const std::filesystem::path folder = std::filesystem::path(options.out) / "photos";
  std::filesystem::create_directories(folder);
  auto& document = session.document;
  document = {{"hookeye", 1}, {"command", "render"}, {"capture", capture.file.string()}};
  document["photos"] = Json::array();
  for (size_t e = 0; e < capture.examples.size(); ++e) {
    const ExampleSpec& example = capture.examples[e];
    // the photos that give the texture would only be copied
    if (static_cast<int>(e) == reference) continue;
    const Scope scope("example " + example.name);
    PhotoComparer comparer(scene, static_cast<int>(e));
    for (size_t k = 0; k < example.photos.size(); ++k) {
      if (interrupted()) throw Interrupted{};
      const std::string& camera = example.photos[k].camera;
      const auto file = folder / fmt::format("{}_{}.{}", example.name, camera, options.format);
      const Encoding encoding{options.format == "png" ? Encoding::Kind::srgb
                                                      : Encoding::Kind::linear};
      write_image(file,
                  look(comparer, model, static_cast<int>(e), static_cast<int>(k), q[e],
                       reference >= 0 ? &q[reference] : nullptr)
                      .picture,
                  encoding);
      document["photos"].push_back(
          {{"example", example.name}, {"camera", camera}, {"file", file.string()}});
      session.say("{}\n", file.string());
    }
  }
}

}  // namespace

void add_render(CLI::App& app, CommandBody& chosen) {
  CLI::App* command = app.add_subcommand("render", "Synthetic photos of every example");
  const auto options = std::make_shared<RenderCommand>();
  command->add_option("CAPTURE", options->capture, "capture.yaml or its folder")->required();
  command->add_option("-o,--out", options->out, "Folder: OUT/photos/EXAMPLE_CAMERA.exr")
      ->required();
  command->add_option("-m,--model", options->model, "model.yaml of a run's step (default: base)");
  command
      ->add_option("--format", options->format,
                   "exr: float, linear (default); tif: 16 bit, linear; png: 8 bit, sRGB")
      ->check(CLI::IsMember({"exr", "tif", "png"}));
  command->callback([&chosen, options] {
    chosen = [options](Session& session) { run_render(*options, session); };
  });
}

}  // namespace hookeye
