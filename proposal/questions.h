// What no file tells: questions with a default, each answered by --set NAME=VALUE.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace hookeye {

struct CaptureQuestion {
  std::string name = {};                  ///< of --set NAME=VALUE
  std::string text = {};                  ///< what is asked
  std::string standard = {};              ///< the answer where none is given; "": there is none
  std::string why = {};                   ///< where the default comes from
  std::vector<std::string> choices = {};  ///< empty: free
  bool asked = true;  ///< false: a file told it, or a choice that is seldom changed
  bool answered = false;
  std::string answer = {};  ///< told, or the default
};

/// Collects the questions of one proposal, in order.
class Questions {
 public:
  using Answers = std::map<std::string, std::string>;
  /// At most as many are asked; of later ones the default is taken.
  static constexpr size_t kMost = 10;

  explicit Questions(Answers answers) : answers_(std::move(answers)) {}

  /// The answer, or the default; "" where there is neither, which needs_answer() then tells. Throws
  /// InputError where the answer is none of the choices.
  std::string ask(CaptureQuestion question);
  /// The same of a finite number.
  double ask_number(CaptureQuestion question, bool above_zero = false);
  const std::vector<CaptureQuestion>& all() const { return questions_; }
  /// Asked and not answered.
  std::vector<CaptureQuestion> open() const;
  /// Not answered and without a default: nothing can be proposed without them.
  std::vector<CaptureQuestion> needed() const;
  /// Throws InputError for an answer to a question that does not exist.
  void expect_no_other() const;

 private:
  Answers answers_;
  std::vector<CaptureQuestion> questions_;
};

/// Of an answer that cannot be: names --set NAME=VALUE.
[[noreturn]] void refuse_answer(const std::string& name, const std::string& value,
                                const std::string& right);

}  // namespace hookeye
