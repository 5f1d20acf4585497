#include "estimation/search/said_intervals.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <tuple>
#include <vector>

#include "estimation/model/parameters_json.h"

namespace hookeye {

namespace {

/// A field of bumps has a hundred values, and its sentence two numbers: the table has the values.
constexpr Eigen::Index kMostValues = 40;

/// A sentence as what stands around its numbers, and those: words[i] before number i.
struct Numbers {
  std::vector<std::string> words;
  std::vector<std::string> texts;
  std::vector<double> values;
};

/// What a sentence says of a number that has no value.
constexpr std::string_view kNoValue = "nan";

bool is_no_value(const std::string& text, size_t at) {
  const size_t end = at + kNoValue.size();
  return text.compare(at, kNoValue.size(), kNoValue) == 0 &&
         (end == text.size() || !std::isalnum(static_cast<unsigned char>(text[end])));
}

/// "m/s2", "'pull_2'" and "mm^3" hold no number.
bool can_begin(const std::string& text, size_t at) {
  const auto digit = [&](size_t i) {
    return i < text.size() && std::isdigit(static_cast<unsigned char>(text[i])) != 0;
  };
  if (!digit(at) && !(text[at] == '-' && digit(at + 1)) && !is_no_value(text, at)) return false;
  if (at == 0) return true;
  const char before = text[at - 1];
  return before == ' ' || before == '(';
}

Numbers split_numbers(const std::string& text) {
  Numbers out;
  out.words.emplace_back();
  for (size_t at = 0; at < text.size();) {
    if (!can_begin(text, at)) {
      out.words.back() += text[at++];
      continue;
    }
    size_t used = 0;
    out.values.push_back(std::stod(text.substr(at), &used));
    out.texts.push_back(text.substr(at, used));
    out.words.emplace_back();
    at += used;
  }
  return out;
}

/// The values with one at the upper end of its interval, then at the lower; value by value.
std::vector<VectorXd> ends_of_values(const KnownValues& known) {
  std::vector<VectorXd> out;
  for (Eigen::Index i = 0; i < known.value.size(); ++i)
    for (const double to : {known.high[i], known.low[i]}) {
      out.push_back(known.value);
      if (std::isfinite(to) && !std::isnan(known.value[i])) out.back()[i] = to;
    }
  return out;
}

/// How far a number goes up (`sign` 1) or down (-1), by what it changes with each value: of
/// correlated changes r_ik, by^2 = sum_ik r_ik by_i by_k, where by_i is negative towards a value's
/// lower end. `upper` and `lower`: its changes to those ends.
double reach_of(const VectorXd& upper, const VectorXd& lower, double sign,
                const Eigen::MatrixXd& correlation) {
  VectorXd by(upper.size());
  for (Eigen::Index i = 0; i < by.size(); ++i)
    by[i] = sign * upper[i] >= sign * lower[i] ? std::max(0.0, sign * upper[i])
                                               : -std::max(0.0, sign * lower[i]);
  return std::sqrt(std::max(0.0, by.dot(correlation * by)));
}

struct Range {
  double low = 0.0, high = 0.0;
};

/// Of number `at`. One that has the same sign at all ends keeps it: its logarithm is summed then.
Range range_of(const Numbers& told, const std::vector<Numbers>& at_ends, size_t at,
               const Eigen::MatrixXd& correlation) {
  const double value = told.values[at], sign = value < 0.0 ? -1.0 : 1.0;
  const Eigen::Index count = correlation.rows();
  VectorXd upper(count), lower(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    upper[i] = at_ends[static_cast<size_t>(2 * i)].values[at];
    lower[i] = at_ends[static_cast<size_t>(2 * i + 1)].values[at];
  }
  const auto range = [&](double from, const VectorXd& up, const VectorXd& low) {
    const VectorXd to_upper = up.array() - from, to_lower = low.array() - from;
    return Range{from - reach_of(to_upper, to_lower, -1.0, correlation),
                 from + reach_of(to_upper, to_lower, 1.0, correlation)};
  };
  const Range out = range(value, upper, lower);
  const bool keeps_sign =
      sign * value > 0.0 && (sign * upper).minCoeff() > 0.0 && (sign * lower).minCoeff() > 0.0;
  if (!keeps_sign || out.low * out.high > 0.0) return out;
  const Range logs =
      range(std::log(sign * value), (sign * upper).array().log(), (sign * lower).array().log());
  const double small = sign * std::exp(logs.low), large = sign * std::exp(logs.high);
  return {std::min(small, large), std::max(small, large)};
}

/// Digits after the point.
int decimals(const std::string& number) {
  const size_t point = number.find('.');
  return point == std::string::npos || number.find('e') != std::string::npos
             ? 0
             : static_cast<int>(number.size() - point - 1);
}

/// "-0.0" is "0.0".
std::string fixed(double value, int digits) {
  const std::string out = fmt::format("{:.{}f}", value, digits);
  return out.find_first_of("123456789") == std::string::npos && out[0] == '-' ? out.substr(1) : out;
}

/// The number as it stands, or with its range.
std::string with_range(const std::string& text, const Range& range, bool in_vector) {
  if (in_vector) {
    const std::string low = fixed(range.low, decimals(text)),
                      high = fixed(range.high, decimals(text));
    return low == high ? text : low + " to " + high;
  }
  const std::string low = fmt::format("{:.3g}", range.low),
                    high = fmt::format("{:.3g}", range.high);
  return low == high ? text : fmt::format("{} ({} to {})", text, low, high);
}

/// Three numbers in parentheses; numbers at, at + 1, at + 2.
bool is_triple(const Numbers& told, size_t at) {
  return at + 2 < told.values.size() && told.words[at].ends_with('(') &&
         told.words[at + 1] == ", " && told.words[at + 2] == ", " &&
         told.words[at + 3].starts_with(')');
}

/// Of length one, as far as two digits say.
bool is_unit(const Numbers& told, size_t at) {
  return std::abs(Eigen::Map<const Eigen::Vector3d>(&told.values[at]).norm() - 1.0) < 0.01;
}

/// Half the opening angle [degrees] of the cone that holds a direction at 95 %. One that turns to
/// the other side at an end, as a vector through zero does, may be any.
double cone_of(const Numbers& told, const std::vector<Numbers>& at_ends, size_t at,
               const Eigen::MatrixXd& correlation) {
  const Eigen::Map<const Eigen::Vector3d> direction(&told.values[at]);
  constexpr double kAny = 180.0;
  const auto at_end = [&](Eigen::Index end) {
    return Eigen::Map<const Eigen::Vector3d>(&at_ends[static_cast<size_t>(end)].values[at]);
  };
  Eigen::Matrix3Xd D(3, correlation.rows());
  for (Eigen::Index i = 0; i < D.cols(); ++i) {
    if (at_end(2 * i).dot(direction) < 0.0 || at_end(2 * i + 1).dot(direction) < 0.0) return kAny;
    D.col(i) = 0.5 * (at_end(2 * i) - at_end(2 * i + 1));
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(D * correlation * D.transpose());
  // 95 % of the values' one dimension are 1.96 deviations, of the cone's two 2.45.
  const double reach = 2.4477 / 1.96 * std::sqrt(std::max(0.0, eigen.eigenvalues().maxCoeff()));
  return std::min(kAny, reach * 180.0 / std::numbers::pi);
}

/// A sentence is put together from left to right.
class WithRanges {
 public:
  WithRanges(const Numbers& told, const std::vector<Numbers>& at_ends,
             const Eigen::MatrixXd& correlation)
      : told_(told), at_ends_(at_ends), correlation_(correlation), out_(told.words.front()) {}

  std::string said() {
    for (size_t i = 0; i < told_.values.size();) i = is_direction(i) ? direction(i) : number(i);
    return any_ ? out_ + "; ranges: 95 %" : out_;
  }

 private:
  /// A place would change its length as its values do.
  bool is_direction(size_t at) const {
    return is_triple(told_, at) && is_unit(told_, at) &&
           std::all_of(at_ends_.begin(), at_ends_.end(),
                       [at](const Numbers& end) { return is_unit(end, at); });
  }
  size_t direction(size_t at) {
    for (size_t i = at; i < at + 3; ++i)
      out_ += told_.texts[i] + (i < at + 2 ? told_.words[i + 1] : "");
    const double cone = cone_of(told_, at_ends_, at, correlation_);
    const std::string& after = told_.words[at + 3];
    any_ = any_ || cone > 0.0;
    out_ += cone > 0.0 ? fmt::format(") within {:.{}f} degrees", cone, cone < 9.95 ? 1 : 0) +
                             after.substr(1)
                       : after;
    return at + 3;
  }
  /// It has no value, or none at an end of some interval.
  bool is_unknown(size_t at) const {
    return std::isnan(told_.values[at]) ||
           std::any_of(at_ends_.begin(), at_ends_.end(),
                       [at](const Numbers& end) { return std::isnan(end.values[at]); });
  }
  size_t unknown(size_t at) {
    out_ += std::isnan(told_.values[at]) ? "not known" : told_.texts[at] + " (not known)";
    out_ += told_.words[at + 1];
    return at + 1;
  }
  size_t number(size_t at) {
    if (is_unknown(at)) return unknown(at);
    const std::string& before = told_.words[at];
    const size_t open = out_.rfind('(');
    const bool in_vector =
        before.ends_with('(') || (before.ends_with(", ") && open != std::string::npos &&
                                  out_.find(')', open) == std::string::npos);
    const std::string text =
        with_range(told_.texts[at], range_of(told_, at_ends_, at, correlation_), in_vector);
    any_ = any_ || text != told_.texts[at];
    out_ += text + told_.words[at + 1];
    return at + 1;
  }

  const Numbers& told_;
  const std::vector<Numbers>& at_ends_;
  const Eigen::MatrixXd& correlation_;
  std::string out_;
  bool any_ = false;
};

}  // namespace

KnownValues known_values(const Fitted& fitted) {
  const Eigen::Index size = fitted.p.size();
  if (fitted.low.size() != size || fitted.high.size() != size) return {};
  const auto parameters = fitted.form.parameters();
  KnownValues out{fitted.p, fitted.low, fitted.high, Eigen::MatrixXd::Identity(size, size)};
  const Eigen::MatrixXd C =
      parameter_covariance(fitted.evaluation, parameters, fitted.p).determined;
  for (Eigen::Index i = 0; i < size; ++i) {
    std::tie(out.low[i], out.high[i]) =
        interval_within(parameters[static_cast<size_t>(i)], out.low[i], out.high[i]);
    for (Eigen::Index k = 0; k < size; ++k)
      if (const double both = C(i, i) * C(k, k); i != k && both > 0.0)
        out.correlation(i, k) = C(i, k) / std::sqrt(both);
  }
  return out;
}

KnownValues part_of(const KnownValues& all, Eigen::Index first, Eigen::Index size) {
  if (all.value.size() == 0) return {};
  return {all.value.segment(first, size), all.low.segment(first, size),
          all.high.segment(first, size), all.correlation.block(first, first, size, size)};
}

void forget_unknown_centres(const std::vector<Parameter>& parameters, KnownValues& values) {
  for (Eigen::Index i = 0; i < values.value.size(); ++i)
    if (centre_is_unknown(parameters[static_cast<size_t>(i)], values.low[i], values.high[i]))
      values.value[i] = std::numeric_limits<double>::quiet_NaN();
}

std::string said_with_intervals(const Saying& say, const KnownValues& values) {
  const std::string told = say(values.value);
  if (values.low.size() == 0 || values.value.size() > kMostValues) return told;
  const Numbers numbers = split_numbers(told);
  std::vector<Numbers> at_ends;
  std::vector<std::string> said;
  for (const VectorXd& end : ends_of_values(values)) {
    said.push_back(say(end));
    at_ends.push_back(split_numbers(said.back()));
  }
  for (size_t k = 0; k + 1 < said.size(); k += 2)
    if (at_ends[k].words != numbers.words || at_ends[k + 1].words != numbers.words)
      return fmt::format("{}; 95 %: from {} to {}", told, said[k + 1], said[k]);
  return WithRanges(numbers, at_ends, values.correlation).said();
}

}  // namespace hookeye
