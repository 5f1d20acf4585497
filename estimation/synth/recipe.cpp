#include "estimation/synth/recipe.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "capture_io/capture_reader.h"
#include "core/input_error.h"
#include "core/text_file.h"
#include "estimation/effects/catalogue.h"
#include "estimation/model/effect.h"
#include "estimation/synth/recipe_sections.h"
#include "simulation/energy_term.h"

namespace hookeye {

namespace {

/// A picture in the surface's texture coordinates, or the numbers of speckles.
void read_texture(const YamlNode* node, const CaptureFolder& folder, Recipe& recipe) {
  TextureRecipe& texture = recipe.texture;
  const Vector3d& size = recipe.shape.size;
  texture.texel = size.maxCoeff() / 500.0;
  texture.speckle = size.maxCoeff() / 35.0;
  if (!node) return;
  const YamlSection section(
      *node, "texture",
      {"texel", "speckle", "cover", "soft", "dark", "bright", "image", "encoding"});
  texture.place = node->place;
  maybe(section, "texel", texture.texel);
  maybe(section, "speckle", texture.speckle);
  maybe(section, "cover", texture.cover, 0.01, 0.95);
  maybe(section, "soft", texture.soft, 0.01, 1.0);
  maybe(section, "dark", texture.dark, 0.0, 1.0);
  maybe(section, "bright", texture.bright, 0.0, 1.0);
  if (const YamlNode* image = section.find("image")) {
    texture.image = {read_file_path(*image, "image of the texture", folder), image->place};
    if (!recipe.shape.own() || recipe.shape.surface->uv.empty())
      throw InputError(image->place, "the surface has no texture coordinates for a picture",
                       "a `surface:` (obj) that has them, or leave `image` out: it is speckled");
  }
  if (const YamlNode* encoding = section.find("encoding"))
    texture.encoding = read_encoding(*encoding, "encoding of the texture");
  if (texture.texel < size.maxCoeff() / 6000.0)
    throw InputError(node->place, "the texture would have more than 6000 texels along the body",
                     "a texel of about half the length that one pixel covers");
}

void read_shape(const YamlSection& section, ShapeRecipe& shape) {
  const std::vector<std::string> kinds = {"block", "cylinder", "blob"};
  const YamlNode& kind = section.need("shape", "shape: block, cylinder or blob; or surface: FILE");
  const std::string chosen = read_choice(kind, "shape of the body", kinds);
  shape.kind =
      static_cast<ShapeRecipe::Kind>(std::find(kinds.begin(), kinds.end(), chosen) - kinds.begin());
  const YamlNode& size = section.need("size", "size: [30, 24, 60]");
  shape.size = read_vector3(size, "size of the body");
  if (!(shape.size.minCoeff() > 0.0))
    throw InputError(size.place, "a side of the body is not positive", "size: [30, 24, 60]");
  maybe(section, "taper", shape.taper, 0.3, 3.0);
  maybe(section, "bumps", shape.bumps, 0.0, 0.3);
  maybe(section, "facet", shape.facet);
  if (shape.facet < shape.size.maxCoeff() / 200.0)
    throw InputError(section.place(), fmt::format("facet = {} is too small", shape.facet),
                     "about the edge of the mesh");
}

void read_own_surface(const YamlSection& section, const CaptureFolder& folder, ShapeRecipe& shape) {
  for (const char* key : {"shape", "size", "taper", "bumps", "facet"})
    if (const YamlNode* node = section.find(key))
      throw InputError(node->place,
                       fmt::format("`{}` is of a drawn shape, and the body is a file's", key),
                       fmt::format("leave `surface` or `{}` out", key));
  const YamlNode& node = *section.find("surface");
  shape.kind = ShapeRecipe::Kind::surface;
  shape.file = {read_file_path(node, "surface of the body", folder, {".obj", ".ply", ".stl"}),
                node.place};
  try {
    shape.surface = std::make_shared<const SurfaceMesh>(read_surface(shape.file.path));
  } catch (const InputError& error) {
    throw told_at(node.place, error);
  }
  const Matrix3Xd& X = shape.surface->X;
  shape.size = X.rowwise().maxCoeff() - X.rowwise().minCoeff();
}

void read_body(const YamlNode& node, const CaptureFolder& folder, Recipe& recipe) {
  const YamlSection section(
      node, "body",
      {"shape", "surface", "size", "taper", "bumps", "facet", "mesh", "density", "texture"});
  const YamlSection mesh(section.need("mesh", "mesh: {edge: 6} is what the capture tells"), "mesh",
                         {"edge", "order"});
  recipe.edge = read_positive(mesh.need("edge", "mesh: {edge: 6}"), "edge of mesh");
  maybe(mesh, "order", recipe.order, 1, 2);
  // coarser than the tetrahedra, so that both the truth and the fit divide it
  recipe.shape.facet = 1.5 * recipe.edge;
  if (section.has("surface"))
    read_own_surface(section, folder, recipe.shape);
  else
    read_shape(section, recipe.shape);
  maybe(section, "density", recipe.density);
  read_texture(section.find("texture"), folder, recipe);
}

/// Of a surface; a shape has its own.
void read_patches(const YamlSection& top, const CaptureFolder& folder, Recipe& recipe) {
  const YamlNode* node = top.find("regions");
  if (!recipe.shape.own()) {
    if (node)
      throw InputError(node->place, "a drawn shape has regions of its own: base, grip, side",
                       "leave `regions` out, or give the body as `surface: FILE`");
    return;
  }
  const char* right = "regions: {base: {halfspace: {point: [0, 0, 0.1], normal: [0, 0, -1]}}, ...}";
  recipe.regions = read_regions(top.need("regions", right), folder);
  const auto names = names_of(recipe.regions);
  if (std::find(names.begin(), names.end(), "base") == names.end())
    throw InputError(top.find("regions")->place, "no region `base`: it is held in all examples",
                     right);
}

std::map<std::string, MaterialSpec::Value> read_law_numbers(const YamlNode& node,
                                                            const std::string& what) {
  std::map<std::string, MaterialSpec::Value> out;
  for (const YamlNode::Entry& entry : read_named(node, what)) {
    MaterialSpec::Value value;
    value.place = entry.value.place;
    const std::string name = fmt::format("{} of {}", entry.key, what);
    if (entry.value.kind == YamlNode::Kind::sequence)
      value.numbers = read_numbers(entry.value, name);
    else
      value.numbers = {read_number(entry.value, name)};
    out[entry.key] = value;
  }
  return out;
}

void read_material(const YamlNode& node, Recipe& recipe) {
  const YamlSection section(node, "material", {"law", "true", "told", "fit"});
  MaterialRecipe& material = recipe.material;
  const YamlNode& law = section.need("law", "law: neo-hookean");
  material.truth.law = read_string(law, "law of the material");
  material.truth.place = law.place;
  material.truth.parameters =
      read_law_numbers(section.need("true", "true: {mu: 0.05, kappa_over_mu: 12}"), "true");
  material.told = material.truth;
  if (const YamlNode* told = section.find("told"))
    for (const auto& [name, value] : read_law_numbers(*told, "told"))
      material.told.parameters[name] = value;
  make_law(material.truth);  // refuses unknown laws and names
  make_law(material.told);
  std::vector<std::string> known;
  for (const auto& [name, value] : material.truth.parameters) known.push_back(name);
  const char* right = "fit: [mu]";
  for (const YamlNode& item : read_list(section.need("fit", right), "fit", right)) {
    const std::string name = read_string(item, "a parameter to fit");
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw InputError(item.place, fmt::format("the law has no parameter `{}`", name),
                       suggest(name, known));
    material.fit.push_back(name);
  }
}

ExampleRecipe read_example(const YamlNode::Entry& entry, const std::vector<std::string>& regions) {
  const std::string what = fmt::format("example {}", entry.key);
  const YamlSection section(entry.value, what,
                            {"use", "region", "force", "move", "rotate", "axis"});
  ExampleRecipe example;
  example.name = entry.key;
  example.place = entry.place;
  if (const YamlNode* use = section.find("use")) {
    const std::string chosen = read_choice(*use, "use", {"fit", "validate", "test"});
    example.validate = chosen != "fit", example.test = chosen == "test";
  }
  const YamlNode* region = section.find("region");
  if (region) example.region = read_choice(*region, "region", regions);
  if (const YamlNode* force = section.find("force")) example.force = read_vector3(*force, "force");
  if (const YamlNode* move = section.find("move")) example.move = read_vector3(*move, "move");
  if (const YamlNode* rotate = section.find("rotate"))
    example.rotate_degrees = read_number(*rotate, "rotate");
  if (const YamlNode* axis = section.find("axis")) example.axis = read_direction(*axis, "axis");
  if (example.force && example.moves())
    throw InputError(entry.place, fmt::format("{} has a force and a motion", what),
                     "a grip is either loaded (force) or moved (move, rotate)");
  const bool named = std::find(regions.begin(), regions.end(), example.region) != regions.end();
  if ((example.force || example.moves()) && !named)
    throw InputError(entry.place, fmt::format("{} does not say on which region it acts", what),
                     fmt::format("region: {}", fmt::join(regions, " or ")));
  return example;
}

HiddenRecipe read_hidden(const YamlNode& node) {
  const YamlSection section(node, "a hidden effect",
                            {"effect", "variant", "values", "rms_px", "times"});
  HiddenRecipe hidden;
  const YamlNode& effect = section.need("effect", "effect: gravity");
  hidden.effect = read_string(effect, "effect");
  hidden.place = hidden.variant_place = effect.place;
  if (!find_effect(hidden.effect)) {
    std::vector<std::string> known;
    for (const Effect* one : catalogue()) known.push_back(one->name());
    throw InputError(effect.place, fmt::format("there is no effect `{}`", hidden.effect),
                     suggest(hidden.effect, known));
  }
  if (const YamlNode* variant = section.find("variant")) {
    hidden.variant = read_string(*variant, "variant");
    hidden.variant_place = variant->place;
  }
  hidden.values_place = effect.place;
  if (const YamlNode* values = section.find("values")) {
    hidden.drawn = false;
    hidden.values_place = values->place;
    for (const YamlNode::Entry& entry : read_named(*values, "values"))
      hidden.values[entry.key] = {read_number(entry.value, entry.key), entry.place};
  }
  if (const YamlNode* size = section.find("rms_px")) hidden.rms_px = read_positive(*size, "rms_px");
  if (const YamlNode* times = section.find("times")) hidden.times = read_positive(*times, "times");
  return hidden;
}

void read_examples(const YamlNode& node, Recipe& recipe) {
  std::vector<std::string> regions = {"grip", "side"};
  if (recipe.shape.own()) {
    regions = names_of(recipe.regions);
    std::erase(regions, "base");
  }
  for (const YamlNode::Entry& entry : read_named(node, "examples"))
    recipe.examples.push_back(read_example(entry, regions));
  const bool fitted = std::any_of(recipe.examples.begin(), recipe.examples.end(),
                                  [](const ExampleRecipe& e) { return !e.validate; });
  if (!fitted)
    throw InputError(node.place, "no example is fitted", "leave `use: validate` out of one");
}

}  // namespace

Recipe parse_recipe(const std::string& text, const std::string& name) {
  const YamlNode root = parse_yaml(text, name);
  const YamlSection top(
      root, "a recipe",
      {"hookeye_recipe", "title", "seed", "units", "body", "material", "cameras", "gravity",
       "light", "regions", "examples", "hidden", "noise", "photos", "truth"});
  const YamlNode& version = top.need("hookeye_recipe", "begin with `hookeye_recipe: 1`");
  if (read_integer(version, "hookeye_recipe") != 1)
    throw InputError(version.place, "a recipe of another version", "hookeye_recipe: 1");
  Recipe recipe;
  recipe.file = name;
  recipe.text = text;
  recipe.title = std::filesystem::path(name).stem().string();
  if (const YamlNode* title = top.find("title")) recipe.title = read_string(*title, "title");
  if (const YamlNode* seed = top.find("seed")) {
    const int value = read_integer(*seed, "seed");
    if (value < 0) throw InputError(seed->place, "the seed is negative", "seed: 1");
    recipe.seed = static_cast<unsigned>(value);
  }
  if (const YamlNode* units = top.find("units")) {
    const YamlSection section(*units, "units", {"length", "force"});
    const char* right = "units: {length: mm, force: N}";
    recipe.units = {
        read_choice(section.need("length", right), "the unit of length", {"mm", "cm", "m", "um"}),
        read_choice(section.need("force", right), "the unit of force", {"N", "mN", "kN", "uN"})};
  }
  const std::filesystem::path given = std::filesystem::path(name).parent_path();
  const CaptureFolder folder{given, std::filesystem::weakly_canonical(given.empty() ? "." : given)};
  read_body(top.need("body", "body: {shape: block, size: [30, 24, 60], mesh: {edge: 6}}"), folder,
            recipe);
  read_patches(top, folder, recipe);
  read_material(top.need("material", "material: {law: neo-hookean, true: {...}, fit: [mu]}"),
                recipe);
  read_cameras(top.need("cameras", "cameras: {count: 2, focal: 1500}"), recipe);
  const YamlNode empty{YamlNode::Kind::map, root.place, {}, {}, {}};
  const auto or_empty = [&](const char* key) -> const YamlNode& {
    const YamlNode* node = top.find(key);
    return node ? *node : empty;
  };
  read_light(or_empty("light"), recipe);
  read_examples(top.need("examples", "examples: {rest: {}, pull: {force: [0, 0, 0.3]}}"), recipe);
  if (const YamlNode* hidden = top.find("hidden"))
    for (const YamlNode& node : read_list(*hidden, "hidden", "a list of effects; [] hides nothing"))
      recipe.hidden.push_back(read_hidden(node));
  if (const YamlNode* gravity = top.find("gravity"))
    recipe.gravity = read_vector3(*gravity, "gravity");
  read_noise(or_empty("noise"), recipe);
  read_photos(or_empty("photos"), recipe);
  read_truth(or_empty("truth"), recipe);
  return recipe;
}

Recipe read_recipe(const std::filesystem::path& file) {
  return parse_recipe(read_text(file), file.string());
}

}  // namespace hookeye
