#include "importers/deck_patches.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <iterator>

#include "capture_io/camera_text.h"
#include "core/text_file.h"

namespace hookeye::solver_deck {
namespace {

/// More nodes apart than these are no clamp of single points.
constexpr size_t kMostPoints = 12;

using Out = std::back_insert_iterator<std::string>;

std::array<int, 3> sorted(int a, int b, int c) {
  std::array<int, 3> out{a, b, c};
  std::sort(out.begin(), out.end());
  return out;
}

template <class Labels>
void list_labels(const Labels& labels, std::string& out) {
  size_t i = 0;
  for (const int label : labels)
    fmt::format_to(Out(out), "{}{}", label, ++i == labels.size() || i % 16 == 0 ? "\n" : ",");
}

}  // namespace

std::string plain_name(const std::string& hint) {
  std::string out;
  for (const char c : hint)
    out += std::isalnum(static_cast<unsigned char>(c)) || c == '-' ? c : '_';
  if (out.empty() || !std::isalpha(static_cast<unsigned char>(out[0]))) out = "set_" + out;
  return out.substr(0, 60);
}

Patches::Patches(Deck& deck, const std::filesystem::path& scratch) : deck_(deck) {
  for (const auto& [label, nodes] : deck.elements)
    for (const int node : nodes) column_[node] = 0;
  for (auto& [label, column] : column_) {
    column = static_cast<int>(labels_.size());
    labels_.push_back(label);
  }
  const std::filesystem::path file = scratch / "body.inp";
  write_text(file, body_text());
  try {
    mesh_ = read_volume(file, {}, &deck.said);
  } catch (const InputError& error) {
    throw InputError({deck.steps.empty() ? "the deck" : deck.steps.front().place.file},
                     error.wrong(), error.right());
  }
  for (Eigen::Index i = 0; i < mesh_.boundary.size(); ++i)
    on_boundary_.insert(mesh_.boundary.data()[i]);
  for (const auto& [key, set] : deck.node_sets) {
    std::set<int> columns;
    for (const int label : set.members)
      if (const auto at = column(label); at && on_boundary_.contains(*at)) columns.insert(*at);
    if (columns.empty() || columns.size() == on_boundary_.size()) continue;
    if (const auto name = group(set.name, columns))
      if (std::find(named_.begin(), named_.end(), *name) == named_.end()) named_.push_back(*name);
  }
}

std::optional<int> Patches::column(int label) const {
  const auto at = column_.find(label);
  if (at == column_.end()) return {};
  return at->second;
}

std::string Patches::body_text() const {
  std::string out = "*NODE\n";
  for (const int label : labels_) {
    const Eigen::Vector3d& x = deck_.nodes.at(label);
    fmt::format_to(Out(out), "{},{},{},{}\n", label, x.x(), x.y(), x.z());
  }
  fmt::format_to(Out(out), "*ELEMENT, TYPE={}\n", deck_.per_element == 4 ? "C3D4" : "C3D10");
  for (const auto& [label, nodes] : deck_.elements)
    fmt::format_to(Out(out), "{},{}\n", label, fmt::join(nodes, ","));
  for (const Section& section : deck_.sections) {
    fmt::format_to(Out(out), "*ELSET, ELSET={}\n", plain_name(section.elements.name));
    list_labels(section.elements.members, out);
  }
  for (const auto& [name, columns] : groups_) {
    std::vector<int> labels;
    for (const int column : columns) labels.push_back(labels_[static_cast<size_t>(column)]);
    fmt::format_to(Out(out), "*NSET, NSET={}\n", name);
    list_labels(labels, out);
  }
  return out;
}

std::string Patches::regions_text() const {
  std::string out;
  for (const std::string& name : order_)
    out += fmt::format("  {}: {{{}}}\n", yaml_name(name), yaml_.at(name));
  return out;
}

std::set<int> Patches::faces_within(const std::set<int>& columns) const {
  std::set<int> faces;
  for (int f = 0; f < static_cast<int>(mesh_.boundary.cols()); ++f)
    if (columns.contains(mesh_.boundary(0, f)) && columns.contains(mesh_.boundary(1, f)) &&
        columns.contains(mesh_.boundary(2, f)))
      faces.insert(f);
  return faces;
}

std::set<int> Patches::nodes_of(const std::set<int>& faces) const {
  std::set<int> out;
  for (const int f : faces)
    for (Eigen::Index k = 0; k < mesh_.boundary.rows(); ++k) out.insert(mesh_.boundary(k, f));
  return out;
}

std::string Patches::store(const std::string& hint, const std::set<int>& columns, RegionSpec spec,
                           const std::string& yaml) {
  spec.name = plain_name(hint);
  for (int i = 2; regions_.contains(spec.name); ++i)
    spec.name = fmt::format("{}_{}", plain_name(hint), i);
  if (std::holds_alternative<RegionSpec::Group>(spec.shape)) {
    spec.shape = RegionSpec::Group{spec.name};
    const std::set<int> faces = faces_within(columns);
    mesh_.boundary_groups[spec.name].assign(faces.begin(), faces.end());
    groups_[spec.name] = columns;
  }
  Capture capture;
  capture.regions = {spec};
  regions_[spec.name] = RegionSet(capture, mesh_, nullptr).at(spec.name);
  order_.push_back(spec.name);
  known_[columns] = spec.name;
  yaml_[spec.name] = yaml.empty() ? "group: " + yaml_name(spec.name) : yaml;
  return spec.name;
}

std::optional<std::string> Patches::group(const std::string& hint, const std::set<int>& columns) {
  if (const auto at = known_.find(columns); at != known_.end()) return at->second;
  const std::set<int> faces = faces_within(columns);
  if (faces.empty() || nodes_of(faces) != columns) return {};
  RegionSpec spec;
  spec.shape = RegionSpec::Group{};
  return store(hint, columns, spec, "");
}

std::optional<std::string> Patches::box(const std::string& hint, const std::set<int>& columns) {
  if (const auto at = known_.find(columns); at != known_.end()) return at->second;
  Eigen::AlignedBox3d around;
  for (const int i : columns) around.extend(Eigen::Vector3d(mesh_.X.col(i)));
  const Eigen::AlignedBox3d whole(Eigen::Vector3d(mesh_.X.rowwise().minCoeff()),
                                  Eigen::Vector3d(mesh_.X.rowwise().maxCoeff()));
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(1e-6 * whole.diagonal().norm());
  const Eigen::Vector3d low = around.min() - margin, high = around.max() + margin;
  const Eigen::AlignedBox3d box(low, high);
  for (const int i : on_boundary_)
    if (box.contains(Eigen::Vector3d(mesh_.X.col(i))) != columns.contains(i)) return {};
  RegionSpec spec;
  spec.shape = RegionSpec::Box{low, high};
  return store(hint, columns, spec,
               fmt::format("box: [[{}, {}, {}], [{}, {}, {}]]", low.x(), low.y(), low.z(), high.x(),
                           high.y(), high.z()));
}

std::set<int> Patches::boundary_columns(const std::string& hint, const std::set<int>& labels,
                                        const Place& place) {
  std::set<int> out;
  size_t within = 0;
  for (const int label : labels) {
    const std::optional<int> at = column(label);
    if (!at) continue;
    if (on_boundary_.contains(*at))
      out.insert(*at);
    else
      ++within;
  }
  if (out.empty())
    throw InputError(place, fmt::format("no node of `{}` lies on the surface of the body", hint),
                     "supports and loads act on the surface here");
  if (within > 0)
    deck_.say(place,
              fmt::format("{} nodes of `{}` lie within the body and are left out", within, hint));
  return out;
}

std::vector<std::string> Patches::of_nodes(const std::string& hint, const std::set<int>& labels,
                                           const Place& place) {
  const std::set<int> columns = boundary_columns(hint, labels, place);
  if (const auto name = group(hint, columns)) return {*name};
  if (const auto name = box(hint, columns)) return {*name};
  if (columns.size() > kMostPoints)
    throw InputError(
        place,
        fmt::format("the {} nodes of `{}` are not all nodes of some faces, and no box holds them "
                    "alone",
                    columns.size(), hint),
        "a set of all nodes (mid-edge ones too) of the faces that are meant");
  std::vector<std::string> out;
  for (const int column : columns)
    if (const auto name =
            box(fmt::format("{}_{}", hint, labels_[static_cast<size_t>(column)]), {column}))
      out.push_back(*name);
  return out;
}

std::set<int> Patches::faces_of(const std::set<Side>& sides, const Place& place) {
  if (face_of_.empty())
    for (int f = 0; f < static_cast<int>(mesh_.boundary.cols()); ++f)
      face_of_[sorted(mesh_.boundary(0, f), mesh_.boundary(1, f), mesh_.boundary(2, f))] = f;
  std::set<int> faces;
  for (const Side& side : sides) {
    if (!deck_.elements.contains(side.first)) continue;
    const std::array<int, 3> c = corners(side);
    const auto at = face_of_.find(sorted(c[0], c[1], c[2]));
    if (at == face_of_.end())
      throw InputError(
          place,
          deck_.split.empty()
              ? fmt::format("side {} of element {} lies within the body", side.second, side.first)
              : "a side that is pressed lies within the body",
          "pressure on sides at the surface");
    faces.insert(at->second);
  }
  return faces;
}

std::array<int, 3> Patches::corners(const Side& side) const {
  std::array<int, 3> out = tetrahedron_side(deck_.elements.at(side.first), side.second);
  for (int& node : out) node = column_.at(node);
  return out;
}

double Patches::area(const Side& side) const {
  if (!deck_.elements.contains(side.first)) return 0;
  const std::array<int, 3> c = corners(side);
  const Eigen::Vector3d a = mesh_.X.col(c[0]), b = mesh_.X.col(c[1]), d = mesh_.X.col(c[2]);
  return 0.5 * (b - a).cross(d - a).norm();
}

bool Patches::is_patch(const std::set<Side>& sides, const Place& place) {
  const std::set<int> faces = faces_of(sides, place);
  return faces_within(nodes_of(faces)) == faces;
}

std::string Patches::of_sides(const std::string& hint, const std::set<Side>& sides,
                              const Place& place) {
  const std::set<int> faces = faces_of(sides, place);
  if (faces.empty())
    throw InputError(place, "none of the loaded elements is a tetrahedron", "sides of the body");
  return *group(hint, nodes_of(faces_within(nodes_of(faces))));
}

std::string Patches::about_nodes(const std::string& hint, const std::set<int>& labels,
                                 const Place& place) {
  const std::set<int> columns = boundary_columns(hint, labels, place);
  std::set<int> faces;
  for (int f = 0; f < static_cast<int>(mesh_.boundary.cols()); ++f)
    for (Eigen::Index k = 0; k < mesh_.boundary.rows(); ++k)
      if (columns.contains(mesh_.boundary(k, f))) faces.insert(f);
  return *group(hint, nodes_of(faces_within(nodes_of(faces))));
}

}  // namespace hookeye::solver_deck
