#include "proposal/loading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "capture_io/camera_text.h"

namespace hookeye {
namespace {

/// A load cell of class 1 (ISO 7500-1) reads within 1 % of the force: two deviations.
constexpr double kLoadCell = 0.005;
/// An extensometer of class 1 (ISO 9513) reads within 3 um where it moves little: two deviations.
/// [mm]
constexpr double kLeastTravelSigma = 0.0015;

std::string vector_yaml(const Vector3d& v) {
  return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);
}

/// The coordinate axis along a direction; -1: it is oblique.
int axis_of(const Vector3d& direction) {
  for (int i = 0; i < 3; ++i)
    if (std::abs(direction[i]) > 1 - 1e-9) return i;
  return -1;
}

/// A direction from the middle (its end face), or a named group of the volume mesh.
std::string region_yaml(const BodyFacts& body, const std::string& name, const std::string& answer,
                        std::vector<std::string>& said) {
  if (std::find(body.groups.begin(), body.groups.end(), answer) != body.groups.end())
    return fmt::format("{{group: {}}}", yaml_name(answer));
  const auto direction = direction_in(answer);
  if (!direction)
    refuse_answer(name, answer,
                  body.groups.empty()
                      ? "the end of the body that it is: +x, -x, +y, -y, +z, -z or a vector x,y,z"
                      : fmt::format("a group of the mesh (as {}), or the end of the body: +x, -x, "
                                    "+y, -y, +z, -z or x,y,z",
                                    body.groups.front()));
  const EndRegion end = end_region(body, *direction);
  if (!end.flat)
    said.push_back(fmt::format(
        "the {} end ({}) is not flat: its outermost twentieth is taken; look whether the grip "
        "holds that much",
        name, answer));
  return fmt::format("{{halfspace: {{point: {}, normal: {}}}}}", vector_yaml(end.point),
                     vector_yaml(end.normal));
}

/// +1, or -1 where travel falls while force rises.
double travel_sign(const MachineRecord& record) {
  double sum = 0;
  for (size_t i = 0; i < record.size(); ++i) sum += record.force[i] * record.travel[i];
  return sum < 0 ? -1 : 1;
}

}  // namespace

MachineLoading propose_loading(const BodyFacts& body, MachineRecord& record, Questions& questions,
                               std::vector<std::string>& said) {
  MachineLoading out;
  const std::string low = end_name(-body.axis), high = end_name(body.axis);
  const std::string held = questions.ask({.name = "held",
                                          .text = "which end of the body is held",
                                          .standard = low,
                                          .why = "an end of the longest axis"});
  const std::string pulled = questions.ask({.name = "pulled",
                                            .text = "which end the machine moves",
                                            .standard = held == high ? low : high,
                                            .why = "the end across from the one held"});
  if (held == pulled) refuse_answer("pulled", pulled, "another end than the one that is held");
  out.held = region_yaml(body, "held", held, said);
  out.pulled = region_yaml(body, "pulled", pulled, said);
  const Vector3d outward = direction_in(pulled).value_or(body.axis);
  const std::string standard = end_name(record.compression ? Vector3d(-outward) : outward);
  const std::string pull =
      questions.ask({.name = "pull",
                     .text = "where a positive force of the table draws the moved end",
                     .standard = standard,
                     .why = record.compression ? "the table speaks of compression"
                                               : "away from the body, as in tension"});
  const auto direction = direction_in(pull);
  if (!direction) refuse_answer("pull", pull, "+x, -x, +y, -y, +z, -z or a vector x,y,z");
  out.direction = *direction;
  const bool both = !record.force.empty() && !record.travel.empty();
  const std::string drive = questions.ask(
      {.name = "drive",
       .text = "what is prescribed: the machine's travel (its force is then measured) or its force",
       .standard = record.travel.empty() ? "force" : "travel",
       .why = both ? "a grip moves as the crosshead does; take force where grips slip or yield"
                   : "the table has no other",
       .choices = both ? std::vector<std::string>{"travel", "force"}
                       : std::vector<std::string>{record.travel.empty() ? "force" : "travel"},
       .asked = both});
  out.moved = drive == "travel";
  if (both && travel_sign(record) < 0) {
    for (double& value : record.travel) value = -value;
    said.push_back("travel falls while the force rises: it is taken with the other sign");
  }
  out.length = body.length_along(outward);
  out.section = body.volume / out.length;
  return out;
}

std::string loading_text(const MachineLoading& loading, const MachineRecord& record,
                         const PairedPhoto& photo, double mm, double clock_error) {
  const Vector3d& d = loading.direction;
  const int axis = axis_of(d);
  std::string out = "    supports:\n      - {region: held, fix: [x, y, z]}\n";
  if (!loading.moved) {
    // A guided crosshead keeps the grip from going sideways.
    if (axis >= 0)
      out += fmt::format("      - {{region: pulled, move: {{{}: 0, {}: 0}}}}\n",
                         "xyz"[(axis + 1) % 3], "xyz"[(axis + 2) % 3]);
    return out + fmt::format("    loads:\n      - {{region: pulled, force: {}}}\n",
                             vector_yaml(photo.force * d));
  }
  const double sigma =
      std::max(std::hypot(record.travel_noise, photo.travel_rate * clock_error), kLeastTravelSigma);
  out += fmt::format("      - {{region: pulled, rigid: {{move: {}}}, sigma: {:.2g}}}\n",
                     vector_yaml(photo.travel / mm * d), sigma / mm);
  if (record.force.empty()) return out;
  double most = 0;
  for (const double force : record.force) most = std::max(most, std::abs(force));
  // A load cell tells the force along its axis alone; across it, anything up to the largest.
  const double along = std::max(
      {std::hypot(record.force_noise, kLoadCell * photo.force, photo.force_rate * clock_error),
       1e-4 * most});
  out += fmt::format("    measured:\n      - {{force_on: pulled, value: {}, ",
                     vector_yaml(photo.force * d));
  if (axis >= 0) {
    Vector3d sigma = Vector3d::Constant(most);
    sigma[axis] = along;
    return out + fmt::format("sigma: {}}}\n", vector_yaml(sigma));
  }
  const Eigen::Matrix3d covariance =
      along * along * d * d.transpose() +
      most * most * (Eigen::Matrix3d::Identity() - d * d.transpose());
  return out + fmt::format("covariance: [{}, {}, {}]}}\n", vector_yaml(covariance.row(0)),
                           vector_yaml(covariance.row(1)), vector_yaml(covariance.row(2)));
}

double start_modulus(const MachineLoading& loading, const MachineRecord& record,
                     const LoadCases& cases, double mm) {
  if (record.force.empty() || record.travel.empty() || cases.loads.empty()) return 0;
  const PairedPhoto& photo = cases.loads[cases.loads.size() / 2].photo;
  const double strain = std::abs(photo.travel) / mm / loading.length;
  const double modulus = std::abs(photo.force) / loading.section / strain / 3;
  return std::isfinite(modulus) ? modulus : 0;
}

}  // namespace hookeye
