// What a report of measured displacements ought to tell (iDICs, A Good Practices Guide for Digital
// Image Correlation, reporting requirements). For dic alone.
#pragma once

#include <string>
#include <vector>

#include "exporters/solver_model.h"

namespace hookeye::dic {

/// A cell of CSV: in quotes where it holds a comma, a quote or a line's end.
std::string quoted(const std::string& cell);

struct Reported {
  std::string part;   ///< "camera front", "analysis"
  std::string item;   ///< "image scale"
  std::string value;  ///< with its unit; "not known"
};
std::vector<Reported> reporting_table(const SeenSurface& seen, const SolverModel& model);
std::string report_csv(const std::vector<Reported>& table);

/// What the files and their columns hold, and the table once more.
std::string readme(const SeenSurface& seen, const SolverModel& model);

}  // namespace hookeye::dic
