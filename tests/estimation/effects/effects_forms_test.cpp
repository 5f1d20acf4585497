// Forms of one effect: names that may stand beside one another, sentences that tell which form it
// is, smaller and plainer forms that say the same, and where wider ones start.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "estimation/effects/catalogue.h"
#include "estimation/effects/floor_planes.h"
#include "estimation/effects/graded_stiffness.h"
#include "estimation/effects_scene.h"
#include "estimation/search/kept_stiffness.h"

namespace hookeye::test {

namespace {

/// What may stand in a model more than once has numbers of its own each time: where it was wrong
/// from one example on and again from another, no name stands twice.
TEST(Catalogue, FormsThatMayStandTogetherShareNoName) {
  for (const Effect* effect : catalogue()) {
    if (!effect->several() || effect->name() == "stiffness_field") continue;
    std::map<std::string, std::string> of;
    for (const auto& one : effect->candidates(base_model(), nullptr))
      for (const Parameter& p : one->parameters()) {
        const auto [found, fresh] = of.emplace(p.name, one->variant());
        EXPECT_TRUE(fresh) << p.name << " of [" << found->second << "] and [" << one->variant()
                           << "]";
      }
  }
}

/// Places are numbered as they come.
TEST(StiffnessField, BesidePlacesOneMoreMayStand) {
  const Effect& field = *find_effect("stiffness_field");
  Ingredients standing;
  std::set<std::string> names;
  for (int place = 1; place <= 3; ++place) {
    const auto all = standing.empty() ? field.candidates(base_model(), nullptr)
                                      : field.candidates_beside(base_model(), standing, nullptr);
    const auto blob = std::find_if(
        all.begin(), all.end(), [](const auto& one) { return one->variant().starts_with("blob"); });
    ASSERT_NE(blob, all.end());
    const auto [free, values, by_way_of, same_claim] =
        field.refit_form(base_model(), *blob, VectorXd::Constant(1, 0.5));
    EXPECT_EQ(free->variant(),
              place == 1 ? std::string("free blob") : "free blob, place " + std::to_string(place));
    const auto ball = *field.form_from(FormEdge::further, base_model(), *free, values);
    for (const auto& form : {*blob, free, ball.form}) {
      const auto again = field.candidate(base_model(), form->variant());
      ASSERT_TRUE(again) << form->variant();
      EXPECT_EQ(again->parameters().front().name, form->parameters().front().name);
    }
    for (const Parameter& p : ball.form->parameters())
      EXPECT_TRUE(names.insert(p.name).second) << p.name;
    standing.push_back(place == 1 ? free : ball.form);
  }
  EXPECT_TRUE(names.count("stiffness_field.place2.thickness"));
  // gradients and fields are all over the body
  for (const char* variant : {"free gradient", "free layers across (0, 0, 1)"})
    EXPECT_TRUE(
        field.candidates_beside(base_model(), {field.candidate(base_model(), variant)}, nullptr)
            .empty());
}

/// From the start, names are plain.
TEST(Catalogue, NamesTellTheExample) {
  const auto first_name = [](const char* effect, const char* variant) {
    return find_effect(effect)->candidate(base_model(), variant)->parameters().front().name;
  };
  EXPECT_EQ(first_name("camera_pose", "front from the start"), "camera_pose.front.rx");
  EXPECT_EQ(first_name("camera_pose", "front from twist on"), "camera_pose.front from twist on.rx");
  EXPECT_EQ(first_name("light_direction", "sun from the start"), "light_direction.angle1");
  EXPECT_EQ(first_name("light_direction", "sun in twist"), "light_direction.in twist.angle1");
  EXPECT_EQ(first_name("light_direction", "strength from bend on"),
            "light_direction.from bend on.strength");
  EXPECT_EQ(first_name("defocus", "side from the start"), "defocus.side");
  EXPECT_EQ(first_name("defocus", "side from pull on"), "defocus.side from pull on");
}

TEST(Catalogue, SentencesTellWhichAndWhen) {
  const auto said = [](const char* effect, const char* variant, const VectorXd& values) {
    const Effect& one = *find_effect(effect);
    return one.sentence(base_model(), *one.candidate(base_model(), variant), values);
  };
  VectorXd gains = VectorXd::Zero(8);
  gains[2] = 0.10, gains[5] = -0.20, gains[7] = 0.05, gains[0] = -0.01;
  EXPECT_EQ(said("exposure", "each photo", gains),
            "each photo has its own exposure: the photo of 'twist' by 'side' is 18.1 % darker, the "
            "photo of 'pull' by 'front' is 10.5 % brighter, the photo of 'bend' by 'side' is "
            "5.13 % brighter, the others by 1.01 % at most");
  EXPECT_EQ(said("creep", "steadily with the order", VectorXd::Constant(1, 0.25)),
            "the body creeps from 'rest' on, the first example: in the last ('press') it gives 25 "
            "% more, growing steadily with the order");
  EXPECT_EQ(said("camera_pose", "side from bend on", VectorXd::Zero(6)),
            "camera side from 'bend' on stands elsewhere, turned by 0 degrees and moved by 0 mm");
  EXPECT_EQ(
      said("light_direction", "lamp from bend on", Vector3d(0.03, 0.04, -0.1)),
      "from 'bend' on the light comes from 2.86 degrees beside the told direction and is 9.52 "
      "% weaker");
}

/// What a plainer form does without is nothing at its null.
TEST(Catalogue, PlainerFormsSayTheSameWithoutTheirNumbers) {
  const VectorXd q = deformed_state(*block_scene());
  std::set<std::string> tried;
  for (const Effect* effect : catalogue())
    for (const auto& one : effect->candidates(base_model(), nullptr)) {
      auto larger = effect->refit_form(base_model(), one, some_values(*one)).form;
      if (effect->name() == "floor_contact")  // one that without its tilt is normal to an axis
        larger =
            effect->candidate(base_model(), "cushion towards (0, 0, 1), tilting about (1, 2, 41)");
      VectorXd values = some_values(*larger);
      const auto found = effect->form_from(FormEdge::plainer, base_model(), *larger, values);
      if (!found) continue;
      std::set<std::string> kept;
      for (const Parameter& p : found->form->parameters()) kept.insert(p.name);
      const auto all = larger->parameters();
      ASSERT_EQ(found->values.size(), static_cast<int>(kept.size())) << larger->variant();
      ASSERT_LT(kept.size(), all.size()) << larger->variant();
      for (size_t i = 0; i < all.size(); ++i)
        if (!kept.count(all[i].name)) values[i] = all[i].value;
      const auto same = effect->form_from(FormEdge::plainer, base_model(), *larger, values);
      if (!same) continue;  // a plane that is oblique without its tilt
      const ModelForm form = extended(base(), larger), other = extended(base(), same->form);
      const VectorXd expected = signature(form.realise(with_values(form, values)), q);
      const VectorXd plain = signature(other.realise(with_values(other, same->values)), q);
      EXPECT_LT((plain - expected).norm(), 1e-9 * expected.norm()) << larger->variant();
      tried.insert(effect->name());
    }
  EXPECT_EQ(tried, (std::set<std::string>{"floor_contact", "light_direction"}));
}

/// The modulus that a hard floor's stiffness was taken from is fitted further: read back, it is the
/// same floor.
TEST(FloorContact, AHardPlaneIsReadAsItWasWritten) {
  const Effect& effect = *find_effect("floor_contact");
  const auto cushion = effect.candidate(base_model(), "cushion on side +x");
  ASSERT_TRUE(cushion);
  const auto next =
      effect.form_from(FormEdge::smaller, base_model(), *cushion, Eigen::Vector2d(12.0, 1e-4));
  ASSERT_TRUE(next);
  const auto& [hard, values, by_way_of, same_claim] = *next;
  const Model stiffer = base().realise(2.0 * base().initial());
  ASSERT_GT(initial_shear_modulus(stiffer.energy),
            1.5 * initial_shear_modulus(base_model().energy));
  const auto read = effect.candidate(stiffer, hard->variant());
  ASSERT_TRUE(read);
  EXPECT_EQ(read->variant(), hard->variant());
  const VectorXd q = deformed_state(*block_scene());
  const ModelForm form = extended(base(), hard), other = extended(base(), read);
  EXPECT_EQ(signature(form.realise(with_values(form, values)), q),
            signature(other.realise(with_values(other, values)), q));
  // and as soft as it is, it is the cushion that a refit goes on to
  const auto further = effect.forms_from(FormEdge::further, base_model(), *hard, values);
  ASSERT_EQ(further.size(), 3u);
  EXPECT_EQ(further[0].form->variant(), cushion->variant());
  for (size_t i = 0; i < 2; ++i) {  // the second one tilts, the third starts elsewhere
    const NextForm& wider = further[i];
    EXPECT_FALSE(wider.by_way_of) << "it starts where the other ended";
    const ModelForm wide = extended(base(), wider.form);
    EXPECT_EQ(signature(wide.realise(with_values(wide, wider.values)), q),
              signature(form.realise(with_values(form, values)), q))
        << wider.form->variant();
  }
}

TEST(Sentences, TellPlacesToThreeDigitsInAnyUnit) {
  EXPECT_EQ(place_text({4.91, -0.04, 38.73}, 42.0), "(4.9, 0.0, 38.7)");
  EXPECT_EQ(place_text({0.00491, -0.00004, 0.03873}, 0.042), "(0.0049, 0.0000, 0.0387)")
      << "in metres";
  EXPECT_EQ(place_text({4912.0, -40.0, 38730.0}, 42e3), "(4900, 0, 38700)") << "in micrometres";
  EXPECT_EQ(place_text({304.91, -200.04, 38.73}, 42.0), "(304.9, -200.0, 38.7)") << "moved";
  EXPECT_EQ(place_text(Vector3d::Zero(), 420.0), "(0, 0, 0)");
}

/// A plane that stands normal to an axis goes on to one that tilts about where it is pressed, and
/// to a hard one next to the body, if it has ended elsewhere.
TEST(FloorContact, APlaneNormalToAnAxisMayTiltWhereItLeavesMore) {
  const Effect& effect = *find_effect("floor_contact");
  Model model = base_model();
  const auto bent = std::make_shared<Equilibrium>();
  bent->q = deformed_state(*block_scene());
  Eigen::Index deepest = 0;
  bent->q.reshaped(3, bent->q.size() / 3).row(0).maxCoeff(&deepest);
  const double reach = bent->q[3 * deepest] += 1.0;  // alone
  model.states = {bent};
  const auto cushion = effect.candidate(model, "cushion on side +x");
  ASSERT_TRUE(cushion);
  const VectorXd values = Eigen::Vector2d(reach - 0.5, 1e-4);
  const auto further = effect.forms_from(FormEdge::further, model, *cushion, values);
  ASSERT_EQ(further.size(), 2u);
  EXPECT_EQ(further[0].values, VectorXd(Eigen::Vector4d(reach - 0.5, 1e-4, 0.0, 0.0)));
  EXPECT_THAT(further[1].form->variant(), testing::StartsWith("hard plane towards (1, 0, 0)"));
  const double at_rest = block_scene()->body->mesh.X.row(0).maxCoeff(), near = further[1].values[0];
  EXPECT_EQ(further[1].values, VectorXd(Eigen::Vector3d(near, 0.0, 0.0)));
  EXPECT_GT(near, at_rest);
  EXPECT_LT(near, at_rest + 0.5);
  ASSERT_TRUE(further[1].by_way_of) << "its tilt has kinks, a softer one's has none";
  EXPECT_LT(plane_form(further[1].by_way_of->variant())->stiffness,
            0.1 * plane_form(further[1].form->variant())->stiffness);
  const auto stays =
      effect.forms_from(FormEdge::further, model, *cushion, Eigen::Vector2d(near, 1e-4));
  EXPECT_EQ(stays.size(), 1u) << "it stands there";
  const auto n = numbers_in(further[0].form->variant());
  ASSERT_EQ(n.size(), 6u);
  const Vector3d about(n[3], n[4], n[5]), there = bent->q.segment<3>(3 * deepest);
  EXPECT_LE((about - (there - 0.5 * Vector3d::UnitX())).norm(), 0.1)
      << about.transpose() << " for " << there.transpose();
  EXPECT_THAT(effect.forms_from(FormEdge::further, model, *further[0].form, further[0].values),
              testing::IsEmpty());
}

/// The block is longest along z: the part of the load across stays, the part along changes sides.
/// A pull along z that is a few degrees off has no other side within the bounds.
TEST(LoadDirection, StartsAgainAsItsMirrorImage) {
  const Effect& effect = *find_effect("load_direction");
  const auto towards = [&](const Ingredient& form, const VectorXd& values) {
    const std::string said = effect.sentence(base_model(), form, values);
    const auto figures = numbers_in(said.substr(said.find("towards")));
    return Vector3d(figures.at(0), figures.at(1), figures.at(2));
  };
  const auto bend = effect.candidate(base_model(), "in bend");
  ASSERT_TRUE(bend);
  const Eigen::Vector2d values(0.7, -0.3);
  const auto further = effect.forms_from(FormEdge::further, base_model(), *bend, values);
  ASSERT_EQ(further.size(), 1u);
  EXPECT_EQ(further[0].form->variant(), bend->variant());
  const Vector3d then = towards(*bend, values), now = towards(*further[0].form, further[0].values);
  EXPECT_GT(std::abs(then.z()), 0.2);
  EXPECT_LT((now - then.cwiseProduct(Vector3d(1, 1, -1))).norm(), 0.02);
  const auto pull = effect.candidate(base_model(), "in pull");
  ASSERT_TRUE(pull);
  EXPECT_THAT(
      effect.forms_from(FormEdge::further, base_model(), *pull, Eigen::Vector2d(0.05, 0.02)),
      testing::IsEmpty());
}

/// A stiff place in a field whose other values are all the same: that is the modulus' own.
TEST(StiffnessField, TheSmallerFormIsThePlaceAndTheRestGoesToTheModulus) {
  const Model& model = base_model();
  const Effect& effect = *find_effect("stiffness_field");
  const auto field = effect.candidates(model, nullptr).front();
  const auto n = static_cast<Eigen::Index>(field->parameters().size());
  for (Eigen::Index k = 0; k < n; ++k) {
    VectorXd values = VectorXd::Constant(n, 0.8);
    values[k] += 0.6;
    const ModelForm larger = extended(base(), field);
    const VectorXd p = with_values(larger, values);
    const auto next = effect.form_from(FormEdge::smaller, model, *field, values);
    ASSERT_TRUE(next);
    const auto& [blob, few, by_way_of, same_claim] = *next;
    const auto centre = numbers_in(field->variant());
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(few[1 + i], centre[static_cast<size_t>(1 + 3 * k + i)], 1e-9) << k;
    EXPECT_NEAR(few[0], 0.6, 0.35) << k;
    const ModelForm smaller = extended(base(), blob);
    const Model large = larger.realise(p);
    const VectorXd start = with_stiffness_of(large, smaller, with_values(smaller, few));
    const VectorXd& w_large = large.energy.parts[0].weight;
    VectorXd ratio = p[0] * w_large;
    const Model small = smaller.realise(start);
    ratio = ratio.cwiseQuotient(start[0] * small.energy.parts[0].weight);
    std::sort(ratio.begin(), ratio.end());
    EXPECT_NEAR(ratio[ratio.size() / 2], 1.0, 1e-9) << k;
    EXPECT_GT(start[0], 1.3 * p[0]) << k;
  }
}

/// Bumps share a place between them out among them: it is none of theirs.
TEST(StiffnessField, TheSmallerFormIsFoundBetweenBumps) {
  const Model& model = base_model();
  const TetMesh& mesh = model.scene->body->mesh;
  const Effect& effect = *find_effect("stiffness_field");
  const auto field = effect.candidates(model, nullptr).front();
  const auto n = numbers_in(field->variant());
  const auto count = static_cast<Eigen::Index>(field->parameters().size());
  Matrix3Xd centres(3, count);
  for (Eigen::Index i = 0; i < centres.size(); ++i) centres(i) = n[static_cast<size_t>(i + 1)];
  Eigen::MatrixXd bumps(mesh.size(), count);
  for (Eigen::Index i = 0; i < count; ++i) bumps.col(i) = gaussian_bump(mesh, centres.col(i), n[0]);
  const Matrix3Xd places = element_centres(mesh);
  const auto nearest = [&](const Vector3d& place) {
    return (centres.colwise() - place).colwise().norm().minCoeff();
  };
  int seen = 0;
  for (Eigen::Index e = 0; e < places.cols(); ++e) {
    const Vector3d place = places.col(e);
    if (nearest(place) < 0.6 * n[0]) continue;
    const VectorXd heights = bumps.colPivHouseholderQr().solve(gaussian_bump(mesh, place, n[0]));
    const auto blob = effect.form_from(FormEdge::smaller, model, *field, heights);
    ASSERT_TRUE(blob);
    const VectorXd& values = blob->values;
    EXPECT_LT((values.segment<3>(1) - place).norm(), 0.6 * n[0]) << e;
    EXPECT_NEAR(values[0], 1.0, 0.4) << e;
    ++seen;
  }
  EXPECT_GT(seen, 5);
}

/// Where the first law is not, it has no stiffness to keep.
TEST(KeptStiffness, IsThatOfTheElementsThatHaveTheLaw) {
  Model model = base_model();
  const auto elements = model.scene->body->mesh.size();
  VectorXd& weight = model.energy.parts[0].weight;
  weight = VectorXd::Constant(elements, 1.5);
  weight.head(elements * 2 / 3).setZero();
  const ModelForm form = base();
  const VectorXd kept = with_stiffness_of(model, form, form.initial());
  EXPECT_NEAR(kept[0], 1.5 * form.initial()[0], 1e-12);
  weight.setZero();
  EXPECT_EQ(with_stiffness_of(model, form, form.initial()), form.initial());
}

/// A field that is high in two places is like these two; photos tell whether three say more.
TEST(StiffnessField, SeveralPlacesAreFoundInAField) {
  const Effect& effect = *find_effect("stiffness_field");
  const auto field = effect.candidates(base_model(), nullptr).front();
  const auto n = numbers_in(field->variant());
  std::vector<Vector3d> centres;
  for (size_t i = 1; i + 2 < n.size(); i += 3) centres.emplace_back(n[i], n[i + 1], n[i + 2]);
  // what bumps say, at most, of Gaussians as wide as they, by least squares over the elements
  const TetMesh& mesh = base_model().scene->body->mesh;
  const auto [low, high] = std::minmax_element(
      centres.begin(), centres.end(), [](const auto& a, const auto& b) { return a.z() < b.z(); });
  const std::vector<Vector3d> told = {*low, *high};
  VectorXd log_factor = VectorXd::Zero(mesh.size());
  for (const Vector3d& c : told) log_factor += 1.2 * gaussian_bump(mesh, c, n[0]);
  Eigen::MatrixXd bumps(mesh.size(), centres.size());
  for (size_t i = 0; i < centres.size(); ++i)
    bumps.col(static_cast<Eigen::Index>(i)) = gaussian_bump(mesh, centres[i], n[0]);
  const VectorXd values = bumps.householderQr().solve(log_factor);
  const auto further = effect.forms_from(FormEdge::further, base_model(), *field, values);
  ASSERT_FALSE(further.empty());
  ASSERT_EQ(further.front().form->variant(), "free blobs, 2");
  EXPECT_EQ(further.at(1).form->variant(), "free blobs, 3");
  std::set<size_t> found;
  for (int k = 0; k < 2; ++k) {
    const Vector3d at = further.front().values.segment<3>(5 * k + 1);
    for (size_t i = 0; i < told.size(); ++i)
      if ((at - told[i]).norm() < 0.5 * n[0]) found.insert(i);
  }
  EXPECT_EQ(found.size(), 2u);

  const auto balls = effect.forms_from(FormEdge::further, base_model(), *further.front().form,
                                       further.front().values);
  ASSERT_EQ(balls.size(), 1u);
  EXPECT_EQ(balls.front().form->variant(), "free balls, 2");
  EXPECT_TRUE(balls.front().same_claim);
  EXPECT_EQ(balls.front().values.size(), 11);
  const auto beside = effect.candidates_beside(base_model(), {balls.front().form}, nullptr);
  ASSERT_FALSE(beside.empty());
  EXPECT_EQ(beside.front()->parameters().front().name, "stiffness_field.place3.a");
}

/// The integral over space of the logarithm, and of that squared, are the Gaussian's.
TEST(StiffnessField, ABallStartsWhereItIsMostLikeAPlace) {
  VectorXd blob(5);
  blob << -1.3, 2.0, 3.0, 15.0, 4.0;
  const NextForm further = ball_like(base_model(), blob);
  EXPECT_EQ(further.form->variant(), "free ball");
  const double a = further.values[0], radius = further.values[4];
  const double volume = 4.0 / 3.0 * EIGEN_PI * std::pow(radius, 3), R3 = std::pow(blob[4], 3);
  EXPECT_NEAR(a * volume, blob[0] * std::pow(2.0 * EIGEN_PI, 1.5) * R3, 1e-9 * volume);
  EXPECT_NEAR(a * a * volume, blob[0] * blob[0] * std::pow(EIGEN_PI, 1.5) * R3, 1e-9 * volume);
  EXPECT_EQ(further.values.segment<3>(1), blob.segment<3>(1));
}

}  // namespace

}  // namespace hookeye::test
