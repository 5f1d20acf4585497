// From a lab's folder to the text of a capture.yaml.
#pragma once

#include <string>
#include <vector>

#include "proposal/inventory.h"
#include "proposal/load_cases.h"
#include "proposal/questions.h"

namespace hookeye {

struct Proposal {
  std::vector<CaptureQuestion> questions;  ///< in order; those with .asked are put to the user
  std::vector<CaptureQuestion> open;       ///< asked and not answered
  std::vector<CaptureQuestion> needed;     ///< without an answer and a default: `yaml` is empty
  std::string yaml;                        ///< the capture, with comments
  std::string pairing;                     ///< how photos were paired with rows
  std::string cameras;                     ///< where they come from
  LoadCases cases;
  bool timed = true;              ///< the table has times; else those of `cases` are rows
  std::vector<std::string> said;  ///< what the user is to know
};

/// The capture for `file` (capture.yaml, absolute): in the inventory's folder or one above it,
/// since a capture takes photos from its own folder only. Throws InputError: what is missing in the
/// folder, an answer that cannot be, a file that cannot be read, with its line.
Proposal propose(const Inventory& inventory, const Questions::Answers& answers,
                 const std::filesystem::path& file);

/// Writes the capture whole, after read_capture() took it; else nothing is left. Throws InputError:
/// `file` is there already and `replace` is false; what read_capture() finds.
void store(const Proposal& proposal, const std::filesystem::path& file, bool replace);

}  // namespace hookeye
