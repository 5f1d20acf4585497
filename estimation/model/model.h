// The model: energy + loadings + optics as a function of parameters. A value; verbs are functions.
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "capture_io/capture.h"
#include "core/parameter.h"
#include "estimation/model/limits.h"
#include "estimation/model/parameter_layout.h"
#include "estimation/model/photo_reading.h"
#include "meshing/body.h"
#include "render/optics.h"
#include "simulation/energy_model.h"
#include "simulation/loading.h"

namespace hookeye {

/// Everything that a fit never changes: capture, body, photos. Shared by all models of a capture.
struct Scene : std::enable_shared_from_this<Scene> {
  Capture capture;  ///< its cameras as `readings` has them
  std::shared_ptr<const Body> body;
  std::vector<std::vector<Photo>> photos;  ///< [example][photo], order of the capture
  PhotoReadings readings;                  ///< of cameras whose photos are not read whole
  /// Planes of the texture image (1 or 3), each at full size, half, quarter (coarse levels).
  std::vector<std::vector<std::shared_ptr<const Image>>> albedo;
  /// What fits, floors, diagnoses and searches of it decide by. Never null.
  std::shared_ptr<const Limits> limits = std::make_shared<const Limits>();
  std::shared_ptr<const TetMesh> mesh() const { return {body, &body->mesh}; }
  int example_index(const std::string& name) const;  ///< -1: none
  int halvings_of(const std::string& camera) const;  ///< of its photos when they were read
  bool in_part(const std::string& camera) const;     ///< PhotoReading::in_part() of its photos
  bool in_part() const;                              ///< of any camera's
};

/// One example under the present parameter values.
struct ExampleModel {
  double stiffness = 1.0;                    ///< factor on the whole energy (history effects)
  Loading loading;                           ///< supports and forces; gravity included
  std::vector<PhotoState> photos;            ///< order of the example's photos
  Vector3d force_offset = Vector3d::Zero();  ///< added to predicted measured forces (force_zero)
};

class Catalogue;  // effect.h
class Ingredient;
struct Equilibrium;

/// The realised model: what equilibrium and rendering need. Ingredients write into it.
struct Model {
  std::shared_ptr<const Scene> scene;
  EnergyModel energy;
  std::vector<ExampleModel> examples;  ///< order of the capture's examples
  /// Pose of the whole set-up: x_in_world = placement x_in_body (gravity, cameras and light are
  /// told in the world; mechanics happen in the body's frame).
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
  /// Acceleration of the self-weight already among the forces, in the world [length/s^2]: what
  /// turns the set-up afterwards (place) turns the body against it.
  Vector3d gravity = Vector3d::Zero();
  /// By how much cameras are off their calibration, in its standard deviations, one independent of
  /// the other (camera_calibration.h). Empty: they are as told.
  VectorXd calibration;
  /// What has been written into it, in order: enough to make the same model of another scene.
  std::vector<std::pair<std::shared_ptr<const Ingredient>, VectorXd>> applied;
  /// Its equilibria by example, without tangents; null: not known. Realising solves nothing and
  /// leaves it empty; realised() (fit.h) fills it in.
  std::vector<std::shared_ptr<const Equilibrium>> states;
  /// Energy of example e: energy with all weights times examples[e].stiffness.
  EnergyModel energy_of(int example) const;
};

/// What an ingredient can change; lets the derivative skip what it does not touch.
struct Touches {
  bool energy = false, loading = false, photos = false, measured = false;
  bool cameras = false;  ///< with photos: where they show a point, not only how bright and sharp
};

/// Derivative of one example by one parameter at fixed q, where an ingredient knows it better than
/// central differences of apply(): empty vectors mean zero.
struct MechanicsDerivative {
  VectorXd dR_dt;   ///< 3n
  VectorXd dqc_dt;  ///< by loading.prescribed
};

/// A group of parameters with one meaning: the material, the light, an added effect. Immutable.
class Ingredient {
 public:
  virtual ~Ingredient() = default;
  virtual std::string name() const = 0;  ///< "material", "gravity", "camera_pose"
  /// Configuration chosen among candidates ("cam0 from twist on"), "" if there is none; together
  /// with name() it rebuilds the ingredient (make_ingredient).
  virtual std::string variant() const { return {}; }
  virtual std::vector<Parameter> parameters() const = 0;
  virtual Touches touches() const = 0;
  /// The same with other bounds of its parameters: those of an effect scale with the model that it
  /// was added to, which a step's file keeps. Null: its bounds are its own.
  virtual std::shared_ptr<const Ingredient> with_bounds(
      const std::vector<std::pair<double, double>>& bounds) const;
  /// Writes the values into the model. At the null values the model stays bit-equal.
  virtual void apply(const Eigen::VectorXd& values, Model& model) const = 0;
  /// Optional exact or one-sided derivative at `values`; default: none (false), and the caller
  /// takes central differences (one-sided at a bound) of residual and prescribed motion at fixed q.
  virtual bool mechanics_derivative(const Eigen::VectorXd& values, const Model& model, int example,
                                    const Equilibrium& equilibrium, int parameter,
                                    MechanicsDerivative& out) const;
};

/// What with_bounds() does to the parameters: {low, high} of each.
void set_bounds(std::vector<Parameter>& parameters,
                const std::vector<std::pair<double, double>>& bounds);

/// Model as a function of parameters: ingredients in order, p their concatenated values.
struct ModelForm {
  std::shared_ptr<const Scene> scene;
  Model start;  ///< before any ingredient
  std::vector<std::shared_ptr<const Ingredient>> ingredients;

