// A folder as a lab has it: photos, a calibration by OpenCV, an STL, a machine's table.
#pragma once

#include <fmt/ranges.h>

#include <string>
#include <vector>

#include "capture_io/capture.h"
#include "proposal/proposal.h"
#include "support/temporary_folder.h"

namespace hookeye::test {

/// A bar of 10 x 10 x 30 mm on z = 0 that two cameras see; it is pulled along z.
class LabFolder {
 public:
  /// CalibrationFile and bar; photos and table are added.
  LabFolder();
  const std::filesystem::path& path() const { return folder_.path(); }
  void write(const std::string& name, const std::string& text) const;
  /// A picture of speckle that has moved by so many px, with noise of its own. `time`: EXIF's, as
  /// "2024:05:01 12:00:03"; "": none.
  void photo(const std::string& name, double moved_px, const std::string& time = "",
             const std::string& fraction = "") const;
  /// Photos cam0_NNNN.tif and cam1_NNNN.tif from number 1, one a travel.
  void photos(const std::vector<double>& moved_px) const;
  /// What propose() says of it; the capture is capture.yaml within.
  Proposal proposal(const Questions::Answers& answers = {}) const;
  /// What is wrong with it, the folder struck out; "" where nothing is.
  std::string complaint(const Questions::Answers& answers = {}) const;
  Capture stored(const Proposal& proposal) const;

 private:
  TemporaryFolder folder_;
};

/// Rows of an even ramp after `still` rows: time 0.5 s apart, 0.2 mm and 0.4 N a row, the load cell
/// off by `zero`.
struct RampRow {
  double time, travel, force;
};
std::vector<RampRow> ramp(size_t still, size_t moving, double zero = 0.0);
/// "time,travel,force" in seconds, mm and N, with a head.
std::string plain_table(const std::vector<RampRow>& rows);

/// Whether one of the texts holds the piece.
bool any_says(const std::vector<std::string>& texts, const std::string& piece);

}  // namespace hookeye::test
