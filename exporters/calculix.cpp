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
         .elastic_by_green = true});
    out.notes = {
        "In this folder: ccx CASE (without .inp). CASE.dat has the displacements of all "
        "nodes, CASE.frd opens in cgx and PrePoMax.",
        "The volumetric energy of *HYPERELASTIC is Hookeye's: 1/D1 (J - 1)^2 with D1 = "
        "2/kappa. There is no difference at any J."};
    return out;
  }
};

}  // namespace
}  // namespace hookeye

HOOKEYE_DEFINE_EXPORTER(calculix, CalculiX)
