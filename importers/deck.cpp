// Decks of Abaqus, CalculiX and FEBio as body.inp, body.yaml and examples.yaml.
//
// Written from the manuals of the programs. The text goes through four hands: cards (deck_cards),
// what they tell (deck_reader, deck_mesh, deck_law; of FEBio deck_febio), regions (deck_patches),
// load cases (deck_cases).
#include "importers/deck.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "capture_io/camera_text.h"
#include "core/text_file.h"
#include "importers/deck_cases.h"
#include "importers/deck_febio.h"
#include "importers/detail.h"

namespace hookeye {
namespace solver_deck {
namespace {

namespace fs = std::filesystem;

/// Names of examples: of a deck with one step the file's.
void name_steps(Deck& deck, const fs::path& file) {
  for (size_t i = 0; i < deck.steps.size(); ++i) {
    DeckStep& step = deck.steps[i];
    if (!step.name.empty()) continue;
    step.name = file.stem().string();
    if (deck.steps.size() > 1) step.name += fmt::format("_{}", i + 1);
  }
}

/// A further deck of the same body.
void join(Deck& all, Deck more, const fs::path& file, const fs::path& first) {
  if (more.nodes != all.nodes || more.elements != all.elements)
    throw InputError({file.string()},
                     fmt::format("the body is another one than in {}", first.string()),
                     "decks of one body; import others into folders of their own");
  const auto law = [](const Deck& deck) {
    std::vector<std::string> out;
    for (const DeckMaterial& one : deck.materials) out.push_back(one.name + one.law.yaml);
    return out;
  };
  if (law(more) != law(all))
    all.said.push_back(fmt::format("{}: the material is another one than in {}, which is taken",
                                   file.string(), first.string()));
  for (auto& [key, set] : more.node_sets) {
    const auto [at, fresh] = all.node_sets.try_emplace(key, set);
    if (!fresh && at->second.members != set.members)
      throw InputError(
          set.place,
          fmt::format("node set `{}` is another one than in {}", set.name, first.string()),
          "sets of the same nodes, or another name");
  }
  for (DeckStep& step : more.steps) all.steps.push_back(std::move(step));
  for (const std::string& said : more.said)
    if (std::find(all.said.begin(), all.said.end(), said) == all.said.end())
      all.said.push_back(said);
}

const DeckMaterial* material_of(const Deck& deck, const Section& section) {
  for (const DeckMaterial& one : deck.materials)
    if (capitals(one.name) == section.material) return &one;
  throw InputError(section.place, fmt::format("there is no material `{}`", section.material),
                   "*MATERIAL, NAME=... of that name");
}

/// Refuses elements without a material.
void check_sections(const Deck& deck) {
  std::set<int> filled;
  for (const Section& section : deck.sections)
    filled.insert(section.elements.members.begin(), section.elements.members.end());
  for (const auto& [label, nodes] : deck.elements)
    if (!filled.contains(label))
      throw InputError(deck.sections.front().place,
                       fmt::format("element {} has no *SOLID SECTION", label),
                       "a section for every element");
}

/// `material` and `fit` of the model; "": no law.
std::string model_text(Deck& deck) {
  std::map<std::string, const DeckMaterial*> of_sets;
  for (const Section& section : deck.sections) {
    const DeckMaterial* one = material_of(deck, section);
    if (one->law.yaml.empty()) return "";
    of_sets[plain_name(section.elements.name)] = one;
  }
  if (!deck.sections.empty()) check_sections(deck);
  if (of_sets.empty() && deck.materials.size() == 1 && !deck.materials[0].law.yaml.empty())
    of_sets["EALL"] = &deck.materials[0];
  if (of_sets.empty()) return "";
  const DeckMaterial* first = of_sets.begin()->second;
  if (std::all_of(of_sets.begin(), of_sets.end(), [&](auto& one) { return one.second == first; })) {
    std::string out = "  material: " + first->law.yaml + "\n";
    if (!first->law.to_fit.empty())
      out += fmt::format("  fit: [{}]\n", fmt::join(first->law.to_fit, ", "));
    return out;
  }
  std::string out = "  material:\n";
  std::vector<std::string> fit;
  for (const auto& [name, one] : of_sets) {
    out += fmt::format("    {}: {}\n", yaml_name(name), one->law.yaml);
    for (const std::string& parameter : one->law.to_fit) fit.push_back(name + "." + parameter);
  }
  return out + (fit.empty() ? "" : fmt::format("  fit: [{}]\n", fmt::join(fit, ", ")));
}

/// One gravity holds for all examples.
Eigen::Vector3d gravity_of(Deck& deck) {
  Eigen::Vector3d out = Eigen::Vector3d::Zero();
  for (const DeckStep& step : deck.steps)
    if (!step.gravity.isZero(0.0)) out = step.gravity;
  for (const DeckStep& step : deck.steps)
    if (step.gravity != out)
      deck.say(step.place, "gravity is another one in this step; a capture has one for all");
  return out;
}

double density_of(Deck& deck) {
  double density = 0;
  for (const DeckMaterial& one : deck.materials) {
    if (density != 0 && one.density != 0 && one.density != density)
      deck.say(one.place, "a second density is left out: a capture has one");
    if (density == 0) density = one.density;
  }
  return density;
}

std::string body_yaml(Deck& deck, const Patches& patches, const std::string& model) {
  const double density = density_of(deck);
  const Eigen::Vector3d g = gravity_of(deck);
  std::string out = "body:\n  volume: body.inp\n";
  if (density > 0) out += fmt::format("  density: {}\n", density);
  out += "model:\n" + model;
  if (!g.isZero(0.0))
    out += fmt::format("  gravity: [{}, {}, {}]\n", g.x() + 0.0, g.y() + 0.0, g.z() + 0.0);
  const std::string regions = patches.regions_text();
  if (!regions.empty()) out += "regions:\n" + regions;
  return out + "examples: {from: examples.yaml}\n";
}

/// Whatever a capture would refuse is refused here.
void try_capture(const ImportedDeck& out, const fs::path& scratch, const Place& place) {
  for (const auto& [name, text] : out.files) write_text(scratch / name, text);
  write_text(scratch / "capture.yaml",
             "hookeye: 1\nunits: {length: mm, force: N}\n" + out.files[1].second);
  try {
    read_capture(scratch);
  } catch (const InputError& error) {
    throw InputError(place, error.wrong(), error.right());
  }
}

}  // namespace
}  // namespace solver_deck

bool is_deck(const std::filesystem::path& file) {
  return detail::has_ending(file, {".inp", ".feb"});
}

std::optional<LawInDeck> law_in_deck(const std::filesystem::path& file) {
  using namespace solver_deck;
  const Deck deck = detail::has_ending(file, {".feb"}) ? read_febio(file) : read_deck(file);
  const DeckMaterial* found = nullptr;
  for (const DeckMaterial& one : deck.materials) {
    if (one.law.yaml.empty()) continue;
    if (found && found->law.yaml != one.law.yaml)
      throw InputError(one.place, "this is a second law beside that of `" + found->name + "`",
                       "one law for the body, or several by hand (docs/capture.md)");
    if (!found) found = &one;
  }
  if (!found) return {};
  return LawInDeck{found->law.yaml, found->law.to_fit, found->density, found->place};
}

ImportedDeck import_decks(const std::vector<std::filesystem::path>& decks,
                          const std::filesystem::path& scratch) {
  using namespace solver_deck;
  Deck deck;
  for (const fs::path& file : decks) {
    Deck one = detail::has_ending(file, {".feb"}) ? read_febio(file) : read_deck(file);
    name_steps(one, file);
    if (&file == &decks.front())
      deck = std::move(one);
    else
      join(deck, std::move(one), file, decks.front());
  }
  const Place place{decks.front().string()};
  std::string model = model_text(deck);
  if (model.empty()) {
    deck.say(place, "no law could be taken: body.yaml has a soft rubber, write your own");
    model = "  material: {law: neo-hookean, mu: 0.1, kappa: 2}  # not from the deck\n  fit: [mu]\n";
  }
  Patches patches(deck, scratch);
  ImportedDeck out;
  std::string examples = "examples:\n";
  std::set<std::string> taken;
  for (const DeckStep& step : deck.steps) {
    const CaseText text = case_text(step, deck, patches);
    const std::string base = plain_name(step.name);
    std::string name = base;
    for (int i = 2; !taken.insert(name).second; ++i) name = fmt::format("{}_{}", base, i);
    examples += text.yaml.empty() ? fmt::format("  {}: {{}}\n", yaml_name(name))
                                  : fmt::format("  {}:\n{}", yaml_name(name), text.yaml);
    out.cases.push_back({name, text.supports, text.loads});
  }
  if (deck.steps.empty()) examples += "  rest: {}\n", out.cases.push_back({"rest"});
  out.files = {{"body.inp", patches.body_text()},
               {"body.yaml", body_yaml(deck, patches, model)},
               {"examples.yaml", examples}};
  try_capture(out, scratch, place);
  out.nodes = patches.mesh().nodes(), out.elements = patches.mesh().size();
  for (const auto& [name, region] : patches.all()) out.regions.push_back(name);
  deck.said.push_back("a deck has no units: write those that it was made with");
  out.said = deck.said;
  return out;
}

}  // namespace hookeye
