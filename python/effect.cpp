#include "python/effect.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/stl.h>

#include <map>
#include <stdexcept>

#include "core/input_error.h"
#include "estimation/effects/catalogue.h"
#include "estimation/effects/session_effects.h"
#include "estimation/effects/toolbox.h"
#include "estimation/model/declaration.h"
#include "python/effect_term.h"
#include "python/errors.h"

namespace hookeye {

namespace py = pybind11;

namespace {

/// Which methods the class has.
struct Kinds {
  bool energy = false, of_invariants = false;
  bool body_force = false, traction = false, follows = false;
  bool photo = false;
};

/// What hookeye._bridge.Bridge.setup() says of one capture.
struct Declared {
  std::vector<Parameter> parameters;
  std::string region;    ///< of a traction; empty: the whole surface
  bool cameras = false;  ///< photo() says where photos show a point, not only how bright
  VectorXd weights;      ///< of the energy in the elements; empty: 1 everywhere
  std::string why_not;   ///< it does not apply here
};

Declared declared_from(const std::string& effect, const py::dict& told, Eigen::Index elements) {
  Declared out;
  out.why_not = told["why_not"].cast<std::string>();
  out.region = told["region"].cast<std::string>();
  out.cameras = told["cameras"].cast<bool>();
  if (!told["weights"].is_none()) out.weights = Bridge::rows_of(told["weights"], elements, 1);
  for (const py::handle& one : told["parameters"]) {
    Parameter p;
    p.name = effect + "." + one["name"].cast<std::string>();
    p.unit = one["unit"].cast<std::string>();
    p.long_name = one["words"].cast<std::string>();
    p.value = one["null"].cast<double>();
    p.low = one["low"].cast<double>();
    p.high = one["high"].cast<double>();
    p.typical = one["typical"].cast<double>();
    out.parameters.push_back(std::move(p));
  }
  return out;
}

py::dict setup_info(const Model& model, double shear_modulus) {
  const Scene& scene = *model.scene;
  const TetMesh& mesh = scene.body->mesh;
  const BodySize body = body_size(scene);
  py::list regions, examples, cameras;
  for (const auto& [region, patch] : scene.body->regions.all()) regions.append(region);
  for (const ExampleSpec& one : scene.capture.examples) examples.append(one.name);
  for (const Camera& one : scene.capture.cameras) cameras.append(one.name);
  py::dict out;
  out["points"] = points_array(mesh.X);
  out["elements"] = int_rows(mesh.elements);
  out["size"] = body.size;
  out["centre"] = array_of(VectorXd(body.centre));
  out["shear_modulus"] = shear_modulus;
  out["length"] = scene.capture.units.length;
  out["force"] = scene.capture.units.force;
  out["stress"] = scene.capture.units.stress();
  out["regions"] = regions;
  out["examples"] = examples;
  out["cameras"] = cameras;
  return out;
}

/// Adds what a row of photo() says: by PhotoColumn, those before kVignetting.
void change_photo(PhotoState& photo, const Eigen::Matrix<double, kVignetting, 1>& by) {
  if (!by.head(kZoom).isZero(0.0))
    photo.camera = photo.camera.moved(by.segment<3>(kRotate), by.segment<3>(kMove));
  if (by[kZoom] != 0.0) photo.camera = photo.camera.zoomed(by[kZoom]);
  photo.gain *= std::exp(by[kLogGain]);
  photo.ambient += by[kAmbient];
  photo.sun += by.segment<3>(kSun);
  photo.specular += by[kSpecular];
  photo.blur_variance = std::max(0.0, photo.blur_variance + by[kBlur]);
  photo.background += by[kBackground];
}

/// Asks photo() for all photos in one call.
void change_photos(const Bridge& bridge, const VectorXd& values, Model& model) {
  const auto& examples = model.scene->capture.examples;
  Eigen::Index count = 0;
  for (const ExampleModel& one : model.examples)
    count += static_cast<Eigen::Index>(one.photos.size());
  const Bridge::Rows rows = bridge.ask([&](py::handle effect) {
    py::list shots;
    for (size_t e = 0; e < model.examples.size(); ++e)
      for (size_t k = 0; k < model.examples[e].photos.size(); ++k)
        shots.append(py::make_tuple(examples[e].name, examples[e].photos[k].camera, e));
    return Bridge::rows_of(effect.attr("photos")(shots, array_of(values)), count, kVignetting);
  });
  Eigen::Index next = 0;
  for (ExampleModel& one : model.examples)
    for (PhotoState& photo : one.photos) change_photo(photo, rows.row(next++).transpose());
}

class PythonEffect final : public Effect {
 public:
  /// `told`: hookeye._bridge.Bridge.
  explicit PythonEffect(const py::object& told) : bridge_(std::make_shared<Bridge>(told)) {
    name_ = told.attr("name").cast<std::string>();
    title_ = told.attr("title").cast<std::string>();
    manual_ = told.attr("manual").cast<std::string>();
    code_ = told.attr("code").cast<std::string>();
    const std::string group = told.attr("group").cast<std::string>();
    for (int g = 0; g <= static_cast<int>(EffectGroup::numerical); ++g)
      if (group_name(static_cast<EffectGroup>(g)) == group) group_ = static_cast<EffectGroup>(g);
    const auto kinds = told.attr("kinds").cast<std::map<std::string, bool>>();
    kinds_ = {kinds.at("energy"),   kinds.at("of_invariants"), kinds.at("body_force"),
              kinds.at("traction"), kinds.at("follows"),       kinds.at("photo")};
  }

