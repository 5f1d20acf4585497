#include "estimation/output/step_json.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "core/text_file.h"
#include "estimation/diagnosis/diagnosis_json.h"
#include "estimation/diagnosis/diagnosis_sums.h"
#include "estimation/effects/catalogue.h"
#include "estimation/fit/at_floor.h"
#include "estimation/fit/energy_curves.h"
#include "estimation/fit/lost_ellipticity.h"
#include "estimation/model/fitted_fields.h"
#include "estimation/model/parameters_json.h"
#include "estimation/model/session_sensors.h"
#include "estimation/output/compare_picture.h"
#include "estimation/output/field_output.h"
#include "estimation/output/material_card.h"
#include "estimation/output/own_weight.h"
#include "estimation/output/page_data.h"
#include "estimation/output/pixels_json.h"
#include "estimation/output/removed.h"
#include "estimation/search/verdict.h"

namespace hookeye {

using nlohmann::json;

json to_json(const FitToAll& all) {
  return {{"chi_fit", all.chi_fit},
          {"chi_validate", all.chi_validate},
          {"parameters",
           parameters_json(all.fitted.form.parameters(), all.fitted.p, nullptr, nullptr)}};
}

json timeline_entry(const Step& step) {
  const Fitted& fitted = step.fitted;
  const double held = fitted.evaluation.chi(true);
  json entry = {{"name", step.name},
                {"added", step.added.empty() ? json() : json(step.added)},
                {"dropped", step.dropped},
                {"not_compared", step.not_compared},
                {"effects", effects_in(fitted.form)},
                {"chi_fit", fitted.evaluation.chi(false)},
                {"chi_validate", held > 0.0 ? json(held) : json()},
                {"rms_px_fit", fitted.evaluation.rms_px(false)},
                {"rms_px_validate", held > 0.0 ? json(fitted.evaluation.rms_px(true)) : json()},
                {"measured_r2", measured_r2(fitted.evaluation)},
                {"converged", fitted.converged},
                {"iterations", fitted.iterations},
                {"undetermined", fitted.undetermined},
                {"says", effects_in_words(fitted)},
                {"parameters",
                 parameters_json(fitted.form.parameters(), fitted.p, &fitted.low, &fitted.high)},
                {"diagnosis", json::array()}};
  if (fitted.all_pixels) entry["all_pixels"] = all_pixels_json(fitted);
  if (!step.diagnosis.effects.empty()) {
    const json diagnosis = to_json(step.diagnosis);
    entry["gate"] = diagnosis["gate"];
    entry["diagnosis"] = diagnosis["effects"];
  }
  const auto left = [](const auto& one) -> json {
    return {{"effect", one.effect},
            {"chi_fit", one.chi_fit},
            {"chi_validate", one.chi_validate > 0.0 ? json(one.chi_validate) : json()}};
  };
  for (const Raced& raced : step.raced) {
    entry["raced"].push_back(left(raced));
    entry["raced"].back()["floor"] = raced.floor;  // of half-size photos
  }
  for (const Rival& rival : step.rivals) {
    entry["rivals"].push_back(left(rival));
    entry["rivals"].back()["score"] = rival.score;
  }
  return entry;
}

namespace {

/// Sums of squares by a key, as chi.
json chi_table(const std::map<std::string, std::pair<double, double>>& sums) {
  json out = json::object();
  for (const auto& [key, sum] : sums)
    if (sum.second > 0.0) out[key] = std::sqrt(sum.first / sum.second);
  return out;
}

/// Regions that hold each triangle of the render surface: those with all nodes that carry it.
std::vector<std::vector<std::string>> regions_of_triangles(const Body& body) {
  const RenderSurface& surface = body.surface;
  std::vector<std::vector<std::string>> out(surface.mesh.triangles.size());
  for (const auto& [name, region] : body.regions.all()) {
    const std::set<int> nodes(region.nodes.begin(), region.nodes.end());
    std::vector<bool> inside(static_cast<size_t>(surface.W.rows()), true);
    for (int v = 0; v < surface.W.rows(); ++v)
      for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(surface.W, v); it; ++it)
        if (!nodes.count(static_cast<int>(it.col()))) inside[v] = false;
    for (size_t t = 0; t < out.size(); ++t) {
      const auto& corners = surface.mesh.triangles[t];
      if (inside[corners[0]] && inside[corners[1]] && inside[corners[2]]) out[t].push_back(name);
    }
  }
  return out;
}

using ChiSums = std::map<std::string, std::pair<double, double>>;

/// Pixels by the region of the surface that they show; "elsewhere": in none.
void add_by_region(const PhotoEvaluation& photo,
                   const std::vector<std::vector<std::string>>& regions, ChiSums& sums) {
  for (size_t i = 0; i < photo.triangle.size(); ++i) {
    const double r = photo.residual.values[i];
    if (std::isnan(r) || photo.triangle[i] < 0) continue;
    auto add = [&](const std::string& name) {
      sums[name].first += r * r, sums[name].second += 1.0;
    };
    const auto& names = regions[photo.triangle[i]];
    for (const auto& name : names) add(name);
    if (names.empty()) add("elsewhere");
  }
}

/// The region; of a strain gauge its two ends.
std::string where(const MeasuredSpec& told) {
  if (told.kind != MeasuredSpec::Kind::strain_of) return told.region;
  const Vector3d &p = told.point, &q = told.direction;
  return fmt::format("({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g})", p.x(), p.y(), p.z(),
                     q.x(), q.y(), q.z());
}

json measured_json(const Scene& scene, const Fitted& fitted) {
  json all = json::array();
  for (const auto& example : fitted.evaluation.examples)
    for (const auto& one : example.measured) {
      const auto& spec = scene.capture.examples[example.example];
      const auto& told = spec.measured[one.index];
      if (told.field || !is_on_body(told)) continue;
      const auto list = [](const VectorXd& v) { return std::vector<double>(v.begin(), v.end()); };
      const bool one_sigma = (told.sigma.array() == told.sigma[0]).all();
      all.push_back({{"example", spec.name},
                     {"kind", kind_of(told).name},
                     {"words", kind_of(told).words},
                     {"region", where(told)},
                     {"measured", list(told.value)},
                     {"predicted", list(one.predicted)},
                     {"unit", measured_unit(told, scene.capture.units)},
                     {"sigma", one_sigma ? json(told.sigma[0]) : json(list(told.sigma))},
                     {"over_sigma", list(one.r)}});
    }
  return all;
}

/// A curve and its band for every load path, and for every addend (where several addends share a
/// strain their sum is known better than each), and the material's card.
void tell_material(const Scene& scene, const Fitted& fitted, json& out) {
  const EnergyNeighbourhood near(fitted);
  out["energy"] = law_curves(scene, fitted, near);
  if (has_additive(near.model()))
    for (json& one : energy_curves(scene, fitted)) out["energy"].push_back(std::move(one));
  out["material"] = material_card(scene, fitted, near);
}

}  // namespace