  std::vector<Parameter> parameters() const;
  ParameterLayout layout() const { return ParameterLayout(ingredients); }
  int size() const { return static_cast<int>(layout().size()); }
  VectorXd initial() const;  ///< concatenated Parameter::value
  Model realise(const VectorXd& p) const;
};

/// Nothing strains the body: no loads, and supports that stand still or one that moves it as a
/// whole.
bool is_rest(const ExampleSpec& example);

/// Scene of a capture: builds the body and reads photos, large ones as photo_reading.h says.
std::shared_ptr<const Scene> load_scene(const Capture& capture, bool with_photos = true,
                                        const Limits& limits = {});
/// The same with photos halved until their longer side is at most `longest_px`, and without their
/// sigma: for pictures and looks, not for fits. `progress`: photos that are read, of all; called by
/// any thread, several at once.
using PhotosRead = std::function<void(int done, int of)>;
std::shared_ptr<const Scene> load_scene_to_look_at(const Capture& capture, int longest_px,
                                                   const PhotosRead& progress = {});
/// The capture without the examples that nothing may see (use: test).
Capture without_tests(Capture capture);
/// `scene`, which was made without them, with the test examples of `whole` behind its own. Reads
/// their photos.
std::shared_ptr<const Scene> with_tests(const Scene& scene, const Capture& whole);
/// Edge of a finer mesh over that of the told one: three times the unknowns.
inline constexpr double kFinerEdge = 0.7;
/// The scene with another mesh of the same body: `edge_factor` times the told edge, `order` 1 or 2
/// (0: as told). Without its photos where they are not needed. Throws InputError as make_body.
std::shared_ptr<const Scene> remeshed(const Scene& scene, double edge_factor, int order,
                                      bool with_photos);
/// The base model: material (what `fit:` names), light where it is not told, rigid: fit supports,
/// placement: fit, uniform albedo, background: fit.
ModelForm base_form(std::shared_ptr<const Scene> scene);

/// The same model of another scene of the same body (another mesh, more examples): ingredients are
/// rebuilt by name and variant, values carried over by the parameters' names; what is new starts at
/// its declared value. Throws std::runtime_error where the scene has no such ingredient.
std::pair<ModelForm, VectorXd> transfer(const Model& model, std::shared_ptr<const Scene> scene,
                                        const Catalogue& effects);

/// model.yaml of a run step: base values, added effects with variants and values. Usable as -m.
std::string write_model(const ModelForm& form, const VectorXd& p, const Catalogue& effects);
/// `scene` as the capture tells; the form may live on a finer mesh of it. Throws InputError with
/// the place.
std::pair<ModelForm, VectorXd> read_model(const std::filesystem::path& file,
                                          std::shared_ptr<const Scene> scene,
                                          const Catalogue& effects);

}  // namespace hookeye
