// What a test machine recorded: time, force and travel in s, N and mm.
#pragma once

#include <string>
#include <vector>

#include "proposal/questions.h"
#include "proposal/text_table.h"

namespace hookeye {

struct MachineRecord {
  std::filesystem::path file;
  std::vector<int> lines;      ///< of each row in the file
  std::vector<double> time;    ///< [s], not falling; empty: no column
  std::vector<double> force;   ///< [N], the load cell's zero taken off; empty: no column
  std::vector<double> travel;  ///< [mm] from the start; empty: no column
  std::vector<double> photo;   ///< number or pulse of the photo's column; empty: no column
  bool compression = false;    ///< its names speak of compression
  /// The rows before the machine moves; 0: none are seen.
  size_t still_rows = 0;
  double onset = 0;  ///< [s] when it begins to move; told where still_rows > 0 and there is a time
  double force_zero = 0, force_noise = 0;    ///< [N] mean and standard deviation while still
  double travel_zero = 0, travel_noise = 0;  ///< [mm]
  std::vector<std::string> said;             ///< what the user is to know

  size_t size() const { return lines.size(); }
  /// Force, or travel where there is no force.
  const std::vector<double>& signal() const { return force.empty() ? travel : force; }
};

/// Whether a table has the columns of a test machine: a force, or a travel beside times or photos.
bool is_machine_table(const TextTable& table);
/// What a table has instead, with its line: names of columns, or rows that do not go with the head.
std::string columns_told(const TextTable& table);
/// Columns by their names and units; what no name tells is asked. Throws InputError with the line:
/// units that are not known, time that goes back, nothing left.
MachineRecord machine_record(const TextTable& table, Questions& questions);

/// Fills what the still start tells, and takes the zeros off.
void find_still_start(MachineRecord& record);

}  // namespace hookeye