json metrics(const Scene& scene, const Fitted& fitted, const Floor& floor) {
  json photos = json::array();
  ChiSums by_example, by_camera, by_region;
  const auto regions = regions_of_triangles(*scene.body);
  for (const auto& example : fitted.evaluation.examples)
    for (const auto& photo : example.photos) {
      const auto& spec = scene.capture.examples[example.example];
      const std::string& camera = spec.photos[photo.photo].camera;
      const FlowStatistics flow = flow_statistics(photo.flow);
      photos.push_back({{"example", spec.name},
                        {"camera", camera},
                        {"plane", photo.plane},
                        {"use", example.held_out ? "validate" : "fit"},
                        {"chi", photo.chi()},
                        {"rms_px", photo.flow.rms_px()},
                        {"pixels", photo.count},
                        {"effective_count", flow.effective},
                        {"whiteness_p", flow.whiteness_p},
                        {"only_noise", flow.whiteness_p > 0.01}});
      for (auto* sum : {&by_example[spec.name], &by_camera[camera]})
        sum->first += photo.r2, sum->second += photo.count;
      add_by_region(photo, regions, by_region);
    }
  if (fitted.evaluation.seen() == Evaluation::Seen::fields)
    for (const auto& example : fitted.evaluation.examples)
      for (const auto& field : example.measured) {
        if (!field.is_field()) continue;
        auto& sum = by_example[scene.capture.examples[example.example].name];
        sum.first += field.r.squaredNorm(), sum.second += field.size();
      }
  const MeshQuality mesh = quality(scene.body->mesh);
  json out = {{"chi_fit", fitted.evaluation.chi(false)},
              {"chi_validate", fitted.evaluation.chi(true)},
              {"rms_px_fit", fitted.evaluation.rms_px(false)},
              {"rms_px_validate", fitted.evaluation.rms_px(true)},
              {"floor", to_json(floor)},
              {"photos", std::move(photos)},
              {"read", readings_json(scene.readings)},
              {"chi_by_example", chi_table(by_example)},
              {"chi_by_camera", chi_table(by_camera)},
              {"chi_by_region", chi_table(by_region)},
              {"measured", measured_json(scene, fitted)},
              {"fields", fields_json(scene, fitted)},
              {"measured_weight", fitted.evaluation.measured_weight},
              {"undetermined", fitted.undetermined},
              {"converged", fitted.converged},
              {"iterations", fitted.iterations},
              {"mesh",
               {{"nodes", mesh.nodes},
                {"elements", mesh.elements},
                {"order", scene.body->mesh.order},
                {"mean_edge", mesh.mean_edge}}}};
  if (const CameraOverFloor most = most_over_floor(fitted, floor); !most.camera.empty())
    out["most_over_floor"] = {
        {"camera", most.camera},
        {"times", most.times},
        {"use", most.held_out ? "validate" : "fit"},
        {"its_own", at_floor(fitted, floor) && !explains_photos(fitted, floor)}};
  if (fitted.all_pixels) out["all_pixels"] = all_pixels_json(fitted);
  if (json weight = own_weight(scene, fitted); !weight.is_null()) out["weight"] = std::move(weight);
  tell_material(scene, fitted, out);
  out["ellipticity"] = lost_ellipticity(scene, fitted);
  if (json additive = additive_metrics(fitted); !additive.is_null())
    out["additive"] = std::move(additive);
  return out;
}

