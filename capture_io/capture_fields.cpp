// Measured fields of displacement or strain: a file, its unit, its frame, and how its noise hangs
// together.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <unordered_map>

#include "capture_io/capture_reader.h"
#include "capture_io/component_sigmas.h"
#include "capture_io/field_rows.h"
#include "capture_io/field_table.h"
#include "capture_io/strain_reader.h"
#include "capture_io/yaml_file.h"

namespace hookeye {
namespace {

/// Points by the cubes that they lie in.
class Grid {
 public:
  Grid(const Eigen::Matrix3Xd& X, double edge) : X_(X), low_(X.rowwise().minCoeff()), edge_(edge) {
    for (Eigen::Index k = 0; k < X.cols(); ++k) cells_[key(cell(X.col(k)))].push_back(k);
  }
  /// Calls visit(k, squared distance) for all points within the edge of X, and for some beyond.
  template <class Visit>
  void near(const Vector3d& X, const Visit& visit) const {
    const Cell at = cell(X);
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j)
        for (int l = -1; l <= 1; ++l) {
          const auto found = cells_.find(key({at[0] + i, at[1] + j, at[2] + l}));
          if (found == cells_.end()) continue;
          for (const Eigen::Index k : found->second) visit(k, (X_.col(k) - X).squaredNorm());
        }
  }

