// What a batch has found, a row a capture: as a table, as a database, and for the page.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "batch/batch_folder.h"

namespace hookeye {

/// Of the tasks that are told, in that order; of all where there are none. A row: {label, capture,
/// key, options, state, verdict, sentence, found, tie, parameters, chi_fit, chi_validate, floor,
/// rms_px, seconds, cpu_seconds, memory, exit, error, run, report, log}. `state` is todo, leased,
/// done or failed; paths are relative to the folder, "" where there is nothing; what is not known
/// is null. `memory` [bytes].
std::vector<nlohmann::json> batch_rows(const BatchFolder& folder,
                                       const std::vector<std::string>& keys);

/// A line a row; three columns a parameter (NAME, NAME_low, NAME_high) and its unit.
std::string index_csv(const std::vector<nlohmann::json>& rows);

/// The bytes of an SQLite database: tables batch, captures, parameters, found, ties.
std::string index_sqlite(const std::vector<nlohmann::json>& rows, const BatchOrder& order);

/// Writes index.csv, index.sqlite and index.html, each whole.
void write_index(const BatchFolder& folder, const std::vector<nlohmann::json>& rows);

}  // namespace hookeye