json diagnosis_json(const Step& step) {
  const Fitted& fitted = step.fitted;
  json out = to_json(step.diagnosis);
  out["parameters"] =
      parameters_json(fitted.form.parameters(), fitted.p, &fitted.low, &fitted.high);
  tell_material(*fitted.form.scene, fitted, out);
  return out;
}

std::string parameters_csv(const Fitted& fitted) {
  std::string csv = "name,unit,long_name,value,low,high\n";
  const auto parameters = fitted.form.parameters();
  for (size_t i = 0; i < parameters.size(); ++i) {
    const auto [low, high] = interval_within(parameters[i], fitted.low[i], fitted.high[i]);
    csv += fmt::format("\"{}\",{},\"{}\",{:.9g},{:.9g},{:.9g}\n", parameters[i].name,
                       parameters[i].unit, parameters[i].long_name, fitted.p[i], low, high);
  }
  return csv;
}

namespace {

void write_compare(const std::filesystem::path& file, const Scene& scene, const Model& model,
                   const PhotoEvaluation& photo) {
  const Photo& shown = scene.photos[photo.example][photo.photo];
  write_compare_picture(file, shown.planes[photo.plane], photo, photo_name(scene, photo),
                        length_per_px(scene, model.examples[photo.example].photos[photo.photo]),
                        scene.capture.units.length);
}

struct NodalResidual {
  VectorXd rms, pixels;  ///< over noise, and how many pixels it is of; 0: no photo sees the node
};

/// Residual of the photos on the nodes of the boundary: root mean square over 9 x 9 pixels around
/// the node in the photos that see it: what the picture shows there lies no nearer to the camera.
NodalResidual nodal_residual(const Scene& scene, const Model& model,
                             const ExampleEvaluation& example) {
  constexpr int kReach = 4;
  const TetMesh& mesh = scene.body->mesh;
  const int n = mesh.nodes();
  const std::set<int> boundary(mesh.boundary.data(), mesh.boundary.data() + mesh.boundary.size());
  const Matrix3Xd x = scene.body->surface.deformed(mesh, example.equilibrium->q);
  VectorXd sum = VectorXd::Zero(n), count = VectorXd::Zero(n);
  for (const auto& photo : example.photos) {
    const Camera& camera = model.examples[photo.example].photos[photo.photo].camera;
    const Image& r = photo.residual;
    const double per_px = length_per_px(scene, model.examples[photo.example].photos[photo.photo]);
    const auto deepest = [&](int triangle) {
      double depth = -1e300;
      for (const int corner : scene.body->surface.mesh.triangles[triangle])
        depth = std::max(depth, camera.depth(x.col(corner)));
      return depth;
    };
    for (const int a : boundary) {
      const Vector3d node = example.equilibrium->q.segment<3>(3 * a);
      const Eigen::Vector2d px = camera.project(node);
      if (!px.allFinite()) continue;
      const auto u = std::lround(px.x()), v = std::lround(px.y());
      if (u < 0 || v < 0 || u >= r.width || v >= r.height) continue;
      const int shown = photo.triangle[v * r.width + u];
      if (shown < 0 || camera.depth(node) > deepest(shown) + kReach * per_px) continue;
      for (auto y = std::max(0L, v - kReach); y <= std::min<long>(r.height - 1, v + kReach); ++y)
        for (auto c = std::max(0L, u - kReach); c <= std::min<long>(r.width - 1, u + kReach); ++c) {
          const float value = r.at(static_cast<int>(c), static_cast<int>(y));
          if (!std::isnan(value)) sum[a] += value * value, count[a] += 1.0;
        }
    }
  }
  return {(sum.array() / count.array().max(1.0)).sqrt(), count};
}

void write_deformed(const std::filesystem::path& file, const Scene& scene, const ModelForm& form,
                    const Model& model, const Evaluation& evaluation,
                    const ExampleEvaluation& example) {
  const TetMesh& mesh = scene.body->mesh;
  const VectorXd& q = example.equilibrium->q;
  const Eigen::MatrixXd u = Eigen::Map<const Matrix3Xd>(q.data(), 3, mesh.nodes()) - mesh.X;
  const Eigen::MatrixXd reaction =
      Eigen::Map<const Matrix3Xd>(example.equilibrium->R.data(), 3, mesh.nodes());
  const ElementState state = element_state(mesh, model.energy_of(example.example), q);
  NodalResidual residual = nodal_residual(scene, model, example);
  const NodalField field = nodal_field(model, evaluation, example);
  if (example.photos.empty()) residual = {field.rms.transpose(), field.share.transpose()};
  std::vector<VtuArray> arrays = {{"displacement", u, true},
                                  {"reaction", reaction, true},
                                  {"residual", residual.rms.transpose(), true},
                                  {"residual_pixels", residual.pixels.transpose(), true},
                                  {"green_strain", state.green_strain, false},
                                  {"cauchy_stress", state.cauchy_stress, false},
                                  {"von_mises", state.von_mises.transpose(), false},
                                  {"J", state.J.transpose(), false}};
  if (field.share.sum() > 0.0) {
    if (field.has_motions) arrays.push_back({"field_residual", field.residual, true});
    if (field.has_strains) arrays.push_back({"strain_residual", field.strain, true});
    arrays.push_back({"field_points", field.share, true});
  }
  for (const auto& [name, values] : fitted_fields(form, model))
    arrays.push_back({name, values.transpose(), false});
  const VectorXd beyond = addends_beyond(scene, model, q);
  if (beyond.size()) arrays.push_back({"beyond_control_points", beyond.transpose(), false});
  write_vtu(file, mesh, arrays);
}

}  // namespace

