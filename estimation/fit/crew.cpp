#include "estimation/fit/crew.h"

#include <fmt/format.h>

#include "core/fingerprint.h"
#include "estimation/fit/archived.h"

namespace hookeye {
namespace {

/// Machines may round differently: what differs by that is one task.
std::string key_of(const Question& task) {
  std::string text = task.kind + "\n" + task.text;
  for (const double number : task.numbers) text += fmt::format(" {:.4g}", number);
  const std::string mark = fingerprint_of(text);
  return mark.substr(mark.find(':') + 1);
}

}  // namespace

Question task_on(const std::string& kind, const ModelForm& form, const VectorXd& p) {
  return question_of(kind, form, p);
}

FitOptions untold(FitOptions options) {
  options.decided = nullptr;
  return options;
}

SideBySide::SideBySide(Workspace& workspace) : workspace_(workspace), place_(workspace.place()) {}

SideBySide::~SideBySide() {
  if (Archive* archive = workspace_.archive(); archive && !archive->in_task())
    archive->drop_results();
}

void SideBySide::begin() const { workspace_.start_from(place_); }

void SideBySide::ask_ahead(const std::vector<Question>& tasks,
                           const std::function<void(size_t)>& ask) const {
  Archive* archive = workspace_.archive();
  if (!archive || !archive->crew() || archive->in_task() || tasks.size() < 2) return;
  std::vector<std::string> keys;
  for (const Question& task : tasks) keys.push_back(key_of(task));
  archive->crew()->share(keys, [&](size_t i) {
    const Archive::Task at_work(*archive);
    begin();
    ask(i);
  });
  begin();
}

}  // namespace hookeye
