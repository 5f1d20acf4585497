#include "exporters/dic_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hookeye::dic {
namespace {

constexpr const char* kNotKnown = "not known";

class Table {
 public:
  explicit Table(std::vector<Reported>& rows) : rows_(rows) {}
  void part(const std::string& name) { part_ = name; }
  void tell(const std::string& item, const std::string& value) {
    rows_.push_back({part_, item, value.empty() ? kNotKnown : value});
  }
  /// What no file of a capture tells: for the user to fill in.
  void leave(std::initializer_list<const char*> items) {
    for (const char* item : items) tell(item, "");
  }

 private:
  std::vector<Reported>& rows_;
  std::string part_;
};

std::string number(double value, const std::string& unit) {
  return std::isfinite(value) ? fmt::format("{:.4g} {}", value, unit) : std::string();
}
std::string number(const std::optional<double>& value, const std::string& unit) {
  return value ? number(*value, unit) : std::string();
}

/// Size of the photos before halving and cutting; a camera as read may be smaller.
std::string size_of(const Scene& scene, const Camera& camera) {
  const auto reading = scene.readings.find(camera.name);
  if (reading == scene.readings.end())
    return fmt::format("{} x {} px", camera.width, camera.height);
  std::string out;
  if (reading->second.window.empty())
    out = fmt::format("{} x {} px, ", camera.width << reading->second.halvings,
                      camera.height << reading->second.halvings);
  return out + fmt::format("{} x {} px of them read at 1/{} of their width", camera.width,
                           camera.height, 1 << reading->second.halvings);
}

double halved(const Scene& scene, const std::string& camera) {
  return std::ldexp(1.0, scene.halvings_of(camera));
}

void camera_rows(const SeenSurface& seen, const Camera& camera, const std::string& length,
                 Table& table) {
  const Scene& scene = *seen.scene;
  const Vector3d middle = scene.body->mesh.X.rowwise().mean();
  const double scale = camera.length_per_px(middle);
  table.part("camera " + camera.name);
  table.leave({"camera, manufacturer and model", "lens, manufacturer and model", "aperture",
               "exposure time", "frame rate"});
  table.tell("picture", size_of(scene, camera));
  table.tell("projection", camera.model->name());
  table.tell("focal length", camera.model->central()
                                 ? number(halved(scene, camera.name) * camera.fx, "px")
                                 : std::string("parallel rays"));
  table.tell("lens numbers",
             camera.distortion.empty() ? "none" : fmt::format("{}", camera.distortion.size()));
  table.tell("stand-off distance", camera.model->central()
                                       ? number((camera.centre() - middle).norm(), length)
                                       : std::string());
  table.tell("image scale", number(halved(scene, camera.name) / scale, "px/" + length));
  table.tell("field of view", fmt::format("{:.4g} x {:.4g} {}", scale * camera.width,
                                          scale * camera.height, length));
  table.tell("noise floor of displacements", number(noise_floor(seen, camera.name, false), length));
  table.tell("noise floor of strains", number(noise_floor(seen, camera.name, true), "m/m"));
}

void pair_rows(const std::vector<Camera>& cameras, Table& table) {
  for (size_t i = 0; i < cameras.size(); ++i)
    for (size_t j = i + 1; j < cameras.size(); ++j) {
      table.part(fmt::format("cameras {} and {}", cameras[i].name, cameras[j].name));
      const double cosine = cameras[i].R.row(2).dot(cameras[j].R.row(2));
      table.tell("stereo angle",
                 number(std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / EIGEN_PI, "degrees"));
      if (cameras[i].model->central() && cameras[j].model->central())
        table.tell("base line",
                   fmt::format("{:.4g}", (cameras[i].centre() - cameras[j].centre()).norm()));
    }
}

void field_rows(const SeenSurface& seen, const std::string& length, Table& table) {
  std::vector<std::string> told;
  for (const SeenCase& one : seen.cases)
    for (const SeenPoints& view : one.views) {
      if (view.camera || std::ranges::find(told, view.view) != told.end()) continue;
      told.push_back(view.view);
      table.part("field " + view.view);
      table.leave({"cameras, lenses, lighting", "program, subset, step, shape functions"});
      if (!view.from.empty()) table.tell("reference", "load case " + view.from);
      table.tell("distance of points", number(view.spacing, length));
      table.tell("sigma as told", view.size() ? number(view.sigma[0], length) : "");
      table.tell("noise floor of displacements",
                 number(noise_floor(seen, view.view, false), length));
      table.tell("noise floor of strains", number(noise_floor(seen, view.view, true), "m/m"));
    }
}

void analysis_rows(const SeenSurface& seen, const SolverModel& model, Table& table) {
  const SeenOptions& options = seen.options;
  const TetMesh& mesh = seen.scene->body->mesh;
  std::string rest;
  for (const SeenCase& one : seen.cases)
    if (one.rest) rest += (rest.empty() ? "" : ", ") + one.name;
  table.part("analysis");
  table.tell("software", "Hookeye, step " + model.step);
  table.tell("kind",
             "global: one finite-element model against all photos; then residual motions "
             "cell by cell");
  table.tell("image filter", "none but the reading of large photos at a part of their width");
  table.tell("shape functions",
             fmt::format("{} tetrahedra, {} nodes", mesh.order == 1 ? "linear" : "quadratic",
                         mesh.nodes()));
  table.tell("matching criterion", "squared difference of intensities over their noise");
  table.tell("interpolant", "of the texture: bilinear, of a photo as texture: cubic B-spline");
  table.tell("subset", fmt::format("cells of {} px of the photo as read", seen.cell_px));
  table.tell("step", fmt::format("{} px", options.grid_px));
  table.tell("strain", "Green-Lagrange, in the plane of the surface at rest");
  table.tell("strain window", fmt::format("{} points across", options.window));
  table.tell("virtual strain gauge",
             fmt::format("{} px", (options.window - 1) * options.grid_px + seen.cell_px));
  table.tell("strain shape function", "affine, of what the photos add to the model");
  table.tell("filter after", "none");
  table.tell("noise floor from", rest.empty() ? std::string() : "photos at rest: " + rest);
  table.tell("bias", "");
}

}  // namespace

