#include "estimation/search/verdict.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "capture_io/seen_in_words.h"
#include "estimation/effects/catalogue.h"
#include "estimation/fit/at_floor.h"
#include "estimation/model/effect.h"
#include "estimation/search/contest.h"
#include "estimation/search/measured_explained.h"
#include "estimation/search/said_intervals.h"

namespace hookeye {

bool only_numerical_left(const Fitted& fitted, const Diagnosis& diagnosis, const FitToAll* all) {
  return (all || explained(fitted, diagnosis)) &&
         std::all_of(diagnosis.effects.begin(), diagnosis.effects.end(), [&](const auto& effect) {
           return numerical(effect.effect) || !nameable(effect, diagnosis);
         });
}

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::explained:
      return "explained";
    case Verdict::ambiguous:
      return "ambiguous";
    default:
      return "unexplained";
  }
}

namespace {

/// ", and ... stands out by less than a finer mesh would change": the largest evidence that is kept
/// from being named by the mesh's error alone. "" where there is none.
std::string hidden_by_mesh(const Diagnosis& diagnosis) {
  for (const EffectScore& effect : diagnosis.effects)
    if (effect.testable && !numerical(effect.effect) &&
        effect.evidence >= std::max(diagnosis.limits().nameable, diagnosis.gate) &&
        effect.fall < effect.mesh_fall && effect.mesh_fall >= least_fall(diagnosis, effect.effect))
      return fmt::format(
          ", and {} stands out by less than a mesh finer still would change: give the body one "
          "(mesh: {{edge: ...}}) and run again",
          effect.effect);
  return "";
}

const char* what_is_seen(const Fitted& fitted) { return seen_in_words(fitted.form.scene->capture); }

/// Fitted photos that are explained know no more: the user hears which held-out ones do.
std::string shown_by_held_out(const Fitted& fitted) {
  const ExampleEvaluation* worst = nullptr;
  const auto chi2 = [](const ExampleEvaluation& example) {
    double r2 = 0.0, count = 0.0;
    for (const auto& photo : example.photos) r2 += photo.r2, count += photo.count;
    for (const auto& measured : example.measured)
      if (example.photos.empty() && measured.is_field())
        r2 += measured.r.squaredNorm(), count += measured.size();
    return r2 / std::max(1.0, count);
  };
  for (const auto& example : fitted.evaluation.examples)
    if (example.held_out && (!worst || chi2(example) > chi2(*worst))) worst = &example;
  if (!worst || chi2(*worst) == 0.0) return "";
  return fmt::format(
      ", and what is missing shows in held-out {} alone, most in '{}': no values that the "
      "fitted ones allow were found to explain it. Fit it too (without use: validate), with "
      "another load held out",
      what_is_seen(fitted), fitted.form.scene->capture.examples[worst->example].name);
}

/// The effects are right for all that is seen; held-out photos are missed by values.
std::string held_out_by_values(const FitToAll& all, const Floor& floor) {
  return fmt::format(
      ", {:.2f} and {:.2f} where the held-out ones are fitted too: the fitted ones alone do not "
      "know the values well enough to predict them. Fitted to all, {}. To have these, fit the "
      "held-out examples too (without use: validate), with another load held out",
      all.chi_fit / floor.chi, all.chi_validate / floor.chi, fmt::join(all.hardly_known, ", "));
}

/// All photos together are at the floor, those of one camera are not: ", but 1.45 times its own in
/// the fitted photos of camera 'cam1', more than 1.3".
std::string left_in_one_camera(const Fitted& fitted, const Floor& floor) {
  if (!at_floor(fitted, floor) || explains_photos(fitted, floor)) return "";
  const CameraOverFloor most = most_over_floor(fitted, floor);
  return fmt::format(", but {:.2f} times its own in the {} photos of camera '{}', more than {:g}",
                     most.times, most.held_out ? "held-out" : "fitted", most.camera,
                     floor.limits->floor.at);
}

}  // namespace

