// A model as a solver takes it: tetrahedra, materials by sets of elements, load cases. Made from
// the realised model; exporters read nothing else.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "estimation/model/model.h"
#include "exporters/seen_surface.h"
#include "simulation/made_of.h"

namespace hookeye {

/// W = c10 (I1bar - 3) + c01 (I2bar - 3) + c20 (I1bar - 3)^2 + c30 (I1bar - 3)^3
///   + sum mu_i/alpha_i (sum_j lbar_j^alpha_i - 3) + kappa/2 (J - 1)^2   [stress]
struct Rubber {
  struct Ogden {
    double mu, alpha;
  };
  double c10 = 0, c01 = 0, c20 = 0, c30 = 0, kappa = 0;
  std::vector<Ogden> ogden;
  bool none() const;
  /// Only I1bar - 3 and the volume.
  bool neo_hookean() const { return ogden.empty() && c01 == 0 && c20 == 0 && c30 == 0; }
  Rubber scaled(double factor) const;
  /// Shear modulus at rest.
  double mu() const;
  /// kappa, or a millionth of the shear modulus where a part has none of its own: programs need
  /// one.
  double some_kappa() const;
  /// I1bar and I2bar as the powers 2 and -2 of the stretches; each exponent once.
  std::vector<Ogden> as_ogden() const;
};

/// The energy of a set of elements.
struct SolverMaterial {
  std::string name;           ///< letters, digits, _
  std::vector<int> elements;  ///< ascending, 0-based
  Rubber rubber;
  /// 1/2 e.C e of the Green strain in the axes of the mesh, added to the above; by Voigt's order 11
  /// 22 33 23 13 12 with engineering shears. Zero: none.
  Stiffness6 linear = Stiffness6::Zero();
};

struct SolverCase {
  std::string name;        ///< as the capture tells it
  std::string file;        ///< the same of letters, digits, - and _; unique
  std::string use;         ///< fit, validate, test
  double stiffness = 1.0;  ///< factor on all energies
  Loading loading;
  std::vector<double> shares;             ///< rising shares of the load to stop at, the last 1
  std::vector<std::string> loaded;        ///< regions on which the capture tells dead forces
  VectorXd nodal_force;                   ///< 3n dead forces without the self-weight [force]
  Vector3d gravity = Vector3d::Zero();    ///< in the axes of the mesh [length/s^2]
  std::vector<PressureOn> pressures;      ///< follow the deformed normal
  std::vector<FoundationOn> foundations;  ///< springs
  std::vector<FloorPlane> floors;
  bool strains = true;                     ///< false: nothing acts on the body
  std::vector<std::string> free_motions;   ///< rigid ones that no support holds
  std::optional<VectorXd> displacement;    ///< 3n as found here [length]; empty: no equilibrium
  double lowest_J = 1.0, highest_J = 1.0;  ///< volume ratios in it
};

/// An ingredient of the model beside the capture's own material and supports.
struct Added {
  std::string name, variant, sentence;
  bool mechanical = true;             ///< false: of cameras, light or sensors alone
  std::vector<Parameter> parameters;  ///< with the values found
};

struct SolverModel {
  std::string title, step;
  Units units;
  double density = 0.0;  ///< [force s^2/length^4]; 1 where gravity is a specific weight
  bool density_told = true;
  std::shared_ptr<const Body> body;
  EnergyModel energy;  ///< as the fit has it: of all cases, without their factors
  std::vector<SolverMaterial> materials;
  std::vector<std::pair<std::string, const Region*>> regions;  ///< those with nodes
  std::vector<SolverCase> cases;
  std::vector<Added> added;
  std::vector<std::string> lacks;   ///< what no SolverMaterial can say, in sentences
  std::optional<SeenSurface> seen;  ///< for exporters that are of pictures

  const TetMesh& mesh() const { return body->mesh; }
};

/// Everything but step, added and displacements.
SolverModel solver_model(const Model& model);
/// The loading of a case with beds of springs replaced by rigid clamps at the places where the
/// springs are at rest, for programs without springs.
Loading clamped(const SolverModel& model, const SolverCase& one);
/// By how much a volumetric energy kappa/2 (log J)^2 differs from kappa/2 (J - 1)^2: relative
/// difference of their pressures at the volume ratios found. Empty: no equilibrium was found.
std::optional<double> logarithm_difference(const SolverModel& model);
/// Puts an equilibrium of case `index` into it.
void set_found(SolverModel& model, int index, const VectorXd& q);

/// Materials of the elements, and sentences on what they do not hold.
std::vector<SolverMaterial> solver_materials(const EnergyModel& energy, const TetMesh& mesh,
                                             std::vector<std::string>& lacks);

}  // namespace hookeye
