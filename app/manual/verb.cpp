#include "app/manual/verb.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "estimation/effects/catalogue.h"

namespace hookeye {
namespace {

/// "additive" of "TEXT:{additive}".
std::vector<std::string> choices_of(const std::string& type) {
  const size_t begin = type.find('{'), end = type.rfind('}');
  if (begin == std::string::npos || end == std::string::npos || end < begin) return {};
  return CLI::detail::split(type.substr(begin + 1, end - begin - 1), ',');
}

std::vector<std::string> effect_names() {
  std::vector<std::string> out;
  for (const Effect* effect : catalogue()) out.push_back(effect->name());
  return out;
}

Word word_of(const CLI::Option& option) {
  Word out;
  const std::string type = option.get_type_name();
  out.description = option.get_description();
  out.required = option.get_required();
  out.choices = choices_of(type);
  if (option.get_positional()) {
    out.names = {option.get_name(true)};
    out.many = option.get_items_expected_max() > 1;
    out.value = type.substr(0, type.find(':'));
    return out;
  }
  for (const std::string& name : option.get_snames()) out.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) out.names.push_back("--" + name);
  if (option.get_items_expected_max() > 0) out.value = type.substr(0, type.find(':'));
  return out;
}

Verb verb_of(const CLI::App& app) {
  Verb out;
  out.name = app.get_parent() ? app.get_name() : "";
  out.description = app.get_description();
  out.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;  // hidden
    Word word = word_of(*option);
    const bool an_effect =
        word.names.front() == "EFFECT" || (out.name == "effects" && word.names.front() == "NAME");
    if (option->get_positional() && an_effect) word.choices = effect_names();
    (option->get_positional() ? out.places : out.options).push_back(std::move(word));
  }
  return out;
}

}  // namespace

std::vector<Verb> verbs_of(const CLI::App& app) {
  std::vector<Verb> out{verb_of(app)};
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    if (!command->get_group().empty()) out.push_back(verb_of(*command));
  return out;
}

}  // namespace hookeye
