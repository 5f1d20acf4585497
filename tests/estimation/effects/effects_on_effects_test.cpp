// Effects beside effects: each one's derivatives know of all that the model has already.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "estimation/effects/catalogue.h"
#include "estimation/effects_scene.h"
#include "estimation/evaluation/columns.h"
#include "estimation/model/model.h"
#include "simulation/equilibrium.h"
#include "support/derivative.h"

namespace hookeye::test {
namespace {

/// A model to which effects have been added that scale stiffness by example and by element and
/// change the rest size: what derivatives must know of.
struct Crowded {
  std::shared_ptr<const Scene> scene;
  ModelForm form;
  VectorXd p;
  explicit Crowded(std::shared_ptr<const Scene> s)
      : scene(std::move(s)), form(base_form(scene)), p(form.initial()) {
    // the last stands beside the field, which does not scale it
    for (const char* name :
         {"softening", "creep", "swelling", "stiffness_field", "strain_stiffening"}) {
      const auto one = find_effect(name)->candidates(form.realise(p), nullptr).front();
      add(one, some_values(*one));
    }
  }
  void add(const std::shared_ptr<const Ingredient>& one, const VectorXd& values) {
    form = extended(form, one);
    p.conservativeResize(p.size() + values.size());
    p.tail(values.size()) = values;
  }

  /// dR/dp of everything that touches the mechanics, and of a candidate at its null, in every
  /// example at one state, against differences. How many of them do not vanish.
  int check(const std::shared_ptr<const Ingredient>& candidate, const VectorXd& q) const {
    const ColumnSet columns(form, p, candidate ? Ingredients{candidate} : Ingredients{});
    ModelForm whole = form;
    VectorXd at = p;
    if (candidate) {
      const VectorXd null = null_values(*candidate);
      whole = extended(form, candidate);
      at.conservativeResize(p.size() + null.size());
      at.tail(null.size()) = null;
    }
    const Model model = form.realise(p);
    Equilibrium state;
    state.q = q;
    int moving = 0;
    for (int e = 0; e < static_cast<int>(model.examples.size()); ++e) {
      const Eigen::MatrixXd dR = columns.of_example(model, e, state).dR;
      int column = 0;
      for (const auto& one : whole.ingredients)
        for (const Parameter& parameter : one->parameters()) {
          const int k = column++;
          const Touches touches = one->touches();
          if (candidate && one != candidate) continue;
          if (!touches.energy && !touches.loading) continue;
          const auto R = [&](double t) -> VectorXd {
            const Model there = whole.realise(at + t * VectorXd::Unit(at.size(), k));
            return residual(scene->body->mesh, there.energy_of(e), there.examples[e].loading, q);
          };
          const std::string label = one->name() + " [" + one->variant() + "] " + parameter.name +
                                    ", example " + std::to_string(e);
          const double h = 1e-3 * (parameter.positive ? at[k] : parameter.typical);
          // of another example, or what this state does not reach
          if ((R(h) - R(-h)).isZero(0.0)) {
            EXPECT_LE(h * dR.col(k).norm(), 1e-9 * R(0.0).norm()) << label;
            continue;
          }
          expect_derivative(R, dR.col(k), h, 1e-6, label);
          ++moving;
        }
    }
    return moving;
  }
};

TEST(EffectsOnEffects, HaveTheirDerivatives) {
  for (const auto& scene : {block_scene(), additive_block({"additive"})}) {
    Crowded crowded(scene);
    const VectorXd q = deformed_state(*scene);
    EXPECT_GT(crowded.check(nullptr, q), 20);
    // What an ingredient keeps for a state serves no other values of its neighbours.
    for (const char* name : {"creep", "swelling.", "stiffness_field"}) {
      const auto parameters = crowded.form.parameters();
      for (Eigen::Index k = 0; k < crowded.p.size(); ++k)
        if (parameters[k].name.starts_with(name)) crowded.p[k] *= 0.5;
      EXPECT_GT(crowded.check(nullptr, q), 20) << name;
    }
    const Model model = crowded.form.realise(crowded.p);
    int on_top = 0;
    for (const Effect* effect : catalogue()) {
      // These look at reactions and at other meshes: effects_sensitivity_test.cpp.
      if (effect->name() == "soft_clamp" || effect->name() == "mesh_resolution") continue;
      const auto candidates = effect->candidates(model, nullptr);
      for (size_t c = 0; c<candidates.size(); c += candidates.size()> 8 ? 5 : 1)
        on_top += crowded.check(candidates[c], q);
    }
    EXPECT_GT(on_top, 50);
  }
}

/// A place beside a place scales what came between them too.
TEST(EffectsOnEffects, APlaceBesideAPlaceHasItsDerivative) {
  Crowded crowded(block_scene());
  const Effect& field = *find_effect("stiffness_field");
  const auto first = field.candidate(base_model(), "free ball");
  crowded.form = base_form(crowded.scene);
  crowded.p = crowded.form.initial();
  crowded.add(first, some_values(*first));
  const auto stiffening = find_effect("strain_stiffening")->candidates(base_model(), nullptr);
  crowded.add(stiffening.front(), some_values(*stiffening.front()));
  const Model model = crowded.form.realise(crowded.p);
  const VectorXd q = deformed_state(*crowded.scene);
  const Ingredients beside = field.candidates_beside(model, {first}, nullptr);
  ASSERT_EQ(beside.size(), 16u);
  for (size_t i = 0; i < beside.size(); i += 5) EXPECT_GT(crowded.check(beside[i], q), 0);
  crowded.add(beside.front(), VectorXd::Constant(1, 0.7));
  EXPECT_GT(crowded.check(nullptr, q), 5);
}

}  // namespace
}  // namespace hookeye::test
