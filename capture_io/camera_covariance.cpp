#include "capture_io/camera_covariance.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "capture_io/camera_text.h"
#include "capture_io/yaml_file.h"

namespace hookeye {
namespace {

constexpr const char* kBegins =
    "write `unit`, `frame: camera`, `numbers` and `covariance`, as "
    "`hookeye calibrate` does (docs/calibrate.md)";

std::vector<std::string> numbers_known(const Camera& camera) {
  std::vector<std::string> out;
  for (const Intrinsic& one : camera.intrinsics()) out.push_back(one.name);
  for (const char* name :
       {"rotation_x", "rotation_y", "rotation_z", "shift_x", "shift_y", "shift_z"})
    out.emplace_back(name);
  return out;
}

/// Which power of a length a number is of: 1 of a shift, -2 of "1/length^2".
int power_of_length(const Camera& camera, const std::string& name) {
  if (name.starts_with("shift_")) return 1;
  for (const Intrinsic& one : camera.intrinsics()) {
    const size_t at = one.unit.find("length");
    if (one.name != name || at == std::string::npos) continue;
    const size_t power = one.unit.find('^', at);
    const int size = power == std::string::npos ? 1 : std::stoi(one.unit.substr(power + 1));
    return at > 0 && one.unit[at - 1] == '/' ? -size : size;
  }
  return 0;
}

/// What one entry of `numbers` names; `factors` grows by what takes each into the capture's units.
void read_names(const YamlNode::Entry& entry, const Camera* camera, double scale,
                CameraCovariance& out, std::vector<double>& factors) {
  const std::string what = fmt::format("numbers of camera `{}`", entry.key);
  const auto& items = read_list(entry.value, what, "write `[fx, fy, cx, cy, rotation_x, ..]`");
  if (items.empty()) unexpected(entry.value, what, "name those that the covariance is of");
  for (const YamlNode& item : items) {
    const std::string name = read_string(item, "a number of camera `" + entry.key + "`");
    if (camera) {
      const auto known = numbers_known(*camera);
      if (std::ranges::find(known, name) == known.end())
        throw InputError(item.place, fmt::format("camera `{}` has no number `{}`", entry.key, name),
                         suggest(name, known));
    }
    for (const auto& other : out.numbers)
      if (other.camera == entry.key && other.name == name)
        throw InputError(item.place, fmt::format("`{}` of `{}` stands twice", name, entry.key),
                         "name each number once");
    out.numbers.push_back({entry.key, name});
    factors.push_back(camera ? std::pow(scale, power_of_length(*camera, name)) : 1.0);
  }
}

/// A camera of the file that the capture lacks was left out of the capture, unless the capture has
/// one that the file lacks: then it is that one under another name.
void check_strangers(const std::vector<YamlNode::Entry>& entries, const Capture& capture,
                     CameraCovariance& out) {
  const YamlNode::Entry* stranger = nullptr;
  std::vector<std::string> told;
  for (const YamlNode::Entry& entry : entries) {
    told.push_back(entry.key);
    const auto same = [&](const Camera& camera) { return camera.name == entry.key; };
    if (std::ranges::any_of(capture.cameras, same)) continue;
    if (!stranger) stranger = &entry;
    out.strangers.push_back(entry.key);
  }
  std::vector<std::string> left;
  for (const Camera& camera : capture.cameras)
    if (std::ranges::find(told, camera.name) == told.end()) left.push_back(camera.name);
  if (stranger && !left.empty())
    throw InputError(stranger->place,
                     fmt::format("the capture has no camera `{}`, and nothing is told of its "
                                 "camera{} {}",
                                 stranger->key, left.size() > 1 ? "s" : "", fmt::join(left, ", ")),
                     suggest(stranger->key, left));
  if (stranger && out.strangers.size() == entries.size())
    throw InputError(stranger->place, "the capture has none of the cameras of its covariance",
                     "the file of another calibration: name that of these cameras");
}

Eigen::MatrixXd read_square(const YamlNode& node, size_t size) {
  const std::string right = fmt::format("{0} rows of {0} numbers, one for each of `numbers`", size);
  const auto& rows = read_list(node, "the covariance", right);
  if (rows.size() != size)
    throw InputError(node.place,
                     fmt::format("the covariance has {} rows for {} numbers", rows.size(), size),
                     right);
  Eigen::MatrixXd out(static_cast<Eigen::Index>(size), static_cast<Eigen::Index>(size));
  for (size_t i = 0; i < size; ++i) {
    const auto row = read_numbers(rows[i], fmt::format("row {} of the covariance", i + 1));
    if (row.size() != size)
      throw InputError(rows[i].place,
                       fmt::format("row {} of the covariance has {} numbers", i + 1, row.size()),
                       right);
    out.row(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Eigen::RowVectorXd>(row.data(), out.cols());
  }
  return out;
}

std::string name_of(const CameraCovariance& of, Eigen::Index i) {
  const auto& number = of.numbers[static_cast<size_t>(i)];
  return fmt::format("`{}` of `{}`", number.name, number.camera);
}

/// Variances above zero, symmetric, and positive definite in units of the deviations.
void check_covariance(const YamlNode& node, CameraCovariance& of) {
  Eigen::MatrixXd& C = of.values;
  for (Eigen::Index i = 0; i < C.rows(); ++i)
    if (!(C(i, i) > 0.0))
      throw InputError(node.items[static_cast<size_t>(i)].place,
                       fmt::format("the variance of {} is {:g}", name_of(of, i), C(i, i)),
                       "a number above zero; a number that is known exactly is left out of "
                       "`numbers` and of the rows and columns");
  const Eigen::VectorXd unit = C.diagonal().cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd R = unit.asDiagonal() * C * unit.asDiagonal();
  constexpr double kRounding = 1e-6;  // files with seven digits
  for (Eigen::Index i = 0; i < R.rows(); ++i)
    for (Eigen::Index k = 0; k < i; ++k) {
      if (std::abs(R(i, k) - R(k, i)) > kRounding)
        throw InputError(node.items[static_cast<size_t>(i)].place,
                         fmt::format("the covariance is not symmetric: of {} and {} it has {:g} "
                                     "and {:g}",
                                     name_of(of, i), name_of(of, k), C(i, k), C(k, i)),
                         "one number for both: the covariance of a pair has no order");
      if (std::abs(R(i, k)) >= 1.0)
        throw InputError(node.items[static_cast<size_t>(i)].place,
                         fmt::format("the covariance is not positive definite: the correlation of "
                                     "{} and {} is {:.6g}",
                                     name_of(of, i), name_of(of, k), R(i, k)),
                         "between -1 and 1; `covariance` has variances, not deviations");
    }
  C = 0.5 * (C + C.transpose()).eval();
  R = 0.5 * (R + R.transpose()).eval();
  if (Eigen::LLT<Eigen::MatrixXd>(R).info() != Eigen::Success)
    throw InputError(node.place, "the covariance is not positive definite",
                     "some mix of its numbers has a variance below zero: write all digits, as "
                     "`hookeye calibrate` does");
}

/// Rows and columns of the numbers for which `keep` holds.
template <class Keep>
CameraCovariance part_of(const CameraCovariance& of, const Keep& keep) {
  CameraCovariance out = of;
  out.numbers.clear();
  std::vector<Eigen::Index> kept;
  for (size_t i = 0; i < of.numbers.size(); ++i)
    if (keep(i)) {
      kept.push_back(static_cast<Eigen::Index>(i));
      out.numbers.push_back(of.numbers[i]);
    }
  out.values = of.values(kept, kept);
  return out;
}

/// The capture's unit of length in one of the file's.
double read_scale(const YamlSection& section, const Units& units) {
  Units file = units;
  file.length = read_choice(section.need("unit", "write the unit of its shifts: `unit: mm`"),
                            "the unit of the covariance", {"mm", "cm", "m", "um"});
  read_choice(section.need("frame",
                           "write `frame: camera`: turns and shifts are along the axes of "
                           "each camera"),
              "the frame of the covariance", {"camera"});
  return units.metre() / file.metre();
}

}  // namespace

std::vector<std::string> CameraCovariance::cameras() const {
  std::vector<std::string> out;
  for (const Number& one : numbers)
    if (out.empty() || out.back() != one.camera) out.push_back(one.camera);
  return out;
}

double CameraCovariance::deviation(size_t i) const {
  const auto k = static_cast<Eigen::Index>(i);
  return std::sqrt(values(k, k));
}

void read_camera_covariance(const YamlNode& node, const CaptureFolder& folder, Capture& capture) {
  const YamlNode* named = &node;
  std::optional<double> told_scale;
  if (node.kind == YamlNode::Kind::map) {
    const YamlSection section(node, "camera_covariance", {"from", "scale"});
    named = &section.need("from", "write `{from: camera_covariance.yaml, scale: 1000}`");
    if (const YamlNode* scale = section.find("scale"))
      told_scale = read_positive(*scale, "scale of the camera covariance");
  }
  const auto file = read_file_path(*named, "the camera covariance", folder, {".yaml", ".yml"});
  auto out = std::make_shared<CameraCovariance>();
  out->told = (folder.given / named->text).string();
  out->place = node.place;
  YamlLimits limits;
  limits.holds = "camera covariance";
  limits.begins = kBegins;
  const YamlNode root = load_yaml(file, out->told, limits);
  const YamlSection section(root, "the camera covariance",
                            {"unit", "frame", "numbers", "covariance"});
  const double by_unit = read_scale(section, capture.units);
  const auto& entries = read_named(section.need("numbers", kBegins), "numbers");
  check_strangers(entries, capture, *out);
  std::vector<double> factors;
  for (const YamlNode::Entry& entry : entries) {
    const auto camera = std::ranges::find(capture.cameras, entry.key, &Camera::name);
    read_names(entry, camera == capture.cameras.end() ? nullptr : &*camera,
               told_scale.value_or(by_unit), *out, factors);
  }
  const YamlNode& rows = section.need("covariance", kBegins);
  out->values = read_square(rows, out->numbers.size());
  check_covariance(rows, *out);
  const Eigen::Map<const Eigen::VectorXd> factor(factors.data(), out->values.rows());
  out->values = (factor.asDiagonal() * out->values * factor.asDiagonal()).eval();
  capture.camera_covariance = std::make_shared<const CameraCovariance>(part_of(*out, [&](size_t i) {
    return std::ranges::find(out->strangers, out->numbers[i].camera) == out->strangers.end();
  }));
}

void measure_calibration(Capture& capture) {
  if (!capture.camera_covariance) return;
  const std::shared_ptr<const CameraCovariance> all = capture.camera_covariance;
  const auto fitted = [&](const std::string& camera) {
    return std::ranges::any_of(capture.examples, [&](const ExampleSpec& example) {
      return !example.validate &&
             std::ranges::find(example.photos, camera, &PhotoSpec::camera) != example.photos.end();
    });
  };
  auto used = std::make_shared<const CameraCovariance>(
      part_of(*all, [&](size_t i) { return fitted(all->numbers[i].camera); }));
  capture.camera_covariance = used->numbers.empty() ? nullptr : used;
  if (used->numbers.empty()) return;
  MeasuredSpec spec;
  spec.kind = MeasuredSpec::Kind::calibration;
  spec.place = all->place;
  const auto size = static_cast<Eigen::Index>(kCalibratedNumbers * used->cameras().size());
  spec.value = Eigen::VectorXd::Zero(size);
  spec.sigma = Eigen::VectorXd::Ones(size);
  const auto first = std::ranges::find_if(capture.examples, [](const ExampleSpec& example) {
    return !example.validate && !example.photos.empty();
  });
  first->measured.push_back(std::move(spec));
}

std::string camera_covariance_text(const CameraCovariance& covariance, const std::string& unit,
                                   const std::string& head) {
  const CameraCovariance known =
      part_of(covariance, [&](size_t i) { return covariance.deviation(i) > 0.0; });
  std::string text = head + "unit: " + unit +
                     "\n# rotation [rad] and shift in the camera's axes: x' = exp(rotation) (R x + "
                     "t) + shift\nframe: camera\nnumbers:\n";
  for (const std::string& camera : known.cameras()) {
    std::vector<std::string> names;
    for (const auto& one : known.numbers)
      if (one.camera == camera) names.push_back(one.name);
    text += fmt::format("  {}: [{}]\n", yaml_name(camera), fmt::join(names, ", "));
  }
  text += "covariance:\n";
  for (const auto& row : known.values.rowwise())
    text += fmt::format("  - [{}]\n", fmt::join(std::vector<double>(row.begin(), row.end()), ", "));
  return text;
}

}  // namespace hookeye
