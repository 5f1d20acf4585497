#include "estimation/search/said_intervals.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
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

/// "m/s2", "'pull_2'" and "mm^3" hold no number.
bool can_begin(const std::string& text, size_t at) {
  const auto digit = [&](size_t i) {
    return i < text.size() && std::isdigit(static_cast<unsigned char>(text[i])) != 0;
  };
  if (!digit(at) && !(text[at] == '-' && digit(at + 1))) return false;
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

std::string with_ranges(const Numbers& told, const std::vector<Numbers>& at_ends,
                        const Eigen::MatrixXd& correlation) {
  std::string out = told.words.front();
  bool any = false;
  for (size_t i = 0; i < told.values.size(); ++i) {
    const std::string& before = told.words[i];
    const bool in_vector =
        before.ends_with('(') || (before.ends_with(", ") && out.rfind('(') != std::string::npos &&
                                  out.find(')', out.rfind('(')) == std::string::npos);
    const std::string number =
        with_range(told.texts[i], range_of(told, at_ends, i, correlation), in_vector);
    any = any || number != told.texts[i];
    out += number + told.words[i + 1];
  }
  return any ? out + "; ranges: 95 %" : out;
}

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
  return with_ranges(numbers, at_ends, values.correlation);
}

}  // namespace hookeye
