#include "estimation/search/conclusion.h"

#include <algorithm>

#include "capture_io/seen_in_words.h"
#include "estimation/search/verdict.h"

namespace hookeye {

namespace {

/// What speaks against photos that are at the floor.
std::string in_doubt(const Discovery& out, const std::vector<Contested>& run) {
  const Step& last = out.steps.back();
  // What was taken back took nothing, however its refits round.
  const bool named = !std::all_of(out.missing.begin(), out.missing.end(), numerical);
  std::string stays;
  if (named) stays = more_stays(last.fitted, last.diagnosis, taken_by_names(run, out.floor));
  return stays.empty() ? moved_at_rest(last.fitted, last.diagnosis) : stays;
}

}  // namespace

void settle_tie(std::vector<std::string>& tie, const std::vector<std::string>& missing) {
  const auto has = [&](const std::string& name) {
    return std::find(missing.begin(), missing.end(), name) != missing.end();
  };
  if (!tie.empty() && (!has(tie.front()) || std::any_of(tie.begin() + 1, tie.end(), has)))
    tie.clear();
}

void conclude(Discovery& out, const std::vector<Contested>& run, const Refusal& refused,
              const Decided& decided) {
  std::string why;
  const Step& last = out.steps.back();
  const FitToAll* all = out.all ? &*out.all : nullptr;
  out.missing = effects_in(last.fitted.form);
  settle_tie(out.tie, out.missing);
  out.verdict = judge(last.fitted, last.diagnosis, out.tie, &why, all);
  if (out.verdict != Verdict::unexplained && !all)
    if (const std::string doubt = in_doubt(out, run) + not_compared(run, out.missing);
        !doubt.empty())
      out.verdict = Verdict::unexplained, why += doubt;
  if (out.verdict == Verdict::unexplained) out.untold = cannot_be_told(last.diagnosis);
  out.sentence = say(out.verdict, out.missing, out.tie, why, refused.words(), out.untold,
                     seen_in_words(last.fitted.form.scene->capture));
  tell(decided,
       {Asked::ended,
        "",
        out.verdict == Verdict::explained,
        {last.fitted.evaluation.chi(false), out.floor.limits->floor.at * out.floor.chi, "floor.at"},
        out.sentence});
}

}  // namespace hookeye
