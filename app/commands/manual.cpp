// hookeye manual: man pages and completions of all commands, for the install rules. Hidden.
#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/manual/verb.h"
#include "core/text_file.h"
#include "runs/versions.h"

namespace hookeye {
namespace {

void write_manual(const std::filesystem::path& folder, const CLI::App& app, Session& session) {
  const std::vector<Verb> verbs = verbs_of(app);
  const auto write = [&](const std::filesystem::path& file, const std::string& text) {
    std::filesystem::create_directories((folder / file).parent_path());
    write_text(folder / file, text);
    session.document["files"].push_back((folder / file).string());
  };
  session.document = {{"hookeye", 1}, {"command", "manual"}, {"files", nlohmann::json::array()}};
  for (const auto& [name, text] : man_pages(verbs, versions().at("hookeye")))
    write(std::filesystem::path("man1") / name, text);
  write("bash/hookeye", bash_completion(verbs));
  write("zsh/_hookeye", zsh_completion(verbs));
  write("fish/hookeye.fish", fish_completion(verbs));
  session.say("{} files written to {}\n", session.document["files"].size(), folder.string());
}

}  // namespace

void add_manual(CLI::App& app, CommandBody& chosen) {
  CLI::App* command = app.add_subcommand("manual", "Man pages and completions of all commands");
  command->group("");  // for those who package it
  const auto folder = std::make_shared<std::string>();
  command->add_option("-o,--out", *folder, "Folder: man1, bash, zsh, fish")->required();
  command->callback([&app, &chosen, folder] {
    chosen = [&app, folder](Session& session) { write_manual(*folder, app, session); };
  });
}

}  // namespace hookeye
