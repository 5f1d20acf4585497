#include "app/server/edit_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

#include "capture_io/encode_png.h"
#include "core/base64.h"
#include "estimation/model/model.h"
#include "meshing/subdivide.h"
#include "runs/report/encode_png.h"

namespace hookeye {

using nlohmann::json;

namespace {

json list(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

template <class Number>
std::string packed(const std::vector<Number>& numbers) {
  return base64(numbers.data(), numbers.size() * sizeof(Number));
}

json describe_shape(const RegionSpec& region) {
  if (const auto* box = std::get_if<RegionSpec::Box>(&region.shape))
    return {{"box", {list(box->low), list(box->high)}}};
  if (const auto* ball = std::get_if<RegionSpec::Sphere>(&region.shape))
    return {{"sphere", {{"center", list(ball->center)}, {"radius", ball->radius}}}};
  if (const auto* half = std::get_if<RegionSpec::Halfspace>(&region.shape))
    return {{"halfspace", {{"point", list(half->point)}, {"normal", list(half->normal)}}}};
  if (const auto* faces = std::get_if<RegionSpec::Faces>(&region.shape))
    return {{"faces", faces->triangles}, {"file", faces->file.filename().string()}};
  return {{"group", std::get<RegionSpec::Group>(region.shape).name}};
}

json describe_support(const SupportSpec& support) {
  json out{{"region", support.region}, {"line", support.place.line}};
  if (support.kind == SupportSpec::Kind::rigid_fit) {
    out["rigid"] = "fit";
  } else if (support.kind == SupportSpec::Kind::rigid) {
    const RigidMotion& rigid = support.rigid;
    out["rigid"] = {{"axis", list(rigid.axis)},
                    {"degrees", rigid.degrees},
                    {"center", list(rigid.center)},
                    {"move", list(rigid.move)}};
  } else {
    for (size_t i = 0; i < 3; ++i)
      out["along"].push_back(support.displacement[i] ? json(*support.displacement[i]) : json());
  }
  return out;
}

json describe_load(const LoadSpec& load) {
  json out{{"region", load.region}, {"line", load.place.line}};
  if (load.force) out["force"] = list(*load.force);
  if (load.pressure) out["pressure"] = *load.pressure;
  return out;
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string time_of(const std::filesystem::path& file) {
  std::error_code error;
  const auto time = std::filesystem::last_write_time(file, error);
  return error ? "" : fmt::format("{}", time.time_since_epoch().count());
}

/// Entries as they were read, each with its number in the file's list.
template <class Specs, class Describe>
json numbered(const Specs& specs, const YamlNode* in_file, const Describe& describe) {
  json out = json::array();
  for (const auto& spec : specs) {
    json one = describe(spec);
    for (size_t i = 0; in_file && i < in_file->items.size(); ++i) {
      const Place& place = in_file->items[i].place;
      if (place.line == spec.place.line && place.column == spec.place.column) one["number"] = i;
    }
    out.push_back(std::move(one));
  }
  return out;
}

json describe_example(const ExampleSpec& example, const YamlNode* node) {
  const auto part = [&](const char* key) { return node ? node->find(key) : nullptr; };
  json photos = json::array();
  for (const PhotoSpec& photo : example.photos)
    photos.push_back({{"camera", photo.camera},
                      {"file", photo.file.filename().string()},
                      {"line", photo.place.line},
                      {"silhouette", photo.kind == PhotoSpec::Kind::silhouette},
                      {"stamp", photo.file.string() + time_of(photo.file)}});
  return {{"name", example.name},
          {"line", example.place.line},
          {"use", example.use()},
          {"rest", is_rest(example)},
          {"supports", numbered(example.supports, part("supports"), describe_support)},
          {"loads", numbered(example.loads, part("loads"), describe_load)},
          {"photos", photos},
          {"measured", example.measured.size()}};
}

}  // namespace

json describe_faults(const PartialCapture& read) {
  json out = json::array();
  for (const InputError& fault : read.faults)
    out.push_back({{"file", fault.place().file},
                   {"line", fault.place().line},
                   {"column", fault.place().column},
                   {"wrong", fault.wrong()},
                   {"right", fault.right()}});
  return out;
}

json describe_partly(const PartialCapture& read) {
  const Capture& capture = read.capture;
  const bool named = !capture.units.length.empty();
  json out{{"title", capture.title},
           {"units",
            {{"length", named ? capture.units.length : "length"},
             {"force", named ? capture.units.force : "force"},
             {"stress", named ? capture.units.stress() : "stress"}}},
           {"texture_from", capture.body.texture_example},
           {"body", stamp_of(capture.body)},
           {"faults", describe_faults(read)}};
  for (const char* key : {"cameras", "regions", "examples"}) out[key] = json::array();
  const YamlNode* cameras = read.root.find("cameras");
  for (const Camera& camera : capture.cameras) {
    const YamlNode::Entry* entry = cameras ? cameras->entry(camera.name) : nullptr;
    std::string pose;  // what a picture of the body depends on
    for (const double number : camera.R.reshaped()) pose += fmt::format("{} ", number);
    for (const double number : camera.t) pose += fmt::format("{} ", number);
    for (const Intrinsic& one : camera.intrinsics()) pose += fmt::format("{} ", one.value);
    out["cameras"].push_back(
        {{"name", camera.name},
         {"line", entry ? entry->place.line : 0},
         {"size", {camera.width, camera.height}},
         {"projection", camera.model->name()},
         {"right", list(camera.R.row(0).transpose())},
         {"down", list(camera.R.row(1).transpose())},
         {"away", list(camera.R.row(2).transpose())},
         {"stamp", fmt::format("{} {} {}", camera.model->name(), camera.width, pose)}});
  }
  for (const RegionSpec& region : capture.regions) {
    json one = describe_shape(region);
    one["name"] = region.name;
    one["line"] = region.place.line;
    out["regions"].push_back(std::move(one));
  }
  const YamlNode* examples = read.root.find("examples");
  for (const ExampleSpec& example : capture.examples)
    out["examples"].push_back(
        describe_example(example, examples ? examples->find(example.name) : nullptr));
  return out;
}

std::string stamp_of(const BodySpec& spec) {
  std::string out;
  for (const auto& file : {spec.surface, spec.volume})
    if (!file.empty()) out += file.string() + " " + time_of(file) + "\n";
  return out;
}

ShownBody shown_body(const BodySpec& spec) {
  ShownBody body;
  SurfaceMesh whole;
  if (!spec.surface.empty()) {
    whole = read_surface(spec.surface);
    body.of_file = true;
  } else if (!spec.volume.empty()) {
    std::vector<std::string> said;
    const TetMesh mesh = read_volume(spec.volume, spec.volume_place, &said);
    std::vector<int> own(static_cast<size_t>(mesh.nodes()), -1);
    std::vector<int> kept;
    for (Eigen::Index f = 0; f < mesh.boundary.cols(); ++f)
      for (int k = 0; k < 3; ++k)
        if (int& vertex = own[static_cast<size_t>(mesh.boundary(k, f))]; vertex < 0) {
          vertex = static_cast<int>(kept.size());
          kept.push_back(mesh.boundary(k, f));
        }
    whole.X = mesh.X(Eigen::all, kept);
    for (Eigen::Index f = 0; f < mesh.boundary.cols(); ++f)
      whole.triangles.push_back({own[static_cast<size_t>(mesh.boundary(0, f))],
                                 own[static_cast<size_t>(mesh.boundary(1, f))],
                                 own[static_cast<size_t>(mesh.boundary(2, f))]});
    body.groups = mesh.boundary_groups;
  } else {
    throw InputError(spec.place, "the capture has no body yet", "write `body: {surface: FILE}`");
  }
  constexpr double kParts = 40.0;         // of the body's diagonal
  constexpr size_t kFineAlready = 60000;  // triangles
  const Eigen::Vector3d size = whole.X.rowwise().maxCoeff() - whole.X.rowwise().minCoeff();
  const double edge = whole.triangles.size() < kFineAlready ? size.norm() / kParts : size.norm();
  detail::Subdivided fine = detail::subdivide(whole, edge);
  body.surface = std::move(fine.mesh);
  body.parent = std::move(fine.parent);
  return body;
}

json describe_shown(const ShownBody& body) {
  std::vector<float> X;
  for (const double x : body.surface.X.reshaped()) X.push_back(static_cast<float>(x));
  std::vector<int> triangles;
  for (const auto& triangle : body.surface.triangles)
    triangles.insert(triangles.end(), triangle.begin(), triangle.end());
  return {{"rest", packed(X)},
          {"triangles", packed(triangles)},
          {"parent", packed(body.parent)},
          {"groups", body.groups},
          {"of_file", body.of_file}};
}

json describe_sight(const ShownBody& body, const Camera& camera) {
  std::vector<float> seen;
  for (Eigen::Index v = 0; v < body.surface.X.cols(); ++v) {
    const Eigen::Vector3d X = body.surface.X.col(v);
    const Eigen::Vector2d pixel = camera.project(X);
    for (const double number : {pixel.x(), pixel.y(), camera.depth(X)})
      seen.push_back(static_cast<float>(number));
  }
  return {{"seen", packed(seen)}};
}

json pictures_in(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  static const std::set<std::string> kinds{".png", ".jpg", ".jpeg", ".tif", ".tiff", ".exr"};
  constexpr size_t kMost = 1000;
  std::set<std::string> found;
  std::error_code error;
  fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && at != fs::recursive_directory_iterator() && found.size() < kMost;
       at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (at.depth() >= 2 || name.starts_with('.')) at.disable_recursion_pending();
    if (kinds.contains(lower_case(at->path().extension().string())) && !name.starts_with('.'))
      found.insert(at->path().lexically_relative(folder).string());
  }
  return found;
}

std::string picture_of(const PhotoSpec& photo, int most) {
  const Image read = luminance(read_image(photo.file, photo.encoding));
  const int longer = std::max(read.width, read.height);
  const Image small = shrink(read, (longer + most - 1) / most);
  std::vector<uint16_t> grey(small.pixels());
  for (size_t i = 0; i < grey.size(); ++i) {
    const double linear = std::clamp(static_cast<double>(small.values[i]), 0.0, 1.0);
    const double stored =
        linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
    grey[i] = static_cast<uint16_t>(std::lround(65535.0 * stored));
  }
  return encode_png(small.width, small.height, grey);
}

}  // namespace hookeye
