// Examples: supports, loads, photos and what else was measured.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <set>

#include "capture_io/capture_reader.h"
#include "capture_io/travel.h"

namespace hookeye {
namespace {

/// Reads the sections of one example with the names it may refer to.
class ExampleReader {
 public:
  ExampleReader(const std::string& name, const Capture& capture, const CaptureFolder& folder)
      : of_(fmt::format(" of example `{}`", name)),
        regions_(names_of(capture.regions)),
        capture_(capture),
        folder_(folder) {}

  /// A travel with a `sigma` is measured, too: `measured` gets it.
  SupportSpec support(const YamlNode& node, std::vector<MeasuredSpec>& measured);
  LoadSpec load(const YamlNode& node) const;
  MeasuredSpec measured(const YamlNode& node) const;

 private:
  std::string region(const YamlNode& node, const std::string& what) const;
  RigidMotion rigid(const YamlNode& node) const;
  void components(const YamlSection& section, SupportSpec& support);
  void read_travel_sigma(const YamlNode& node, const SupportSpec& support,
                         std::vector<MeasuredSpec>& measured) const;
  void claim(const Place& place, const std::string& region, int component);

  std::string of_;
  std::vector<std::string> regions_;
  const Capture& capture_;
  const CaptureFolder& folder_;
  std::set<std::pair<std::string, int>> held_;  ///< region and component already prescribed
};

std::string ExampleReader::region(const YamlNode& node, const std::string& what) const {
  const std::string name = read_string(node, "region of " + what);
  if (std::find(regions_.begin(), regions_.end(), name) == regions_.end())
    throw InputError(node.place, fmt::format("{} names the unknown region `{}`", what, name),
                     suggest(name, regions_));
  return name;
}

void ExampleReader::claim(const Place& place, const std::string& region, int component) {
  if (!held_.insert({region, component}).second)
    throw InputError(place,
                     fmt::format("the supports{} prescribe component {} of region `{}` twice", of_,
                                 "xyz"[component], region),
                     "prescribe every component of a region once");
}

int component_of(const std::string& text) {
  return text.size() == 1 && text[0] >= 'x' && text[0] <= 'z' ? text[0] - 'x' : -1;
}

void ExampleReader::components(const YamlSection& section, SupportSpec& support) {
  if (const YamlNode* fix = section.find("fix")) {
    const std::string right = "a list of x, y and z is expected";
    if (read_list(*fix, "fix", right).empty()) unexpected(*fix, "fix", right);
    for (const YamlNode& item : fix->items) {
      const int i = component_of(item.text);
      if (i < 0) unexpected(item, "a component of fix", "x, y or z is expected");
      claim(item.place, support.region, i);
      support.displacement[i] = 0.0;
    }
  }
  if (const YamlNode* move = section.find("move")) {
    const YamlSection parts(*move, "move", {"x", "y", "z"});
    if (move->entries.empty())
      throw InputError(move->place, "move prescribes nothing", "write `move: {x: 0, y: 0}`");
    for (const YamlNode::Entry& entry : move->entries) {
      const int i = component_of(entry.key);
      claim(entry.place, support.region, i);
      support.displacement[i] = read_number(entry.value, "move along " + entry.key);
    }
  }
}

RigidMotion ExampleReader::rigid(const YamlNode& node) const {
  const YamlSection section(node, "rigid", {"rotate", "move"});
  RigidMotion motion;
  if (!section.has("rotate") && !section.has("move"))
    throw InputError(node.place, "rigid prescribes nothing",
                     "give `rotate`, `move` or both; `rigid: fit` leaves the motion unknown");
  if (const YamlNode* rotate = section.find("rotate")) {
    const YamlSection turn(*rotate, "rotate", {"axis", "degrees", "center"});
    const std::string right = "write `rotate: {axis: [0, 0, 1], degrees: 20, center: [0, 0, 80]}`";
    motion.axis = read_direction(turn.need("axis", right), "axis");
    motion.degrees = read_number(turn.need("degrees", right), "degrees");
    motion.center = read_vector3(turn.need("center", right), "center");
  }
  if (const YamlNode* move = section.find("move")) motion.move = read_vector3(*move, "move");
  return motion;
}

void ExampleReader::read_travel_sigma(const YamlNode& node, const SupportSpec& support,
                                      std::vector<MeasuredSpec>& measured) const {
  const double sigma = read_positive(node, "sigma of a support");
  const Vector3d travel = prescribed_travel(support);
  if (travel.isZero(0.0) || support.rigid.degrees != 0.0)
    throw InputError(node.place,
                     fmt::format("`sigma` is of a travel, and region `{}` {}", support.region,
                                 travel.isZero(0.0) ? "has none" : "turns as well"),
                     "beside `move` alone: `{region: grip, move: {z: 5}, sigma: 0.02}`");
  MeasuredSpec of_it;
  of_it.kind = MeasuredSpec::Kind::travel_of;
  of_it.place = node.place;
  of_it.region = support.region;
  of_it.direction = travel.normalized();
  of_it.value = Eigen::VectorXd::Constant(1, travel.norm());
  of_it.sigma = Eigen::VectorXd::Constant(1, sigma);
  measured.push_back(std::move(of_it));
}

SupportSpec ExampleReader::support(const YamlNode& node, std::vector<MeasuredSpec>& measured) {
  const YamlSection section(node, "a support" + of_, {"region", "fix", "move", "rigid", "sigma"});
  SupportSpec support;
  support.place = node.place;
  support.region =
      region(section.need("region", "write `{region: base, fix: [x, y, z]}`"), section.what());
  const YamlNode* rigid_motion = section.find("rigid");
  if (!rigid_motion) {
    if (!section.has("fix") && !section.has("move")) section.one_of({"fix", "move", "rigid"});
    components(section, support);
  } else {
    for (const char* other : {"fix", "move"})
      if (const YamlNode::Entry* entry = section.entry(other))
        throw InputError(entry->place,
                         fmt::format("{} has both `rigid` and `{}`", section.what(), other),
                         "keep one of the two");
    for (int i = 0; i < 3; ++i) claim(rigid_motion->place, support.region, i);
    if (rigid_motion->kind == YamlNode::Kind::scalar && rigid_motion->text == "fit") {
      support.kind = SupportSpec::Kind::rigid_fit;
    } else {
      if (rigid_motion->kind == YamlNode::Kind::scalar)
        unexpected(*rigid_motion, "rigid", "`fit` is expected, or a map of `rotate` and `move`");
      support.kind = SupportSpec::Kind::rigid;
      support.rigid = rigid(*rigid_motion);
    }
  }
  if (const YamlNode* sigma = section.find("sigma")) read_travel_sigma(*sigma, support, measured);
  return support;
}

LoadSpec ExampleReader::load(const YamlNode& node) const {
  const YamlSection section(node, "a load" + of_, {"region", "force", "pressure"});
  LoadSpec load;
  load.place = node.place;
  load.region =
      region(section.need("region", "write `{region: grip, force: [0, 0, 2.5]}`"), section.what());
  const std::string kind = section.one_of({"force", "pressure"});
  if (kind == "force")
    load.force = read_vector3(*section.find(kind), "force");
  else
    load.pressure = read_number(*section.find(kind), "pressure");
  return load;
}

/// A point to refer to, or a direction, a unit vector.
Vector3d read_argument(const YamlSection& section, const MeasuredKind& kind) {
  const bool point = kind.key == std::string("about");
  const YamlNode& node = section.need(
      kind.key, point ? "a moment refers to a point: write `about: [0, 0, 80]`"
                      : fmt::format("tell the direction: write `{}: [0, 0, 1]`", kind.key));
  return point ? read_vector3(node, kind.key) : read_direction(node, kind.key);
}

/// The two ends of a strain gauge.
void read_gauge(const YamlNode& node, MeasuredSpec& measured) {
  const std::string right = "two points of the body at rest: `strain_of: [[0, 0, 10], [0, 0, 30]]`";
  const auto& ends = read_list(node, "strain_of", right);
  if (ends.size() != 2)
    throw InputError(node.place, fmt::format("`strain_of` has {} entries", ends.size()), right);
  measured.point = read_vector3(ends[0], "the first point of `strain_of`");
  measured.direction = read_vector3(ends[1], "the second point of `strain_of`");
  if (measured.point == measured.direction)
    throw InputError(node.place, "the two points of `strain_of` are one: nothing lies between them",
                     right);
}

Eigen::VectorXd read_as_many(const YamlNode& node, const std::string& what, int size) {
  if (size == 3) return read_vector3(node, what);
  if (node.kind == YamlNode::Kind::scalar)
    return Eigen::VectorXd::Constant(size, read_number(node, what));
  const auto numbers = read_numbers(node, what);
  if (static_cast<int>(numbers.size()) != size)
    throw InputError(node.place, fmt::format("`{}` has {} numbers", what, numbers.size()),
                     fmt::format("{} of them", size));
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), size);
}

