#include "runs/search.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "capture_io/seen_in_words.h"
#include "estimation/output/step_json.h"
#include "estimation/search/tested.h"
#include "runs/decision_log.h"
#include "runs/failed.h"
#include "runs/record.h"
#include "runs/tables.h"

namespace hookeye {
namespace {

/// "12 s", "4 min".
std::string seconds_in_words(double seconds) {
  constexpr double kMinute = 60.0;
  return seconds < 2.0 * kMinute ? fmt::format("{:.2g} s", seconds)
                                 : fmt::format("{:.0f} min", seconds / kMinute);
}

/// The run has a step that the search, taken up, does not come to: made by another hand, or by
/// another way of rounding.
struct OtherStep {};

/// The step of the timeline is this one, but for rounding.
bool same_step(const nlohmann::json& told, const Step& step) {
  const nlohmann::json now = timeline_entry(step);
  for (const char* key : {"name", "added", "dropped", "effects"})
    if (told.value(key, nlohmann::json()) != now.at(key)) return false;
  const nlohmann::json &were = told.at("parameters"), &are = now.at("parameters");
  return std::equal(were.begin(), were.end(), are.begin(), are.end(), [](auto& was, auto& is) {
    const double value = number_in(was, "value"), other = number_in(is, "value");
    const double interval = number_in(was, "high") - number_in(was, "low");
    const double rounding = 1e-6 * (std::abs(value) + std::abs(other));
    return was.at("name") == is.at("name") &&
           std::abs(value - other) <= std::max(rounding, 0.01 * interval);
  });
}

/// Steps as the search comes to them: what the run has already stays as it is.
class Recorder {
 public:
  /// `from`: the step that the search goes on from, which has no diagnosis yet; -1: none.
  Recorder(Run& run, Bench& bench, DecisionLog& log, int from, const SearchRequest& wanted)
      : run_(run),
        bench_(bench),
        log_(log),
        wanted_(wanted),
        from_(from),
        next_(static_cast<size_t>(std::max(from, 0))) {}

  void operator()(const Step& step) {
    const size_t index = next_++;
    if (index >= run_.steps().size()) {
      record(run_, whole(step), wanted_.command, true);
    } else if (!same_step(run_.timeline().at("steps").at(index), step)) {
      throw OtherStep{};
    } else if (from_ >= 0 && index + 1 == run_.steps().size() && index == size_t(from_)) {
      record_diagnosis(run_, whole(step));
    }
    log_.follow(run_.steps().at(index));
    if (wanted_.step) wanted_.step(step);
  }

 private:
  Step whole(const Step& step) { return with_displaced(bench_, step, wanted_.options.fit.cancel); }