Verdict judge(const Fitted& fitted, const Diagnosis& diagnosis, const std::vector<std::string>& tie,
              std::string* why, const FitToAll* all) {
  const double chi = fitted.evaluation.chi(false), held_out = fitted.evaluation.chi(true);
  const auto standing =
      only_numerical_left(fitted, diagnosis, all) ? std::vector<std::string>() : leaders(diagnosis);
  std::string sensors;
  const bool photos = all || photos_explained(fitted, diagnosis);
  const bool measured = all || measured_explained(fitted, diagnosis, &sensors);
  if (why) {
    *why = fmt::format(
        "what is left is {:.2f} times the noise floor{}{}", chi / diagnosis.floor.chi,
        held_out > 0.0 ? fmt::format(" ({:.2f} on held-out {})", held_out / diagnosis.floor.chi,
                                     what_is_seen(fitted))
                       : "",
        photos || at_floor(fitted, diagnosis.floor)
            ? ""
            : fmt::format(", more than {:g}", diagnosis.floor.limits->floor.at));
    if (!all) *why += left_in_one_camera(fitted, diagnosis.floor);
    if (const MotionLeft* moved = most_moved(diagnosis.motions); moved && !all)
      *why += (at_floor(fitted, diagnosis.floor) ? ", but " : ", and ") +
              in_words(*moved, *fitted.form.scene);
    if (!sensors.empty()) *why += ", but " + sensors;
    if (all) *why += held_out_by_values(*all, diagnosis.floor);
    if (!standing.empty())
      *why += fmt::format(", and {} still stand{} out", fmt::join(standing, " and "),
                          standing.size() == 1 ? "s" : "");
    else if (!photos)
      *why += spoils_held_out(fitted, diagnosis.floor) ? shown_by_held_out(fitted)
                                                       : hidden_by_mesh(diagnosis);
    else if (measured && !all && !on_floor(fitted, diagnosis.floor))
      *why += fmt::format(
          ", over {:g}: what the mesh or the renderer may err by, or something small that is not "
          "named",
          diagnosis.floor.limits->floor.on);
  }
  // Two that leave as much are no answer to choose from where that is much.
  if (!photos || !measured) return Verdict::unexplained;
  return tie.empty() ? Verdict::explained : Verdict::ambiguous;
}

namespace {

/// Every named effect changes how bright or sharp photos are, and nothing of where they show the
/// body.
bool brightness_alone_is_named(const Fitted& fitted) {
  return std::all_of(
      fitted.form.ingredients.begin(), fitted.form.ingredients.end(), [](const auto& ingredient) {
        const std::string& name = ingredient->name();
        return !find_effect(name) || numerical(name) || brightness_alone(*ingredient);
      });
}

}  // namespace

std::string more_stays(const Fitted& fitted, const Diagnosis& diagnosis,
                       const TakenByNames& taken) {
  // The rest photos' floor is shading and texture gone wrong: of brightness' own kind.
  Floor floor = diagnosis.floor;
  const bool bright = floor.chi > floor.limits->floor.on && brightness_alone_is_named(fitted);
  if (bright) floor.chi = 1.0;
  const bool named = taken.fit > 0.0 || taken.held_out > 0.0;
  if (!named || fitted.evaluation.seen() == Evaluation::Seen::sensors || on_floor(fitted, floor) ||
      sensors_speak(taken.measured, diagnosis) || taken.fit >= over_floor(fitted, floor, false) ||
      taken.held_out > over_floor(fitted, floor, true))
    return "";
  if (bright)
    return fmt::format(
        "; what was named changes brightness alone, and has taken less than what stays over the "
        "told noise ({:.2f} times it in the rest photos), of which it may be part",
        diagnosis.floor.chi);
  const bool mesh = std::any_of(diagnosis.effects.begin(), diagnosis.effects.end(),
                                [&](const EffectScore& effect) {
                                  return numerical(effect.effect) && nameable(effect, diagnosis);
                                });
  return fmt::format(
      "; that is more than what was named has taken, which may be part of what is not named{}",
      mesh ? ". A finer mesh would tell (mesh: {edge: ...}): run again on it" : "");
}

