// Fits, trials and diagnoses as questions to an archive, and their answers. Internal to those.
#pragma once

#include <atomic>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "estimation/evaluation/evaluation.h"
#include "estimation/fit/archive.h"
#include "estimation/fit/fit.h"

namespace hookeye {

/// About the form at p: ingredients with their variants, bounds and starts, the mesh, and which
/// examples are held out. Numbers are in units of what matters. (The rest of the capture is what
/// the whole archive is about.)
Question question_of(const std::string& kind, const ModelForm& form, const VectorXd& p);

/// Where the examples are, in every bit: what is asked next begins there.
nlohmann::json states_json(const Evaluation& evaluation);
/// `before` with the examples that are told where they are told.
Workspace::Place place_from(const nlohmann::json& states, Workspace::Place before);

nlohmann::json vector_json(const VectorXd& v);
VectorXd vector_from(const nlohmann::json& list);

nlohmann::json failure_json(const NumericalFailure& failure);
std::optional<NumericalFailure> failure_from(const nlohmann::json& answer);

/// What is asked at p, and where from.
struct WorkedOut {
  Workspace& workspace;
  const ModelForm& form;
  const VectorXd& p;
  const std::atomic<bool>* cancel;
  std::function<Question()> question;
  /// It is the same wherever it is asked from: of a model's own equilibria, which a fit asks where
  /// it ends and whoever reads of that fit asks where it began.
  bool anywhere = false;
};

/// Where a question of a form of `scene` is asked from: from rest where the workspace was
/// elsewhere.
Workspace::Place place_in(const Workspace& workspace, const std::shared_ptr<const Scene>& scene);

/// A fit leaves the workspace in its own equilibria; whatever else was asked, where it was.
inline Workspace::Place place_after(const Workspace::Place& before, const auto&) { return before; }
Workspace::Place place_after(Workspace::Place before, const Fitted& fitted);

/// Mark of the equilibria in it.
std::string mark_of(const Workspace::Place& place);

/// A question while it is worked out: whatever ends that, the next one may take it up.
class AtWork {
 public:
  AtWork(Archive* archive, const std::optional<Question>& question)
      : archive_(archive), question_(question) {}
  AtWork(const AtWork&) = delete;
  AtWork& operator=(const AtWork&) = delete;
  ~AtWork() {
    if (archive_) archive_->leave(*question_);
  }

 private:
  Archive* archive_;
  const std::optional<Question>& question_;
};

/// The answer of the workspace's archive; else that of `work`, which the archive keeps unless it
/// was cancelled, or found no memory. `read` may return nothing: then it is worked out. Whichever
/// it was, answer and workspace are the same bits.
template <class T, class Work, class Write, class Read>
Result<T> archived(const WorkedOut& asked, const Work& work, const Write& write, const Read& read) {
  Archive* archive = asked.workspace.archive();
  const Workspace::Place place = place_in(asked.workspace, asked.form.scene);
  asked.workspace.start_from(place);
  const auto leave = [&](Result<T> result) {
    asked.workspace.start_from(result ? place_after(place, *result) : place);
    return result;
  };
  std::optional<Question> question;
  nlohmann::json known;
  if (archive) {
    question.emplace(asked.question());
    if (!asked.anywhere) question->from = mark_of(place);
    if (archive->find(*question, known, asked.cancel)) {
      if (auto failure = failure_from(known)) return leave(no_result(*std::move(failure)));
      if (std::optional<Result<T>> result = read(known)) return leave(std::move(*result));
      asked.workspace.start_from(place);
    }
  }
  const AtWork turn(archive, question);
  Result<T> result = work();
  const bool answered = result || result.error().kind == NumericalFailure::Kind::numbers;
  if (archive && answered && !(asked.cancel && *asked.cancel))
    archive->keep(*question, result ? write(*result) : failure_json(result.error()));
  return leave(std::move(result));
}

}  // namespace hookeye
