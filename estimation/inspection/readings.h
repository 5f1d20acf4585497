// What sensors of load cases tell, beside what the first guess expects of them.
#pragma once

#include <string>
#include <vector>

#include "estimation/inspection/sight.h"

namespace hookeye::inspection {

/// One measurement of a load case, less that at rest where there is one.
struct Reading {
  int example = 0;
  const MeasuredSpec* measured = nullptr;
  VectorXd value, first_order, in_equilibrium;
  bool less_shared = false;  ///< what all readings have, as a weight or a zero, is taken off
};
using Readings = std::vector<Reading>;

/// Readings of one sensor each; those at rest are taken off the others. Without a reading at rest
/// only forces and moments are told: a weight that the capture leaves out may have moved the rest.
std::vector<Readings> all_series(Sight& sight);

/// 1: the same direction, -1: the opposite one, 0: one of them is nothing.
double cosine(const VectorXd& a, const VectorXd& b);
/// The least force or moment that a weight, which the capture leaves out, cannot be: of the body's
/// told density, else of the heaviest soft body. Where what readings share is off, there is left
/// what a weight changes as the body deforms.
double beyond_weight(const Sight& sight, const Reading& one);
/// Far enough from nothing, and expected alike to first order and in equilibrium: what second order
/// alone gives, as a twist's axial force, has no sure sign here.
bool sure(const Sight& sight, const Reading& one);

/// "1.2", "(1.2, 0, 3)".
std::string told(const VectorXd& value);
/// "`force_on: grip`".
std::string sensor_in_words(const Sight& sight, const MeasuredSpec& measured);

}  // namespace hookeye::inspection
