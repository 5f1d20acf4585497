#include "capture_io/strain_field.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace hookeye {

namespace {

struct MeasureName {
  const char *word, *measure;
};
/// In small letters, without blanks and hyphens.
constexpr MeasureName kMeasureNames[] = {
    {"green", "green"},
    {"lagrange", "green"},
    {"lagrangian", "green"},
    {"greenlagrange", "green"},
    {"hencky", "hencky"},
    {"log", "hencky"},
    {"logarithmic", "hencky"},
    {"true", "hencky"},
    {"biot", "biot"},
    {"engineering", "engineering"},
    {"eng", "engineering"},
    {"small", "small"},
    {"infinitesimal", "small"},
    {"cauchy", "small"},
    {"almansi", "almansi"},
    {"euleralmansi", "almansi"},
    {"logeuleralmansi", "logarithmic almansi"},
    {"logalmansi", "logarithmic almansi"},
};

struct StrainUnit {
  const char* name;
  double fraction;
};
constexpr StrainUnit kStrainUnits[] = {
    {"", 1.0},
    {"1", 1.0},
    {"-", 1.0},
    {"m/m", 1.0},
    {"mm/mm", 1.0},
    {"fraction", 1.0},
    {"strain", 1.0},
    {"%", 1e-2},
    {"percent", 1e-2},
    {"pct", 1e-2},
    {"mm/m", 1e-3},
    {"mstrain", 1e-3},
    {"millistrain", 1e-3},
    {"me", 1e-3},
    {"m\xCE\xB5", 1e-3},  // m and epsilon
    {"um/m", 1e-6},
    {"\xC2\xB5m/m", 1e-6},  // micro sign
    {"\xCE\xBCm/m", 1e-6},  // mu
    {"ustrain", 1e-6},
    {"\xC2\xB5strain", 1e-6},
    {"\xCE\xBCstrain", 1e-6},
    {"microstrain", 1e-6},
    {"ue", 1e-6},
    {"u\xCE\xB5", 1e-6},
    {"\xC2\xB5\x65", 1e-6},
    {"\xC2\xB5\xCE\xB5", 1e-6},
    {"\xCE\xBC\xCE\xB5", 1e-6},
};

std::string small_letters(const std::string& text, bool blanks) {
  std::string out;
  for (const char c : text)
    if (blanks || (c != ' ' && c != '-' && c != '_'))
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

}  // namespace

const std::vector<std::string>& strain_measures() {
  static const std::vector<std::string> names{"green", "hencky", "biot", "engineering", "small"};
  return names;
}

const std::string& name_of(StrainMeasure measure) {
  return strain_measures()[static_cast<size_t>(measure)];
}

std::string measure_called(const std::string& word) {
  const std::string plain = small_letters(word, false);
  for (const auto& [name, measure] : kMeasureNames)
    if (plain == name) return measure;
  return "";
}

double fraction_in(const std::string& unit) {
  const std::string plain = small_letters(unit, true);
  for (const auto& [name, fraction] : kStrainUnits)
    if (plain == name) return fraction;
  return 0.0;
}

}  // namespace hookeye