std::string moved_at_rest(const Fitted& fitted, const Diagnosis& diagnosis) {
  const Floor& floor = diagnosis.floor;
  if (on_floor(fitted, floor)) return "";
  const auto most =
      std::max_element(floor.moved_at_rest.begin(), floor.moved_at_rest.end(),
                       [](auto& one, auto& other) { return one.second < other.second; });
  if (most == floor.moved_at_rest.end()) return "";
  // A renderer's error is rough: it moves a photo smoothly by a twentieth of what it leaves at most
  // (Cycles, 0.03 px beside 1.9 times the noise).
  const double rough = floor.chi * floor.chi - 1.0;
  // Less than a tenth of what stays says nothing of the rest of it.
  const double stays = std::max(over_floor(fitted, floor, false), over_floor(fitted, floor, true));
  if (most->second <=
      std::max({renderers_err_by(floor), rough, floor.limits->search.at_rest_share * stays}))
    return "";
  return fmt::format(
      "; rest photos of camera '{}' still show the body moved, by {:.2g} px, where the model has "
      "it as it was given: no mesh and no material moves a body without a load. What does is not "
      "named (where the camera or the body stands, a lens, a weight)",
      most->first, std::sqrt(most->second / floor.per_px2));
}

namespace {

/// "; ... ended at ...": of numbers that went to the end of what is tried. What a bound gave is no
/// measurement. Not where the null lies there: a spring may be rigid. Nor of a NaN, which is said
/// to be unknown anyway.
std::string at_their_bounds(const Ingredient& ingredient, const VectorXd& values) {
  std::string out;
  const auto parameters = ingredient.parameters();
  for (size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& one = parameters[i];
    const double value = values[static_cast<Eigen::Index>(i)];
    for (const bool high : {false, true}) {
      const double bound = high ? one.high : one.low;
      const double near = 1e-6 * one.typical + 1e-9 * std::abs(bound);
      if (std::isnan(value) || !std::isfinite(bound) || std::abs(value - bound) > near ||
          bound == one.value)
        continue;
      out += fmt::format(
          "; the {} ended at the {} that is tried, {:g}{}{}: how {} it is, is not known",
          one.long_name, high ? "largest" : "smallest", bound, one.unit.empty() ? "" : " ",
          one.unit, high ? "large" : "small");
    }
  }
  return out;
}

}  // namespace

std::vector<std::string> effects_in_words(const Fitted& fitted) {
  std::vector<std::string> out;
  const KnownValues all = known_values(fitted);
  ModelForm before = fitted.form;
  before.ingredients.clear();
  const ParameterLayout at = fitted.form.layout();
  for (size_t i = 0; i < fitted.form.ingredients.size(); ++i) {
    const auto& ingredient = fitted.form.ingredients[i];
    if (const Effect* effect = find_effect(ingredient->name())) {
      const Model model = before.realise(at.before(fitted.p, i));
      const auto say = [&](const VectorXd& values) {
        return effect->sentence(model, *ingredient, values);
      };
      KnownValues known = part_of(all, at[i].first, at[i].size);
      forget_unknown_centres(ingredient->parameters(), known);
      if (known.value.size() == 0) known.value = at.of(fitted.p, i);
      out.push_back(fmt::format("{}: {}{}", effect->name(), said_with_intervals(say, known),
                                at_their_bounds(*ingredient, known.value)));
    }
    before.ingredients.push_back(ingredient);
  }
  return out;
}

