#include "estimation/synth/recipe_sections.h"

#include <fmt/format.h>

namespace hookeye {

void maybe(const YamlSection& section, const std::string& key, double& value,
           double (*read)(const YamlNode&, const std::string&)) {
  if (const YamlNode* node = section.find(key))
    value = read(*node, fmt::format("{} of {}", key, section.what()));
}

void maybe(const YamlSection& section, const std::string& key, int& value, int low, int high) {
  const YamlNode* node = section.find(key);
  if (!node) return;
  value = read_integer(*node, fmt::format("{} of {}", key, section.what()));
  if (value < low || value > high)
    throw InputError(node->place, fmt::format("{} = {} is out of range", key, value),
                     fmt::format("an integer between {} and {}", low, high));
}

void maybe(const YamlSection& section, const std::string& key, double& value, double low,
           double high) {
  const YamlNode* node = section.find(key);
  if (!node) return;
  value = read_number(*node, fmt::format("{} of {}", key, section.what()));
  if (!(value >= low && value <= high))
    throw InputError(node->place, fmt::format("{} = {} is out of range", key, value),
                     fmt::format("a number between {} and {}", low, high));
}

namespace {

/// One name for all cameras or a list, and the numbers of the lenses.
void read_models(const YamlSection& section, CameraRecipe& cameras) {
  std::vector<std::string> names;
  for (const CameraModel* model : camera_models()) names.push_back(model->name());
  if (const YamlNode* told = section.find("projection")) {
    const bool each = told->kind == YamlNode::Kind::sequence;
    cameras.projection.clear();
    for (const YamlNode& one : each ? told->items : std::vector<YamlNode>{*told})
      cameras.projection.push_back(read_choice(one, "projection of cameras", names));
    if (each && told->items.size() != static_cast<size_t>(cameras.count))
      throw InputError(
          told->place,
          fmt::format("{} cameras have {} projections", cameras.count, told->items.size()),
          "one name for all, or a list of one a camera");
  }
  const YamlNode* lens = section.find("distortion");
  if (lens) cameras.distortion = read_numbers(*lens, "distortion of cameras");
  for (const std::string& name : cameras.projection)
    if (const CameraModel& model = camera_model(name);
        model.central() && !model.takes(cameras.distortion.size()))
      throw InputError(
          lens->place,
          fmt::format("distortion of {} cameras has {} numbers", name, cameras.distortion.size()),
          model.count_rule());
}

}  // namespace

void read_cameras(const YamlNode& node, Recipe& recipe) {
  const YamlSection section(node, "cameras",
                            {"count", "size", "distance", "focal", "projection", "distortion",
                             "vignetting", "azimuth", "spread", "elevation", "look_at"});
  CameraRecipe& cameras = recipe.cameras;
  cameras.place = node.place;
  maybe(section, "count", cameras.count, 1, 16);
  if (const YamlNode* size = section.find("size")) {
    const auto numbers = read_numbers(*size, "size of cameras");
    if (numbers.size() != 2 || numbers[0] < 16 || numbers[1] < 16 || numbers[0] > 8192 ||
        numbers[1] > 8192)
      throw InputError(size->place, "a picture has two sides of 16 to 8192 px", "size: [480, 360]");
    cameras.width = static_cast<int>(numbers[0]);
    cameras.height = static_cast<int>(numbers[1]);
  }
  maybe(section, "distance", cameras.distance, 1.0, 1000.0);
  cameras.focal = read_positive(section.need("focal", "focal: 1500, in px"), "focal of cameras");
  read_models(section, cameras);
  maybe(section, "vignetting", cameras.vignetting, 0.0, 100.0);
  maybe(section, "azimuth", cameras.azimuth, read_number);
  maybe(section, "spread", cameras.spread, read_number);
  maybe(section, "elevation", cameras.elevation, -80.0, 80.0);
  if (const YamlNode* at = section.find("look_at"); at && recipe.shape.own())
    cameras.look_at_point = read_vector3(*at, "look_at of cameras");
  else
    maybe(section, "look_at", cameras.look_at, -1.0, 2.0);
}

void read_light(const YamlNode& node, Recipe& recipe) {
  const YamlSection section(node, "light", {"ambient", "harmonics", "toward", "strength"});
  LightSpec& light = recipe.light;
  light.given = true;
  light.ambient = 0.35;
  double strength = 0.6;
  const YamlNode::Entry* harmonics = section.entry("harmonics");
  if (harmonics && section.has("ambient"))
    throw InputError(harmonics->place, "light has both `ambient` and `harmonics`",
                     "keep one of the two: an even sky is the first of the harmonics");
  if (harmonics) {
    read_harmonics(harmonics->value, light);
    strength = 0.0;
  }
  maybe(section, "ambient", light.ambient, 0.0, 1.0);
  maybe(section, "strength", strength, 0.0, 1.0);
  Vector3d toward = Vector3d(0.5, -0.4, 0.75).normalized();
  if (const YamlNode* given = section.find("toward")) toward = read_direction(*given, "toward");
  light.sun = strength * toward;
  if (Irradiance(light.ambient, light.uneven).most() + strength > 1.0)
    throw InputError(node.place,
                     harmonics ? "harmonics and strength light a white surface beyond full scale"
                               : "ambient and strength add up to more than full scale",
                     "keep their sum at 1 or below, or pictures saturate");
}

void read_noise(const YamlNode& node, Recipe& recipe) {
  const YamlSection section(node, "noise", {"full_well", "read", "bits", "force", "moment"});
  NoiseRecipe& noise = recipe.noise;
  maybe(section, "full_well", noise.full_well);
  maybe(section, "read", noise.read, read_not_negative);
  maybe(section, "force", noise.force);
  maybe(section, "moment", noise.moment);
  if (const YamlNode* bits = section.find("bits"))
    noise.bits = std::stoi(read_choice(*bits, "bits", {"8", "16"}));
}

void read_photos(const YamlNode& node, Recipe& recipe) {
  const YamlSection section(node, "photos", {"kind", "threshold"});
  recipe.photos.place = node.place;
  const YamlNode* kind = section.find("kind");
  if (!kind || read_choice(*kind, "kind of the photos", {"image", "silhouette"}) == "image") return;
  double threshold = 0.5;
  maybe(section, "threshold", threshold, 0.01, 0.99);
  recipe.photos.silhouette = threshold;
}

void read_truth(const YamlNode& node, Recipe& recipe) {
  const YamlSection section(node, "truth",
                            {"edge_factor", "order", "rays_per_axis", "visibility_rays"});
  maybe(section, "edge_factor", recipe.truth.edge_factor, 0.2, 3.0);
  maybe(section, "order", recipe.truth.order, 1, 2);
  maybe(section, "rays_per_axis", recipe.truth.rays_per_axis, 1, 15);
  maybe(section, "visibility_rays", recipe.truth.visibility_rays, 0, 4096);
}

}  // namespace hookeye
