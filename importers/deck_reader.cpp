// A deck from its first card to its last: materials, and what acts in each step.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "importers/deck_model.h"

namespace hookeye::solver_deck {
namespace {

/// Output, numerics and frames of cards: nothing of the body hangs on them.
const std::array kQuiet = {"*HEADING",
                           "*NODE PRINT",
                           "*EL PRINT",
                           "*NODE FILE",
                           "*EL FILE",
                           "*OUTPUT",
                           "*NODE OUTPUT",
                           "*ELEMENT OUTPUT",
                           "*CONTACT OUTPUT",
                           "*ENERGY OUTPUT",
                           "*ENERGY PRINT",
                           "*RESTART",
                           "*CONTROLS",
                           "*PREPRINT",
                           "*PRINT",
                           "*MONITOR",
                           "*FILE FORMAT",
                           "*FILE OUTPUT",
                           "*SECTION PRINT",
                           "*CONTACT FILE",
                           "*CONTACT PRINT",
                           "*SOLUTION TECHNIQUE",
                           "*STATIC",
                           "*END PART",
                           "*HOURGLASS STIFFNESS",
                           "*SECTION CONTROLS",
                           "*TIME POINTS",
                           "*DIAGNOSTICS",
                           "*BULK VISCOSITY",
                           "*END LOAD CASE"};

/// What acts on a body or makes it up and is not taken.
const std::array kToldOnly = {"*TEMPERATURE",
                              "*INITIAL CONDITIONS",
                              "*EXPANSION",
                              "*PLASTIC",
                              "*VISCOELASTIC",
                              "*CREEP",
                              "*VISCO",
                              "*DAMPING",
                              "*SPRING",
                              "*DASHPOT",
                              "*CONTACT PAIR",
                              "*CONTACT",
                              "*CONTACT PROPERTY ASSIGNMENT",
                              "*CONTACT INCLUSIONS",
                              "*SURFACE INTERACTION",
                              "*SURFACE BEHAVIOR",
                              "*FRICTION",
                              "*TIE",
                              "*EQUATION",
                              "*MPC",
                              "*RIGID BODY",
                              "*COUPLING",
                              "*KINEMATIC",
                              "*DISTRIBUTING",
                              "*ORIENTATION",
                              "*DSFLUX",
                              "*DFLUX",
                              "*FILM",
                              "*CONDUCTIVITY",
                              "*SPECIFIC HEAT",
                              "*DYNAMIC",
                              "*HEAT TRANSFER",
                              "*BUCKLE",
                              "*FREQUENCY",
                              "*MODEL CHANGE",
                              "*CLEARANCE",
                              "*GAP",
                              "*SHELL SECTION",
                              "*BEAM SECTION",
                              "*MEMBRANE SECTION",
                              "*MASS",
                              "*DISTRIBUTION",
                              "*PHYSICAL CONSTANTS",
                              "*HYPERFOAM",
                              "*MULLINS EFFECT",
                              "*DEPVAR",
                              "*USER MATERIAL",
                              "*CONNECTOR SECTION",
                              "*CONNECTOR LOAD",
                              "*INERTIA RELIEF",
                              "*PRE-TENSION SECTION",
                              "*CHANGE FRICTION",
                              "*UNIAXIAL TEST DATA",
                              "*BIAXIAL TEST DATA",
                              "*PLANAR TEST DATA",
                              "*VOLUMETRIC TEST DATA",
                              "*DAMAGE INITIATION",
                              "*DAMAGE EVOLUTION",
                              "*COHESIVE SECTION",
                              "*TRUSS SECTION",
                              "*RATE DEPENDENT",
                              "*CONNECTOR MOTION",
                              "*COUPLED TEMPERATURE-DISPLACEMENT",
                              "*UNCOUPLED TEMPERATURE-DISPLACEMENT"};

/// What would move nodes, or turn what supports mean.
const std::array kRefused = {"*SYSTEM", "*NGEN",   "*NFILL",     "*NCOPY",     "*NMAP",
                             "*ELGEN",  "*ELCOPY", "*TRANSFORM", "*PARAMETER", "*ELEMENT MATRIX"};

const std::array kTaken = {
    "*NODE",     "*ELEMENT",      "*NSET",          "*ELSET",        "*SURFACE",  "*PART",
    "*INSTANCE", "*END INSTANCE", "*ASSEMBLY",      "*END ASSEMBLY", "*MATERIAL", "*HYPERELASTIC",
    "*ELASTIC",  "*DENSITY",      "*SOLID SECTION", "*AMPLITUDE",    "*STEP",     "*END STEP",
    "*BOUNDARY", "*CLOAD",        "*DLOAD",         "*DSLOAD",       "*INCLUDE"};

template <class Words>
bool among(const Words& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

class DeckReader {
 public:
  explicit DeckReader(const std::filesystem::path& file) : mesh_(deck_) {
    Place end;
    for (const Card& card : read_cards(file, end)) take(card);
    if (in_step_) throw InputError(end, "the deck ends within a step: it is cut off", "*END STEP");
    mesh_.finish(end);
    if (deck_.steps.empty())
      deck_.say(end, "there is no *STEP: the body is imported, and an example at rest");
  }

  Deck deck_;

 private:
  void take(const Card& card) {
    const std::string& word = card.word;
    if (mesh_.take(card)) return;
    if (word == "*MATERIAL" || word == "*HYPERELASTIC" || word == "*ELASTIC" ||
        word == "*DENSITY" || word == "*SOLID SECTION")
      material(card);
    else if (word == "*AMPLITUDE")
      amplitude(card);
    else if (word == "*STEP" || word == "*END STEP")
      step(card);
    else if (word == "*BOUNDARY")
      boundary(card);
    else if (word == "*CLOAD")
      nodal_loads(card);
    else if (word == "*DLOAD" || word == "*DSLOAD")
      distributed(card);
    else if (among(kToldOnly, word))
      deck_.say(card.place, word + " is left out");
    else if (!among(kQuiet, word))
      refuse(card);
  }

  [[noreturn]] void refuse(const Card& card) {
    if (among(kRefused, card.word))
      card.fault(card.word + " is not obeyed",
                 "nodes, elements and supports written out, in the axes of the body");
    std::vector<std::string> known(kTaken.begin(), kTaken.end());
    known.insert(known.end(), kQuiet.begin(), kQuiet.end());
    known.insert(known.end(), kToldOnly.begin(), kToldOnly.end());
    const std::string near = nearest_name(card.word, known);
    card.fault(fmt::format("the keyword {} is not known here", card.word),
               near.empty() ? "take it out where nothing of the body hangs on it"
                            : fmt::format("did you mean {}?", near));
  }

  void material(const Card& card) {
    if (card.word == "*MATERIAL") {
      DeckMaterial fresh;
      fresh.name = card.option("NAME");
      fresh.place = card.place;
      deck_.materials.push_back(std::move(fresh));
      return;
    }
    if (card.word == "*SOLID SECTION") {
      const LabelSet& set = set_called(deck_, false, card.option("ELSET"), card.place);
      if (card.has("ORIENTATION"))
        deck_.say(card.place, "the orientation of the section is left out");
      deck_.sections.push_back({set, capitals(card.option("MATERIAL")), card.place});
      return;
    }
    if (deck_.materials.empty())
      card.fault(card.word + " stands before any *MATERIAL", "*MATERIAL, NAME=... above it");
    DeckMaterial& of = deck_.materials.back();
    if (card.word != "*DENSITY") {
      of.law = law_of(card, deck_);
      return;
    }
    if (card.lines.empty()) card.fault("the density is missing", "a number below *DENSITY");
    of.density = real(card.lines[0].fields()[0], card.lines[0].place);
    if (!(of.density > 0))
      throw InputError(card.lines[0].place, "the density is not above zero", "mass per volume");
  }

  void amplitude(const Card& card) {
    std::vector<double> all;
    for (const CardLine& line : card.lines)
      for (const std::string& field : line.fields()) all.push_back(real(field, line.place));
    const std::string definition = capitals(card.option("DEFINITION"));
    if (!definition.empty() && definition != "TABULAR" && definition != "SMOOTH STEP") {
      deck_.say(card.place,
                fmt::format("an amplitude by {} is left out: the full load counts", definition));
      all = {0, 1};
    }
    if (all.size() < 2 || all.size() % 2 != 0)
      card.fault("the amplitude is no table", "pairs of time and value");
    amplitudes_[capitals(card.option("NAME"))] = all.back();
  }

  /// What an amplitude leaves at its end.
  double share(const Card& card) {
    if (!card.has("AMPLITUDE")) return 1;
    const std::string name = card.option("AMPLITUDE");
    const auto at = amplitudes_.find(capitals(name));
    if (at == amplitudes_.end())
      card.fault(fmt::format("there is no amplitude `{}`", name), "*AMPLITUDE, NAME=... before");
    deck_.say(card.place, fmt::format("amplitude {}: its last value counts, {}", name, at->second));
    return at->second;
  }

  void step(const Card& card) {
    if (card.word == "*END STEP") {
      if (!in_step_) card.fault("*END STEP without a step", "*STEP above it");
      in_step_ = false;
      deck_.steps.push_back(now_);
      return;
    }
    if (in_step_) card.fault("a step begins within a step", "*END STEP before it");
    if (card.has("PERTURBATION")) deck_.say(card.place, "PERTURBATION is left out: a static step");
    in_step_ = true;
    now_.name = card.option("NAME");
    now_.place = card.place;
  }

  /// Where supports and loads go; those of before are forgotten where the card says so.
  template <class Map>
  void fresh(const Card& card, Map& map) {
    if (capitals(card.option("OP")) == "NEW") map.clear();
  }

  std::string target_of(const std::string& field, const Place& place) {
    if (is_label(field)) {
      if (!deck_.nodes.contains(whole(field, place)))
        throw InputError(place, fmt::format("there is no node {}", field), "a node of the deck");
      return field;
    }
    const LabelSet& set = set_called(deck_, true, field, place);
    if (set.members.empty())
      throw InputError(place, fmt::format("node set `{}` has no node of the body", field),
                       "supports and loads on nodes of the body; reference points are left out");
    return capitals(set.name);
  }

  void boundary(const Card& card) {
    const std::string type = capitals(card.option("TYPE"));
    if ((!type.empty() && type != "DISPLACEMENT") || card.has("USER") || card.has("FIXED") ||
        card.has("SUBMODEL"))
      card.fault("supports of this kind are not read", "*BOUNDARY with displacements");
    fresh(card, now_.held);
    const double factor = share(card);
    for (const CardLine& line : card.lines) {
      const std::vector<std::string> f = line.fields();
      const std::string target = target_of(f[0], line.place);
      if (f.size() < 2)
        throw InputError(line.place, "a support needs a component", "node or set, 1, 3, value");
      std::vector<int> which = named_support(capitals(f[1]), line.place);
      const double value = f.size() > 3 && !f[3].empty() ? factor * real(f[3], line.place) : 0;
      if (which.empty()) {
        const int first = whole(f[1], line.place);
        const int last = f.size() > 2 && !f[2].empty() ? whole(f[2], line.place) : first;
        if (first < 1 || last < first || first > 30)
          throw InputError(line.place, "no such components", "1 to 3, first and last");
        for (int i = first; i <= std::min(last, 3); ++i) which.push_back(i - 1);
        if (first > 6)
          deck_.say(line.place, fmt::format("component {} is no displacement: left out", first));
      }
      for (const int i : which) now_.held[{target, i}] = {value, line.place};
    }
  }

  /// Components from 0; empty: the field is a number.
  static std::vector<int> named_support(const std::string& word, const Place& place) {
    if (word == "ENCASTRE" || word == "PINNED") return {0, 1, 2};
    if (word == "XSYMM") return {0};
    if (word == "YSYMM") return {1};
    if (word == "ZSYMM") return {2};
    if (word == "XASYMM") return {1, 2};
    if (word == "YASYMM") return {0, 2};
    if (word == "ZASYMM") return {0, 1};
    if (!is_label(word))
      throw InputError(place, fmt::format("`{}` is no kind of support", word),
                       "a component from 1 to 3, ENCASTRE, PINNED or XSYMM and its like");
    return {};
  }

  void nodal_loads(const Card& card) {
    if (card.has("FOLLOWER"))
      deck_.say(card.place, "FOLLOWER is left out: forces keep their direction");
    fresh(card, now_.forces);
    const double factor = share(card);
    for (const CardLine& line : card.lines) {
      const std::vector<std::string> f = line.fields();
      const std::string target = target_of(f[0], line.place);
      if (f.size() < 3)
        throw InputError(line.place, "a load has too few fields", "node or set, 1, value");
      const int component = whole(f[1], line.place);
      if (component < 1 || component > 3) {
        deck_.say(line.place, fmt::format("component {} is no force: left out", component));
        continue;
      }
      now_.forces[{target, component - 1}] = {factor * real(f[2], line.place), line.place};
    }
  }

  void distributed(const Card& card) {
    if (capitals(card.option("OP")) == "NEW") now_.pressures.clear(), now_.gravity.setZero();
    const double factor = share(card);
    for (const CardLine& line : card.lines) {
      const std::vector<std::string> f = line.fields();
      if (f.size() < 3)
        throw InputError(line.place, "a load has too few fields", "elements, P1 to P6, value");
      const std::string kind = capitals(f[1]);
      if (kind == "GRAV")
        gravity(f, factor, line.place);
      else if (card.word == "*DSLOAD" && kind == "P")
        for (const Side& side : surface_called(f[0], line.place))
          now_.pressures[side] = {factor * real(f[2], line.place), line.place};
      else if (kind.size() == 2 && kind[0] == 'P' && kind[1] >= '1' && kind[1] <= '6')
        for (const Side& side :
             sides_called(deck_, element_named(f[0], line.place), kind[1] - '0', line.place))
          now_.pressures[side] = {factor * real(f[2], line.place), line.place};
      else
        deck_.say(line.place, fmt::format("a load of kind {} is left out", kind));
    }
  }

  void gravity(const std::vector<std::string>& f, double factor, const Place& place) {
    if (f.size() < 6)
      throw InputError(place, "gravity needs a direction", "elements, GRAV, g, x, y, z");
    const Eigen::Vector3d along(real(f[3], place), real(f[4], place), real(f[5], place));
    if (!(along.norm() > 0)) throw InputError(place, "gravity has no direction", "x, y, z");
    if (elements_called(f[0], place).size() < deck_.elements.size())
      deck_.say(place, "gravity acts on a part of the body: here it acts on all of it");
    now_.gravity = factor * real(f[2], place) * along.normalized();
  }

  /// The field, which is a set or an element that is there.
  const std::string& element_named(const std::string& field, const Place& place) {
    if (is_label(field) && !deck_.has_element(whole(field, place)))
      throw InputError(place, fmt::format("there is no element {}", field), "one of the deck");
    return field;
  }

  std::set<int> elements_called(const std::string& field, const Place& place) {
    if (!is_label(element_named(field, place)))
      return set_called(deck_, false, field, place).members;
    return deck_.elements_of(whole(field, place));
  }

  const std::set<Side>& surface_called(const std::string& name, const Place& place) {
    const std::string key = capitals(name);
    auto at = deck_.surfaces.find(key);
    if (const size_t dot = key.rfind('.'); at == deck_.surfaces.end() && dot != std::string::npos)
      at = deck_.surfaces.find(key.substr(dot + 1));
    if (at == deck_.surfaces.end())
      throw InputError(place, fmt::format("there is no surface `{}`", name),
                       "*SURFACE, TYPE=ELEMENT, NAME=... before");
    return at->second;
  }

  MeshCards mesh_;
  std::map<std::string, double> amplitudes_;
  DeckStep now_;
  bool in_step_ = false;
};

}  // namespace

Deck read_deck(const std::filesystem::path& file) { return std::move(DeckReader(file).deck_); }

}  // namespace hookeye::solver_deck