std::string too_little_to_name(const Diagnosis& diagnosis, const std::string& seen) {
  for (const EffectScore& score : diagnosis.effects) {
    if (!score.testable || numerical(score.effect)) continue;
    const bool chance = score.evidence < std::max(diagnosis.limits().nameable, diagnosis.gate);
    if (chance || nameable(score, diagnosis) ||
        score.explains_held_out < diagnosis.floor.limits->search.hint)
      return "";
    return fmt::format(
        "not named, but worth a look: {} would remove {:.0f} % of what is over the floor, {:.0f} % "
        "on held-out {}, which is less than renderers and meshes err by (`hookeye add` tries "
        "it)",
        score.effect, 100.0 * score.explains, 100.0 * score.explains_held_out, seen);
  }
  return "";
}

namespace {

/// "gravity and either creep or softening (...)". Of a tie the first stands in the model
/// (discover() settles it so), the others would do in its place.
std::string named_with_tie(std::vector<std::string> missing, const std::vector<std::string>& tie,
                           const std::string& seen) {
  const auto standing =
      tie.empty() ? missing.end() : std::find(missing.begin(), missing.end(), tie.front());
  if (standing != missing.end()) {
    *standing = fmt::format("either {} (these {} cannot tell which)", fmt::join(tie, " or "), seen);
    std::rotate(standing, standing + 1, missing.end());
  }
  return fmt::format("{}", fmt::join(missing, " and "));
}

}  // namespace

std::vector<std::string> cannot_be_told(const Diagnosis& diagnosis) {
  std::vector<std::string> out;
  for (const EffectScore& score : diagnosis.effects)
    if (score.testable && !numerical(score.effect) && score.evidence > diagnosis.gate &&
        score.evidence < diagnosis.limits().nameable &&
        score.explains >= diagnosis.floor.limits->search.worth_a_name)
      out.push_back(score.effect);
  return out;
}

std::string any_of_them(const std::vector<std::string>& effects) {
  constexpr size_t kTold = 3;
  std::vector<std::string> told(
      effects.begin(),
      effects.begin() + static_cast<std::ptrdiff_t>(std::min(effects.size(), kTold)));
  if (effects.size() > kTold)
    told.push_back(effects.size() == kTold + 1
                       ? effects.back()
                       : fmt::format("{} other effects", effects.size() - kTold));
  const std::string last = told.empty() ? "" : told.back();
  if (told.size() < 2) return last;
  told.pop_back();
  return fmt::format("{} or {}", fmt::join(told, ", "), last);
}

std::string say(Verdict verdict, const std::vector<std::string>& missing,
                const std::vector<std::string>& tie, std::string why, const std::string& refused,
                const std::vector<std::string>& untold, const std::string& seen) {
  if (verdict == Verdict::unexplained && !untold.empty())
    why += fmt::format("; {} stand{} out by more than chance, but these {} hold too little to tell",
                       any_of_them(untold), untold.size() > 1 ? "" : "s", seen);
  if (!refused.empty()) why += "; nothing more was added: " + refused;
  std::vector<std::string> physical = missing, mesh;
  std::erase_if(physical, numerical);
  std::copy_if(missing.begin(), missing.end(), std::back_inserter(mesh), numerical);
  const std::string finer =
      mesh.empty() ? "" : fmt::format("a finer mesh ({})", fmt::join(mesh, " and "));
  if (!physical.empty())
    return fmt::format("{}: {}; with {}{}, {}",
                       verdict == Verdict::unexplained ? "named, but not enough" : "missing",
                       named_with_tie(physical, tie, seen), physical.size() == 1 ? "it" : "them",
                       mesh.empty() ? "" : " on " + finer, why);
  if (verdict != Verdict::explained)
    return fmt::format("{}: {}{}",
                       !refused.empty() ? std::string("nothing that was tried explains it")
                       : untold.empty() ? std::string("not in the catalogue")
                                        : "not told by these " + seen,
                       mesh.empty() ? "" : "even on " + finer + ", ", why);
  if (!mesh.empty()) return fmt::format("nothing is missing but {}: on it, {}", finer, why);
  return fmt::format(
      "{}: {}", refused.empty() ? "nothing is missing" : "nothing that is missing pays for itself",
      why);
}

}  // namespace hookeye
