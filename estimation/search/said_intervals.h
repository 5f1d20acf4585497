// What a sentence says in numbers, with the intervals of the values that it is of.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "estimation/fit/fit.h"

namespace hookeye {

using Saying = std::function<std::string(const VectorXd&)>;

/// The values within whose 95 % a sentence's numbers are told, and how they are correlated.
struct KnownValues {
  VectorXd value, low, high;
  Eigen::MatrixXd correlation;
};

/// How all values of a fit are known; empty where it has no intervals.
KnownValues known_values(const Fitted& fitted);
/// Of the values [first, first + size) of those.
KnownValues part_of(const KnownValues& all, Eigen::Index first, Eigen::Index size);

/// `say(value)`, where there are intervals with the range of every number that changes as the
/// values go through their 95 %: "9.81 (9.79 to 9.83) m/s2"; of a number in a vector the range
/// alone, of a direction the cone: "(0.60, 0.00, -0.80) within 1.4 degrees". Where its words
/// change, too
/// ("stiff", "soft"), what it says at both ends. The sentence speaks for itself, so that what it
/// derives from the values (a length, an angle, a percentage) has its range as well. Of a number
/// that has no value at some end (a NaN, as figure() writes it) is said that it is not known.
std::string said_with_intervals(const Saying& say, const KnownValues& values);

/// A NaN for each coordinate of a place's centre that is unknown (centre_is_unknown): place_text()
/// says so.
void forget_unknown_centres(const std::vector<Parameter>& parameters, KnownValues& values);

}  // namespace hookeye
