#include "estimation/model/base_ingredients.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "estimation/model/additive_material.h"
#include "meshing/extent.h"

namespace hookeye {

namespace {

const double kDegree = EIGEN_PI / 180.0;

class Material final : public Ingredient {
 public:
  struct Slot {
    int part, index;
    Parameter parameter;
  };
  explicit Material(std::vector<Slot> slots) : slots_(std::move(slots)) {}
  std::string name() const override { return "material"; }
  std::vector<Parameter> parameters() const override {
    std::vector<Parameter> all;
    for (const auto& slot : slots_) all.push_back(slot.parameter);
    return all;
  }
  Touches touches() const override { return {.energy = true}; }
  void apply(const Eigen::VectorXd& values, Model& model) const override {
    for (size_t part = 0; part < model.energy.parts.size(); ++part) {
      auto& term = model.energy.parts[part].term;
      VectorXd theta;
      for (size_t i = 0; i < slots_.size(); ++i) {
        if (slots_[i].part != static_cast<int>(part)) continue;
        if (theta.size() == 0) theta = present(*term, model);
        theta[slots_[i].index] = values[i];
      }
      if (theta.size() != 0) term = term->with(theta);
    }
  }

 private:
  static VectorXd present(const EnergyTerm& term, const Model& model) {
    const auto declared = term.parameters(model.scene->capture.units);
    VectorXd theta(declared.size());
    for (size_t i = 0; i < declared.size(); ++i) theta[i] = declared[i].value;
    return theta;
  }
  std::vector<Slot> slots_;
};

/// Six numbers a support: rotation vector [rad] about the region's centroid, then translation.
class RigidSupports final : public Ingredient {
 public:
  struct Slot {
    int example;
    std::string region;
    Vector3d centre;
    double size;
  };
  explicit RigidSupports(std::vector<Slot> slots, const Scene& scene)
      : slots_(std::move(slots)), length_(scene.capture.units.length) {
    for (const auto& slot : slots_) names_.push_back(scene.capture.examples[slot.example].name);
  }
  std::string name() const override { return "rigid_support"; }
  std::vector<Parameter> parameters() const override {
    std::vector<Parameter> all;
    for (size_t s = 0; s < slots_.size(); ++s)
      for (int i = 0; i < 6; ++i) {
        const bool turn = i < 3;
        Parameter parameter;
        parameter.name =
            fmt::format("{}.{}.{}{}", names_[s], slots_[s].region, turn ? "r" : "t", "xyz"[i % 3]);
        parameter.unit = turn ? "rad" : length_;
        parameter.long_name =
            fmt::format("{} of '{}' in '{}' {} {}", turn ? "rotation" : "motion", slots_[s].region,
                        names_[s], turn ? "about" : "along", "xyz"[i % 3]);
        parameter.typical = turn ? 0.01 : 0.01 * slots_[s].size;
        parameter.example = slots_[s].example;
        all.push_back(parameter);
      }
    return all;
  }
  Touches touches() const override { return {.loading = true}; }
  void apply(const Eigen::VectorXd& values, Model& model) const override {
    const Body& body = *model.scene->body;
    for (size_t s = 0; s < slots_.size(); ++s) {
      const Vector3d w = values.segment<3>(6 * s);
      RigidMotion motion;
      motion.degrees = w.norm() / kDegree;
      motion.axis = w.norm() > 0.0 ? Vector3d(w.normalized()) : Vector3d::UnitZ();
      motion.center = slots_[s].centre;
      motion.move = values.segment<3>(6 * s + 3);
      model.examples[slots_[s].example].loading.prescribe_rigid(
          body.mesh, body.regions.at(slots_[s].region), motion);
    }
  }

