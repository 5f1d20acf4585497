// Where to look when the catalogue has no name for what is left (method.md, "Which effect is
// missing"): dead forces on a coarse basis that would remove it.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include "estimation/diagnosis/diagnosis.h"

namespace hookeye {

/// A field of forces, in the body or on its surface, the same in all examples or in one alone. It
/// names no cause, is never added, and stands for whatever acts there.
struct FreeForm {
  std::string name;     ///< "body_force" or "traction"
  std::string example;  ///< the one it acts in; "": all
  std::string unit;     ///< of `forces`
  double evidence = 0.0;
  double explains = 0.0;           ///< share of (chi^2 - floor^2) removed, fitted photos
  double explains_held_out = 0.0;  ///< of a field in all examples
  Eigen::Matrix3Xd
      forces;  ///< at the nodes, dead, in the body's frame [force/length^3 or /length^2]
  Vector3d place = Vector3d::Zero();  ///< where it is largest [length]
  std::string sentence;
};

/// The fields as they are scored: parameter 3 i + c is component c of bump i.
std::vector<std::shared_ptr<const Ingredient>> free_form_ingredients(const Model& model);

/// Best by evidence: the fields of every kind that has any, estimated as the mean under the prior
/// that the evidence chose (a step by least squares would be noise where the photos tell little).
Result<std::vector<FreeForm>> free_form(Workspace& workspace, const Fitted& fitted,
                                        const std::atomic<bool>* cancel);

/// Point arrays by the fields' names on the body at rest, for ParaView.
void write_free_form(const std::filesystem::path& vtu, const Scene& scene,
                     const std::vector<FreeForm>& fields);

}  // namespace hookeye