/// One number for all, one for each, or a covariance: rows in a list.
void read_sigma(const YamlNode& node, int size, MeasuredSpec& measured) {
  if (node.kind == YamlNode::Kind::scalar) {
    measured.sigma = Eigen::VectorXd::Constant(size, read_positive(node, "sigma"));
    return;
  }
  measured.sigma = read_as_many(node, "sigma", size);
  for (int i = 0; i < size; ++i)
    if (!(measured.sigma[i] > 0.0))
      throw InputError(node.place, "`sigma` has a number that is not above zero",
                       "standard deviations, one for each component");
}

void read_covariance(const YamlNode& node, int size, MeasuredSpec& measured) {
  const std::string right =
      fmt::format("{0} lists of {0} numbers, symmetric and positive definite", size);
  const auto& rows = read_list(node, "covariance", right);
  if (static_cast<int>(rows.size()) != size)
    throw InputError(node.place, fmt::format("`covariance` has {} rows", rows.size()), right);
  Eigen::MatrixXd C(size, size);
  for (int i = 0; i < size; ++i) C.row(i) = read_as_many(rows[i], "covariance", size).transpose();
  const Eigen::LLT<Eigen::MatrixXd> root(C);
  if (!C.isApprox(C.transpose(), 1e-9) || root.info() != Eigen::Success)
    throw InputError(node.place, "`covariance` is none", right);
  measured.sigma = C.diagonal().cwiseSqrt();
  measured.covariance_root = root.matrixL();
}

