#include "app/commands/check_fields.h"

#include <functional>

#include "estimation/fit/field_floor.h"
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

}  // namespace

Json describe_fields(const Scene& scene) {
  Json out = Json::array();
  for_each_field(scene, [&](const auto& example, const auto& measured, const auto& field) {
    const double rough = rough_of(measured);
    out.push_back({{"example", example.name},
                   {"file", field.told},
                   {"points", field.X.cols()},
                   {"dropped", field.dropped},
                   {"components", field.components},
                   {"spacing", field.spacing},
                   {"correlation", field.correlation},
                   {"numbers", field.numbers()},
                   {"sigma", field.sigma},
                   {"rough", rough > 0.0 ? Json(rough * field.sigma) : Json()},
                   {"largest", measured.value.cwiseAbs().maxCoeff()},
                   {"gap", field_points(scene.body->mesh, field).gap.maxCoeff()}});
  });
  return out;
}

void say_fields(const Scene& scene, const Json& fields, const Session& session) {
  if (fields.empty()) return;
  std::vector<std::vector<std::string>> rows{{"example", "field", "points", "dropped", "along",
                                              "alike", "numbers", "sigma", "rough", "largest",
                                              "gap"}};
  const auto short_number = [](const Json& value) {
    return value.is_null() ? "-" : fmt::format("{:.3g}", value.get<double>());
  };
  for (const auto& one : fields)
    rows.push_back(
        {one["example"], std::filesystem::path(one["file"].get<std::string>()).filename().string(),
         std::to_string(one["points"].get<long>()), std::to_string(one["dropped"].get<long>()),
         one["components"] == 3 ? "x y z" : "x y", short_number(one["correlation"]),
         fmt::format("{:.0f}", one["numbers"].get<double>()), short_number(one["sigma"]),
         short_number(one["rough"]), short_number(one["largest"]), short_number(one["gap"])});
  session.say("\nmeasured fields [{}]\n{}", scene.capture.units.length, table(rows));
}

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
    const double rough = rough_of(measured);
    if (rough > 0.0 && rough < 0.5)
      session.warn(fmt::format(
          "{}the field is rough by {:.2g} {} only, and `sigma` is {:g}: told too large it hides "
          "what is missing",
          at, rough * field.sigma, length, field.sigma));
    else if (rough > 2.0 && is_rest(example))
      session.warn(fmt::format(
          "{}at rest the field is rough by {:.2g} {}, and `sigma` is {:g}: told too small it "
          "promises too much; rows that are outliers may do it too",
          at, rough * field.sigma, length, field.sigma));
  });
}

}  // namespace hookeye
