// Nodes, elements, sets and surfaces of a deck.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cctype>

#include "importers/deck_split.h"

namespace hookeye::solver_deck {
namespace {

/// Corners of side 1 to 4 of a tetrahedron.
constexpr int kSides[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};

/// Corners of solids that are split, by the type of the element; 0: it is none.
int corners_of_solid(const std::string& type) {
  const auto is = [&](const std::string& name) {  // "C3D8R", and not "C3D80"
    return type.starts_with(name) && (type.size() == name.size() ||
                                      !std::isdigit(static_cast<unsigned char>(type[name.size()])));
  };
  return is("C3D8") ? 8 : is("C3D6") ? 6 : 0;
}

const char* const kOnePart = "one part with one instance at most";

/// First line: a translation. Second: two points of an axis, and degrees (Abaqus, *INSTANCE).
void place_nodes(const Card& card, std::map<int, Eigen::Vector3d>& nodes) {
  if (card.lines.size() > 2) card.fault("an instance is placed by two lines at most", kOnePart);
  Eigen::Isometry3d placed = Eigen::Isometry3d::Identity();
  for (size_t i = 0; i < card.lines.size(); ++i) {
    std::vector<double> v;
    for (const std::string& field : card.lines[i].fields())
      v.push_back(real(field, card.lines[i].place));
    if (v.size() != (i == 0 ? 3 : 7))
      throw InputError(card.lines[i].place, "this places no instance",
                       "x, y, z of a translation, then two points of an axis and degrees");
    if (i == 0) {
      placed = Eigen::Translation3d(v[0], v[1], v[2]);
      continue;
    }
    const Eigen::Vector3d a(v[0], v[1], v[2]), axis = Eigen::Vector3d(v[3], v[4], v[5]) - a;
    if (!(axis.norm() > 0))
      throw InputError(card.lines[i].place, "the axis has no direction", "two distinct points");
    placed = Eigen::Translation3d(a) * Eigen::AngleAxisd(v[6] * EIGEN_PI / 180, axis.normalized()) *
             Eigen::Translation3d(-a) * placed;
  }
  for (auto& [label, x] : nodes) x = placed * x;
}

void fill_range(const CardLine& line, std::set<int>& members) {
  const std::vector<std::string> f = line.fields();
  const int step = f.size() > 2 ? whole(f[2], line.place) : 1;
  if (f.size() < 2 || step < 1)
    throw InputError(line.place, "this is no range", "first, last, step");
  const int first = whole(f[0], line.place), last = whole(f[1], line.place);
  if (first < 1 || (last - first) / step > 5'000'000)
    throw InputError(line.place, "no such range of labels", "first and last label of the deck");
  for (long i = first; i <= last; i += step) members.insert(static_cast<int>(i));
}

}  // namespace

std::array<int, 3> tetrahedron_side(const std::vector<int>& nodes, int side) {
  std::array<int, 3> out{};
  for (size_t k = 0; k < 3; ++k) out[k] = nodes[static_cast<size_t>(kSides[side - 1][k])];
  return out;
}

void LabelSet::add(const LabelSet& other) {
  members.insert(other.members.begin(), other.members.end());
  solids.insert(other.solids.begin(), other.solids.end());
}

std::set<Side> sides_called(const Deck& deck, const std::string& name, int side,
                            const Place& place) {
  std::set<Side> out;
  const auto add = [&](int element) {
    const bool solid = deck.split.contains(element);
    const std::set<Side> own = deck.sides_of({element, side});
    if (own.empty() || (!solid && side > 4))
      throw InputError(place, fmt::format("element {} has no side {}", element, side),
                       "sides 1 to 4 of tetrahedra, 1 to 5 of wedges, 1 to 6 of hexahedra");
    out.insert(own.begin(), own.end());
  };
  if (is_label(name)) {
    add(whole(name, place));
    return out;
  }
  const LabelSet& set = set_called(deck, false, name, place);
  std::set<int> of_solids;
  for (const int solid : set.solids) {
    add(solid);
    of_solids.merge(deck.elements_of(solid));
  }
  for (const int element : set.members)
    if (!of_solids.contains(element)) add(element);
  return out;
}

std::set<int> Deck::elements_of(int label) const {
  const auto at = split.find(label);
  if (at == split.end()) return {label};
  return {at->second.begin(), at->second.end()};
}

std::set<Side> Deck::sides_of(const Side& side) const {
  if (!split.contains(side.first)) return {side};
  const auto at = split_sides.find(side);
  return at == split_sides.end() ? std::set<Side>{} : at->second;
}

MeshCards::MeshCards(Deck& deck) : deck_(deck), splitter_(std::make_unique<Splitter>(deck)) {}
MeshCards::~MeshCards() = default;

const LabelSet& set_called(const Deck& deck, bool of_nodes, const std::string& name,
                           const Place& place) {
  const auto& sets = of_nodes ? deck.node_sets : deck.element_sets;
  std::string key = capitals(name);
  auto at = sets.find(key);
  if (const size_t dot = key.rfind('.'); at == sets.end() && dot != std::string::npos)
    at = sets.find(key.substr(dot + 1));  // behind the name of an instance
  if (at != sets.end()) return at->second;
  std::vector<std::string> known;
  for (const auto& [own, set] : sets) known.push_back(set.name);
  const std::string near = nearest_name(name, known);
  throw InputError(
      place, fmt::format("there is no {} set `{}`", of_nodes ? "node" : "element", name),
      near.empty() ? fmt::format("a set given by {} before", of_nodes ? "*NSET" : "*ELSET")
                   : fmt::format("did you mean `{}`?", near));
}

bool MeshCards::take(const Card& card) {
  const std::string& word = card.word;
  if (word == "*NODE")
    nodes(card);
  else if (word == "*ELEMENT")
    elements(card);
  else if (word == "*NSET" || word == "*ELSET")
    set(card, word == "*NSET");
  else if (word == "*SURFACE")
    surface(card);
  else if (word == "*PART" || word == "*END PART" || word == "*INSTANCE" ||
           word == "*END INSTANCE" || word == "*ASSEMBLY" || word == "*END ASSEMBLY")
    structure(card);
  else
    return false;
  return true;
}

void MeshCards::structure(const Card& card) {
  const std::string& word = card.word;
  if (word == "*PART" && ++parts_ > 1) card.fault("there is a second part", kOnePart);
  if (word == "*INSTANCE") {
    if (++instances_ > 1) card.fault("there is a second instance", kOnePart);
    place_nodes(card, deck_.nodes);
    for (auto* sets : {&deck_.node_sets, &deck_.element_sets}) {
      std::map<std::string, LabelSet> of_instance;
      for (const auto& [key, set] : *sets)
        of_instance[capitals(card.option("NAME")) + "." + key] = set;
      sets->merge(of_instance);
    }
  }
  if (word == "*ASSEMBLY") in_assembly_ = true;
  if (word == "*END ASSEMBLY") in_assembly_ = false;
  const bool ends = word.starts_with("*END");
  if (word == "*PART" || word == "*INSTANCE" || ends)
    open_ = ends ? (in_assembly_ ? "*ASSEMBLY" : "") : word;
  if (word == "*ASSEMBLY") open_ = word;
}

void MeshCards::nodes(const Card& card) {
  if (card.has("INPUT"))
    card.fault("nodes in a file of their own are not read", "*INCLUDE, or all in one file");
  if (card.has("SYSTEM") && capitals(card.option("SYSTEM")) != "R")
    card.fault("these nodes are in coordinates of another kind", "rectangular coordinates");
  const std::string name = card.option("NSET");
  LabelSet* set = nullptr;
  if (!name.empty()) {
    set = &deck_.node_sets[capitals(name)];
    if (set->name.empty()) set->name = name, set->place = card.place;
  }
  if (open_ == "*ASSEMBLY") {
    deck_.say(card.place, "reference points of the assembly are left out");
    return;
  }
  for (const CardLine& line : card.lines) {
    const std::vector<std::string> f = line.fields();
    if (f.size() < 4)
      throw InputError(line.place, "a node needs a label and three coordinates", "n, x, y, z");
    const int label = whole(f[0], line.place);
    if (!deck_.nodes
             .try_emplace(label, real(f[1], line.place), real(f[2], line.place),
                          real(f[3], line.place))
             .second)
      throw InputError(line.place, fmt::format("node {} is there twice", label), "each node once");
    if (set) set->members.insert(label);
  }
}

void MeshCards::elements(const Card& card) {
  const std::string type = capitals(card.option("TYPE"));
  if (card.has("INPUT"))
    card.fault("elements in a file of their own are not read", "*INCLUDE, or all in one file");
  const int corners = corners_of_solid(type);
  const int per = type == "C3D4" || type == "C3D4H" ? 4 : type.starts_with("C3D10") ? 10 : corners;
  if (per == 0 && type.starts_with("C3D"))
    card.fault(fmt::format("elements of type {} are not read", type),
               "C3D4, C3D10, C3D8 or C3D6: mesh the part anew with them");
  if (per == 0) {  // shells, springs, masses: no part of the volume
    if (left_out_.insert(type).second)
      deck_.say(card.place, fmt::format("elements of type {} are left out", type));
    return;
  }
  const int tetrahedron = per == 10 ? 10 : 4;
  if (deck_.per_element != 0 && deck_.per_element != tetrahedron)
    card.fault("linear and quadratic elements are mixed", "elements of one order");
  deck_.per_element = tetrahedron;
  const std::string name = card.option("ELSET");
  LabelSet* set = name.empty() ? nullptr : &deck_.element_sets[capitals(name)];
  if (set && set->name.empty()) set->name = name, set->place = card.place;
  std::vector<int> labels;
  for (const CardLine& line : card.lines) {
    for (const std::string& field : line.fields()) labels.push_back(whole(field, line.place));
    if (static_cast<int>(labels.size()) <= per) continue;  // goes on in the next line
    if (static_cast<int>(labels.size()) > per + 1)
      throw InputError(line.place,
                       fmt::format("element {} has {} nodes", labels[0], labels.size() - 1),
                       fmt::format("{} nodes", per));
    for (size_t k = 1; k < labels.size(); ++k)
      if (!deck_.nodes.contains(labels[k]))
        throw InputError(
            line.place,
            fmt::format("element {} names node {}, which is not there", labels[0], labels[k]),
            "nodes given by *NODE before");
    if (corners > 0)
      splitter_->add(labels[0], {labels.begin() + 1, labels.end()}, line.place);
    else if (splitter_->has(labels[0]) ||
             !deck_.elements.try_emplace(labels[0], labels.begin() + 1, labels.end()).second)
      throw InputError(line.place, fmt::format("element {} is there twice", labels[0]),
                       "each element once");
    if (set) set->members.merge(deck_.elements_of(labels[0]));
    if (set && corners > 0) set->solids.insert(labels[0]);
    labels.clear();
  }
  if (!labels.empty())
    throw InputError(card.lines.back().place,
                     fmt::format("element {} has {} nodes", labels[0], labels.size() - 1),
                     fmt::format("{} nodes", per));
}

void MeshCards::set(const Card& card, bool of_nodes) {
  const std::string name = card.option(of_nodes ? "NSET" : "ELSET");
  if (name.empty()) card.fault("the set has no name", of_nodes ? "NSET=NAME" : "ELSET=NAME");
  LabelSet found;
  for (const CardLine& line : card.lines) {
    if (card.has("GENERATE")) {
      fill_range(line, found.members);
      continue;
    }
    for (const std::string& field : line.fields()) {
      if (field.empty()) continue;
      if (is_label(field)) {
        found.members.insert(whole(field, line.place));
        continue;
      }
      found.add(set_called(deck_, of_nodes, field, line.place));
    }
  }
  if (!of_nodes && !deck_.split.empty()) {
    std::set<int> split;
    for (const int label : found.members) {
      if (deck_.split.contains(label)) found.solids.insert(label);
      split.merge(deck_.elements_of(label));
    }
    found.members = std::move(split);
  }
  if (open_ == "*ASSEMBLY" && !card.has("INSTANCE"))  // reference points, which are left out
    found = {};
  if (of_nodes && card.has("ELSET"))
    for (const int element : set_called(deck_, false, card.option("ELSET"), card.place).members)
      if (const auto at = deck_.elements.find(element); at != deck_.elements.end())
        found.members.insert(at->second.begin(), at->second.end());
  LabelSet& set = (of_nodes ? deck_.node_sets : deck_.element_sets)[capitals(name)];
  // An assembly may call a set as the part does; steps mean the assembly's.
  if (in_assembly_ && !set.of_assembly) set = {};
  set.of_assembly = in_assembly_;
  if (set.name.empty()) set.name = name, set.place = card.place;
  set.add(found);
}

void MeshCards::surface(const Card& card) {
  const std::string type = capitals(card.option("TYPE"));
  if (!type.empty() && type != "ELEMENT") {
    deck_.say(card.place, fmt::format("a surface of type {} is left out", type));
    return;
  }
  std::set<Side>& sides = deck_.surfaces[capitals(card.option("NAME"))];
  for (const CardLine& line : card.lines) {
    const std::vector<std::string> f = line.fields();
    const std::string side = f.size() > 1 ? capitals(f[1]) : "";
    if (side.size() != 2 || side[0] != 'S' || side[1] < '1' || side[1] > '6')
      throw InputError(line.place, "the side of an element is missing",
                       "an element or its set, and S1 to S4 (of hexahedra S6)");
    sides.merge(sides_called(deck_, f[0], side[1] - '0', line.place));
  }
}

void MeshCards::finish(const Place& end) {
  if (!open_.empty())
    throw InputError(end, fmt::format("{} is not closed: the deck is cut off", open_),
                     "*END " + open_.substr(1));
  if (deck_.elements.empty())
    throw InputError({end.file}, "the deck has no tetrahedra", "elements of type C3D4 or C3D10");
  splitter_->say(end);
}

}  // namespace hookeye::solver_deck
