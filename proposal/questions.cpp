#include "proposal/questions.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/input_error.h"
#include "proposal/text_table.h"

namespace hookeye {

void refuse_answer(const std::string& name, const std::string& value, const std::string& right) {
  throw InputError({fmt::format("--set {}={}", name, value)}, "this is no answer", right);
}

std::string Questions::ask(CaptureQuestion question) {
  const auto told = answers_.find(question.name);
  question.answered = told != answers_.end();
  question.answer = question.answered ? told->second : question.standard;
  const auto& choices = question.choices;
  if (question.answered && !choices.empty() &&
      std::find(choices.begin(), choices.end(), question.answer) == choices.end()) {
    const std::string near = nearest_name(question.answer, choices);
    refuse_answer(question.name, question.answer,
                  near.empty() ? fmt::format("one of {}", fmt::join(choices, ", "))
                               : fmt::format("did you mean `{}`?", near));
  }
  const auto asked = std::count_if(questions_.begin(), questions_.end(),
                                   [](const CaptureQuestion& one) { return one.asked; });
  if (static_cast<size_t>(asked) >= kMost && !question.standard.empty()) question.asked = false;
  questions_.push_back(question);
  return question.answer;
}

double Questions::ask_number(CaptureQuestion question, bool above_zero) {
  const std::string name = question.name;
  const std::string answer = ask(std::move(question));
  if (answer.empty()) return above_zero ? 1.0 : 0.0;
  const auto value = number_in(answer, false);
  if (!value || (above_zero && *value <= 0))
    refuse_answer(name, answer, above_zero ? "a number above zero" : "a number");
  return *value;
}

std::vector<CaptureQuestion> Questions::open() const {
  std::vector<CaptureQuestion> out;
  for (const CaptureQuestion& one : questions_)
    if (one.asked && !one.answered) out.push_back(one);
  return out;
}

std::vector<CaptureQuestion> Questions::needed() const {
  std::vector<CaptureQuestion> out;
  for (const CaptureQuestion& one : questions_)
    if (!one.answered && one.standard.empty()) out.push_back(one);
  return out;
}

void Questions::expect_no_other() const {
  std::vector<std::string> names;
  for (const CaptureQuestion& one : questions_) names.push_back(one.name);
  for (const auto& [name, value] : answers_) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    const std::string near = nearest_name(name, names);
    throw InputError({fmt::format("--set {}={}", name, value)}, "nothing of this name is asked",
                     near.empty() ? fmt::format("one of {}", fmt::join(names, ", "))
                                  : fmt::format("did you mean `{}`?", near));
  }
}

}  // namespace hookeye
