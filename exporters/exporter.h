// The found model for other programs. One file a program, exporters/NAME.cpp.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "exporters/solver_model.h"

namespace hookeye {

struct Exported {
  std::vector<std::pair<std::string, std::string>> files;  ///< name below the folder, content
  std::vector<std::string> lacks;  ///< what the program lacks of this model, in sentences
  std::vector<std::string> notes;  ///< how to run it, what its conventions are
};

/// One program. Has no state and lives as long as the program.
///
/// A new one is a file exporters/NAME.cpp that ends with HOOKEYE_DEFINE_EXPORTER(NAME, Class), and
/// the line HOOKEYE_EXPORTER(NAME) in exporters/catalogue.def.
class Exporter {
 public:
  virtual ~Exporter() = default;
  virtual std::string name() const = 0;   ///< as behind --to
  virtual std::string title() const = 0;  ///< what it writes, for people
  /// It tells what cameras and fields see (SolverModel::seen), and no mesh, material or load.
  virtual bool of_pictures() const { return false; }
  virtual Exported write(const SolverModel& model) const = 0;
};

/// All of the catalogue.
const std::vector<const Exporter*>& exporters();
/// By its name; null where there is none.
const Exporter* find_exporter(const std::string& name);

/// Files of `exporter`; of one for solvers README.txt and the displacements found here, CASE.csv,
/// among them.
Exported export_model(const Exporter& exporter, const SolverModel& model);

}  // namespace hookeye

#define HOOKEYE_DEFINE_EXPORTER(NAME, CLASS) \
  namespace hookeye {                        \
  const Exporter& exporter_##NAME() {        \
    static const CLASS exporter;             \
    return exporter;                         \
  }                                          \
  }