 private:
  std::vector<Slot> slots_;
  std::vector<std::string> names_;
  std::string length_;
};

class Light final : public Ingredient {
 public:
  std::string name() const override { return "light"; }
  std::vector<Parameter> parameters() const override {
    Parameter ambient{"ambient", "", "ambient light", 0.6, 0.0, 100.0, 0.1, false};
    std::vector<Parameter> all = {ambient};
    for (char axis : std::string("xyz"))
      all.push_back({fmt::format("sun.{}", axis), "", fmt::format("sun along {}", axis),
                     axis == 'z' ? 0.2 : 0.0, -100.0, 100.0, 0.1, false});
    return all;
  }
  Touches touches() const override { return {.photos = true}; }
  void apply(const Eigen::VectorXd& values, Model& model) const override {
    for (auto& example : model.examples)
      for (auto& photo : example.photos) {
        photo.ambient = values[0];
        photo.sun = values.tail<3>();
      }
  }
};

/// The sky's nine numbers; a told sun stays.
class Harmonics final : public Ingredient {
 public:
  std::string name() const override { return "light"; }
  std::vector<Parameter> parameters() const override {
    std::vector<Parameter> all;
    for (const char* harmonic : harmonic_names) {
      const bool even = all.empty();
      all.push_back({fmt::format("light.{}", harmonic), "",
                     fmt::format("harmonic {} of the light", harmonic),
                     even ? 0.6 / even_by_harmonic : 0.0, even ? 0.0 : -400.0, 400.0, 0.3, false});
    }
    return all;
  }
  Touches touches() const override { return {.photos = true}; }
  void apply(const Eigen::VectorXd& values, Model& model) const override {
    for (auto& example : model.examples)
      for (auto& photo : example.photos) {
        photo.ambient = even_by_harmonic * values[0];
        photo.uneven = values.tail<kUnevenNumbers>();
      }
  }
};

/// What lenses do to brightness and colour.
class Lenses final : public Ingredient {
 public:
  explicit Lenses(std::vector<Camera> cameras) : cameras_(std::move(cameras)) {}
  std::string name() const override { return "lenses"; }
  std::vector<Parameter> parameters() const override {
    std::vector<Parameter> all;
    for (const Camera& camera : cameras_) {
      const std::string of = " of camera '" + camera.name + "'";
      if (camera.fit_vignetting)
        all.push_back(
            {"vignetting." + camera.name, "", "vignetting" + of, 0.0, 0.0, 100.0, 1.0, false});
      for (const char* colour : {"red", "blue"})
        if (camera.fit_colour_zoom)
          all.push_back({fmt::format("{}_shift.{}", colour, camera.name), "",
                         fmt::format("log size of the {} picture over the green one{}", colour, of),
                         0.0, -0.05, 0.05, 0.001, false});
    }
    return all;
  }
  Touches touches() const override { return {.photos = true}; }
  void apply(const Eigen::VectorXd& values, Model& model) const override {
    Eigen::Index at = 0;
    for (const Camera& camera : cameras_) {
      const auto each = [&](const auto& change) {
        for (auto& example : model.examples)
          for (auto& photo : example.photos)
            if (photo.camera.name == camera.name) change(photo.camera);
      };
      if (camera.fit_vignetting) each([&](Camera& seen) { seen.vignetting = values[at]; }), at += 1;
      if (camera.fit_colour_zoom)
        each([&](Camera& seen) { seen.colour_zoom = values.segment<2>(at); }), at += 2;
    }
  }

 private:
  std::vector<Camera> cameras_;
};

class Albedo final : public Ingredient {
 public:
  std::string name() const override { return "albedo"; }
  std::vector<Parameter> parameters() const override {
    return {{"albedo", "", "uniform albedo", 0.5, 0.0, 10.0, 0.1, false}};
  }
  Touches touches() const override { return {.photos = true}; }
  void apply(const Eigen::VectorXd& values, Model& model) const override {
    // told_photo() put 0.5 into all of the light
    for (auto& example : model.examples)
      for (auto& photo : example.photos) {
        photo.ambient *= values[0] / 0.5;
        photo.uneven *= values[0] / 0.5;
        photo.sun *= values[0] / 0.5;
      }
  }
};

class Background final : public Ingredient {
 public:
  explicit Background(std::vector<std::string> cameras) : cameras_(std::move(cameras)) {}
  std::string name() const override { return "background"; }
  std::vector<Parameter> parameters() const override {
    std::vector<Parameter> all;
    for (const auto& camera : cameras_)
      all.push_back({"background." + camera, "", "background level of camera '" + camera + "'", 0.0,
                     -1.0, 10.0, 0.1, false});
    return all;
  }
  Touches touches() const override { return {.photos = true}; }
  void apply(const Eigen::VectorXd& values, Model& model) const override {
    for (size_t e = 0; e < model.examples.size(); ++e) {
      const auto& specs = model.scene->capture.examples[e].photos;
      for (size_t k = 0; k < specs.size(); ++k)
        for (size_t c = 0; c < cameras_.size(); ++c)
          if (is_fitted(specs[k]) && specs[k].camera == cameras_[c])
            model.examples[e].photos[k].background = values[c];
    }
  }
  static bool is_fitted(const PhotoSpec& photo) {
    return photo.background.kind == BackgroundSpec::Kind::fit;
  }

