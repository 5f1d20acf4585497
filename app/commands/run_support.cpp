#include "app/commands/run_support.h"

#include <algorithm>

#include "app/interrupt.h"
#include "app/progress.h"
#include "estimation/diagnosis/diagnosis_json.h"
#include "runs/report/answer.h"
#include "runs/tables.h"

namespace hookeye {

Warn warn_to(Session& session) {
  return [&session](const std::string& sentence) { session.warn(sentence); };
}

void warn_of_doubts(const Scene& scene, Session& session) {
  warn_of_doubts(scene, warn_to(session));
}

Bench open_capture(const std::filesystem::path& path, Session& session, const Limits& limits) {
  return open_capture(path, warn_to(session), limits);
}

Step newest_step(const Run& run, Bench& bench) { return newest_step(run, bench, fit_options()); }

FitOptions fit_options() {
  FitOptions options;
  options.cancel = &interrupted();
  auto progress = std::make_shared<Progress>("fit", 0);
  options.progress = [progress](const FitProgress& now) {
    progress->set(now.iteration, now.of,
                  now.chi > 0.0 ? fmt::format("{}, misfit {:.3f}", now.stage, now.chi) : now.stage);
  };
  return options;
}

DiagnosisOptions diagnosis_options() {
  DiagnosisOptions options;
  options.cancel = &interrupted();
  auto progress = std::make_shared<Progress>("diagnose", 0);
  options.progress = [progress](int done, int of) {
    progress->set(done, of, "loads solved and compared");
  };
  return options;
}

DiscoverOptions discover_options() {
  DiscoverOptions options;
  options.fit = fit_options();
  options.diagnosis = diagnosis_options();
  return options;
}

void tell_free_form(const Run& run, Bench& bench, const Step& step, Session& session) {
  auto fields = tell_free_form(run, bench, step, &interrupted());
  if (fields.empty()) return;
  session.document["free_form"] = to_json(fields);
  fields.resize(std::min(fields.size(), kDrawnFreeForms));
  session.say("{}", wrapped("no effect of the catalogue explains what is left. Forces that would "
                            "show where to look, whatever they stand for:"));
  for (const FreeForm& field : fields) session.say("{}", wrapped("- " + field.sentence));
  session.say("for ParaView: {}\n", (run.steps().back() / "free_form.vtu").string());
}

void say_answer(const Run& run, Session& session) {
  const nlohmann::json answer = answer_of(run.folder(), run.timeline());
  session.document["answer"] = answer;
  session.say("{}", answer_text(answer));
}

void say_pictures(const std::filesystem::path& step, const Session& session) {
  const auto compared = step / "compare";  // removed by hand, or of forces and positions alone
  if (!std::filesystem::exists(compared) || std::filesystem::is_empty(compared)) return;
  session.say("pictures: {}\n", compared.string());
  if (std::filesystem::exists(step / "removed"))
    session.say("          what effects would remove:\n          {}\n",
                (step / "removed").string());
}

}  // namespace hookeye
