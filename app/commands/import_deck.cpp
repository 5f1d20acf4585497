// hookeye import DECK.inp: the body, its material, supports and loads of a deck.
#include <nlohmann/json.hpp>

#include "app/commands/import_files.h"
#include "app/scratch_folder.h"
#include "capture_io/cameras_file.h"
#include "core/scope.h"
#include "importers/deck.h"

namespace hookeye {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// A deck may hold thousands of cards of a kind that is left out.
constexpr size_t kMostSaid = 40;

void run_import_decks(const std::vector<fs::path>& decks, const fs::path& folder,
                      Session& session) {
  const Scope scope("source " + decks.front().string());
  const ScratchFolder scratch("the deck's mesh");
  ImportedDeck imported = import_decks(decks, scratch.path());
  std::string told;
  for (const fs::path& deck : decks) told += " " + deck.filename().string();
  const std::string head = head_line("hookeye import deck" + told);
  for (auto& [name, text] : imported.files) {
    std::string above = (fs::path(name).extension() == ".inp" ? "** " : "# ") + head;
    if (name == "body.yaml")
      above +=
          "# sections of a capture.yaml, below `hookeye: 1` and\n"
          "# `units: {length: mm, force: N}` (those of the deck)\n";
    text = above + text;
  }
  write_imported(folder, imported.files);
  std::vector<std::vector<std::string>> rows{{"example", "supports", "loads"}};
  Json cases = Json::array();
  for (const auto& one : imported.cases) {
    rows.push_back({one.name, std::to_string(one.supports), std::to_string(one.loads)});
    cases.push_back({{"name", one.name}, {"supports", one.supports}, {"loads", one.loads}});
  }
  session.document = {{"hookeye", 1},
                      {"command", "import"},
                      {"kind", "deck"},
                      {"files", Json::array()},
                      {"nodes", imported.nodes},
                      {"elements", imported.elements},
                      {"regions", imported.regions},
                      {"examples", cases},
                      {"said", imported.said}};
  for (const auto& [name, text] : imported.files)
    session.document["files"].push_back((folder / name).string());
  session.say("{}: a deck, {} nodes and {} tetrahedra, {} regions\n{}", decks.front().string(),
              imported.nodes, imported.elements, imported.regions.size(), table(rows));
  for (size_t i = 0; i < imported.said.size() && i < kMostSaid; ++i)
    session.say("{}", wrapped(imported.said[i], 2));
  if (imported.said.size() > kMostSaid)
    session.say("  and {} more: --json tells all\n", imported.said.size() - kMostSaid);
  session.say(
      "written to {}: body.inp, examples.yaml, and body.yaml, whose sections go into a "
      "capture.yaml\n",
      folder.string());
}

}  // namespace hookeye