std::string quoted(const std::string& cell) {
  if (cell.find_first_of(",\"\n\r") == std::string::npos) return cell;
  std::string out = "\"";
  for (const char c : cell) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

std::vector<Reported> reporting_table(const SeenSurface& seen, const SolverModel& model) {
  std::vector<Reported> rows;
  Table table(rows);
  const std::string& length = model.units.length;
  const auto& cameras = seen.scene->capture.cameras;
  for (const Camera& camera : cameras) camera_rows(seen, camera, length, table);
  pair_rows(cameras, table);
  table.part("specimen");
  table.leave({"lighting", "patterning", "size of pattern features"});
  field_rows(seen, length, table);
  analysis_rows(seen, model, table);
  return rows;
}

std::string report_csv(const std::vector<Reported>& table) {
  std::string out = "part,item,value\n";
  for (const Reported& one : table)
    out += fmt::format("{},{},{}\n", quoted(one.part), quoted(one.item), quoted(one.value));
  return out;
}

std::string readme(const SeenSurface& seen, const SolverModel& model) {
  std::string out = fmt::format(
      R"({}

Displacements and strains of the surface, step {} of a run of hookeye.

CASE-VIEW.csv   one row a point of the body that the camera sees, or of a measured field
  x_px, y_px    the point in the photo of the body at rest, on a grid of {} px
  x, y, z       where it is at rest, in the body's frame [{}]
  u, v, w       displacement of the model
  exx, eyy, exy Green-Lagrange strain of the model in the plane of the surface; exy is half of the
                engineering shear. x is the picture's right laid into the surface, or what --along
                told, y is left of x seen from outside. Of a measured field both are along its own
                axes, where these lie in the surface; a field of strains has them over its gauge
  e1, e2, angle principal strains; of e1 from x towards y, in degrees
  von_mises     2/sqrt(3) sqrt(e1^2 + e1 e2 + e2^2)
  u_photo, ..   the same of the photos: model, and the motion that removes the residual. Empty: the
                photos do not tell
  sigma_photo   its standard deviation, in the worst known direction, for noise as told
  known         directions in which it is known: 2 across one camera's view, 3 by several
  exx_photo, .. strain of the model and of that motion's gradient over {} points across
gauges.csv      means over the capture's regions; _same_points: the model's over the photos' points
lines.csv       extensometers of --line, and CASE-lineN.csv along each
reporting.csv   the table below

)",
      model.title.empty() ? "untitled" : model.title, model.step, seen.options.grid_px,
      model.units.length, seen.options.window);
  std::string part;
  for (const Reported& one : reporting_table(seen, model)) {
    if (one.part != part) out += one.part + "\n";
    part = one.part;
    out += fmt::format("  {:<32} {}\n", one.item, one.value);
  }
  return out;
}

}  // namespace hookeye::dic
