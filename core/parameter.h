// A parameter is declared once; yaml, csv, JSON and page all read this declaration.
#pragma once

#include <limits>
#include <string>

namespace hookeye {

struct Parameter {
  std::string name;       ///< short name used in files: "mu", "gravity.x"
  std::string unit;       ///< in the capture's units, "" if dimensionless: "MPa", "mm/s^2"
  std::string long_name;  ///< for people: "shear modulus"
  double value = 0.0;
  double low = -std::numeric_limits<double>::infinity();  ///< bound, not interval
  double high = std::numeric_limits<double>::infinity();  ///< bound, not interval
  double typical = 1.0;   ///< > 0: a change of this size matters; scales steps and columns
  bool positive = false;  ///< fitted as its logarithm
  /// Index of the example that it concerns alone (a jaw's motion there), -1: all. Such a number is
  /// fitted to its example even where that is held out: it is no part of the model.
  int example = -1;
};

}  // namespace hookeye
