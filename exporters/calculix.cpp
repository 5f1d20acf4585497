// calculix: decks for ccx, C3D4 or C3D10, *HYPERELASTIC, large deformation.
//
// Run in the folder: ccx CASE; displacements come in CASE.dat and CASE.frd.
#include "exporters/deck.h"

namespace hookeye {
namespace {

class CalculiX final : public Exporter {
 public:
  std::string name() const override { return "calculix"; }
  std::string title() const override { return "a CalculiX deck a load case"; }
  Exported write(const SolverModel& model) const override {
    Exported out = deck::write(
        model,
        {.program = "CalculiX",
         .printed = "U,RF",
         .results = "*NODE FILE\nU,RF\n*EL FILE\nS,E\n",
         .most_ogden_terms = 4,
         .swelling =
             "CalculiX takes it off the Green strain: the same where the body is free, to first "
             "order elsewhere",
         .elastic_by_green = true,
         // With a pressure CalculiX converges linearly, a correction a seventh of the one before,
         // and stops at a residual of 1e-6 whatever *CONTROLS say. What is left shrinks with the
         // increment: of a block pressed and bent 1.4e-4 at 0.5, 6e-6 at 0.05.
         .pressed_step = 0.05});
    out.notes = {
        "In this folder: ccx CASE (without .inp). CASE.dat has the displacements of all "
        "nodes, CASE.frd opens in cgx and PrePoMax.",
        "The volumetric energy of *HYPERELASTIC is Hookeye's: 1/D1 (J - 1)^2 with D1 = "
        "2/kappa. There is no difference at any J.",
        "CalculiX takes a residual force below 1e-6 for none, in the unit of force of these files. "
        "Where the forces at nodes are nearly as small, multiply moduli, springs, forces, "
        "pressures and density by 1000, and divide D1 by it."};
    return out;
  }
};

}  // namespace
}  // namespace hookeye

HOOKEYE_DEFINE_EXPORTER(calculix, CalculiX)
