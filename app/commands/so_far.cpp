#include "app/commands/so_far.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "app/invocation.h"
#include "runs/report/answer.h"
#include "runs/tables.h"

namespace hookeye {
namespace {

using nlohmann::json;

constexpr size_t kMostTold = 3;  // of a kind: the run's files have all

/// "3.1 on fitted, 2.9 on held-out ones".
std::string both(double fitted, double held_out) {
  return held_out > 0.0
             ? fmt::format("{} fitted, {} held out", chi_text(fitted), chi_text(held_out))
             : chi_text(fitted);
}

std::string refits_in_words(std::vector<EndedRefit> refits) {
  std::sort(refits.begin(), refits.end(), [](const EndedRefit& a, const EndedRefit& b) {
    return std::max(a.fitted, a.held_out) < std::max(b.fitted, b.held_out);
  });
  std::vector<std::string> told;
  for (const EndedRefit& one : refits)
    if (told.size() < kMostTold)
      told.push_back(fmt::format("with {} {}", one.effect, both(one.fitted, one.held_out)));
  return fmt::format("refitted since, which is no step yet (normalised residual): {}",
                     fmt::join(told, "; "));
}

/// Of the newest step's diagnosis, which stands with the likeliest first; "": none stands out.
std::string leaders(const json& step) {
  std::vector<std::string> told;
  for (const json& one : step.value("diagnosis", json::array())) {
    if (told.size() == kMostTold || !one.value("named", false)) continue;
    told.push_back(
        fmt::format("{} (log Bayes factor {:.1f}, would remove {:.0f} % of the excess misfit)",
                    one.at("effect").get<std::string>(), number_in(one, "evidence"),
                    100.0 * number_in(one, "explains")));
  }
  return told.empty() ? "" : fmt::format("{}", fmt::join(told, ", "));
}

}  // namespace

SoFar::SoFar(SearchRequest& wanted) {
  wanted.refitted = [this](const EndedRefit& refit) {
    std::erase_if(refits_, [&](const EndedRefit& one) { return one.effect == refit.effect; });
    refits_.push_back(refit);
  };
  wanted.step = [this](const Step&) { refits_.clear(); };
}

void SoFar::say(const Run& run, const std::string& folder, const Session& session) const {
  const json& timeline = run.timeline();
  const json steps = timeline.value("steps", json::array());
  if (steps.empty()) {
    session.say("so far: no model is fitted yet\n");
  } else {
    const json& newest = steps.back();
    const json answer = answer_of(run.folder(), timeline);
    session.say("so far, with nothing settled:\n{}", material_text(answer.at("material")));
    session.say("{}", wrapped(fmt::format("model of the newest step, {}: {}",
                                          newest.at("name").get<std::string>(),
                                          answer.at("misfit").get<std::string>())));
    if (!refits_.empty()) session.say("{}", wrapped(refits_in_words(refits_)));
    const std::string lead = leaders(newest);
    session.say("{}",
                wrapped(lead.empty() ? "no effect stands out beyond chance in its diagnosis"
                                     : fmt::format("what leads by one linear step, and refits are "
                                                   "to decide: {}",
                                                   lead)));
  }
  session.say("run: {}\n", folder);
  session.say("{}", wrapped("go on, with what was worked out: " + invocation()));
}

}  // namespace hookeye
