// Completions of bash, zsh and fish.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "app/manual/verb.h"

namespace hookeye {
namespace {

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

/// For a place between single quotes of bash and zsh.
std::string quoted(const std::string& text) { return replaced(text, "'", "'\\''"); }

std::string in_one_line(const std::string& text) { return replaced(text, "\n", " "); }

std::vector<std::string> names_of_all(const std::vector<Word>& words) {
  std::vector<std::string> out;
  for (const Word& word : words) out.insert(out.end(), word.names.begin(), word.names.end());
  return out;
}

std::vector<std::string> verb_names(const std::vector<Verb>& verbs) {
  std::vector<std::string> out;
  for (size_t i = 1; i < verbs.size(); ++i) out.push_back(verbs[i].name);
  return out;
}

/// Of the last word by its place that takes one of a few words; null: none does.
const Word* chosen_by_place(const Verb& verb) {
  for (const Word& word : verb.places)
    if (!word.choices.empty()) return &word;
  return nullptr;
}

std::string zsh_text(const std::string& text) {
  std::string out = quoted(in_one_line(text));
  for (const char* mark : {"[", "]", ":"}) out = replaced(out, mark, std::string("\\") + mark);
  return out;
}

std::string zsh_value(const Word& word) {
  if (word.value.empty()) return {};
  if (!word.choices.empty())
    return fmt::format(":{}:({})", word.value, fmt::join(word.choices, " "));
  return ":" + word.value + (word.value == "TEXT" ? ":_files" : ":");
}

std::string zsh_option(const Word& word) {
  const std::string told = fmt::format("[{}]{}", zsh_text(word.description), zsh_value(word));
  if (word.names.size() == 1) return fmt::format("'{}{}'", word.names.front(), told);
  return fmt::format("'({})'{{{}}}'{}'", fmt::join(word.names, " "), fmt::join(word.names, ","),
                     told);
}

std::string fish_text(const std::string& text) {
  return replaced(replaced(in_one_line(text), "\\", "\\\\"), "'", "\\'");
}

std::string fish_option(const std::string& when, const Word& word) {
  std::string out = "complete -c hookeye -n '" + when + "'";
  for (const std::string& name : word.names)
    out += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  if (!word.choices.empty())
    out += fmt::format(" -x -a '{}'", fmt::join(word.choices, " "));
  else if (!word.value.empty())
    out += word.value == "TEXT" ? " -r" : " -x";
  return out + " -d '" + fish_text(word.description) + "'\n";
}

}  // namespace

std::string bash_completion(const std::vector<Verb>& verbs) {
  std::string values, words;
  for (const Verb& verb : verbs) {
    for (const Word& word : verb.options) {
      if (word.choices.empty()) continue;
      std::vector<std::string> cases;
      for (const std::string& name : word.names)
        cases.push_back("'" + verb.name + " " + name + "'");
      values += fmt::format("    {}) words='{}' ;;\n", fmt::join(cases, " | "),
                            fmt::join(word.choices, " "));
    }
    const Word* chosen = verb.name.empty() ? nullptr : chosen_by_place(verb);
    words +=
        fmt::format("      {}) words='{}'; named='{}' ;;\n", verb.name.empty() ? "''" : verb.name,
                    fmt::join(names_of_all(verb.options), " "),
                    verb.name.empty() ? fmt::format("{}", fmt::join(verb_names(verbs), " "))
                    : chosen          ? fmt::format("{}", fmt::join(chosen->choices, " "))
                                      : "");
  }
  return R"(# bash completion of hookeye
_hookeye() {
  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} verb='' words='' named='' i
  for ((i = 1; i < COMP_CWORD; i++)); do
    case ${COMP_WORDS[i]} in
      --threads | --memory) ((i++)) ;;
      -*) ;;
      *) verb=${COMP_WORDS[i]}; break ;;
    esac
  done
  COMPREPLY=()
  case "$verb $before" in
)" + values +
         R"(    *) ;;
  esac
  if [[ -n $words ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
    return
  fi
  case $verb in
)" + replaced(words, "      ", "    ") +
         R"(  esac
  if [[ $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
    return
  fi
  mapfile -t COMPREPLY < <(compgen -W "$named" -- "$current")
  if [[ -n $verb ]]; then
    compopt -o filenames 2>/dev/null
    mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -f -- "$current")
  fi
}
complete -F _hookeye hookeye
)";
}

std::string zsh_completion(const std::vector<Verb>& verbs) {
  std::string out = "#compdef hookeye\n_hookeye() {\n  local state\n  local -a verbs\n  verbs=(\n";
  for (size_t i = 1; i < verbs.size(); ++i)
    out += fmt::format("    '{}:{}'\n", verbs[i].name, zsh_text(verbs[i].description));
  out += "  )\n  _arguments -C \\\n";
  for (const Word& word : verbs.front().options) out += "    " + zsh_option(word) + " \\\n";
  out +=
      "    '1:command:->verb' '*::argument:->rest'\n  case $state in\n"
      "    verb) _describe command verbs ;;\n    rest)\n      case $words[1] in\n";
  for (size_t i = 1; i < verbs.size(); ++i) {
    out += "        " + verbs[i].name + ")\n          _arguments \\\n";
    for (const Word& word : verbs[i].options) out += "            " + zsh_option(word) + " \\\n";
    int place = 0;
    for (const Word& word : verbs[i].places)
      out += fmt::format(
          "            '{}:{}:{}' \\\n", word.many ? "*" : std::to_string(++place),
          word.names.front(),
          word.choices.empty() ? "_files" : fmt::format("({})", fmt::join(word.choices, " ")));
    out += "            ;;\n";
  }
  return out + "      esac ;;\n  esac\n}\n_hookeye \"$@\"\n";
}

std::string fish_completion(const std::vector<Verb>& verbs) {
  std::string out = "# fish completion of hookeye\n";
  for (const Word& word : verbs.front().options) out += fish_option("__fish_use_subcommand", word);
  for (size_t i = 1; i < verbs.size(); ++i) {
    const Verb& verb = verbs[i];
    out += fmt::format("complete -c hookeye -n __fish_use_subcommand -f -a {} -d '{}'\n", verb.name,
                       fish_text(verb.description));
    const std::string seen = "__fish_seen_subcommand_from " + verb.name;
    for (const Word& word : verb.options) out += fish_option(seen, word);
    if (const Word* chosen = chosen_by_place(verb))
      out += fmt::format("complete -c hookeye -n '{}' -a '{}'\n", seen,
                         fmt::join(chosen->choices, " "));
  }
  return out;
}

}  // namespace hookeye