  std::string name() const override { return name_; }
  EffectGroup group() const override { return group_; }
  std::string title() const override { return title_; }
  std::string manual() const override { return manual_; }
  const std::string& code() const { return code_; }

  Ingredients candidates(const Model& model, std::string* why_not) const override {
    const double mu = initial_shear_modulus(model.energy);
    const Declared declared = bridge_->ask([&](py::handle effect) {
      return declared_from(name_, effect.attr("setup")(setup_info(model, mu)).cast<py::dict>(),
                           model.scene->body->mesh.size());
    });
    std::string reason = declared.why_not;
    if (reason.empty()) reason = unknown_region(*model.scene, declared.region);
    if (!reason.empty()) {
      if (why_not) *why_not = reason;
      return {};
    }
    return {made(*model.scene, declared)};
  }

  /// Values that were fitted by other code mean something else.
  std::shared_ptr<const Ingredient> rebuild(const Model&,
                                            const std::string& variant) const override {
    if (starts_with(variant, kCode) && variant != kCode + code_)
      throw InputError({name_},
                       "this effect has other code than the one that the run was fitted by",
                       "register that code, or fit anew");
    return nullptr;
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    std::string numbers;
    const auto parameters = ingredient.parameters();
    for (size_t i = 0; i < parameters.size(); ++i) {
      const std::string unit = parameters[i].unit.empty() ? "" : " " + parameters[i].unit;
      numbers +=
          fmt::format("{}{} {}{}", i > 0 ? ", " : "", parameters[i].name.substr(name_.size() + 1),
                      figure(values[static_cast<Eigen::Index>(i)]), unit);
    }
    (void)model;
    const std::string own = bridge_->ask([&](py::handle effect) {
      return effect.attr("sentence")(array_of(values)).cast<std::string>();
    });
    return own.empty() ? fmt::format("{}: {}", title_, numbers) : own;
  }

 private:
  static constexpr const char* kCode = "code ";

  std::string unknown_region(const Scene& scene, const std::string& region) const {
    if (region.empty()) return "";
    std::vector<std::string> known;
    for (const auto& [one, patch] : scene.body->regions.all()) {
      if (one == region) return "";
      known.push_back(one);
    }
    return fmt::format("there is no region '{}' here; there are {}", region,
                       fmt::join(known, ", "));
  }

  std::shared_ptr<const Ingredient> made(const Scene& scene, const Declared& declared) const {
    IngredientSpec spec;
    spec.name = name_;
    spec.variant = kCode + code_;
    spec.parameters = declared.parameters;
    spec.touches.energy = kinds_.energy;
    spec.touches.loading = kinds_.body_force || kinds_.traction;
    spec.touches.photos = kinds_.photo;
    spec.touches.cameras = declared.cameras;
    const TetMesh& mesh = scene.body->mesh;
    std::shared_ptr<const LoadPoints> points;
    if (kinds_.body_force) points = std::make_shared<const LoadPoints>(volume_points(mesh));
    if (kinds_.traction) {
      const Region region =
          declared.region.empty() ? whole_boundary(mesh) : scene.body->regions.at(declared.region);
      points = std::make_shared<const LoadPoints>(surface_points(mesh, region));
    }
    const EnergyOf of = kinds_.of_invariants ? EnergyOf::invariants : EnergyOf::gradient;
    spec.apply = [bridge = bridge_, kinds = kinds_, of, weights = declared.weights, points](
                     const VectorXd& values, Model& m) {
      if (kinds.energy) m.energy.parts.push_back({python_energy(bridge, of, values), weights});
      if (points) add_forces(bridge, points, kinds.follows, values, m);
      if (kinds.photo) change_photos(*bridge, values, m);
    };
    return make_ingredient(std::move(spec));
  }

  static void add_forces(const std::shared_ptr<const Bridge>& bridge,
                         const std::shared_ptr<const LoadPoints>& points, bool follows,
                         const VectorXd& values, Model& model) {
    const auto& examples = model.scene->capture.examples;
    const auto shares = bridge->ask([&](py::handle effect) {
      std::vector<double> out;
      for (size_t e = 0; e < model.examples.size(); ++e)
        out.push_back(effect.attr("share")(examples[e].name, e).cast<double>());
      return out;
    });
    std::map<double, std::shared_ptr<const ForceTerm>> made;  // most cases have the same share
    for (size_t e = 0; e < model.examples.size(); ++e) {
      if (shares[e] == 0.0) continue;
      auto& force = made[shares[e]];
      if (!force) force = python_force(bridge, points, follows, shares[e], values);
      model.examples[e].loading.forces.push_back(force);
    }
  }

  std::shared_ptr<const Bridge> bridge_;
  std::string name_, title_, manual_, code_;
  EffectGroup group_ = EffectGroup::material;
  Kinds kinds_;
};

}  // namespace

void bind_effects(py::module_& m) {
  m.def(
      "register_effect",
      [](const py::object& bridge) {
        auto effect = std::make_shared<const PythonEffect>(bridge);
        const std::string code = effect->code();
        try {
          add_to_catalogue(std::move(effect), code);
        } catch (const std::invalid_argument& error) {
          bad_argument(error.what(), "another name");
        }
      },
      py::arg("bridge"));
  m.def("unregister_effect", &take_from_catalogue, py::arg("name"));
}

}  // namespace hookeye