 private:
  std::vector<std::string> cameras_;
};

class Placement final : public Ingredient {
 public:
  Placement(const Vector3d& centre, double size, std::string length)
      : centre_(centre), size_(size), length_(std::move(length)) {}
  std::string name() const override { return "set_up_pose"; }
  std::vector<Parameter> parameters() const override {
    std::vector<Parameter> all;
    for (int i = 0; i < 6; ++i) {
      const bool turn = i < 3;
      Parameter parameter;
      parameter.name = fmt::format("placement.{}{}", turn ? "r" : "t", "xyz"[i % 3]);
      parameter.unit = turn ? "rad" : length_;
      parameter.long_name = fmt::format("{} of the set-up {} {}", turn ? "rotation" : "translation",
                                        turn ? "about" : "along", "xyz"[i % 3]);
      parameter.typical = turn ? 0.01 : 0.01 * size_;
      all.push_back(parameter);
    }
    return all;
  }
  Touches touches() const override {
    return {.loading = true, .photos = true, .measured = true, .cameras = true};
  }
  void apply(const Eigen::VectorXd& values, Model& model) const override {
    if (values.isZero(0.0)) return;
    place(model, pose_about(centre_, values.head<3>(), values.tail<3>()));
  }

 private:
  Vector3d centre_;
  double size_;
  std::string length_;
};

class SelfWeight final : public Ingredient {
 public:
  explicit SelfWeight(const Vector3d& gravity) : gravity_(gravity) {}
  std::string name() const override { return "self_weight"; }
  std::vector<Parameter> parameters() const override { return {}; }
  Touches touches() const override { return {.loading = true}; }
  void apply(const Eigen::VectorXd&, Model& model) const override {
    const Vector3d in_body = model.placement.linear().transpose() * gravity_;
    const auto weight =
        self_weight(model.scene->body->mesh, density_or_one(model.scene->capture), in_body);
    for (auto& example : model.examples) example.loading.forces.push_back(weight);
    model.gravity += gravity_;
  }

