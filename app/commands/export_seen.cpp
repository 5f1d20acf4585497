#include "app/commands/export_seen.h"

#include <charconv>

#include "app/interrupt.h"
#include "app/progress.h"
#include "runs/failed.h"

namespace hookeye {
namespace {

/// Numbers between commas, blanks and colons. Empty: something is none.
std::vector<double> numbers_of(const std::string& told) {
  std::vector<double> out;
  for (size_t at = 0; (at = told.find_first_not_of(" ,:", at)) != std::string::npos;) {
    const size_t end = std::min(told.find_first_of(" ,:", at), told.size());
    double value = 0.0;
    const auto [rest, error] = std::from_chars(told.data() + at, told.data() + end, value);
    if (error != std::errc() || rest != told.data() + end || !std::isfinite(value)) return {};
    out.push_back(value);
    at = end;
  }
  return out;
}

std::array<Vector3d, 2> line_of(const std::string& told) {
  const std::vector<double> x = numbers_of(told);
  if (x.size() != 6)
    throw InputError({"--line"}, fmt::format("'{}' is no line", told),
                     "two points of the body at rest: --line 0,0,5:0,0,35");
  const std::array<Vector3d, 2> out = {Vector3d(x[0], x[1], x[2]), Vector3d(x[3], x[4], x[5])};
  if (out[0] == out[1])
    throw InputError({"--line"}, fmt::format("both ends of '{}' are one point", told),
                     "two points apart from each other");
  return out;
}

}  // namespace

SeenOptions seen_options(const SeenArguments& arguments) {
  SeenOptions out;
  out.grid_px = arguments.grid_px, out.window = arguments.window, out.gauges = arguments.gauges;
  if (out.window % 2 == 0)
    throw InputError({"--window"}, fmt::format("{} is even", out.window),
                     "an odd number of points, which has a middle");
  for (const std::string& told : arguments.lines) out.lines.push_back(line_of(told));
  if (arguments.along.empty()) return out;
  const std::vector<double> x = numbers_of(arguments.along);
  if (x.size() != 3 || Vector3d(x[0], x[1], x[2]).isZero(0.0))
    throw InputError({"--along"}, fmt::format("'{}' is no direction", arguments.along),
                     "three numbers: --along 0,0,1");
  out.along = Vector3d(x[0], x[1], x[2]).normalized();
  return out;
}

SeenSurface look_at(const ModelForm& form, const VectorXd& p, const SeenOptions& options) {
  Workspace workspace(form.scene);
  EvaluationOptions evaluation;
  evaluation.derivatives = false;
  evaluation.pictures = evaluation.held_out = true;
  evaluation.cancel = &interrupted();
  const auto progress = std::make_shared<Progress>("comparing", 0);
  evaluation.progress = [progress](int done, int of) {
    progress->set(done, of, "loads solved and compared");
  };
  const Evaluation seen = value_or_fail(workspace.evaluate(form, p, evaluation));
  return seen_surface(form.realise(p), seen, options);
}

}  // namespace hookeye
