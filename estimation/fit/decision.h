// What was decided, by which number and where in the sources: nothing is refused in silence.
#pragma once

#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

namespace hookeye {

/// A line of the sources; as a default argument, that of the caller. (std::source_location, which
/// clang 14 has not.)
struct SourceLine {
  const char* file;
  int line;
  static constexpr SourceLine current(const char* file = __builtin_FILE(),
                                      int line = __builtin_LINE()) {
    return {file, line};
  }
};

/// What was asked of a candidate.
enum class Asked {
  named,     ///< does it stand out of the residual?
  screened,  ///< does it run, at half size, and how far does it get?
  refitted,  ///< is it worth a fit to the end?
  ranked,    ///< which of the refits says most?
  stands,    ///< may the best be added?
  widened,   ///< does a wider form say more?
  dropped,   ///< can the model do without it?
  swapped,   ///< does another stand better in its place?
  tied,      ///< can it be told from the one that was chosen?
  paired,    ///< do two together explain what one does not?
  ended,     ///< how did the search end?
  scored,    ///< what is the model worth by the score that decides nothing yet (score.h)?
};
const char* to_string(Asked asked);

/// A number and what it was held against.
struct Compared {
  double value = std::numeric_limits<double>::quiet_NaN();
  double limit = std::numeric_limits<double>::quiet_NaN();
  std::string option;  ///< that the limit follows from: "search.worth_a_name"; "": none

  Compared() = default;
  Compared(double value_, double limit_, std::string option_ = "")
      : value(value_), limit(limit_), option(std::move(option_)) {}
};

struct Decision {
  Asked asked = Asked::named;
  std::string candidate;  ///< "gravity", "creep as 'levels off'"; "": the model
  bool accepted = false;
  Compared by;
  std::string why;                      ///< one plain clause
  std::string where;                    ///< FILE:LINE of the rule; tell() knows it
  std::map<std::string, double> parts;  ///< other numbers of the same model, by name
  double cpu_s = 0.0;  ///< worked since the decision before it; whoever keeps it knows

  Decision() = default;
  Decision(Asked asked_, std::string candidate_, bool accepted_, Compared by_, std::string why_)
      : asked(asked_),
        candidate(std::move(candidate_)),
        accepted(accepted_),
        by(std::move(by_)),
        why(std::move(why_)) {}
};

using Decided = std::function<void(const Decision&)>;

/// Tells `decided`, if anybody listens. Returns whether it was accepted.
bool tell(const Decided& decided, Decision decision, SourceLine where = SourceLine::current());

/// One line of decisions.jsonl.
nlohmann::json to_json(const Decision& decision);
/// Throws nlohmann::json::exception for what is none.
Decision decision_from_json(const nlohmann::json& line);

}  // namespace hookeye
