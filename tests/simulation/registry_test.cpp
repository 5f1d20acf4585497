// The laws by name: what is read, and every fault with its place.
#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cmath>

#include "simulation/energy_term.h"

namespace hookeye {
namespace {

using Eigen::Vector3d;
using Law = std::shared_ptr<const EnergyTerm>;

Matrix3d some_deformation() {
  Matrix3d F;
  F << 1.2, 0.1, -0.05, 0.2, 0.9, 0.1, 0.0, -0.1, 1.1;
  return F;
}

MaterialSpec spec(const std::string& law, std::map<std::string, std::vector<double>> values) {
  MaterialSpec s;
  s.law = law;
  s.place = {"capture.yaml", 9, 14};
  int column = 20;
  for (auto& [name, numbers] : values)
    s.parameters[name] = {numbers, {"capture.yaml", 9, column++}};
  return s;
}

void expect_fault(const MaterialSpec& s, const std::string& wrong, const std::string& right,
                  int column) {
  try {
    make_law(s);
    ADD_FAILURE() << "accepted: " << wrong;
  } catch (const InputError& e) {
    EXPECT_THAT(e.wrong(), testing::HasSubstr(wrong));
    EXPECT_THAT(e.right(), testing::HasSubstr(right));
    EXPECT_EQ(e.place().column, column);
  }
}

TEST(Registry, NamesTheFaultAndItsPlace) {
  expect_fault(spec("neo-hokean", {{"mu", {1}}}), "no law `neo-hokean`", "`neo-hookean`", 14);
  expect_fault(spec("xyz", {{"mu", {1}}}), "no law", "yeoh {c1, c2, c3, kappa}", 14);
  expect_fault(spec("neo-hookean", {{"mu", {1}}}), "lacks `kappa`", "kappa_over_mu", 14);
  expect_fault(spec("neo-hookean", {{"kappa", {1}}, {"mux", {1}}, {"mu", {1}}}), "`mux`", "`mu`",
               22);
  expect_fault(spec("neo-hookean", {{"kappa", {1}}, {"kappa_over_mu", {1}}, {"mu", {1}}}),
               "does not go", "kappa", 21);
  expect_fault(spec("yeoh", {{"c1", {-1}}, {"c2", {0}}, {"c3", {0}}, {"kappa", {1}}}), "`c1` is -1",
               "above 0", 20);
  expect_fault(spec("stvk", {{"lambda", {1, 2}}, {"mu", {1}}}), "2 numbers", "one number", 20);
  expect_fault(spec("stvk", {{"lambda", {NAN}}, {"mu", {1}}}), "`lambda` is nan", "finite", 20);
  expect_fault(spec("ogden", {{"alpha", {2}}, {"kappa", {1}}, {"mu", {1, 2}}}), "2 moduli",
               "every modulus", 20);
  expect_fault(spec("fung", {{"b", {1, 1, 1}}, {"c", {1}}, {"kappa", {1}}}), "`b` has 3 numbers",
               "g23 g13", 20);
  expect_fault(spec("fung", {{"b", {1, 1, 1, 2, 0, 0, 1, 1, 1}}, {"c", {1}}, {"kappa", {1}}}),
               "positive definite", "larger b11", 20);
  expect_fault(spec("fung", {{"b", {1, 1, 1, 0, 0, 0, 1, 0, 1}}, {"c", {1}}, {"kappa", {1}}}),
               "shear coefficient", "above 0", 20);
  expect_fault(spec("ogden", {{"alpha", {-2}}, {"kappa", {1}}, {"mu", {1}}}),
               "shear modulus, sum of mu_i alpha_i / 2, is -1", "sign of its exponent", 22);
  expect_fault(spec("ogden", {{"alpha", {2, 0}}, {"kappa", {1}}, {"mu", {1, 1}}}),
               "exponent 2 of `alpha` is 0", "neo-Hooke", 20);
  expect_fault(spec("mooney-rivlin", {{"c01", {-2}}, {"c10", {1}}, {"kappa", {1}}}),
               "2 (c10 + c01) is -2", "above 0", 20);
}

TEST(Registry, MakesEveryLawWithItsNumbers) {
  EXPECT_THAT(law_names(), testing::ElementsAre("neo-hookean", "stvk", "mooney-rivlin", "yeoh",
                                                "ogden", "fung", "holzapfel", "additive"));
  const Law law =
      make_law(spec("ogden", {{"alpha", {1.3, -2.7}}, {"kappa", {0.6}}, {"mu", {0.03, -0.01}}}));
  const auto p = law->parameters(Units{"mm", "N"});
  ASSERT_EQ(p.size(), 5u);
  EXPECT_EQ(p[1].name, "mu2");
  EXPECT_EQ(p[3].name, "alpha2");
  EXPECT_EQ(p[4].unit, "MPa");
  const Matrix3d F = some_deformation();
  EXPECT_EQ(law->P(F), ogden({0.03, -0.01}, {1.3, -2.7}, 0.6)->P(F));
  EXPECT_EQ(make_law(spec("neo-hookean", {{"mu", {0.05}}, {"kappa_over_mu", {12}}}))->P(F),
            neo_hookean_tied(0.05, 12)->P(F));
}

using Values = std::map<std::string, std::vector<double>>;
/// Columns go by the alphabet: frame 20 where it is given.
MaterialSpec artery(Values more) {
  Values all = {{"k1", {0.08}}, {"k2", {2}}, {"kappa", {0.6}}, {"mu", {0.05}}};
  for (auto& [name, numbers] : more) all[name] = numbers;
  return spec("holzapfel", all);
}

TEST(Registry, HolzapfelsFibresByAngleByDirectionAndInATube) {
  const double c = std::cos(EIGEN_PI / 6), s = std::sin(EIGEN_PI / 6);
  const Matrix3d F = some_deformation();
  const Law angles = make_law(artery({{"angles", {30, -30}}}));
  const Law directions = make_law(artery({{"directions", {c, s, 0, 2 * c, -2 * s, 0}}}));
  EXPECT_LE((angles->P(F) - directions->P(F)).norm(), 1e-15);
  EXPECT_EQ(angles->size(), 7);
  EXPECT_EQ(directions->size(), 5);
  EXPECT_EQ(angles->parameters(Units{"mm", "N"})[6].name, "angle2");
  // A frame turns the fibres: axis 1 along z, axis 2 along x.
  const Values frame = {{"frame", {0, 0, 1, 1, 0, 0, 0, 1, 0}}};
  Values told = frame;
  told["angles"] = {30};
  const Law turned = make_law(artery(told));
  const Law same = make_law(artery({{"directions", {s, 0, c}}}));
  EXPECT_LE((turned->P(F) - same->P(F)).norm(), 1e-15);
  told = frame;
  told["directions"] = {c, s, 0};
  EXPECT_LE((make_law(artery(told))->P(F) - same->P(F)).norm(), 1e-15);
  // In a tube 0 degrees is around it, which is axis 2 of its frame, and 90 along it.
  const Values tube = {{"frame.axis", {0, 0, 1}}, {"frame.center", {0, 0, 0}}};
  told = tube;
  told["angles"] = {30};
  const Law wall = make_law(artery(told));
  ASSERT_TRUE(wall->cylinder());
  EXPECT_FALSE(angles->cylinder());
  EXPECT_LE((wall->P(F) - make_law(artery({{"directions", {0, c, s}}}))->P(F)).norm(), 1e-15);
  EXPECT_TRUE(wall->with((Eigen::VectorXd(6) << 1, 1, 1, 0, 1, 20).finished())->cylinder());
}

TEST(Registry, NamesTheFaultOfHolzapfelAndItsPlace) {
  const auto fault = [](Values more, const char* wrong, const char* right, int column) {
    expect_fault(artery(std::move(more)), wrong, right, column);
  };
  fault({}, "lacks `angles`", "dispersion, toe, frame", 14);
  fault({{"angles", {30}}, {"directions", {1, 0, 0}}}, "`directions` does not go", "angles", 21);
  fault({{"angles", {30}}, {"k2", {0}}}, "`k2` is 0", "above 0", 22);
  fault({{"angles", {30}}, {"dispersion", {0.4}}}, "`dispersion` is 0.4", "1/3", 21);
  fault({{"angles", {30}}, {"dispersion", {-0.1}}}, "`dispersion` is -0.1", "1/3", 21);
  fault({{"angles", {30}}, {"toe", {0}}}, "`toe` is 0", "0.01", 25);
  fault({{"angles", {30}}, {"toes", {0}}}, "no parameter `toes`", "`toe`", 25);
  fault({{"directions", {1, 0}}}, "2 numbers", "three for every family", 20);
  fault({{"directions", {1, 0, 0, 0, 0, 0}}}, "direction 2 has no length", "", 20);
  fault({{"angles", {30}}, {"frame", {1, 0, 0, 0.1, 1, 0, 0, 0, 1}}}, "not orthonormal", "", 21);
  fault({{"angles", {30}}, {"frame.axis", {0, 0, 1}}}, "axis and its center", "center", 21);
  fault({{"angles", {30}}, {"frame.axis", {0, 0, 0}}, {"frame.center", {0, 0, 0}}}, "no length", "",
        21);
}

}  // namespace
}  // namespace hookeye
