// Which photos become the rest and the load cases of the capture.
#pragma once

#include "proposal/pairing.h"

namespace hookeye {

struct LoadCase {
  std::string name;  ///< load1, load2, ...
  PairedPhoto photo;
  bool held_out = false;
};

struct LoadCases {
  PairedPhoto rest;
  std::vector<LoadCase> loads;  ///< in the order in which they were taken
  std::vector<std::string> said;
};

/// The last photo before the machine moves is the rest (the one of the least load, where it moves
/// from the start). `count` photos up to the peak, whose force (travel, where no force is known) is
/// spread evenly, are the load cases; the second of each three is held out. Throws InputError.
LoadCases choose_cases(const Pairing& pairing, const MachineRecord& record, size_t count);

}  // namespace hookeye