StepFiles step_files(const Scene& scene, const Step& step) {
  using std::filesystem::path;
  const Fitted& fitted = step.fitted;
  const auto model = std::make_shared<const Model>(fitted.form.realise(fitted.p));
  StepFiles out;
  out["model.yaml"] = [&](const path& file) {
    write_text(file, write_model(fitted.form, fitted.p, catalogue()));
  };
  out["metrics.json"] = [&](const path& file) {
    const Floor floor = measure_floor(scene, fitted.evaluation);
    write_text(file, metrics(scene, fitted, floor).dump(1) + "\n");
  };
  if (!step.diagnosis.effects.empty())
    out["diagnosis.json"] = [&](const path& file) {
      write_text(file, diagnosis_json(step).dump(1) + "\n");
    };
  if (has_pictures(step.diagnosis))
    out["removed"] = [&](const path& folder) { write_removed(folder, step); };
  out["parameters.csv"] = [&](const path& file) { write_text(file, parameters_csv(fitted)); };
  const auto each_photo = [&](const path& folder, const auto& write) {
    std::filesystem::create_directories(folder);
    for (const auto& example : fitted.evaluation.examples)
      for (const auto& photo : example.photos) write(folder / photo_name(scene, photo), photo);
  };
  out["residuals"] = [&, each_photo](const path& folder) {
    each_photo(folder, [](const path& stem, const PhotoEvaluation& photo) {
      write_image(stem.string() + ".exr", photo.residual);
      write_residual_png(stem.string() + ".png", photo.residual);
    });
  };
  out["compare"] = [&, model, each_photo](const path& folder) {
    each_photo(folder, [&](const path& stem, const PhotoEvaluation& photo) {
      write_compare(stem.string() + ".png", scene, *model, photo);
    });
  };
  out["deformed"] = [&, model](const path& folder) {
    std::filesystem::create_directories(folder);
    for (const auto& example : fitted.evaluation.examples)
      write_deformed(folder / (scene.capture.examples[example.example].name + ".vtu"), scene,
                     fitted.form, *model, fitted.evaluation, example);
  };
  out["page"] = [&, model](const path& folder) { write_page_data(folder, scene, *model, fitted); };
  return out;
}

void write_step(const std::filesystem::path& folder, const Scene& scene, const Step& step) {
  for (const auto& [name, write] : step_files(scene, step)) write(folder / name);
}

}  // namespace hookeye
