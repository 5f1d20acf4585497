// Hexahedra and wedges of a deck as tetrahedra. For this folder alone.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "importers/deck_model.h"

namespace hookeye::solver_deck {

/// A solid with flat or nearly flat quadrilaterals: its corners and its sides, outward, as Abaqus,
/// CalculiX and FEBio number both.
struct SolidShape {
  size_t corners;
  std::vector<std::vector<int>> sides;
};
/// 8 or 6 corners; null: neither.
const SolidShape* solid_shape(size_t corners);

/// Tetrahedra of a solid by the labels of its corners: from its smallest label to the triangles of
/// all sides that do not have it; a quadrilateral is cut from its own smallest label. So neighbours
/// cut a common side alike, whatever their order (after Dompierre et al., 1999). Corners that
/// coincide leave out what has no volume. Each has det[x1-x0, x2-x0, x3-x0] > 0 where the solid is
/// told with its sides outward and is convex.
std::vector<std::array<int, 4>> split_solid(const SolidShape& shape,
                                            const std::vector<int>& labels);

/// Keeps which tetrahedra solids became, and which of their sides a solid's side did.
class Splitter {
 public:
  explicit Splitter(Deck& deck) : deck_(deck) {}
  /// Adds the tetrahedra of a solid to the deck. Throws InputError at `place` for a twisted one and
  /// a second one of its label.
  void add(int label, const std::vector<int>& nodes, const Place& place);
  bool has(int label) const { return deck_.split.contains(label); }
  /// "hexahedra are split": once, at the end of the deck.
  void say(const Place& end);

 private:
  Deck& deck_;
  std::map<size_t, int> solids_;  ///< by corners
  int tetrahedra_ = 0;
};

}  // namespace hookeye::solver_deck
