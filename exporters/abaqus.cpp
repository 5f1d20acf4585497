// abaqus: decks for Abaqus/Standard, C3D4 or C3D10, *HYPERELASTIC, large deformation.
//
// Run in the folder: abaqus job=CASE.
#include "exporters/deck.h"

namespace hookeye {
namespace {

class Abaqus final : public Exporter {
 public:
  std::string name() const override { return "abaqus"; }
  std::string title() const override { return "an Abaqus/Standard deck a load case"; }
  Exported write(const SolverModel& model) const override {
    Exported out = deck::write(
        model, {.program = "Abaqus",
                .printed = "U1,U2,U3",
                .results = "*OUTPUT, FIELD, VARIABLE=PRESELECT\n",
                .most_ogden_terms = 6,
                .swelling = "Abaqus takes it out of the volume ratio: to first order under load",
                .elastic_by_green = false,
                .pressed_step = 0.5});
    out.notes = {"In this folder: abaqus job=CASE. CASE.dat has the displacements of all nodes.",
                 "The volumetric energy of *HYPERELASTIC is Hookeye's: 1/D1 (J - 1)^2 with D1 = "
                 "2/kappa. There is no difference at any J.",
                 "C3D10 is the element of Hookeye. Abaqus advises C3D10H where D1 is small; it "
                 "gives other displacements."};
    return out;
  }
};

}  // namespace
}  // namespace hookeye

HOOKEYE_DEFINE_EXPORTER(abaqus, Abaqus)
