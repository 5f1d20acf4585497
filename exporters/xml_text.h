// What exporters of XML and of programs without springs share. For this folder alone.
#pragma once

#include <string>
#include <vector>

#include "exporters/solver_model.h"

namespace hookeye {

/// Text that may stand in a comment of XML.
std::string xml_comment(const std::string& text);

/// What no load case of `program` holds: floors, springs, supports that are not there.
void add_case_lacks(const SolverModel& model, const std::string& program,
                    std::vector<std::string>& lacks);

}  // namespace hookeye