void read_told(const YamlSection& section, const MeasuredKind& kind, MeasuredSpec& measured) {
  const YamlNode& value =
      section.need("value", kind.size == 3 ? "write `value: [0, 0, 2.5]`" : "write `value: 2.5`");
  const int size =
      kind.size > 0 ? kind.size : std::max<int>(1, static_cast<int>(value.items.size()));
  measured.value = read_as_many(value, "value", size);
  const YamlNode* covariance = section.find("covariance");
  if (covariance && section.find("sigma"))
    throw InputError(covariance->place, "`sigma` and `covariance` tell the same",
                     "leave one of them out");
  if (covariance)
    read_covariance(*covariance, size, measured);
  else
    read_sigma(section.need("sigma", "give the measurement's standard deviation: `sigma: 0.02`"),
               size, measured);
}

MeasuredSpec ExampleReader::measured(const YamlNode& node) const {
  if (node.find("field")) return read_field(node, of_, capture_, folder_);
  std::vector<std::string> kinds, keys = {"value", "sigma", "covariance"};
  for (const MeasuredKind& kind : measured_kinds()) {
    if (kind.on == std::string("cameras")) continue;  // the capture's `camera_covariance`
    kinds.push_back(kind.name);
    if (kind.key != std::string("none")) keys.push_back(kind.key);
  }
  keys.insert(keys.end(), kinds.begin(), kinds.end());
  const YamlSection section(node, "a measurement" + of_, keys);
  const std::string name = section.one_of(kinds);
  const YamlNode& subject = *section.find(name);
  MeasuredSpec measured;
  measured.place = node.place;
  for (size_t k = 0; k < measured_kinds().size(); ++k)
    if (name == measured_kinds()[k].name) measured.kind = static_cast<MeasuredSpec::Kind>(k);
  const MeasuredKind& kind = kind_of(measured);
  if (kind.on == std::string("point"))
    measured.point = read_vector3(subject, name);
  else if (kind.on == std::string("points"))
    read_gauge(subject, measured);
  else if (kind.on == std::string("name"))
    measured.region = read_string(subject, name);
  else
    measured.region = region(subject, section.what());
  for (const MeasuredKind& other : measured_kinds()) {
    if (other.key == std::string("none") || other.key == std::string(kind.key)) continue;
    if (const YamlNode::Entry* told = section.entry(other.key))
      throw InputError(told->place, fmt::format("`{}` has no meaning for `{}`", other.key, name),
                       fmt::format("only {} has `{}`: remove it", other.name, other.key));
  }
  if (kind.key != std::string("none")) measured.direction = read_argument(section, kind);
  read_told(section, kind, measured);
  return measured;
}

