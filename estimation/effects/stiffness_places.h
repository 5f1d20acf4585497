// Forms of stiffness_field that are several places at once, and the places that a field is like.
#pragma once

#include "estimation/effects/toolbox.h"

namespace hookeye {

/// The one Gaussian place, and its amplitude, that least squares over the volume put nearest to the
/// sum of bumps of `radius` around `centres`: anywhere in the body, for a place between bumps is
/// shared out among them, and from half to 1.4 times as wide as they. The rest is a constant and
/// the same amplitude in all bumps, which is none: they overlap where the body is thick, and hardly
/// at its edges.
std::pair<Blob, double> likest_place(const TetMesh& mesh, const std::vector<Vector3d>& centres,
                                     double radius, const VectorXd& values);

/// Gaussian places and the log of the stiffness factor in the middle of each.
struct StiffPlaces {
  std::vector<Blob> blobs;
  VectorXd amplitudes;
  /// What they leave of the field's variance over the body, less the same rest, as a share.
  double left = 1.0;
};
/// One place, two ... up to `most`, about bumps' centres: of all subsets the one that leaves least.
/// (One after the other they would not be found: two stiff ends are most like one soft middle.)
std::vector<StiffPlaces> likest_places(const TetMesh& mesh, const std::vector<Vector3d>& centres,
                                       double radius, const VectorXd& values, int most);

/// "free blobs, 3", "free balls, 3": as many places as the variant says; all balls have edges as
/// sharp. Null: another variant.
std::shared_ptr<const Ingredient> places_form(const Model& model, const std::string& variant);
bool is_places(const std::string& variant);
/// Two blobs, three and so on, where a field of bumps is most like them; as few numbers as bumps,
/// at most. (One is the field's smaller form.) Photos tell how many: the field itself hardly does.
std::vector<NextForm> places_like(const Model& model, const std::vector<Vector3d>& centres,
                                  double radius, const VectorXd& values);
/// Balls in place of blobs, each as ball_like() has it. Nothing: they are balls.
std::optional<NextForm> balls_like(const Model& model, const Ingredient& blobs,
                                   const VectorXd& values);
std::string places_sentence(const Model& model, const Ingredient& ingredient,
                            const VectorXd& values);

}  // namespace hookeye
