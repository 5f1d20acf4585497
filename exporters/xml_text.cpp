#include "exporters/xml_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace hookeye {

std::string xml_comment(const std::string& text) {
  std::string out;
  for (const char c : text) out += static_cast<unsigned char>(c) < 32 || c == '-' ? ' ' : c;
  return out;
}

void add_case_lacks(const SolverModel& model, const std::string& program,
                    std::vector<std::string>& lacks) {
  for (const SolverCase& one : model.cases) {
    if (!one.floors.empty())
      lacks.push_back(
          fmt::format("load case {}: the floor that the body may touch is left out", one.name));
    if (!one.foundations.empty())
      lacks.push_back(
          fmt::format("load case {}: a soft clamp is replaced by a rigid one", one.name));
    if (one.strains && !one.free_motions.empty())
      lacks.push_back(fmt::format("load case {}: no support holds the {}; {} needs one", one.name,
                                  fmt::join(one.free_motions, ", the "), program));
  }
}

}  // namespace hookeye
