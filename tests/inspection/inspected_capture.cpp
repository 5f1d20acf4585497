#include "inspection/inspected_capture.h"

#include <fmt/format.h>

#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "estimation/synth/synth.h"

namespace hookeye::test {

namespace fs = std::filesystem;

namespace {

constexpr const char* kRecipe = R"(hookeye_recipe: 1
title: looked at
seed: 4
body:
  shape: block
  size: [22, 16, 34]
  taper: 0.9
  bumps: 0.06
  facet: 5
  mesh: {edge: 6}
  density: 1.07e-9
  texture: {texel: 0.1, speckle: 1.3}
material:
  law: neo-hookean
  true: {mu: 0.02, kappa_over_mu: 10}
  told: {mu: 0.017}
  fit: [mu]
cameras: {count: 2, size: [400, 480], distance: 6, focal: 2100, spread: 55}
examples:
  rest: {}
  pull: {force: [0, 0, 0.3]}
  side: {force: [0.015, 0.008, 0]}
  twist: {rotate: 24}
  press: {move: [0, 0, -0.1]}
  poke: {use: validate, region: side, force: [-0.05, 0, 0]}
truth: {edge_factor: 0.8, rays_per_axis: 4}
)";

std::string read(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

/// Each recipe is made once.
const fs::path& right_capture(const std::string& recipe) {
  static const TemporaryFolder folder;
  static std::map<std::string, fs::path> made;
  const auto found = made.find(recipe);
  if (found != made.end()) return found->second;
  const auto out =
      synthesize(parse_recipe(recipe, "recipe.yaml"), folder / std::to_string(made.size()));
  return made.emplace(recipe, out->capture).first->second;
}

}  // namespace

InspectedCapture::InspectedCapture() : InspectedCapture(kRecipe) {}

InspectedCapture::InspectedCapture(const std::string& recipe) {
  fs::copy(right_capture(recipe), folder_.path(),
           fs::copy_options::recursive | fs::copy_options::overwrite_existing);
}

std::string InspectedCapture::text() const { return read(folder_ / "capture.yaml"); }

void InspectedCapture::change(const std::string& what, const std::string& by) {
  const std::string now = text();
  const std::regex pattern(what);
  if (!std::regex_search(now, pattern))
    throw std::runtime_error(what + " is not in the capture:\n" + now);
  write(folder_ / "capture.yaml", std::regex_replace(now, pattern, by));
}

void InspectedCapture::change_numbers(const std::string& key,
                                      const std::function<double(double)>& f) {
  std::string now = text(), out;
  const std::string begin = key + ": [";
  size_t from = 0;
  for (size_t at = now.find(begin); at != std::string::npos; at = now.find(begin, from)) {
    const size_t first = at + begin.size(), end = now.find(']', first);
    out += now.substr(from, first - from);
    std::istringstream numbers(now.substr(first, end - first));
    std::string number, joint;
    while (std::getline(numbers, number, ',')) {
      out += joint + fmt::format("{:.17g}", f(std::stod(number)));
      joint = ", ";
    }
    from = end;
  }
  if (from == 0) throw std::runtime_error(key + " is not in the capture");
  write(folder_ / "capture.yaml", out + now.substr(from));
}

void InspectedCapture::change_photos(const std::function<Image(const Image&)>& f, int bits) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder_ / "photos"))
    files.push_back(entry.path());
  for (const fs::path& file : files) {
    const Image changed = f(read_image(file, Encoding{}));
    fs::remove(file);
    fs::path written = file;
    if (bits == 16) written.replace_extension(".tif");
    write_image(written, changed);
  }
  if (bits == 16) change("(photos/\\w+)\\.png", "$1.tif");
}

Inspection InspectedCapture::inspect(const InspectionOptions& options) const {
  return hookeye::inspect(*load_scene(read_capture(folder_.path())), options);
}

std::string said(const Inspection& inspection) {
  std::string out;
  for (const CaptureWarning& warning : inspection.warnings)
    out += warning.question + ": " + warning.text() + "\n";
  return out;
}

}  // namespace hookeye::test
