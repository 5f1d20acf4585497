// hookeye effects: the catalogue, as the effects declare themselves.
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "app/commands/commands.h"
#include "app/scratch_folder.h"
#include "estimation/effects/catalogue.h"
#include "estimation/model/declaration.h"
#include "runs/add_step.h"

namespace hookeye {
namespace {

using Json = nlohmann::ordered_json;

struct EffectsCommand {
  std::string name, capture;
};

/// Rows of a table before "and so on"; --json has them all.
constexpr size_t kRows = 12;

/// The block that the catalogue tells its forms of, where no capture is given.
std::shared_ptr<const Scene> example_scene() {
  const ScratchFolder folder("effects");
  write_example_block(folder.path());
  return load_scene(read_capture(folder.path()), false);
}

Json json_number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json describe(const DeclaredForm& form) {
  Json parameters = Json::array();
  for (const Parameter& p : form.parameters)
    parameters.push_back({{"name", p.name},
                          {"unit", p.unit},
                          {"long_name", p.long_name},
                          {"null", p.value},
                          {"low", json_number(p.low)},
                          {"high", json_number(p.high)},
                          {"matters", p.typical}});
  return {{"form", form.variant},      {"name", form_name(form.variant)},
          {"ways", form.ways},         {"by", form.refit ? "refit" : "diagnosis"},
          {"sentence", form.sentence}, {"parameters", parameters}};
}

Json describe(const Declaration& declared) {
  const Effect& effect = *declared.effect;
  Json out = {{"name", effect.name()},       {"group", group_name(effect.group())},
              {"title", effect.title()},     {"manual", effect.manual()},
              {"several", effect.several()}, {"why_not", declared.why_not},
              {"forms", Json::array()}};
  for (const DeclaredForm& form : declared.forms) out["forms"].push_back(describe(form));
  return out;
}

/// "a1" of "stiffness_field.a1".
std::string short_name(const Effect& effect, const std::string& name) {
  const std::string prefix = effect.name() + ".";
  return name.starts_with(prefix) ? name.substr(prefix.size()) : name;
}

/// Runs of parameters that differ in their names alone: {first, last}.
std::vector<std::pair<size_t, size_t>> alike(const std::vector<Parameter>& all) {
  std::vector<std::pair<size_t, size_t>> runs;
  const auto same = [](const Parameter& a, const Parameter& b) {
    return a.unit == b.unit && a.long_name == b.long_name && a.value == b.value && a.low == b.low &&
           a.high == b.high && a.typical == b.typical;
  };
  for (size_t i = 0; i < all.size(); ++i)
    if (runs.empty() || !same(all[runs.back().first], all[i]))
      runs.emplace_back(i, i);
    else
      runs.back().second = i;
  return runs;
}

std::string names_of(const Effect& effect, const DeclaredForm& form) {
  std::string text;
  for (const auto& [first, last] : alike(form.parameters)) {
    text += (text.empty() ? "" : ", ") + short_name(effect, form.parameters[first].name);
    if (last > first)
      text += (last > first + 1 ? " .. " : ", ") + short_name(effect, form.parameters[last].name);
  }
  return text;
}

std::string bound(double x) { return std::isfinite(x) ? fmt::format("{:.3g}", x) : "none"; }

/// The null, without what rounding left of a place in the middle.
std::string null_of(const Parameter& p) {
  constexpr double kRounding = 1e-12;
  return bound(std::abs(p.value) < kRounding * p.typical ? 0.0 : p.value);
}

/// Forms and how they read in a capture's model; those of a diagnosis or of a refit.
std::string forms_table(const Declaration& declared, bool refit) {
  std::vector<std::vector<std::string>> rows{
      {refit ? "a refit may go on to" : "tested as", "ways", "parameters"}};
  size_t more = 0;
  for (const DeclaredForm& form : declared.forms) {
    if (form.refit != refit) continue;
    if (rows.size() > kRows) {
      ++more;
      continue;
    }
    rows.push_back({form.variant.empty() ? "-" : form.variant,
                    refit ? "" : std::to_string(form.ways), names_of(*declared.effect, form)});
  }
  if (rows.size() == 1) return {};
  return "\n" + table(rows) + (more ? fmt::format("  and {} more (--json)\n", more) : "");
}

/// Each parameter once, as the first form that has it declares it.
std::string parameters_table(const Declaration& declared) {
  std::vector<std::vector<std::string>> rows{
      {"parameter", "unit", "null", "from", "to", "matters", "meaning"}};
  std::vector<std::string> told;
  size_t more = 0;
  for (const DeclaredForm& form : declared.forms)
    for (const auto& [first, last] : alike(form.parameters)) {
      const Parameter& p = form.parameters[first];
      if (std::find(told.begin(), told.end(), p.name) != told.end()) continue;
      told.push_back(p.name);
      if (rows.size() > 2 * kRows) {
        ++more;
        continue;
      }
      const std::string to =
          last > first ? " .. " + short_name(*declared.effect, form.parameters[last].name) : "";
      rows.push_back({p.name + to, p.unit.empty() ? "-" : p.unit, null_of(p), bound(p.low),
                      bound(p.high), bound(p.typical), p.long_name});
    }
  return "\n" + table(rows) + (more ? fmt::format("  and {} more (--json)\n", more) : "");
}

/// What `hookeye add --as` takes.
std::string form_names_of(const Declaration& declared) {
  std::vector<std::string> names;
  for (const DeclaredForm& form : declared.forms) {
    const std::string name = form_name(form.variant);
    if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  }
  if (names.size() < 2) return {};
  return "\n" + wrapped(fmt::format("`hookeye add RUN {} --as FORM` takes one of: '{}'",
                                    declared.effect->name(), fmt::join(names, "', '")),
                        2);
}

void say_one(const Session& session, const Declaration& declared) {
  const Effect& effect = *declared.effect;
  session.say("{}: {} ({})\n\n{}", effect.name(), effect.title(), group_name(effect.group()),
              wrapped(effect.manual(), 2));
  if (declared.forms.empty()) {
    session.say("\n{}", wrapped("not possible here: " + declared.why_not, 2));
    return;
  }
  session.say("\n{}", wrapped("said as: " + declared.forms.front().sentence, 2));
  session.say("{}{}{}{}", forms_table(declared, false), forms_table(declared, true),
              form_names_of(declared), parameters_table(declared));
}

void say_all(const Session& session, const std::vector<Declaration>& all) {
  std::vector<std::vector<std::string>> rows;
  EffectGroup group{};
  for (const Declaration& declared : all) {
    const Effect& effect = *declared.effect;
    if (rows.empty() || effect.group() != group) {
      if (!rows.empty()) session.say("{}\n", table(rows));
      group = effect.group();
      rows = {{group_name(group), "what the model may lack", "parameters"}};
    }
    rows.push_back({effect.name(), effect.title(),
                    declared.forms.empty() ? "not possible here: " + declared.why_not
                                           : names_of(effect, declared.forms.front())});
  }
  session.say("{}", table(rows));
}

void run_effects(const EffectsCommand& options, Session& session) {
  if (!options.name.empty()) check_effect(options.name);
  const bool own = !options.capture.empty();
  const auto scene = own ? load_scene(read_capture(options.capture), false) : example_scene();
  const ModelForm form = base_form(scene);
  const Model model = form.realise(form.initial());
  std::vector<Declaration> all;
  for (const Effect* effect : catalogue())
    if (options.name.empty() || effect->name() == options.name)
      all.push_back(declare(*effect, model));
  auto& document = session.document;
  document = {{"hookeye", 1},
              {"command", "effects"},
              {"capture", own ? Json(scene->capture.file.string()) : Json(nullptr)},
              {"units",
               {{"length", scene->capture.units.length},
                {"force", scene->capture.units.force},
                {"stress", scene->capture.units.stress()}}},
              {"effects", Json::array()}};
  for (const Declaration& declared : all) document["effects"].push_back(describe(declared));
  if (options.name.empty())
    say_all(session, all);
  else
    say_one(session, all.front());
  session.say("\n{}", wrapped(own ? "Numbers are those of " + options.capture + "."
                                  : "Numbers are those of a block of 20 x 16 x 40 mm under a few "
                                    "loads; --capture CAPTURE tells yours."));
}

}  // namespace

void add_effects(CLI::App& app, CommandBody& chosen) {
  CLI::App* command = app.add_subcommand(
      "effects", "The catalogue: what a model may lack, its forms and parameters");
  const auto options = std::make_shared<EffectsCommand>();
  command->add_option("NAME", options->name, "One effect in full (default: a list of all)");
  command->add_option("--capture", options->capture,
                      "Tell forms, units and bounds for this capture");
  command->callback([&chosen, options] {
    chosen = [options](Session& session) { run_effects(*options, session); };
  });
}

}  // namespace hookeye
