// Numbers that are told and do not move: the same model with fewer parameters, in a run's file too.
#include "estimation/model/held.h"

#include <gmock/gmock.h>

#include <fstream>
#include <stdexcept>

#include "core/input_error.h"
#include "estimation/effects/catalogue.h"
#include "tests/estimation/effects_scene.h"
#include "tests/support/temporary_folder.h"

namespace hookeye {
namespace {

using test::base;

/// The base form with its first material parameter held at `value`.
std::pair<ModelForm, std::string> holding(double value) {
  ModelForm form = base();
  const std::string name = form.ingredients.front()->parameters().front().name;
  form.ingredients.front() = hold(form.ingredients.front(), {{name, value}});
  return {form, name};
}

VectorXd tail(const VectorXd& p) { return p.tail(p.size() - 1); }

TEST(Held, IsTheSameModelWithOneParameterLess) {
  VectorXd p = base().initial();
  p[0] *= 1.25;
  const auto [form, name] = holding(p[0]);
  EXPECT_EQ(form.size(), base().size() - 1);
  const VectorXd q = test::deformed_state(*form.scene);
  EXPECT_EQ(test::signature(form.realise(tail(p)), q), test::signature(base().realise(p), q));
  for (const Parameter& one : form.parameters()) EXPECT_NE(one.name, name);
}

TEST(Held, ComesBackFromAModelFileAndOnAnotherScene) {
  VectorXd p = base().initial();
  p[0] *= 1.25;
  const auto [form, name] = holding(p[0]);
  const test::TemporaryFolder folder;
  const auto file = folder / "model.yaml";
  std::ofstream(file) << write_model(form, tail(p), catalogue());
  const auto [again, values] = read_model(file, form.scene, catalogue());
  EXPECT_EQ(values, tail(p));
  EXPECT_EQ(again.ingredients.front()->variant(), form.ingredients.front()->variant());
  const auto [moved, carried] = transfer(form.realise(tail(p)), form.scene, catalogue());
  EXPECT_EQ(carried, tail(p));
  const VectorXd q = test::deformed_state(*form.scene);
  for (const Model& model : {again.realise(values), moved.realise(carried)})
    EXPECT_EQ(test::signature(model, q), test::signature(base().realise(p), q));
}

TEST(Held, ADamagedVariantIsRefusedWithItsPlace) {
  const auto [form, name] = holding(0.1);
  std::string text = write_model(form, tail(base().initial()), catalogue());
  text.replace(text.find("holds " + name), 6 + name.size(), "holds nothing");
  const test::TemporaryFolder folder;
  const auto file = folder / "model.yaml";
  std::ofstream(file) << text;
  try {
    read_model(file, form.scene, catalogue());
    FAIL() << "it was read";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place().line, 4) << error.what();
  }
}

TEST(Held, NamesThatAreNoneAreRefused) {
  const auto& material = base().ingredients.front();
  EXPECT_THROW(hold(material, {{"nothing", 1.0}}), std::invalid_argument);
  const auto held = hold(material, {{material->parameters().front().name, 1.0}});
  EXPECT_THROW(hold(held, {{"nothing", 1.0}}), std::invalid_argument);  // it has a form of its own
  EXPECT_FALSE(held_in(""));
  EXPECT_FALSE(held_in("holds mu=x"));
  EXPECT_FALSE(held_in("cam0 from twist on"));
}

}  // namespace
}  // namespace hookeye
