#include "runs/fit_base.h"

#include <spdlog/spdlog.h>

#include "estimation/model/additive_material.h"
#include "estimation/search/progressive.h"
#include "runs/failed.h"
#include "runs/record.h"

namespace hookeye {
namespace {

/// The textbook law first, where it can move; then the same energy told additively, refined.
Fitted fit_additive(Bench& bench, const ModelForm& form, const VectorXd& p,
                    const FitOptions& fit_options) {
  const bool own = has_additive(form);
  std::vector<AdditiveStart> starts = {own ? AdditiveStart(form, p) : to_additive(form, p)};
  if (!own && form.size() > 0) {
    const Fitted base = value_or_fail(fit(bench.workspace, form, p, fit_options));
    for (int i = 0; i < base.p.size(); ++i)
      spdlog::info("the law by itself: {} {:.5g} {}", form.parameters()[i].name, base.p[i],
                   form.parameters()[i].unit);
    starts.insert(starts.begin(), to_additive(form, base.p));
  }
  ProgressiveOptions options;
  options.fit = fit_options;
  return value_or_fail(fit_progressive(bench.workspace, starts, options));
}

}  // namespace

Step fit_base(Run& run, Bench& bench, const BaseFit& wanted, const FitOptions& options,
              const std::function<void(const Step&)>& finished) {
  Step step;
  step.name = "base";
  step.fitted = wanted.additive || has_additive(wanted.form)
                    ? fit_additive(bench, wanted.form, wanted.start, options)
                    : value_or_fail(fit(bench.workspace, wanted.form, wanted.start, options));
  if (finished) finished(step);
  record(run, step, wanted.command);
  const Floor floor = measure_floor(*step.fitted.form.scene, step.fitted.evaluation);
  run.update([&](nlohmann::json& timeline) { tell_floor(timeline, floor); });
  record_all_pixels(run, bench, step, options);
  return step;
}

}  // namespace hookeye
