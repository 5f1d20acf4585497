#include "estimation/inspection/readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "estimation/evaluation/sensor.h"
#include "estimation/inspection/load_case.h"
#include "estimation/inspection/si.h"
#include "estimation/model/session_sensors.h"
#include "meshing/extent.h"

namespace hookeye::inspection {

namespace {

/// The same sensor in several examples.
std::tuple<int, std::string, std::vector<double>> sensor_of(const MeasuredSpec& measured) {
  std::vector<double> where(measured.point.begin(), measured.point.end());
  where.insert(where.end(), measured.direction.begin(), measured.direction.end());
  return {static_cast<int>(measured.kind), measured.region, where};
}

/// What the coarse model's sensor shows with its nodes at `q` under the reactions `R`.
VectorXd sensed(const CoarseModel& coarse, int e, const MeasuredSpec& measured, const VectorXd& q,
                const VectorXd& R) {
  Equilibrium state;
  state.q = q, state.R = R;
  return predicted(measured, {coarse.scene(), coarse.model(), e, state, Eigen::MatrixXd(), nullptr})
      .value;
}

/// Nothing is said of a case without an equilibrium, or of one that another question doubts.
bool can_be_read(Sight& sight, int e) {
  const FirstGuess& guess = *sight.guess(e);
  return guess.reaction.size() > 0 && guess.q.size() > 0 && !moved_by_unknown(sight.example(e)) &&
         !sight.load_doubted(e);
}

Reading read(Sight& sight, int e, const MeasuredSpec& measured) {
  const CoarseModel& coarse = *sight.coarse();
  const FirstGuess& guess = *sight.guess(e);
  const VectorXd X = coarse.scene().body->mesh.X.reshaped();
  const VectorXd rest = sensed(coarse, e, measured, X, VectorXd::Zero(X.size()));
  return {e,
          &measured,
          measured.value - rest,
          sensed(coarse, e, measured, X + guess.u, guess.reaction) - rest,
          sensed(coarse, e, measured, guess.q, guess.R) - rest,
          false};
}

/// Where an angle is counted from is told by the value alone then.
bool is_past_half_a_turn(const MeasuredSpec& measured) {
  return measured.kind == MeasuredSpec::Kind::rotation_of && std::abs(measured.value[0]) >= 180.0;
}

}  // namespace

std::vector<Readings> all_series(Sight& sight) {
  std::map<std::tuple<int, std::string, std::vector<double>>, Readings> by_sensor;
  for (size_t i = 0; i < sight.scene().capture.examples.size(); ++i) {
    const int e = static_cast<int>(i);
    if (!can_be_read(sight, e)) continue;
    for (const MeasuredSpec& measured : sight.example(e).measured)
      if (!measured.field && is_on_body(measured) && !is_past_half_a_turn(measured))
        by_sensor[sensor_of(measured)].push_back(read(sight, e, measured));
  }
  std::vector<Readings> out;
  for (auto& [sensor, series] : by_sensor) {
    const auto rest = std::find_if(series.begin(), series.end(), [&](const Reading& one) {
      return is_rest(sight.example(one.example));
    });
    if (rest != series.end()) {
      const Reading off = *rest;
      series.erase(rest);
      for (Reading& one : series) {
        one.value -= off.value;
        one.first_order -= off.first_order, one.in_equilibrium -= off.in_equilibrium;
        one.less_shared = true;
      }
    } else if (!is_reaction(*series.front().measured)) {
      continue;  // a weight that the capture leaves out may have moved it
    }
    out.push_back(std::move(series));
  }
  return out;
}

double cosine(const VectorXd& a, const VectorXd& b) {
  const double size = a.norm() * b.norm();
  return size > 0.0 ? a.dot(b) / size : 0.0;
}

double beyond_weight(const Sight& sight, const Reading& one) {
  const MeasuredSpec& measured = *one.measured;
  const Capture& capture = sight.scene().capture;
  const bool weighs = capture.gravity && capture.body.density > 0.0;
  if (!is_reaction(measured) || weighs) return 0.0;
  const TetMesh& mesh = sight.scene().body->mesh;
  const double metre = capture.units.metre();
  const double kg = sight.options().heaviest_soft * quality(mesh).volume / (metre * metre * metre);
  const double own = capture.body.density * quality(mesh).volume * 9.81 * metre;
  const double weight = own > 0.0 ? own : 9.81 * kg / newtons(capture.units);
  const double share = one.less_shared ? sight.options().weight_moved : 1.0;
  return share *
         (measured.kind == MeasuredSpec::Kind::moment_on ? weight * extent(mesh.X) : weight);
}

bool sure(const Sight& sight, const Reading& one) {
  const InspectionOptions& options = sight.options();
  const double expected = one.in_equilibrium.norm();
  if (!(expected > 0.0) || cosine(one.first_order, one.in_equilibrium) < options.sure_cosine)
    return false;
  const double times = one.value.norm() / expected;
  return std::abs(std::log(times)) <= std::log(options.most_times_by_force) &&
         one.measured->whitened(one.value).norm() >= options.sure_sigmas &&
         one.value.norm() > beyond_weight(sight, one);
}

std::string told(const VectorXd& value) {
  std::string out;
  for (const double one : value) out += fmt::format("{}{:.3g}", out.empty() ? "" : ", ", one);
  return value.size() == 1 ? out : "(" + out + ")";
}

std::string sensor_in_words(const Sight& sight, const MeasuredSpec& measured) {
  const MeasuredKind& kind = kind_of(measured);
  return measured.region.empty() ? fmt::format("`{}` of {} {}", kind.name, told(measured.point),
                                               sight.scene().capture.units.length)
                                 : fmt::format("`{}: {}`", kind.name, measured.region);
}

}  // namespace hookeye::inspection
