#include "app/commands/check_fields.h"

#include <algorithm>
#include <functional>

#include "capture_io/component_sigmas.h"
#include "capture_io/field_start.h"
#include "capture_io/strain_field.h"
#include "estimation/fit/field_floor.h"
#include "estimation/fit/field_scatter.h"
#include "estimation/model/field_points.h"
#include "runs/text.h"

namespace hookeye {
namespace {

using Json = nlohmann::ordered_json;

void for_each_field(
    const Scene& scene,
    const std::function<void(const ExampleSpec&, const MeasuredSpec&, const FieldSpec&)>& visit) {
  for (const ExampleSpec& example : scene.capture.examples)
    for (const MeasuredSpec& measured : example.measured)
      if (measured.field) visit(example, measured, *measured.field);
}

/// What a plane in each small piece leaves of the displacements, over the told noise; 0: too few.
double rough_of(const MeasuredSpec& measured) {
  return rough_field(*measured.field, measured.value.cwiseQuotient(measured.sigma)).chi();
}

/// The same of each component, in its unit; empty: too few.
std::vector<double> rough_by_component(const MeasuredSpec& measured) {
  const auto found = scatter_in_pieces(measured);
  return found && *std::min_element(found->sigma.begin(), found->sigma.end()) > 0.0
             ? found->sigma
             : std::vector<double>();
}

/// "0.0052, 0.0049, 0.021".
std::string listed_numbers(const std::vector<double>& values) {
  std::string out;
  for (const double one : values) out += (out.empty() ? "" : ", ") + fmt::format("{:.2g}", one);
  return out;
}

double gap_of(const TetMesh& mesh, const FieldSpec& field) {
  const BoundaryLocator locator(mesh);
  double out = 0.0;
  SurfacePoint point;
  for (Eigen::Index k = 0; k < field.X.cols(); ++k)
    out = std::max(out, locator.locate(field.X.col(k), &point));
  return out;
}

/// What a point tells, by its number of components.
std::string directions_of(bool strains, int components) {
  if (strains) return components == 3 ? "exx eyy exy" : "exx eyy";
  return components == 3 ? "x y z" : "x y";
}

}  // namespace

Json describe_fields(const Scene& scene) {
  Json out = Json::array();
  for_each_field(scene, [&](const auto& example, const auto& measured, const auto& field) {
    const double rough = rough_of(measured);
    out.push_back(
        {{"example", example.name},
         {"file", field.told},
         {"points", field.X.cols()},
         {"dropped", field.dropped},
         {"holds", field.strain ? "strains" : "displacements"},
         {"components", field.components},
         {"spacing", field.spacing},
         {"correlation", field.correlation},
         {"numbers", field.numbers()},
         {"sigma", field.sigma},
         {"rough", rough > 0.0 ? Json(rough * field.sigma) : Json()},
         {"sigmas",
          [&] {
            const VectorXd sigmas = component_sigmas(measured);
            return std::vector<double>(sigmas.begin(), sigmas.end());
          }()},
         {"rough_along", rough_by_component(measured)},
         {"scatter_along",
          [&] {
            const auto found = scatter_of_neighbours(measured);
            return found ? found->sigma : std::vector<double>();
          }()},
         {"largest", measured.value.cwiseAbs().maxCoeff()},
         {"gap", start_of(measured).empty() ? Json(gap_of(scene.body->mesh, field)) : Json()}});
    // Where its points lie, the load case tells once it is solved.
    if (!start_of(measured).empty()) out.back()["from"] = start_of(measured);
    if (field.strain)
      out.back().update(
          {{"strain", name_of(field.strain->measure)}, {"gauge", field.strain->gauge}});
  });
  return out;
}

void say_fields(const Scene& scene, const Json& fields, const Session& session) {
  const std::string& length = scene.capture.units.length;
  const std::vector<std::string> heads{"example", "field", "points", "dropped", "along", "alike",
                                       "numbers", "sigma", "rough",  "largest", "gap"};
  std::vector<std::vector<std::string>> moved{heads}, strained{heads};
  strained[0].insert(strained[0].begin() + 2, {"measure", "gauge"});
  const auto short_number = [](const Json& value, double in = 1.0) {
    return value.is_null() ? "-" : fmt::format("{:.3g}", in * value.get<double>());
  };
  // One number where two digits of all are the same.
  const auto by_component = [](const Json& values, double in) {
    std::string out, last;
    bool alike = true;
    for (const Json& one : values) {
      const std::string text = fmt::format("{:.2g}", in * one.get<double>());
      alike = alike && (last.empty() || text == last);
      out += (out.empty() ? "" : " ") + text, last = text;
    }
    return out.empty() ? std::string("-") : alike ? last : out;
  };
  for (const auto& one : fields) {
    const bool strains = one["holds"] == "strains";
    const double in = strains ? 1e3 : 1.0;
    std::string example = one["example"];
    if (one.contains("from")) example += " from " + one["from"].get<std::string>();
    std::vector<std::string> row{
        example,
        std::filesystem::path(one["file"].get<std::string>()).filename().string(),
        std::to_string(one["points"].get<long>()),
        std::to_string(one["dropped"].get<long>()),
        directions_of(strains, one["components"]),
        short_number(one["correlation"]),
        fmt::format("{:.0f}", one["numbers"].get<double>()),
        by_component(one["sigmas"], in),
        by_component(one["rough_along"], in),
        short_number(one["largest"], in),
        short_number(one["gap"])};
    if (strains)
      row.insert(row.begin() + 2, {one["strain"].get<std::string>(), short_number(one["gauge"])});
    (strains ? strained : moved).push_back(std::move(row));
  }
  if (moved.size() > 1) session.say("\nmeasured fields [{}]\n{}", length, table(moved));
  if (strained.size() > 1)
    session.say("\nmeasured strains [millistrain; alike, gauge and gap in {}]\n{}", length,
                table(strained));
  for_each_field(scene, [&](const auto&, const auto&, const auto& field) {
    if (!field.strain_columns.empty())
      session.say("{} holds strains too ({}): an entry with `strain: green` would read them",
                  field.told, field.strain_columns);
  });
}

namespace {

/// Two cameras see worse along their sight than across it: one number for all tells the one too
/// well, and takes weight from the others. Whether something was said.
bool warn_of_unlike(const ExampleSpec& example, const MeasuredSpec& measured, Session& session) {
  constexpr double kUnlike = 2.0;
  const std::vector<double> rough = rough_by_component(measured);
  const VectorXd sigmas = component_sigmas(measured);
  if (rough.empty() || !is_rest(example) || sigmas.minCoeff() < sigmas.maxCoeff()) return false;
  const auto [least, most] = std::minmax_element(rough.begin(), rough.end());
  if (*most <= kUnlike * *least) return false;
  const FieldSpec& field = *measured.field;
  session.warn(fmt::format(
      "{}: at rest the field is rough by {} along {}, and `sigma` is {:g} for all: give one a "
      "component, `sigma: [{}]`",
      measured.place.str(), listed_numbers(rough),
      directions_of(field.strain != nullptr, field.components), field.sigma,
      listed_numbers(rough)));
  return true;
}

/// A lower bound of a field's noise, and how it was seen.
struct Bound {
  LeastNoise noise;
  std::string words;
};

std::vector<Bound> bounds_of(const ExampleSpec& example, const MeasuredSpec& measured) {
  std::vector<Bound> out;
  const auto add = [&](std::optional<LeastNoise> noise, const std::string& words) {
    if (noise) out.push_back({*std::move(noise), words});
  };
  if (is_rest(example) && start_of(measured).empty())
    add(scatter_in_pieces(measured), "at rest the field is rough by");
  for (const MeasuredSpec& other : example.measured)
    if (other.field && &other != &measured)
      add(scatter_of_repeats(measured, other),
          fmt::format("beside {}, of the same points and load case, the field is noisy by",
                      other.field->told));
  add(scatter_of_neighbours(measured), "neighbouring points of the field scatter by");
  return out;
}

/// Noise that is told smaller than the field itself shows it. A right model then keeps more than
/// counts as explained (floor.at); beyond that only three standard errors make it sure.
void warn_of_small_sigma(const Scene& scene, const ExampleSpec& example,
                         const MeasuredSpec& measured, Session& session) {
  const FieldSpec& field = *measured.field;
  const VectorXd sigmas = component_sigmas(measured);
  for (const Bound& bound : bounds_of(example, measured)) {
    const double most = scene.limits->floor.at * (1.0 + 3.0 * bound.noise.error);
    bool small = false;
    for (int c = 0; c < field.components; ++c)
      small = small || bound.noise.sigma[static_cast<size_t>(c)] > most * sigmas[c];
    if (!small) continue;
    const std::vector<double> told(sigmas.begin(), sigmas.end());
    session.warn(fmt::format(
        "{}: {} {}{} along {}, and `sigma` is {}: told too small it promises too much; rows that "
        "are outliers may do it too",
        measured.place.str(), bound.words, listed_numbers(bound.noise.sigma),
        field.strain ? "" : " " + scene.capture.units.length,
        directions_of(field.strain != nullptr, field.components),
        sigmas.minCoeff() < sigmas.maxCoeff() ? listed_numbers(told)
                                              : fmt::format("{:g}", sigmas[0])));
    return;
  }
}

}  // namespace

void warn_of_fields(const Scene& scene, Session& session) {
  const std::string& length = scene.capture.units.length;
  for_each_field(scene, [&](const auto& example, const auto& measured, const auto& field) {
    const std::string at = measured.place.str() + ": ";
    if (!field.unit_told)
      session.warn(
          fmt::format("{}neither {} nor the capture tells the unit: it is taken for {}; "
                      "tell `unit: {}`",
                      at, field.told, length, length));
    if (const auto rows = field.X.cols() + field.dropped; field.dropped > 0.2 * rows)
      session.warn(
          fmt::format("{}{} of {} rows of {} are dropped: they have no number, or the file "
                      "marks them as lost",
                      at, field.dropped, rows, field.told));
    if (field.strain && !field.strain->gauge_told)
      session.warn(
          fmt::format("{}the strains of {} are taken pointwise: tell over which length "
                      "the program smoothed, `gauge: LENGTH` (0: none)",
                      at, field.told));
    const double rough = rough_of(measured);
    const std::string size = field.strain
                                 ? fmt::format("{:.2g} millistrain", 1e3 * rough * field.sigma)
                                 : fmt::format("{:.2g} {}", rough * field.sigma, length);
    if (rough > 0.0 && rough < 0.5)
      session.warn(
          fmt::format("{}the field is rough by {} only, and `sigma` is {:g}: told too "
                      "large it hides what is missing",
                      at, size, field.sigma));
    if (!warn_of_unlike(example, measured, session))
      warn_of_small_sigma(scene, example, measured, session);
  });
}

}  // namespace hookeye
