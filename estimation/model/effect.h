// What an effect is. A new one is one file in estimation/effects/ and one line in
// estimation/effects/catalogue.def.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "estimation/model/model.h"

namespace hookeye {

enum class EffectGroup { material, loads, supports, history, measurement, numerical };

using Ingredients = std::vector<std::shared_ptr<const Ingredient>>;

/// Why a fit goes on from one form of an effect to another.
enum class FormEdge {
  refit,    ///< larger, after the score named it (blob to field, compliance to log stiffness)
  smaller,  ///< may say as much (a field that stands out in one place: one blob); kept where it
            ///< misses no more
  plainer,  ///< without numbers that may be nothing (a tilt, a lamp's strength beside its angles);
            ///< kept where they do not pay for themselves
  further   ///< another of the same meaning (fibres that only pull, creep that levels off), or the
            ///< same form started in another valley: tried where more than noise is left
};

/// Another form of an effect, started where it is most like the one that leads to it.
struct NextForm {
  std::shared_ptr<const Ingredient> form;
  Eigen::VectorXd values;
  /// Another form of the same parameters, fitted from `values` first: `form` starts where it
  /// ends. Null: `form` is fitted at once.
  std::shared_ptr<const Ingredient> by_way_of = nullptr;
  /// It says the same in another shape (a place that ends at an edge, or fades): it need not take
  /// most of what is left, which may be another effect's.
  bool same_claim = false;
};

/// One hypothesis: an ingredient whose null values leave the model unchanged.
///
/// Recipe: write estimation/effects/NAME.cpp with a class derived from Effect and
/// `HOOKEYE_DEFINE_EFFECT(NAME, ClassName)` at its end; add HOOKEYE_EFFECT(NAME) to catalogue.def.
class Effect {
 public:
  virtual ~Effect() = default;
  virtual std::string name() const = 0;
  virtual EffectGroup group() const = 0;
  virtual std::string title() const = 0;  ///< "self-weight", for people
  /// What it is, what it is easily taken for: two sentences for the manual.
  virtual std::string manual() const = 0;
  /// The ways in which the effect can be present in this model (which camera, from which example
  /// on, which field). All candidates are scored; the best stands for the effect. Parameters'
  /// `value` are the nulls. Empty: not applicable to this capture (reason in `why_not`).
  virtual Ingredients candidates(const Model& model, std::string* why_not) const = 0;
  /// Whether a model may hold it more than once, each time with parameters of their own names: two
  /// cameras that were knocked, the loads of two examples.
  virtual bool several() const { return false; }
  /// What may stand beside those of its own that the model holds already (`standing`, not empty;
  /// `model` has them). Those whose parameters' names are taken are left out by who asks. Default:
  /// candidates() where it may stand more than once, else none.
  virtual Ingredients candidates_beside(const Model& model, const Ingredients& standing,
                                        std::string* why_not) const;
  /// Candidate for write/read: by variant(). Null when the variant is not one of this effect's.
  std::shared_ptr<const Ingredient> candidate(const Model& model, const std::string& variant) const;
  /// Builds what candidates() does not list (refit forms) or lists only for the very same mesh;
  /// asked first by candidate(). Null: look among the candidates.
  virtual std::shared_ptr<const Ingredient> rebuild(const Model& model,
                                                    const std::string& variant) const;
  /// The forms to which one goes on from `from` at `values`, along edges of that kind, likeliest
  /// first: the graph of the effect's forms. `model` is without the effect. Default: none.
  virtual std::vector<NextForm> forms_from(FormEdge edge, const Model& model,
                                           const Ingredient& from,
                                           const Eigen::VectorXd& values) const;
  /// The first of forms_from(). Empty: there is none.
  std::optional<NextForm> form_from(FormEdge edge, const Model& model, const Ingredient& from,
                                    const Eigen::VectorXd& values) const;
  /// What a refit of a scored form fits: along FormEdge::refit, or the form itself.
  NextForm refit_form(const Model& model, const std::shared_ptr<const Ingredient>& scored,
                      const Eigen::VectorXd& values) const;
  /// Whether the form of this variant lives on another mesh than the capture tells; then
  /// refit_scene() makes the scene to fit on, from the capture of `scene`.
  virtual bool remeshes(const std::string& variant) const;
  virtual std::shared_ptr<const Scene> refit_scene(const Scene& scene,
                                                   const std::string& variant) const;
  /// One plain clause from figures: "self-weight, 9.6 m/s2 towards (0.5, -0.2, -0.8)".
  virtual std::string sentence(const Model& model, const Ingredient& ingredient,
                               const Eigen::VectorXd& values) const = 0;
};

/// Effects by name, in an order. Handed down to what makes a model again: no file below
/// estimation/effects knows one.
class Catalogue {
 public:
  /// Effects live as long as the program; none is null.
  explicit Catalogue(std::vector<const Effect*> effects) : effects_(std::move(effects)) {}
  /// Null: no effect of this name.
  const Effect* find(const std::string& name) const;
  auto begin() const { return effects_.begin(); }
  auto end() const { return effects_.end(); }
  size_t size() const { return effects_.size(); }
  const Effect* operator[](size_t i) const { return effects_[i]; }

 private:
  std::vector<const Effect*> effects_;
};

}  // namespace hookeye

/// Ends an effect's file: the one function that catalogue.cpp calls.
#define HOOKEYE_DEFINE_EFFECT(NAME, CLASS) \
  namespace hookeye {                      \
  const Effect& effect_##NAME() {          \
    static const CLASS effect;             \
    return effect;                         \
  }                                        \
  }
