#include "importers/deck_split.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>

namespace hookeye::solver_deck {
namespace {

/// Labels of tetrahedra that a deck does not number itself.
constexpr int kFirstLabel = 100'000'001;

/// Triangles of a side, cut from its smallest label.
std::vector<std::array<int, 3>> triangles_of(std::vector<int> side) {
  std::rotate(side.begin(), std::min_element(side.begin(), side.end()), side.end());
  std::vector<std::array<int, 3>> out;
  for (size_t k = 1; k + 1 < side.size(); ++k) {
    const std::array<int, 3> one{side[0], side[k], side[k + 1]};
    if (one[0] != one[1] && one[1] != one[2] && one[0] != one[2]) out.push_back(one);
  }
  return out;
}

std::vector<int> labels_of(const std::vector<int>& side, const std::vector<int>& labels) {
  std::vector<int> out;
  for (const int corner : side) out.push_back(labels[static_cast<size_t>(corner)]);
  return out;
}

}  // namespace

const SolidShape* solid_shape(size_t corners) {
  static const SolidShape hexahedron{
      8, {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
  static const SolidShape wedge{6,
                                {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}};
  return corners == 8 ? &hexahedron : corners == 6 ? &wedge : nullptr;
}

std::vector<std::array<int, 4>> split_solid(const SolidShape& shape,
                                            const std::vector<int>& labels) {
  const int apex = *std::min_element(labels.begin(), labels.end());
  std::vector<std::array<int, 4>> out;
  for (const auto& side : shape.sides) {
    const std::vector<int> own = labels_of(side, labels);
    if (std::find(own.begin(), own.end(), apex) != own.end()) continue;
    for (const auto& [a, b, c] : triangles_of(own)) out.push_back({apex, a, b, c});
  }
  return out;
}

void Splitter::add(int label, const std::vector<int>& nodes, const Place& place) {
  const SolidShape& shape = *solid_shape(nodes.size());
  if (deck_.elements.contains(label) || has(label))
    throw InputError(place, fmt::format("element {} is there twice", label), "each element once");
  const auto x = [&](int node) { return deck_.nodes.at(node); };
  std::vector<int>& into = deck_.split[label];
  double largest = 0.0, smallest = 0.0;
  for (const auto& t : split_solid(shape, nodes)) {
    Eigen::Matrix3d edges;
    edges << x(t[1]) - x(t[0]), x(t[2]) - x(t[0]), x(t[3]) - x(t[0]);
    const double volume = edges.determinant();
    largest = std::max(largest, std::abs(volume)), smallest = std::min(smallest, volume);
    if (volume == 0.0) continue;
    into.push_back(kFirstLabel + tetrahedra_++);
    deck_.elements[into.back()] = {t.begin(), t.end()};
  }
  if (into.empty() || smallest < 0.0)
    throw InputError(
        place,
        fmt::format("element {} is {}: it cannot be split into tetrahedra", label,
                    into.empty() || smallest > -1e-9 * largest ? "flat" : "twisted or inside out"),
        "corners in the order of the manual, and sides that are nearly flat");
  auto& sides = deck_.split_sides;
  for (size_t s = 0; s < shape.sides.size(); ++s) {
    const std::vector<int> own = labels_of(shape.sides[s], nodes);
    const std::set<int> corners(own.begin(), own.end());
    for (const int t : into)
      for (int k = 1; k <= 4; ++k)
        if (const auto three = tetrahedron_side(deck_.elements.at(t), k);
            corners.contains(three[0]) && corners.contains(three[1]) && corners.contains(three[2]))
          sides[{label, static_cast<int>(s) + 1}].insert({t, k});
  }
  ++solids_[nodes.size()];
}

void Splitter::say(const Place& end) {
  for (const auto& [corners, count] : solids_)
    deck_.say(end, fmt::format("{} {} are split into linear tetrahedra, which are stiffer in "
                               "bending and where the volume hardly changes",
                               count, corners == 8 ? "hexahedra" : "wedges"));
}

}  // namespace hookeye::solver_deck
