// What the effects share: ingredients from functions, sizes of the body, forces of single terms.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "estimation/model/additive_function.h"
#include "estimation/model/effect.h"
#include "simulation/equilibrium.h"

namespace hookeye {

/// An ingredient told by values and functions.
struct IngredientSpec {
  std::string name, variant;
  std::vector<Parameter> parameters;
  Touches touches;
  std::function<void(const VectorXd& values, Model& model)> apply;
  /// As Ingredient::mechanics_derivative; empty: central differences.
  std::function<bool(const VectorXd& values, const Model& model, int example,
                     const Equilibrium& equilibrium, int parameter, MechanicsDerivative& out)>
      derivative;
  /// The parameters' `value` are nulls: apply() is not called for them, so that the model stays
  /// bit-equal. False for refit forms that have no null (log stiffness of a spring).
  bool has_null = true;
};
std::shared_ptr<const Ingredient> make_ingredient(IngredientSpec spec);

/// The body at rest. Its box is the frame's; all else is the same in every frame.
struct BodySize {
  Vector3d low, high;  ///< bounding box
  Vector3d centre;     ///< of the volume
  double size = 0.0;   ///< extent() [length]
};
BodySize body_size(const Scene& scene);
/// Rest centroids of the elements, 3 x m.
Matrix3Xd element_centres(const TetMesh& mesh);
VectorXd element_volumes(const TetMesh& mesh);
/// `count` centres spread over the body by farthest points, rounded().
std::vector<Vector3d> spread_centres(const Scene& scene, int count);
/// The boundary of the mesh as a region.
Region whole_boundary(const TetMesh& mesh);
/// exp(-|X - centre|^2 / (2 radius^2)) at the element centroids.
VectorXd gaussian_bump(const TetMesh& mesh, const Vector3d& centre, double radius);

/// Radius of `count` bumps that overlap with their neighbours: that of equal shares of the volume,
/// rounded to 3 digits.
double bump_radius(const Scene& scene, int count);

/// Initial shear modulus of the first material (mean over parts that act everywhere): P_xy by F_xy
/// at F = I [stress].
double initial_shear_modulus(const EnergyModel& energy);
/// The model of the first material, where all of a capture's materials are additive: what an effect
/// adds to the material is then told in the same language (additive_function.h) and stays convex
/// with it. Null: some law is not.
const AdditiveModel* additive_base(const Model& model);
/// A model without addends in the frame of another.
AdditiveModel in_frame_of(const AdditiveModel& base);
/// A function that is zero at rest and bends at control points on one side of it, as variants tell
/// it: "... at 0.1 0.2", sizes of strain, rising. Empty: the variant is damaged.
std::vector<double> ramp_in(const std::string& variant);
/// The same function of one control point with another in its middle; `values` become those of
/// both. Of more points: as it is.
std::vector<double> refined_ramp(const std::vector<double>& at, VectorXd& values);
/// "EFFECT.WHAT.", before the names of parameters; what is wrong from some example on, or in one,
/// says so behind WHAT ("camera_pose.front from twist on."), so that it may stand in a model beside
/// what was wrong from another. "from the start" stays plain.
std::string parameter_prefix(const std::string& effect, const std::string& what,
                             const std::string& when);
/// "cam0 from twist on", as variants have it, for a sentence: "cam0 from 'twist' on".
std::string examples_quoted(const Scene& scene, std::string variant);
/// To five digits, or to the fourth of `size`: a variant is written with "{:g}", and read back it
/// must be the very same.
double rounded(double value);
Vector3d rounded(const Vector3d& x, double size);
/// Two unit axes normal to `direction` and to each other.
std::pair<Vector3d, Vector3d> normal_axes(const Vector3d& direction);
Eigen::Matrix3d rotation_of(const Vector3d& rotation_vector);

/// Appends a part that acts everywhere.
void add_part(EnergyModel& energy, std::shared_ptr<const EnergyTerm> term);
/// Internal force [3n] of one term alone, as a part added to example `example` of `model`.
VectorXd part_force(const Model& model, int example, const VectorXd& q,
                    std::shared_ptr<const EnergyTerm> term);
/// Sums element by element columns (3 npe x m), each times its factor, into 3n.
VectorXd scatter(const TetMesh& mesh, const Eigen::MatrixXd& element_columns,
                 const VectorXd& factor);

/// Element forces at an example's equilibrium, kept for the many columns that share them.
/// Safe to use from several threads.
class ElementForces {
 public:
  using Compute = std::function<Eigen::MatrixXd(const Model&, int example, const VectorXd& q)>;
  explicit ElementForces(Compute compute) : compute_(std::move(compute)) {}
  std::shared_ptr<const Eigen::MatrixXd> at(const Model& model, int example, const VectorXd& q);

 private:
  struct Entry {
    EnergyModel energy;  ///< keeps the terms alive, so that equal pointers mean equal terms
    VectorXd q;
    std::shared_ptr<const Eigen::MatrixXd> forces;
  };
  Compute compute_;
  std::mutex mutex_;
  std::map<int, Entry> entries_;
};

/// All numbers in a text, in order.
std::vector<double> numbers_in(const std::string& text);
/// "(0.5, -0.2, -0.8)".
std::string vector_text(const Vector3d& v, int digits = 2);
/// "(4.9, -0.2, 38.7)": a place, to 3 digits of the body's size, in whatever unit and frame; of
/// a NaN "somewhere along x".
std::string place_text(const Vector3d& X, double size);
/// 3 significant digits.
std::string figure(double value);
bool starts_with(const std::string& text, const std::string& start);

/// First examples from which something may be wrong: fitted ones for which `concerned` holds, the
/// first of them standing for "from the start".
struct FirstExample {
  int index;         ///< applies to examples index, index + 1, ...
  std::string text;  ///< "from the start", "from twist on"
};
std::vector<FirstExample> first_examples(const Scene& scene,
                                         const std::function<bool(int example)>& concerned);
bool has_photo_of(const Scene& scene, int example, const std::string& camera);
/// `make` for every camera with fitted photos and every example from which it may have changed.
/// Says why where there is none.
Ingredients per_camera(
    const Scene& scene, std::string* why_not,
    const std::function<std::shared_ptr<const Ingredient>(const Camera&, const FirstExample&)>&
        make);

/// A Gaussian place in the body. Effects write it as "blob X Y Z RADIUS" while it stands where it
/// was scored, and as values (amplitude, X, Y, Z, radius) once it is free.
struct Blob {
  Vector3d centre;
  double radius;
};
std::string blob_text(const Blob& blob);
std::optional<Blob> blob_in(const std::string& variant);
/// Values of the free form, from the amplitude of the scored one.
VectorXd freed(const Blob& blob, double amplitude);
/// Where a blob of either form is.
Blob blob_of(const Ingredient& ingredient, const VectorXd& values);

}  // namespace hookeye