 private:
  using Cell = std::array<int64_t, 3>;
  Cell cell(const Vector3d& X) const {
    Cell out;
    for (int i = 0; i < 3; ++i) out[i] = static_cast<int64_t>(std::floor((X[i] - low_[i]) / edge_));
    return out;
  }
  static uint64_t key(const Cell& cell) {
    uint64_t out = 0;
    for (const int64_t one : cell) out = (out << 21) ^ static_cast<uint64_t>(one + 2);
    return out;
  }
  const Eigen::Matrix3Xd& X_;
  Vector3d low_;
  double edge_;
  std::unordered_map<uint64_t, std::vector<Eigen::Index>> cells_;
};

double size_of_points(const Eigen::Matrix3Xd& X) {
  return (X.rowwise().maxCoeff() - X.rowwise().minCoeff()).norm();
}

/// Middle distance from a point to the next one.
double spacing_of(const Eigen::Matrix3Xd& X) {
  const double size = size_of_points(X);
  if (X.cols() < 2 || size <= 0.0) return 0.0;
  const double edge = 2.0 * size / std::sqrt(static_cast<double>(X.cols()));
  const Grid grid(X, edge);
  std::vector<double> nearest;
  // Some thousand points tell the middle.
  const Eigen::Index step = std::max<Eigen::Index>(1, X.cols() / 2000);
  for (Eigen::Index k = 0; k < X.cols(); k += step) {
    double least = edge * edge;
    grid.near(X.col(k), [&](Eigen::Index other, double d2) {
      if (other != k && d2 > 0.0) least = std::min(least, d2);
    });
    nearest.push_back(std::sqrt(least));
  }
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  return *middle;
}

/// How many points lie in the disc about each that has the area of a patch of side `correlation`.
/// Of many some are counted for all.
VectorXd alike_in(const Eigen::Matrix3Xd& X, double correlation, double spacing) {
  VectorXd out = VectorXd::Ones(X.cols());
  const double radius = correlation / std::sqrt(std::numbers::pi);
  if (radius <= 1e-6 * size_of_points(X) || spacing <= 0.0) return out;
  const double expected =
      std::min(std::pow(correlation / spacing, 2), static_cast<double>(X.cols()));
  const auto stride = static_cast<Eigen::Index>(std::max(1.0, std::floor(expected / 200.0)));
  Eigen::Matrix3Xd some(3, (X.cols() + stride - 1) / stride);
  for (Eigen::Index k = 0; k < some.cols(); ++k) some.col(k) = X.col(k * stride);
  const Grid grid(some, radius);
  // A point as far as the disc's edge is in it, whatever the last digit says.
  const double within = radius * radius * (1.0 + 1e-9);
  for (Eigen::Index k = 0; k < X.cols(); ++k) {
    double others = 0.0;
    grid.near(X.col(k), [&](Eigen::Index other, double d2) {
      if (other * stride != k && d2 <= within) others += 1.0;
    });
    out[k] += others * static_cast<double>(stride);
  }
  return out;
}

/// Edge of a piece over that of a patch of alike points.
constexpr double kPatchesWide = 3.0;

void cut_into_pieces(FieldSpec& field) {
  const double edge = kPatchesWide * std::max(field.correlation, field.spacing);
  field.piece.assign(static_cast<size_t>(field.X.cols()), 0);
  field.piece_at = Eigen::Matrix3Xi::Zero(3, 1);
  if (edge <= 0.0) return;
  const Vector3d low = field.X.rowwise().minCoeff();
  std::map<std::array<double, 3>, int> index;
  for (Eigen::Index k = 0; k < field.X.cols(); ++k) {
    const Vector3d at = ((field.X.col(k) - low) / edge).array().floor();
    const auto [found, fresh] =
        index.try_emplace({at.x(), at.y(), at.z()}, static_cast<int>(index.size()));
    field.piece[static_cast<size_t>(k)] = found->second;
  }
  field.pieces = static_cast<int>(index.size());
  field.piece_at.resize(3, field.pieces);
  for (const auto& [at, piece] : index)
    for (Eigen::Index i = 0; i < 3; ++i)
      field.piece_at(i, piece) = static_cast<int>(at[static_cast<size_t>(i)]);
}

/// Metres in one of the file's unit; 0: it is none.
double metres(const std::string& unit) {
  if (unit == "m") return 1.0;
  if (unit == "cm") return 1e-2;
  if (unit == "mm") return 1e-3;
  if (unit == "um" || unit == "\xC2\xB5m" || unit == "\xCE\xBCm") return 1e-6;
  if (unit == "in" || unit == "inch") return 0.0254;
  return 0.0;
}

/// What the file's numbers are multiplied by to be lengths of the capture.
double length_of_one(const YamlSection& section, const Capture& capture, const FieldTable& table,
                     const std::string& told) {
  const YamlNode* scale = section.find("scale");
  const YamlNode* unit = section.find("unit");
  if (scale && unit)
    throw InputError(unit->place, "`unit` and `scale` tell the same", "leave one of them out");
  if (scale) return read_positive(*scale, "scale");
  std::string of = table.unit;
  if (unit) {
    of = read_choice(*unit, "unit of the field", {"mm", "cm", "m", "um", "in"});
    if (!table.unit.empty() && table.unit != of)
      throw InputError(
          unit->place,
          fmt::format("{} tells its columns in {}, the capture in {}", told, table.unit, of),
          "remove `unit`, or tell `scale: LENGTH` of one of the file's units");
  }
  if (of.empty()) return 1.0;
  if (of == "px")
    throw InputError(section.place(), fmt::format("the field of {} is in pixels", told),
                     "tell the length of a pixel, `scale: 0.05`, and where its plane lies, `frame: "
                     "{origin: [0, 0, 0], x: [1, 0, 0], y: [0, -1, 0]}`");
  if (metres(of) == 0.0)
    throw InputError(
        section.place(), fmt::format("{} is in the unknown unit `{}`", told, of),
        fmt::format("tell `scale: LENGTH`, the {} of one of them", capture.units.length));
  return metres(of) * capture.units.metre();
}

struct Frame {
  Vector3d origin = Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
};

Frame read_frame(const YamlNode& node) {
  const YamlSection section(node, "frame of the field", {"origin", "x", "y"});
  const std::string right = "write `frame: {origin: [0, 0, 0], x: [1, 0, 0], y: [0, 1, 0]}`";
  Frame out;
  if (const YamlNode* origin = section.find("origin"))
    out.origin = read_vector3(*origin, "origin of the frame");
  const Vector3d x = read_direction(section.need("x", right), "x of the frame");
  const Vector3d y = read_direction(section.need("y", right), "y of the frame");
  if (std::abs(x.dot(y)) > 1e-3)
    throw InputError(node.place, "x and y of the frame are not at right angles", right);
  out.axes.col(0) = x;
  out.axes.col(2) = x.cross(y).normalized();
  out.axes.col(1) = out.axes.col(2).cross(x);
  return out;
}

std::map<std::string, std::string> read_columns(const YamlNode& node) {
  std::vector<std::string> roles(kFieldRoles.begin(), kFieldRoles.end());
  roles.emplace_back("GXY");
  const YamlSection section(node, "columns of the field", roles);
  std::map<std::string, std::string> out;
  for (const std::string& role : roles)
    if (const YamlNode* name = section.find(role)) out[role] = read_string(*name, "column " + role);
  return out;
}

/// The disc holds nine points of a square grid: subsets that overlap by two thirds.
constexpr double kStepsAlike = 3.0;

void read_field_noise(const YamlSection& section, FieldSpec& field) {
  field.spacing = spacing_of(field.X);
  // A strain's disc holds the same displacements as those of the points in it.
  field.correlation =
      std::max(kStepsAlike * field.spacing, field.strain ? field.strain->gauge : 0.0);
  if (const YamlNode* told = section.find("correlation")) {
    field.correlation = read_not_negative(*told, "correlation");
    field.correlation_told = true;
  }
  if (const YamlNode* told = section.find("tolerance"))
    field.tolerance = read_positive(*told, "tolerance");
  field.alike = alike_in(field.X, field.correlation, field.spacing);
  cut_into_pieces(field);
}

}  // namespace

