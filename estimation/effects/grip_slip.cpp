#include <fmt/format.h>

#include <set>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

/// One support that moves its region by a told amount.
struct Moved {
  int example;
  size_t support;
  bool turns = false, shifts = false;
};

std::map<std::string, std::vector<Moved>> moved_supports(const Capture& capture) {
  std::map<std::string, std::vector<Moved>> by_region;
  for (size_t e = 0; e < capture.examples.size(); ++e)
    for (size_t s = 0; s < capture.examples[e].supports.size(); ++s) {
      const SupportSpec& support = capture.examples[e].supports[s];
      Moved moved{static_cast<int>(e), s, false, false};
      if (support.kind == SupportSpec::Kind::rigid) {
        moved.turns = support.rigid.degrees != 0.0;
        moved.shifts = !support.rigid.move.isZero(0.0);
      } else if (support.kind == SupportSpec::Kind::components) {
        for (const auto& u : support.displacement) moved.shifts |= u && *u != 0.0;
      }
      if (moved.turns || moved.shifts) by_region[support.region].push_back(moved);
    }
  return by_region;
}

/// Nodes whose motion this support decides: those that no later support claims.
std::set<int> decided_nodes(const Scene& scene, const Moved& moved) {
  const auto& supports = scene.capture.examples[moved.example].supports;
  const auto& nodes = scene.body->regions.at(supports[moved.support].region).nodes;
  std::set<int> own(nodes.begin(), nodes.end());
  for (size_t s = moved.support + 1; s < supports.size(); ++s)
    for (int node : scene.body->regions.at(supports[s].region).nodes) own.erase(node);
  return own;
}

/// The support lacks the rest of these shares of its told motion. (What else moves it stays.)
void follow(Model& model, const Moved& moved, double of_turn, double of_shift) {
  const Scene& scene = *model.scene;
  const SupportSpec& support = scene.capture.examples[moved.example].supports[moved.support];
  const std::set<int> own = decided_nodes(scene, moved);
  RigidMotion motion = support.rigid;
  motion.degrees *= of_turn;
  motion.move *= of_shift;
  Loading& loading = model.examples[moved.example].loading;
  for (size_t i = 0; i < loading.prescribed.size(); ++i) {
    const int node = loading.prescribed[i] / 3, component = loading.prescribed[i] % 3;
    if (!own.count(node)) continue;
    const Vector3d X = scene.body->mesh.X.col(node);
    if (support.kind == SupportSpec::Kind::rigid)
      loading.displacement[i] += (motion.apply(X) - support.rigid.apply(X))[component];
    else if (support.displacement[component])
      loading.displacement[i] += (of_shift - 1.0) * *support.displacement[component];
  }
}

/// A grip follows only the share 1 - s of the motion it was told to make.
class GripSlip final : public Effect {
 public:
  std::string name() const override { return "grip_slip"; }
  EffectGroup group() const override { return EffectGroup::supports; }
  std::string title() const override { return "a grip that slips"; }
  bool several() const override { return true; }
  std::string manual() const override {
    return "The moved region follows only part of the told motion or rotation: it slips in the "
           "grip, or the machine gives. Easily taken for a softer material where only "
           "displacements are told; photos of the grip itself tell.";
  }

  Ingredients candidates(const Model& model, std::string* why_not) const override {
    const auto& examples = model.scene->capture.examples;
    Ingredients all;
    for (const auto& [region, moves] : moved_supports(model.scene->capture)) {
      std::vector<Moved> turning, shifting;
      bool fitted = false;
      for (const Moved& moved : moves) {
        if (moved.turns) turning.push_back(moved);
        if (moved.shifts) shifting.push_back(moved);
        if (examples[moved.example].validate) continue;
        fitted = true;
        const std::string where = fmt::format("{} in {}", region, examples[moved.example].name);
        all.push_back(slip(where, {moved}, true, true));
        if (!moved.turns || !moved.shifts) continue;
        all.push_back(slip(where + ", rotation only", {moved}, true, false));
        all.push_back(slip(where + ", translation only", {moved}, false, true));
      }
      if (!fitted || moves.size() < 2) continue;
      all.push_back(slip(region + " in all", moves, true, true));
      if (turning.empty() || shifting.empty()) continue;
      if (turning.size() > 1)
        all.push_back(slip(region + " in all, rotation only", turning, true, false));
      if (shifting.size() > 1)
        all.push_back(slip(region + " in all, translation only", shifting, false, true));
    }
    if (all.empty() && why_not) *why_not = "no support moves by a told amount";
    return all;
  }

  std::string sentence(const Model&, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    return fmt::format("the grip slips: {} follows only {} % of the told motion",
                       ingredient.variant(), figure(100.0 * (1.0 - values[0])));
  }

 private:
  std::shared_ptr<const Ingredient> slip(const std::string& variant, std::vector<Moved> moves,
                                         bool turn, bool shift) const {
    IngredientSpec spec;
    spec.name = name();
    spec.variant = variant;
    spec.parameters = {{"grip_slip." + variant, "", "share of the motion lost by " + variant, 0.0,
                        0.0, 1.0, 0.05, false}};
    spec.touches = {.loading = true};
    spec.apply = [moves, turn, shift](const VectorXd& s, Model& m) {
      for (const Moved& moved : moves)
        follow(m, moved, turn ? 1.0 - s[0] : 1.0, shift ? 1.0 - s[0] : 1.0);
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(grip_slip, GripSlip)