  Run& run_;
  Bench& bench_;
  DecisionLog& log_;
  const SearchRequest& wanted_;
  int from_;
  size_t next_;
};

/// "normalised residual 1.039 on fitted photos (4.334 without it), 1.036 on held-out ones (3.988);
/// noise floor 0.998". Before nothing was added there is no `without`.
struct Residuals {
  double fitted = 0.0, held_out = 0.0;
};
std::string residuals_in_words(const Residuals& now, const std::optional<Residuals>& without,
                               double floor, const Scene& scene) {
  std::string out = fmt::format("normalised residual {} on fitted {}", chi_text(now.fitted),
                                seen_in_words(scene.capture));
  if (without) out += fmt::format(" ({} without it)", chi_text(without->fitted));
  if (now.held_out > 0.0) {
    out += fmt::format(", {} on held-out ones", chi_text(now.held_out));
    if (without) out += fmt::format(" ({})", chi_text(without->held_out));
  }
  return out + (floor > 0.0 ? fmt::format("; noise floor {:.3f}", floor) : "; noise floor unknown");
}

Residuals residuals_of(const Evaluation& evaluation) {
  return {evaluation.chi(false), evaluation.chi(true)};
}

void say_step(const Step& step, const std::optional<Residuals>& without) {
  spdlog::info("step {}: {}", name_of(step),
               residuals_in_words(residuals_of(step.fitted.evaluation), without,
                                  step.diagnosis.floor.chi, *step.fitted.form.scene));
  bool announced = false;
  for (const auto& effect : step.diagnosis.effects) {
    if (!nameable(effect, step.diagnosis)) continue;
    if (!std::exchange(announced, true))
      spdlog::info(
          "  what stands out by one linear step (a log Bayes factor of {:.3g} does; refits "
          "decide):",
          std::max(step.diagnosis.gate, step.diagnosis.limits().nameable));
    spdlog::info("  {}: log Bayes factor {:.1f}, {}", effect.effect, effect.evidence, effect.why);
  }
}

/// What this machine took for the first fit of this capture: the rest is some of these.
void say_how_long(double seconds) {
  spdlog::info(
      "  the first fit and its diagnosis took {}; the whole search takes several times that",
      seconds_in_words(seconds));
}

DiscoverEvents events(Run& run, Bench& bench, DecisionLog& log, int from, bool known,
                      const SearchRequest& wanted) {
  auto recorder = std::make_shared<Recorder>(run, bench, log, from, wanted);
  /// What refits are held against: the newest step.
  struct Newest {
    std::optional<Residuals> residuals;
    double floor = 0.0;
  };
  auto newest = std::make_shared<Newest>();
  DiscoverEvents events;
  // Of a search that is taken up again the first fit is read and not made.
  std::optional<std::chrono::steady_clock::time_point> begun;
  if (from < 0 && !known) begun = std::chrono::steady_clock::now();
  events.step = [recorder, newest, begun](const Step& step) mutable {
    (*recorder)(step);
    say_step(step, !step.added.empty() ? newest->residuals : std::nullopt);
    if (begun)
      say_how_long(
          std::chrono::duration<double>(std::chrono::steady_clock::now() - *begun).count());
    begun.reset();
    *newest = {residuals_of(step.fitted.evaluation), step.diagnosis.floor.chi};
  };
  events.tried = [](const Racer& racer) {
    spdlog::info("screening of {}{}: {}", racer.effect, on_half_size(racer.form.scene->capture),
                 residuals_in_words({racer.trial.chi_fit, racer.trial.chi_validate},
                                    Residuals{racer.start.chi, racer.start.chi_validate},
                                    racer.start.floor, *racer.form.scene));
  };
  events.refitting = [](const std::string& effect) { spdlog::info("refit with {}", effect); };
  events.refitted = [newest, told = wanted.refitted](const std::string& effect,
                                                     const Result<Fitted>& result) {
    if (result && told) told({effect, result->evaluation.chi(false), result->evaluation.chi(true)});
    if (result)
      spdlog::info("  with {}: {}", effect,
                   residuals_in_words(residuals_of(result->evaluation), newest->residuals,
                                      newest->floor, *result->form.scene));
    else if (const NumericalFailure& failure = result.error(); !cancelled(failure))
      spdlog::info("  {}: given up, {}{}", effect, failure.reason,
                   failure.example.empty() ? "" : fmt::format(" in '{}'", failure.example));
  };
  return events;
}

/// The step that the search of this run goes on from, -1 where it makes the base itself: where it
/// was taken up before, if what it came to is known still. With all that was asked in between it
/// then takes the same way.
int begin(Run& run, const DiscoverOptions& options, bool known) {
  const int last = static_cast<int>(run.steps().size()) - 1;
  const nlohmann::json asked = {{"without", options.diagnosis.without}};
  const nlohmann::json told = run.timeline().value("search", nlohmann::json::object());
  if (known && told.contains("from") && told.value("asked", nlohmann::json()) == asked &&
      told.at("from") <= last)
    return told.at("from");
  run.update([&](auto& timeline) { timeline["search"] = {{"from", last}, {"asked", asked}}; });
  return last;
}

}  // namespace

Discovery search_anew(const Run& run, Bench& bench, int from, DiscoverOptions options,
                      const DiscoverEvents& events) {
  for (int i = 0; i <= from; ++i) {
    const nlohmann::json& step = run.timeline().at("steps").at(static_cast<size_t>(i));
    if (auto tied = tied_in(step, *bench.scene->limits); tied.size() > 1)
      options.tie = std::move(tied);
    options.past.push_back(contested_in(step));
  }
  const ModelForm form = base_form(bench.scene);
  return value_or_fail(
      from < 0 ? discover(bench.workspace, form, form.initial(), options, events)
               : discover_from(bench.workspace,
                               step_of(run, bench, static_cast<size_t>(from), options.fit), options,
                               events));
}

namespace {

Discovery search_from(int from, bool known, Run& run, Bench& bench, const SearchRequest& wanted) {
  if (wanted.begun) wanted.begun(from);
  DiscoverOptions options = wanted.options;
  DecisionLog log(run);
  options.fit.decided = [&log](const Decision& decision) {
    log(decision);
    if (decision.asked == Asked::stands)
      spdlog::info("decided: {} {}: {} ({})", decision.candidate,
                   decision.accepted ? "is added" : "is not added", decision.why,
                   number_in_words(decision));
  };
  return search_anew(run, bench, from, options, events(run, bench, log, from, known, wanted));
}

/// `known`: something of it was worked out before.
Discovery search(Run& run, Bench& bench, const SearchRequest& wanted, bool known) {
  try {
    return search_from(begin(run, wanted.options, known), known, run, bench, wanted);
  } catch (const OtherStep&) {
    spdlog::info("the search goes on from the newest step");
    return search_from(begin(run, wanted.options, false), true, run, bench, wanted);
  }
}

/// What is left of examples that nothing has seen, once the verdict is written: nothing that comes
/// of it changes or loses that.
void tell_tested(Run& run, const Bench& bench, const Fitted& last, const SearchRequest& wanted) {
  const auto result = test(last, bench.capture, wanted.options.fit);
  if (!result) {
    if (cancelled(result.error())) fail(result.error());
    if (wanted.warn)
      wanted.warn(fmt::format("example '{}' of use: test could not be predicted: {}",
                              result.error().example, result.error().reason));
  } else if (const auto& tested = *result) {
    run.update([&](nlohmann::json& timeline) { timeline["tested"] = to_json(*tested); });
  }
}

}  // namespace

Discovery discover_into(Run& run, Bench& bench, const SearchRequest& wanted, bool known) {
  Discovery found = search(run, bench, wanted, known);
  // What held-out photos alone show there are the values.
  std::string hint = found.all ? ""
                               : too_little_to_name(found.steps.back().diagnosis,
                                                    seen_in_words(bench.scene->capture));
  for (const std::string& told : {high_floor(found.floor), copied_floor(found.floor)})
    if (!told.empty()) hint += (hint.empty() ? "" : ". ") + told;
  run.update([&](nlohmann::json& timeline) {
    timeline.erase("tested");
    timeline["verdict"] = to_string(found.verdict);
    timeline["sentence"] = found.sentence;
    timeline["missing"] = found.missing;
    timeline["tie"] = found.tie;
    timeline["untold"] = found.untold;
    timeline["hint"] = hint;
    timeline.erase("fitted_to_all");
    if (found.all) timeline["fitted_to_all"] = to_json(*found.all);
    tell_floor(timeline, found.floor);
  });
  record_all_pixels(run, bench, found.steps.back(), wanted.options.fit);
  tell_tested(run, bench, found.steps.back().fitted, wanted);
  return found;
}

}  // namespace hookeye
