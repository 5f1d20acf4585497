// hookeye explain: why an effect was added, or where its way ended, from the log alone.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "app/commands/commands.h"
#include "app/commands/run_support.h"
#include "core/json_file.h"
#include "core/text_file.h"
#include "runs/add_step.h"
#include "runs/decision_log.h"
#include "runs/report/answer.h"
#include "runs/tables.h"

namespace hookeye {
namespace {

struct ExplainArguments {
  std::string run, effect;
  bool scores = false;
};

/// {where it was accepted, where not}
std::pair<const char*, const char*> words_of(Asked asked) {
  switch (asked) {
    case Asked::named:
      return {"stands out", "does not stand out"};
    case Asked::screened:
      return {"screened", "not screened further"};
    case Asked::refitted:
      return {"refitted", "not refitted"};
    case Asked::ranked:
      return {"says most", "says less than the best"};
    case Asked::stands:
      return {"stands", "refused"};
    case Asked::widened:
      return {"this form was taken", "this form was not taken"};
    case Asked::dropped:
      return {"left the model", "stays in the model"};
    case Asked::swapped:
      return {"took its place", "did not take its place"};
    case Asked::tied:
      return {"cannot be told from it", "can be told from it"};
    case Asked::paired:
      return {"stand together", "do not stand together"};
    case Asked::ended:
      return {"explained", "not explained"};
    case Asked::scored:
      return {"best by the score in the shadow", "not the best by the score in the shadow"};
  }
  return {"yes", "no"};
}

/// "refused: ... (log Bayes factor 2.1; to be named it takes 5: diagnosis.nameable)
/// [estimation/search/contest.cpp:270]".
std::string in_words(const Decision& one) {
  const auto [yes, no] = words_of(one.asked);
  std::string out = fmt::format("{}: {}", one.accepted ? yes : no, one.why);
  const std::string number = number_in_words(one);
  if (!number.empty())
    out += fmt::format(" ({}{})", number, one.by.option.empty() ? "" : ": " + one.by.option);
  else if (!one.by.option.empty())
    out += fmt::format(" ({})", one.by.option);
  return out + fmt::format(" [{}]", one.where);
}

/// The floor that a step's own diagnosis was made with; else that of its figures. 0: neither tells.
double floor_of_step(const std::filesystem::path& step) {
  for (const char* name : {"diagnosis.json", "metrics.json"}) {
    if (!std::filesystem::exists(step / name)) continue;
    std::string damage;  // whoever asks for that file hears of it
    const auto told = parse_json(read_text(step / name), damage);
    if (!told || !told->is_object() || !told->contains("floor")) continue;
    if (const double floor = number_in(told->at("floor"), "chi"); floor > 0.0) return floor;
  }
  return 0.0;
}

/// What the numbers of a step are held against.
std::string heading(const nlohmann::json& timeline, size_t index,
                    const std::filesystem::path& folder, const std::string& seen) {
  const nlohmann::json& told = timeline.at("steps").at(index);
  const double fitted = number_in(told, "chi_fit"), held_out = number_in(told, "chi_validate");
  const double floor = floor_of_step(folder);
  std::string out =
      fmt::format("beyond the model of step {}: its normalised residual is {} on fitted {}",
                  folder.filename().string(), chi_text(fitted), seen);
  if (held_out > 0.0) out += fmt::format(", {} on held-out ones", chi_text(held_out));
  if (floor > 0.0) out += fmt::format("; noise floor {:.3f}", floor);
  return wrapped(out);
}

constexpr const char* kHowToRead =
    "An effect stands out where one linear step tells it from noise. Those that do are screened "
    "(a step or two of a refit), the best refitted to the end, and ranked. The first "
    "stands if it says enough. In brackets: its number, what that is held against and the option "
    "behind it; then the line of the sources.";

/// "creep" of "creep as 'levels off'", of "gravity and creep": whom a decision is about.
bool is_about(const Decision& one, const std::string& effect) {
  const std::string padded = " " + one.candidate + " ";
  return padded.find(" " + effect + " ") != std::string::npos;
}

/// Every decision of one effect, in order.
std::string all_of(const std::vector<Decision>& decisions, const ExplainArguments& asked) {
  const std::string& effect = asked.effect;
  std::string out;
  for (const Decision& one : decisions)
    if (is_about(one, effect) && (asked.scores || one.asked != Asked::scored))
      out += wrapped((one.candidate == effect ? "" : one.candidate + ": ") + in_words(one), 2);
  return out;
}

/// Where the way of each candidate ended; those that did not stand out are counted alone.
std::string ends_of(const std::vector<Decision>& decisions) {
  std::vector<const Decision*> last;
  for (const Decision& one : decisions) {
    if (one.asked == Asked::scored) continue;  // how_sure()
    const auto same = std::find_if(last.begin(), last.end(), [&](const Decision* other) {
      return other->candidate == one.candidate;
    });
    if (same == last.end())
      last.push_back(&one);
    else
      *same = &one;
  }
  const auto cost = [&](const std::string& candidate) {
    double sum = 0.0;
    for (const Decision& one : decisions) sum += one.candidate == candidate ? one.cpu_s : 0.0;
    return sum >= 0.05 ? fmt::format(" ({:.1f} CPU-s)", sum) : std::string();
  };
  std::string out;
  size_t silent = 0;
  for (const Decision* one : last) {
    if (one->asked == Asked::named && !one->accepted) {
      ++silent;
      continue;
    }
    out += wrapped((one->candidate.empty() ? "the search ended" : one->candidate) +
                       cost(one->candidate) + ", " + in_words(*one),
                   2);
  }
  if (silent)
    out += fmt::format("  {} effects do not stand out (hookeye explain RUN EFFECT tells why)\n",
                       silent);
  return out;
}

/// The models that were fitted beyond a step's, by falling score; "": none was scored.
std::string how_sure(const std::vector<Decision>& decisions) {
  std::vector<const Decision*> scored;
  for (const Decision& one : decisions)
    if (one.asked == Asked::scored && one.parts.contains("sure") &&
        one.parts.contains("below_best"))
      scored.push_back(&one);
  if (scored.size() < 2) return {};
  std::stable_sort(scored.begin(), scored.end(), [](const Decision* a, const Decision* b) {
    return a->parts.at("below_best") > b->parts.at("below_best");
  });
  std::string out = wrapped(
      "How sure, by a score that decides nothing yet (share among all models fitted so far; log "
      "evidence below the best; the present score over this step's model):");
  for (const Decision* one : scored) {
    const auto old = one->parts.find("old");
    out +=
        wrapped(fmt::format("{}: {:.1f} %, {:.1f}{}",
                            one->candidate.empty() ? "the capture's own model" : one->candidate,
                            100.0 * one->parts.at("sure"), one->parts.at("below_best"),
                            old == one->parts.end() ? "" : fmt::format("; {:+.1f}", old->second)),
                2);
  }
  return out;
}

void run_explain(const ExplainArguments& arguments, Session& session) {
  if (!arguments.effect.empty()) check_effect(arguments.effect);
  const Run run = open_run(arguments.run, false);
  session.document["steps"] = nlohmann::json::array();
  bool any = false, about = false, scored = false;
  const auto steps = run.steps();
  for (size_t index = 0; index < steps.size(); ++index) {
    const auto& step = steps[index];
    const std::vector<Decision> decisions = decisions_of(step);
    any = any || !decisions.empty();
    nlohmann::ordered_json told = {{"step", step.filename().string()},
                                   {"decisions", nlohmann::json::array()}};
    for (const Decision& one : decisions)
      if (arguments.effect.empty() || is_about(one, arguments.effect))
        told["decisions"].push_back(nlohmann::ordered_json(to_json(one)));
    session.document["steps"].push_back(std::move(told));
    const std::string sure = how_sure(decisions);
    scored = scored || !sure.empty();
    const std::string text = arguments.effect.empty()
                                 ? ends_of(decisions) + (arguments.scores ? sure : "")
                                 : all_of(decisions, arguments);
    if (text.empty()) continue;
    if (!about) session.say("{}\n", wrapped(kHowToRead));
    about = true;
    session.say("{}{}\n", heading(run.timeline(), index, step, seen_in_step(run.folder(), step)),
                text);
  }
  if (scored && !arguments.scores)
    session.say("`hookeye explain {} --scores` adds a second score, which decides nothing yet\n",
                arguments.run);
  if (!any)
    throw InputError({arguments.run}, "nothing was decided in this run yet",
                     fmt::format("run 'hookeye diagnose {0}' or 'hookeye discover CAPTURE -o {0}'",
                                 arguments.run));
  if (!about) session.say("nothing was asked of {} in this run\n", arguments.effect);
}

}  // namespace

void add_explain(CLI::App& app, CommandBody& chosen) {
  CLI::App* command =
      app.add_subcommand("explain", "Why an effect was added or refused: the number and its line");
  const auto arguments = std::make_shared<ExplainArguments>();
  command->add_option("RUN", arguments->run, "Run folder")->required();
  command->add_option("EFFECT", arguments->effect, "All that was decided of this effect");
  command->add_flag("--scores", arguments->scores,
                    "Also a second score of all fitted models, which decides nothing yet");
  command->callback([&chosen, arguments] {
    chosen = [arguments](Session& session) { run_explain(*arguments, session); };
  });
}

}  // namespace hookeye
