// Units, body and model.
#include <fmt/format.h>

#include <algorithm>

#include "capture_io/capture_reader.h"
#include "capture_io/placement.h"

namespace hookeye {
namespace {

void read_texture(const YamlNode& node, const CaptureFolder& folder, BodySpec& body) {
  const YamlSection texture(node, "texture", {"image", "encoding", "from", "uniform"});
  body.texture_place = node.place;
  const std::string source = texture.one_of({"image", "from", "uniform"});
  const YamlNode& value = *texture.find(source);
  if (const YamlNode* encoding = texture.find("encoding")) {
    if (source != "image")
      throw InputError(texture.entry("encoding")->place,
                       fmt::format("texture has an encoding but is `{}`", source),
                       "only `image` has an encoding: remove it");
    body.texture_encoding = read_encoding(*encoding, "encoding of the texture");
  }
  if (source == "image") {
    body.texture = BodySpec::Texture::image;
    body.texture_image = {read_file_path(value, "the texture's image", folder), value.place};
    header_at(value, body.texture_image.path);
  } else if (source == "from") {
    body.texture = BodySpec::Texture::rest;
    body.texture_place = value.place;
    body.texture_example = read_string(value, "the example of the texture");
  } else {
    body.texture = BodySpec::Texture::uniform;
    if (const auto told = read_or_fit(value, "the uniform albedo", read_positive))
      body.uniform_albedo = *told;
  }
}

/// Numbers of a law, `points.strain: [...]` for nested maps; nested lists are laid out by rows.
void read_law_values(const YamlNode& node, const std::string& name,
                     std::map<std::string, MaterialSpec::Value>& values) {
  const std::string what = fmt::format("`{}` of the material", name);
  if (node.kind == YamlNode::Kind::map) {
    for (const YamlNode::Entry& entry : node.entries)
      read_law_values(entry.value, name + "." + entry.key, values);
    return;
  }
  MaterialSpec::Value value;
  value.place = node.place;
  if (node.kind == YamlNode::Kind::sequence) {
    for (const YamlNode& item : node.items) {
      if (item.kind == YamlNode::Kind::sequence) {
        const std::vector<double> row = read_numbers(item, "a row of " + what);
        if (item.items.size() != node.items.front().items.size())
          throw InputError(item.place, fmt::format("the rows of {} differ in length", what),
                           "all rows need the same number of values");
        value.numbers.insert(value.numbers.end(), row.begin(), row.end());
      } else {
        value.numbers.push_back(read_number(item, "a number of " + what));
      }
    }
  } else {
    value.numbers = {read_number(node, what)};
  }
  if (value.numbers.empty())
    throw InputError(node.place, what + " is an empty list", "give at least one number");
  values[name] = std::move(value);
}

MaterialSpec::Blend read_blend(const YamlNode& node) {
  const YamlSection section(node, "blend", {"along", "at", "weight"});
  const std::string right = "write `blend: {along: [0, 0, 1], at: [0, 60], weight: [1, 0]}`";
  const YamlNode &along = section.need("along", right), &at = section.need("at", right),
                 &weight = section.need("weight", right);
  MaterialSpec::Blend blend{read_vector3(along, "the direction of the blend"),
                            read_numbers(at, "the places of the blend"),
                            read_numbers(weight, "the weights of the blend")};
  if (!(blend.along.norm() > 0.0))
    throw InputError(along.place, "the direction of the blend is zero", right);
  blend.along.normalize();
  if (blend.at.size() != blend.weight.size())
    throw InputError(weight.place,
                     fmt::format("{} weights at {} places", blend.weight.size(), blend.at.size()),
                     "give one weight at every place");
  for (size_t i = 0; i + 1 < blend.at.size(); ++i)
    if (!(blend.at[i] < blend.at[i + 1]))
      throw InputError(at.place, "the places of the blend do not rise", "order them");
  for (const double w : blend.weight)
    if (w < 0.0)
      throw InputError(weight.place, fmt::format("a weight of the blend is {}", w),
                       "weights are zero or positive");
  return blend;
}

MaterialSpec read_material(const YamlNode& node, const std::string& region) {
  if (node.kind != YamlNode::Kind::map)
    unexpected(node, "material", "write `{law: neo-hookean, mu: 0.05, kappa: 0.5}`");
  MaterialSpec material;
  material.region = region;
  material.place = node.place;
  for (const YamlNode::Entry& entry : node.entries) {
    if (entry.key == "law") {
      material.law = read_string(entry.value, "law of the material");
      material.place = entry.value.place;
    } else if (entry.key == "blend") {
      material.blend = read_blend(entry.value);
    } else {
      read_law_values(entry.value, entry.key, material.parameters);
    }
  }
  if (material.law.empty())
    throw InputError(node.place, "material lacks `law`",
                     "write `{law: neo-hookean, mu: 0.05, kappa: 0.5}`");
  return material;
}

/// One law for the whole body, or a map from region of the body, or from the name of what is
/// blended over the body, to law: the latter has maps as all its values and no `law`.
std::vector<MaterialSpec> read_materials(const YamlNode& node, const BodySpec& body) {
  const bool by_region =
      node.kind == YamlNode::Kind::map && !node.entries.empty() &&
      std::all_of(node.entries.begin(), node.entries.end(), [](const YamlNode::Entry& e) {
        return e.value.kind == YamlNode::Kind::map && e.key != "law";
      });
  if (!by_region) return {read_material(node, "")};
  std::vector<MaterialSpec> materials;
  for (const YamlNode::Entry& entry : node.entries)
    materials.push_back(read_material(entry.value, entry.key));
  const bool blended = std::all_of(materials.begin(), materials.end(),
                                   [](const MaterialSpec& one) { return one.blend.has_value(); });
  if (body.volume.empty() && !blended)
    throw InputError(node.place,
                     "material names regions of the body, but the body has no volume mesh",
                     "give `body: {volume: FILE}` with named groups, one law, or a `blend` each");
  return materials;
}

}  // namespace

double MaterialSpec::Blend::of(const Eigen::Vector3d& X) const {
  const double s = along.dot(X);
  const auto next = std::upper_bound(at.begin(), at.end(), s) - at.begin();
  if (next == 0) return weight.front();
  if (next == static_cast<std::ptrdiff_t>(at.size())) return weight.back();
  const double share = (s - at[next - 1]) / (at[next] - at[next - 1]);
  return (1.0 - share) * weight[next - 1] + share * weight[next];
}

Units read_units(const YamlNode& node) {
  const YamlSection units(node, "units", {"length", "force"});
  const std::string right = "write `units: {length: mm, force: N}`";
  return {read_choice(units.need("length", right), "the unit of length", {"mm", "cm", "m", "um"}),
          read_choice(units.need("force", right), "the unit of force", {"N", "mN", "kN", "uN"})};
}

BodySpec read_body(const YamlNode& node, const CaptureFolder& folder) {
  const YamlSection section(
      node, "body", {"surface", "mesh", "volume", "density", "texture", "placement", "shading"});
  BodySpec body;
  body.place = node.place;
  if (const YamlNode* surface = section.find("surface")) {
    body.surface = read_file_path(*surface, "the surface", folder, {".obj", ".ply", ".stl"});
    body.surface_place = surface->place;
  }
  if (const YamlNode* volume = section.find("volume")) {
    body.volume = read_file_path(*volume, "the volume", folder, {".msh", ".vtu", ".inp", ".mesh"});
    body.volume_place = volume->place;
  }
  if (body.surface.empty() && body.volume.empty())
    throw InputError(node.place, "body lacks one of surface, volume",
                     "give a closed surface (obj, ply, stl) or a mesh (msh, vtu, inp, mesh)");
  if (const YamlNode* mesh = section.find("mesh")) {
    const YamlSection options(*mesh, "mesh", {"edge", "order"});
    body.mesh_given = true;
    if (const YamlNode* edge = options.find("edge"))
      body.edge = read_positive(*edge, "the edge of the mesh");
    if (const YamlNode* order = options.find("order")) {
      body.order = read_integer(*order, "the order of the mesh");
      if (body.order != 1 && body.order != 2)
        unexpected(*order, "the order of the mesh", "1 (linear) or 2 (quadratic) is expected");
    }
  }
  if (const YamlNode* density = section.find("density"))
    body.density = read_positive(*density, "the density");
  if (const YamlNode* texture = section.find("texture")) read_texture(*texture, folder, body);
  if (const YamlNode* shading = section.find("shading"))
    body.flat_shading = read_choice(*shading, "the shading", {"smooth", "flat"}) == "flat";
  if (const YamlNode* placement = section.find("placement"))
    body.fit_placement = read_placement(*placement).fit;
  return body;
}

void read_model(const YamlNode& node, Capture& capture) {
  const YamlSection model(node, "model", {"material", "fit", "gravity"});
  capture.materials = read_materials(
      model.need("material", "write `material: {law: neo-hookean, mu: 0.05, kappa: 0.5}`"),
      capture.body);
  if (const YamlNode* fit = model.find("fit")) {
    for (const YamlNode& item : read_list(*fit, "fit", "a list of parameters is expected: [mu]")) {
      const std::string name = read_string(item, "a parameter to fit");
      if (std::find(capture.fit.begin(), capture.fit.end(), name) != capture.fit.end())
        throw InputError(item.place, fmt::format("`{}` is to be fitted twice", name),
                         "name every parameter once");
      capture.fit.push_back(name);
      capture.fit_places.push_back(item.place);
    }
  }
  if (const YamlNode* gravity = model.find("gravity")) {
    capture.gravity = read_vector3(*gravity, "gravity");
    if (capture.body.density == 0)
      throw InputError(gravity->place, "the model has gravity but the body has no density",
                       "give `body: {density: ...}`, for example 1.07e-9 t/mm^3");
  }
}

}  // namespace hookeye
