// What a deck of Abaqus or CalculiX tells of one body. For this folder alone.
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "importers/deck_cards.h"

namespace hookeye::solver_deck {

/// Labels of nodes or elements under a name, which counts in capitals.
struct LabelSet {
  std::string name;  ///< as the deck first spells it
  std::set<int> members;
  std::set<int> solids;  ///< of elements: those among them that were split, by their own labels
  Place place;
  bool of_assembly = false;
  void add(const LabelSet& other);
};

/// Side of an element, from 1: of a tetrahedron 1 to 4.
using Side = std::pair<int, int>;
/// Labels of the corners of side 1 to 4 of a tetrahedron, as the programs count them.
std::array<int, 3> tetrahedron_side(const std::vector<int>& nodes, int side);

struct Law {
  std::string yaml;  ///< "{law: neo-hookean, mu: 0.05, kappa: 0.5}"; "": there is none
  std::vector<std::string> to_fit;
};

struct DeckMaterial {
  std::string name;
  Law law;
  double density = 0;  ///< 0: not told
  Place place;
};

struct Section {
  LabelSet elements;     ///< as the section found them
  std::string material;  ///< in capitals
  Place place;
};

/// What acts at the end of a step. Targets are names of node sets in capitals, or labels.
struct DeckStep {
  template <class T>
  struct Told {
    T value;
    Place place;
  };
  std::string name;                                          ///< "": the deck has none
  std::map<std::pair<std::string, int>, Told<double>> held;  ///< target, component 0 to 2 [length]
  std::map<std::pair<std::string, int>, Told<double>> forces;  ///< the same, of each node [force]
  std::map<Side, Told<double>> pressures;                      ///< [stress], inwards
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();           ///< [length/s^2]
  Place place;
};

struct Deck {
  std::map<int, Eigen::Vector3d> nodes;
  std::map<int, std::vector<int>> elements;  ///< of 4 or 10 labels, in the order of the deck
  int per_element = 0;
  /// What hexahedra and wedges became, by their labels: labels in `elements`, and by side theirs.
  std::map<int, std::vector<int>> split;
  std::map<Side, std::set<Side>> split_sides;
  std::map<std::string, LabelSet> node_sets, element_sets;
  std::map<std::string, std::set<Side>> surfaces;
  std::vector<DeckMaterial> materials;
  std::vector<Section> sections;
  std::vector<DeckStep> steps;
  std::vector<std::string> said;

  void say(const Place& place, const std::string& text) {
    said.push_back(place.str() + ": " + text);
  }
  /// `label`, or what it was split into.
  std::set<int> elements_of(int label) const;
  std::set<Side> sides_of(const Side& side) const;
  bool has_element(int label) const { return elements.contains(label) || split.contains(label); }
};

/// Throws InputError with file and line.
Deck read_deck(const std::filesystem::path& file);

class Splitter;

/// Nodes, elements, their sets and surfaces: true where the card is one of these.
class MeshCards {
 public:
  explicit MeshCards(Deck& deck);
  ~MeshCards();
  bool take(const Card& card);
  /// What can only be known at the end of the deck.
  void finish(const Place& end);

 private:
  void structure(const Card& card);
  void nodes(const Card& card);
  void elements(const Card& card);
  void set(const Card& card, bool of_nodes);
  void surface(const Card& card);

  Deck& deck_;
  std::unique_ptr<Splitter> splitter_;
  int parts_ = 0, instances_ = 0;
  std::string open_;  ///< *PART, *INSTANCE, *ASSEMBLY that is not closed
  bool in_assembly_ = false;
  std::set<std::string> left_out_;  ///< types of elements that were told
};

/// Sides of tetrahedra behind side `side` of an element or of a set. Throws InputError at `place`.
std::set<Side> sides_called(const Deck& deck, const std::string& name, int side,
                            const Place& place);

/// The set behind a name, "PART-1-1.TOP" too. Throws InputError at `place`.
const LabelSet& set_called(const Deck& deck, bool of_nodes, const std::string& name,
                           const Place& place);

/// *HYPERELASTIC or *ELASTIC as a law; what is not taken is said.
Law law_of(const Card& card, Deck& deck);

}  // namespace hookeye::solver_deck