ExampleSpec read_example(const YamlNode::Entry& entry, const Capture& capture,
                         const PhotoDefaults& defaults, const CaptureFolder& folder) {
  const std::string what = fmt::format("example `{}`", entry.key);
  const YamlSection section(entry.value, what, {"use", "supports", "loads", "photos", "measured"});
  ExampleSpec example;
  example.name = entry.key;
  example.place = entry.place;
  ExampleReader reader(entry.key, capture, folder);
  if (const YamlNode* use = section.find("use")) {
    const std::string chosen = read_choice(*use, "use of " + what, {"fit", "validate", "test"});
    example.validate = chosen != "fit", example.test = chosen == "test";
  }
  if (const YamlNode* supports = section.find("supports"))
    for (const YamlNode& item :
         read_list(*supports, "supports of " + what, "write `- {region: base, fix: [x, y, z]}`"))
      example.supports.push_back(reader.support(item, example.measured));
  if (const YamlNode* loads = section.find("loads"))
    for (const YamlNode& item :
         read_list(*loads, "loads of " + what, "write `- {region: grip, force: [0, 0, 2.5]}`"))
      example.loads.push_back(reader.load(item));
  if (const YamlNode* photos = section.find("photos"))
    example.photos = read_photos(*photos, entry.key, capture, defaults, folder);
  if (const YamlNode* measured = section.find("measured"))
    for (const YamlNode& item :
         read_list(*measured, "measured of " + what,
                   "write `- {force_on: grip, value: [0, 0, 2.5], sigma: 0.02}`")) {
      example.measured.push_back(reader.measured(item));
      if (is_reaction(example.measured.back()) && example.supports.empty())
        throw InputError(item.place, what + " measures a support's force but has no supports",
                         "forces are measured where a support holds the body");
    }
  return example;
}

}  // namespace

std::vector<ExampleSpec> read_examples(const YamlNode& node, const Capture& capture,
                                       const PhotoDefaults& defaults, const CaptureFolder& folder) {
  std::vector<ExampleSpec> examples;
  for (const YamlNode::Entry& entry : read_named(node, "examples"))
    examples.push_back(read_example(entry, capture, defaults, folder));
  if (examples.empty())
    throw InputError(node.place, "there are no examples",
                     "write `examples: {rest: {photos: {CAMERA: FILE}}}`");
  return examples;
}

}  // namespace hookeye