 private:
  Vector3d gravity_;
};

/// Every control value moves.
bool asks_for_additive(const Capture& capture) {
  return !capture.materials.empty() && capture.fit == std::vector<std::string>{"additive"} &&
         std::all_of(capture.materials.begin(), capture.materials.end(),
                     [](const MaterialSpec& spec) { return spec.law == "additive"; });
}

[[noreturn]] void unknown_parameter(const Capture& capture, size_t i,
                                    const std::vector<std::string>& known) {
  const std::string& wanted = capture.fit[i];
  const std::string near = nearest_name(wanted, known);
  throw InputError(capture.fit_places[i], fmt::format("the material has no parameter '{}'", wanted),
                   near.empty() ? fmt::format("one of: {}", fmt::join(known, ", "))
                                : fmt::format("did you mean '{}'?", near));
}

}  // namespace

std::vector<std::shared_ptr<const Ingredient>> material_ingredients(const Scene& scene,
                                                                    const EnergyModel& energy) {
  const Capture& capture = scene.capture;
  if (asks_for_additive(capture)) {
    std::vector<std::shared_ptr<const Ingredient>> all;
    for (size_t i = 0; i < capture.materials.size(); ++i)
      all.push_back(additive_material(*additive_model(*energy.parts.at(i).term), capture.units,
                                      {static_cast<int>(i), capture.materials[i].region}));
    return all;
  }
  std::vector<Material::Slot> slots;
  for (size_t i = 0; i < capture.fit.size(); ++i) {
    std::vector<std::string> known;
    bool found = false;
    for (size_t part = 0; part < energy.parts.size(); ++part) {
      const auto declared = energy.parts[part].term->parameters(capture.units);
      const std::string& region = capture.materials[part].region;
      for (size_t k = 0; k < declared.size(); ++k) {
        const std::string qualified =
            region.empty() ? declared[k].name : region + "." + declared[k].name;
        known.push_back(qualified);
        // The name of an addend stands for all of its control values.
        const bool of_addend = declared[k].name.rfind(capture.fit[i] + ".", 0) == 0 ||
                               qualified.rfind(capture.fit[i] + ".", 0) == 0;
        if (capture.fit[i] != qualified && capture.fit[i] != declared[k].name && !of_addend)
          continue;
        Parameter parameter = declared[k];
        parameter.name = qualified;
        slots.push_back({static_cast<int>(part), static_cast<int>(k), parameter});
        found = true;
      }
    }
    if (!found) unknown_parameter(capture, i, known);
  }
  if (slots.empty()) return {};
  return {std::make_shared<Material>(std::move(slots))};
}

std::shared_ptr<const Ingredient> rigid_support_ingredient(const Scene& scene) {
  std::vector<RigidSupports::Slot> slots;
  for (size_t e = 0; e < scene.capture.examples.size(); ++e)
    for (const auto& support : scene.capture.examples[e].supports) {
      if (support.kind != SupportSpec::Kind::rigid_fit) continue;
      const Region& region = scene.body->regions.at(support.region);
      slots.push_back({static_cast<int>(e), support.region, region.centroid,
                       std::sqrt(std::max(region.area, 1e-300))});
    }
  if (slots.empty()) return nullptr;
  return std::make_shared<RigidSupports>(std::move(slots), scene);
}

std::shared_ptr<const Ingredient> light_ingredient(const Scene& scene) {
  if (scene.capture.light.fit_harmonics) return std::make_shared<Harmonics>();
  return std::make_shared<Light>();
}

std::shared_ptr<const Ingredient> lens_ingredient(const Scene& scene) {
  std::vector<Camera> cameras;
  for (const Camera& camera : scene.capture.cameras)
    if (camera.fit_vignetting || camera.fit_colour_zoom) cameras.push_back(camera);
  if (cameras.empty()) return nullptr;
  return std::make_shared<Lenses>(std::move(cameras));
}

std::shared_ptr<const Ingredient> albedo_ingredient() { return std::make_shared<Albedo>(); }

std::shared_ptr<const Ingredient> background_ingredient(const Scene& scene) {
  std::vector<std::string> cameras;
  for (const auto& camera : scene.capture.cameras) {
    bool any = false;
    for (const auto& example : scene.capture.examples)
      for (const auto& photo : example.photos)
        any |= photo.camera == camera.name && Background::is_fitted(photo);
    if (any) cameras.push_back(camera.name);
  }
  if (cameras.empty()) return nullptr;
  return std::make_shared<Background>(std::move(cameras));
}

std::shared_ptr<const Ingredient> placement_ingredient(const Scene& scene) {
  const Matrix3Xd& X = scene.body->mesh.X;
  return std::make_shared<Placement>(X.rowwise().mean(), extent(X), scene.capture.units.length);
}

std::shared_ptr<const Ingredient> self_weight_ingredient(const Vector3d& gravity_in_world) {
  return std::make_shared<SelfWeight>(gravity_in_world);
}

void place(Model& model, const Eigen::Isometry3d& motion) {
  const Vector3d gravity_before = model.placement.linear().transpose() * model.gravity;
  model.placement = model.placement * motion;
  std::shared_ptr<const ForceTerm> turned;
  if (!model.gravity.isZero(0.0))
    turned = self_weight(model.scene->body->mesh, density_or_one(model.scene->capture),
                         model.placement.linear().transpose() * model.gravity - gravity_before);
  for (auto& example : model.examples) {
    if (turned) example.loading.forces.push_back(turned);
    for (auto& photo : example.photos) {
      photo.camera.t += photo.camera.R * motion.translation();
      photo.camera.R = photo.camera.R * motion.linear();
      photo.sun = motion.linear().transpose() * photo.sun;
      photo.uneven = hookeye::turned(photo.uneven, motion.linear().transpose());
    }
  }
}

Eigen::Isometry3d pose_about(const Vector3d& centre, const Vector3d& rotation,
                             const Vector3d& translation) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const double angle = rotation.norm();
  if (angle > 0.0) pose.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  pose.translation() = centre - pose.linear() * centre + translation;
  return pose;
}

double density_or_one(const Capture& capture) {
  return capture.body.density > 0.0 ? capture.body.density : 1.0;
}

}  // namespace hookeye