namespace {

const std::vector<std::string> kFieldKeys{"field", "strain",  "sigma",       "from",  "correlation",
                                          "unit",  "scale",   "strain_unit", "gauge", "axes",
                                          "frame", "columns", "tolerance"};

FieldTable read_table(const YamlSection& section, const YamlNode& name, const FieldSpec& field) {
  std::map<std::string, std::string> columns;
  if (const YamlNode* told = section.find("columns")) columns = read_columns(*told);
  try {
    return read_field_table(
        field.file, field.told, columns,
        section.has("strain") ? FieldHolds::strains : FieldHolds::displacements);
  } catch (const InputError& error) {
    throw told_at(name.place, error);
  }
}

void refuse_strain_keys(const YamlSection& section) {
  for (const char* key : {"strain_unit", "gauge", "axes"})
    if (const YamlNode* node = section.find(key))
      throw InputError(node->place, fmt::format("`{}` is of a field of strains", key),
                       "add `strain: green`, or remove it");
}

}  // namespace

MeasuredSpec read_field(const YamlNode& node, const std::string& of, const Capture& capture,
                        const CaptureFolder& folder) {
  const YamlSection section(node, "a measured field" + of, kFieldKeys);
  auto field = std::make_shared<FieldSpec>();
  const YamlNode& name = section.need("field", "write `field: u.csv`");
  field->file = read_file_path(name, "field" + of, folder);
  field->told = (folder.given / name.text).string();
  if (!section.has("strain")) refuse_strain_keys(section);
  FieldTable table = read_table(section, name, *field);
  const double length = length_of_one(section, capture, table, field->told);
  Frame frame;
  if (const YamlNode* told = section.find("frame")) frame = read_frame(*told);
  field->X = (frame.axes * (length * table.X)).colwise() + frame.origin;
  field->axes = frame.axes;
  field->components = table.has_w ? 3 : 2;
  VectorXd sigma;
  Eigen::MatrixXd value = length * table.u.topRows(field->components);
  if (section.has("strain")) {
    field->components = table.has_exy ? 3 : 2;
    value = strain_scale(section, table, field->told) * table.strain.topRows(field->components);
    field->strain = read_strain(section, table, field->told, length, frame.axes);
    sigma = field->strain->sigma;
  } else {
    sigma = read_component_sigmas(
        section.need("sigma", "give the standard deviation of a displacement: `sigma: 0.01`"),
        field->components, field->components == 3 ? "x, y, z of the frame" : "x, y of the frame");
    field->strain_columns = table.strain_columns;
  }
  field->sigma = std::sqrt(sigma.squaredNorm() / field->components);
  if (!(field->X.cwiseAbs().maxCoeff() < 1e15 && value.cwiseAbs().maxCoeff() < 1e15))
    throw InputError({field->told},
                     fmt::format("there are places or {} above 1e15",
                                 field->strain ? "strains" : "displacements"),
                     "lengths in the unit that is told");
  field->lines = std::move(table.lines);
  field->dropped = static_cast<int>(table.dropped_lines.size());
  field->unit_told = section.has("unit") || section.has("scale") || !table.unit.empty();
  read_field_noise(section, *field);
  MeasuredSpec out;
  out.kind = MeasuredSpec::Kind::field;
  out.place = node.place;
  out.value = value.reshaped();
  out.sigma = (sigma * field->alike.cwiseSqrt().transpose()).reshaped();
  out.field = std::move(field);
  if (const YamlNode* from = section.find("from"))
    out.region = read_string(*from, "the example that the field starts from");
  return out;
}

std::vector<int> dropped_lines(const Capture& capture, const MeasuredSpec& measured) {
  if (!measured.field || measured.field->dropped == 0) return {};
  const YamlNode root = load_yaml(capture.file, capture.file.string());
  const YamlNode* told = root.find("examples");
  if (!told) return {};
  const YamlNode examples = section_in_place(*told, "examples", {capture.folder, capture.folder});
  for (const YamlNode::Entry& example : examples.entries) {
    const YamlNode* all = example.value.find("measured");
    for (const YamlNode& node : all ? all->items : std::vector<YamlNode>()) {
      const YamlNode* name = node.find("field");
      if (!name || node.place.line != measured.place.line ||
          node.place.column != measured.place.column)
        continue;
      return read_table(YamlSection(node, "a measured field", kFieldKeys), *name, *measured.field)
          .dropped_lines;
    }
  }
  return {};
}

}  // namespace hookeye
