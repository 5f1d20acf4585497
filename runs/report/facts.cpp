#include "runs/report/facts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "capture_io/seen_in_words.h"
#include "estimation/fit/fit.h"
#include "render/renderer.h"

namespace hookeye {

using nlohmann::json;

namespace {

std::string three(const Vector3d& v) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", v.x(), v.y(), v.z());
}

std::string support_text(const SupportSpec& support, const Units& units) {
  if (support.kind == SupportSpec::Kind::rigid_fit)
    return fmt::format("{} moves rigidly, fitted", support.region);
  if (support.kind == SupportSpec::Kind::rigid)
    return fmt::format("{} turns {:.4g}° about {} and moves {} {}", support.region,
                       support.rigid.degrees, three(support.rigid.axis), three(support.rigid.move),
                       units.length);
  std::vector<std::string> parts;
  for (int i = 0; i < 3; ++i)
    if (support.displacement[i])
      parts.push_back(
          *support.displacement[i] == 0.0
              ? fmt::format("{} fixed", "xyz"[i])
              : fmt::format("{} by {:.4g} {}", "xyz"[i], *support.displacement[i], units.length));
  return fmt::format("{}: {}", support.region, fmt::join(parts, ", "));
}

std::string load_fact(const LoadSpec& load, const Units& units) {
  if (load.force)
    return fmt::format("force {} {} on {}", three(*load.force), units.force, load.region);
  return fmt::format("pressure {:.4g} {} on {}", load.pressure.value_or(0.0), units.stress(),
                     load.region);
}

std::string texture_fact(const BodySpec& body) {
  switch (body.texture) {
    case BodySpec::Texture::image:
      return "image " + body.texture_image.path.filename().string();
    case BodySpec::Texture::rest:
      return "photos of " + body.texture_example;
    case BodySpec::Texture::uniform:
      return "uniform";
    default:
      return "none";
  }
}

std::string noise_text(const Capture& capture) {
  for (const auto& example : capture.examples)
    for (const auto& photo : example.photos) {
      if (!photo.noise) return "estimated from each photo (high-pass residuals)";
      if (photo.noise->full_well > 0.0)
        return fmt::format(
            "variance = read² + intensity / full well; read {:.3g}, full well {:.0f}",
            photo.noise->read, photo.noise->full_well);
      return fmt::format("standard deviation {:.3g} of full scale", photo.noise->read);
    }
  return "no photos";
}

/// What acts on the body where, to be drawn on it: `fixed`, the components that stand still;
/// `move`, `force`: vectors; `pressure`.
json support_act(const SupportSpec& support, const Units& units) {
  json out = {{"region", support.region}, {"text", support_text(support, units)}};
  const Vector3d move =
      support.kind == SupportSpec::Kind::components
          ? Vector3d(support.displacement[0].value_or(0.0), support.displacement[1].value_or(0.0),
                     support.displacement[2].value_or(0.0))
          : Vector3d(support.rigid.move);
  const bool told = support.kind != SupportSpec::Kind::rigid_fit;
  if (told && !move.isZero(0.0)) out["move"] = {move.x(), move.y(), move.z()};
  return out;
}

json load_act(const LoadSpec& load, const Units& units) {
  json out = {{"region", load.region}, {"text", load_fact(load, units)}};
  if (load.force) out["force"] = {load.force->x(), load.force->y(), load.force->z()};
  if (load.pressure) out["pressure"] = *load.pressure;
  return out;
}

json example_facts(const ExampleSpec& example, const Units& units) {
  json out = {{"name", example.name},
              {"use", example.use()},
              {"supports", json::array()},
              {"loads", json::array()},
              {"acts", json::array()},
              {"photos", example.photos.size()},
              {"measured", std::ranges::count_if(example.measured, is_on_body)}};
  for (const auto& support : example.supports)
    out["supports"].push_back(support_text(support, units));
  for (const auto& load : example.loads) out["loads"].push_back(load_fact(load, units));
  for (const auto& support : example.supports) out["acts"].push_back(support_act(support, units));
  for (const auto& load : example.loads) out["acts"].push_back(load_act(load, units));
  return out;
}

}  // namespace

json capture_facts(const Capture& capture) {
  json out = {{"title", capture.title},
              {"file", capture.file.string()},
              {"units",
               {{"length", capture.units.length},
                {"force", capture.units.force},
                {"stress", capture.units.stress()}}},
              {"fit", capture.fit},
              {"texture", texture_fact(capture.body)},
              {"laws", json::array()},
              {"cameras", json::array()},
              {"examples", json::array()}};
  for (const auto& material : capture.materials) out["laws"].push_back(material.law);
  for (const auto& camera : capture.cameras)
    out["cameras"].push_back({{"name", camera.name},
                              {"width", camera.width},
                              {"height", camera.height},
                              {"projection", camera.model->name()}});
  for (const auto& example : capture.examples)
    out["examples"].push_back(example_facts(example, capture.units));
  return out;
}

json reporting_table(const Capture& capture) {
  const RenderOptions render;
  const FitOptions fit;
  const bool from_photo = capture.body.texture == BodySpec::Texture::rest;
  json rows = json::array();
  auto row = [&](const char* name, const std::string& value) {
    rows.push_back({{"name", name}, {"value", value}});
  };
  if (const std::string seen = seen_in_words(capture); seen != "photos") {
    row("Technique",
        fmt::format("the whole body's equilibrium is matched to all measured {} at once", seen));
    row("Matching criterion",
        fmt::format("sum of squared (model − measured) / sigma over the {}", seen));
    row("Regularisation",
        fmt::format("none: the mechanical model alone; directions the {} do not fix are named, not "
                    "smoothed",
                    seen));
    row("Units", fmt::format("{}, {}, {}", capture.units.length, capture.units.force,
                             capture.units.stress()));
    return rows;
  }
  row("Technique",
      "integrated digital image correlation: the whole body's equilibrium is matched "
      "to all photos at once, no subsets");
  row("Matching criterion",
      fmt::format("sum of squared (model − photo) / noise over pixels, Huber beyond {:.0f} times "
                  "the photos' own misfit",
                  FitLimits{}.huber));
  row("Noise", noise_text(capture));
  row("Interpolation", from_photo ? "cubic B-spline in the rest photo (one interpolation)"
                                  : "bilinear in the texture");
  row("Pixel filter",
      fmt::format("Blackman-Harris, {:.1f} px wide, {}×{} rays a pixel", render.filter_width_px,
                  render.rays_per_axis, render.rays_per_axis));
  row("Pre-filtering", "none at full size; coarse levels are halved with a low pass");
  row("Regularisation",
      "none: the mechanical model alone; directions the photos do not fix are "
      "named, not smoothed");
  row("Residual displacement",
      "least squares on cells of 16 px, shown where both directions are "
      "known to better than 1 px");
  row("Units", fmt::format("{}, {}, {}; pictures in px; intensity linear, full scale 1",
                           capture.units.length, capture.units.force, capture.units.stress()));
  return rows;
}

}  // namespace hookeye
