// What holds the body and what pulls it.
#pragma once

#include <string>
#include <vector>

#include "proposal/body_facts.h"
#include "proposal/load_cases.h"

namespace hookeye {

struct MachineLoading {
  std::string held, pulled;   ///< yaml of the two regions
  Eigen::Vector3d direction;  ///< unit: where a positive force draws the pulled region
  bool moved = false;         ///< by the travel, the force is measured; else drawn by the force
  double length = 0;          ///< of the body between the two [length]
  double section = 0;         ///< its mean cross-section [length^2]
};

MachineLoading propose_loading(const BodyFacts& body, MachineRecord& record, Questions& questions,
                               std::vector<std::string>& said);

/// Supports, loads and measured values of a load case, as yaml below its name. `mm` is the length
/// unit in mm, `clock_error` in s.
std::string loading_text(const MachineLoading& loading, const MachineRecord& record,
                         const PairedPhoto& photo, double mm, double clock_error);

/// The shear modulus to start from [N/length^2]: of force over section and travel over length of
/// the middle load case, a third of Young's; 0: nothing tells.
double start_modulus(const MachineLoading& loading, const MachineRecord& record,
                     const LoadCases& cases, double mm);

}  // namespace hookeye
