// Fits, trials and diagnoses as questions to an archive, and their answers. Internal to those.
#pragma once

#include <atomic>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "estimation/archive.h"
#include "estimation/evaluation.h"

namespace hookeye {

/// About the form at p: ingredients with their variants, bounds and starts, the mesh, and which
/// examples are held out. Numbers are in units of what matters. (The rest of the capture is what
/// the whole archive is about.)
Question question_of(const std::string& kind, const ModelForm& form, const VectorXd& p);

/// Where the examples are, in every bit: what is asked next begins there, and another rounding
/// would make other questions of it.
nlohmann::json states_json(const Evaluation& evaluation);
/// Deformed positions by example, 3n each; empty where none is told.
std::vector<VectorXd> states_from(const nlohmann::json& states, const Scene& scene);

nlohmann::json vector_json(const VectorXd& v);
VectorXd vector_from(const nlohmann::json& list);

nlohmann::json failure_json(const NumericalFailure& failure);
std::optional<NumericalFailure> failure_from(const nlohmann::json& answer);

/// The answer of the workspace's archive; else that of `work`, which the archive keeps unless it
/// was cancelled. `read` may return nothing: then it is worked out.
template <class T, class Ask, class Work, class Write, class Read>
std::variant<T, NumericalFailure> archived(Workspace& workspace, const std::atomic<bool>* cancel,
                                           const Ask& ask, const Work& work, const Write& write,
                                           const Read& read) {
  Archive* archive = workspace.archive();
  if (!archive) return work();
  const Question question = ask();
  nlohmann::json answer;
  if (archive->find(question, answer)) {
    if (auto failure = failure_from(answer)) return *failure;
    std::optional<std::variant<T, NumericalFailure>> known = read(answer);
    if (known) return std::move(*known);
  }
  std::variant<T, NumericalFailure> result = work();
  if (cancel && *cancel) return result;
  if (const auto* failure = std::get_if<NumericalFailure>(&result))
    archive->keep(question, failure_json(*failure));
  else
    archive->keep(question, write(std::get<T>(result)));
  return result;
}

}  // namespace hookeye
