// Sets of nodes and sides of elements as regions of a capture. For this folder alone.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "importers/deck_model.h"
#include "meshing/regions.h"

namespace hookeye::solver_deck {

/// Letters, digits, - and _, first a letter.
std::string plain_name(const std::string& hint);

class Patches {
 public:
  /// Writes body.inp into `scratch` and reads it as a capture does. Throws InputError.
  Patches(Deck& deck, const std::filesystem::path& scratch);

  const TetMesh& mesh() const { return mesh_; }
  /// Column of a node; empty: no element has it.
  std::optional<int> column(int label) const;
  int label(int column) const { return labels_[static_cast<size_t>(column)]; }
  /// The regions of these nodes: one, or where they are few and apart one a node.
  std::vector<std::string> of_nodes(const std::string& hint, const std::set<int>& labels,
                                    const Place& place);
  /// Whether these sides are all that their nodes bound. Throws where one is not at the surface.
  bool is_patch(const std::set<Side>& sides, const Place& place);
  double area(const Side& side) const;  ///< [length^2], of its corners
  /// The region of these sides, and of others that their nodes bound.
  std::string of_sides(const std::string& hint, const std::set<Side>& sides, const Place& place);
  /// Faces that touch these nodes, as a region.
  std::string about_nodes(const std::string& hint, const std::set<int>& labels, const Place& place);
  /// Of named sets that are all nodes of some faces, and not of all.
  const std::vector<std::string>& named() const { return named_; }
  const Region& region(const std::string& name) const { return regions_.at(name); }
  const std::map<std::string, Region>& all() const { return regions_; }

  std::string body_text() const;     ///< of body.inp
  std::string regions_text() const;  ///< entries of `regions:`

 private:
  std::set<int> boundary_columns(const std::string& hint, const std::set<int>& labels,
                                 const Place& place);
  std::set<int> faces_of(const std::set<Side>& sides, const Place& place);
  std::array<int, 3> corners(const Side& side) const;  ///< columns
  std::set<int> faces_within(const std::set<int>& columns) const;
  std::set<int> nodes_of(const std::set<int>& faces) const;
  std::optional<std::string> group(const std::string& hint, const std::set<int>& columns);
  std::optional<std::string> box(const std::string& hint, const std::set<int>& columns);
  std::string store(const std::string& hint, const std::set<int>& columns, RegionSpec spec,
                    const std::string& yaml);

  Deck& deck_;
  TetMesh mesh_;
  std::vector<int> labels_;  ///< of the columns
  std::map<int, int> column_;
  std::map<std::array<int, 3>, int> face_of_;  ///< boundary by its corners, ascending
  std::set<int> on_boundary_;
  std::map<std::set<int>, std::string> known_;  ///< regions by their nodes
  std::map<std::string, Region> regions_;
  std::vector<std::string> order_, named_;
  std::map<std::string, std::string> yaml_;
  std::map<std::string, std::set<int>> groups_;  ///< node sets of body.inp, columns
};

}  // namespace hookeye::solver_deck
