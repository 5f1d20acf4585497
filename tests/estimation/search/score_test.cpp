// The score that decides nothing yet: one function of a model, bounded, with priors of typical
// size.
#include "estimation/search/score.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <set>

#include "estimation/effects/catalogue.h"
#include "estimation/effects/typical_sizes.h"
#include "tests/estimation/effects_scene.h"

namespace hookeye {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Photos whose cells are linear in some columns, and what models of some of them leave there.
class LinearPhotos {
 public:
  explicit LinearPhotos(unsigned seed) : engine_(seed) {
    for (int k = 0; k < kPhotos; ++k) {
      J_.push_back(drawn(kCells, kColumns));
      r_.push_back(drawn(kCells, 1));
    }
  }
  void put_in(int column, double size) {
    for (int k = 0; k < kPhotos; ++k) r_[static_cast<size_t>(k)] -= size * photo(k).col(column);
  }
  /// The model with these columns, fitted to all photos but the last.
  ScoredModel fitted(const std::vector<int>& columns, double log_prior = 0.0) const {
    const auto m = static_cast<Eigen::Index>(columns.size());
    MatrixXd H = MatrixXd::Zero(m, m);
    VectorXd s = VectorXd::Zero(m);
    for (int k = 0; k + 1 < kPhotos; ++k) {
      const MatrixXd own = photo(k)(Eigen::all, columns);
      H += own.transpose() * own;
      s += own.transpose() * r_[static_cast<size_t>(k)];
    }
    const VectorXd t = -H.ldlt().solve(s);
    ScoredModel out;
    out.log_prior = log_prior;
    for (Eigen::Index i = 0; i < m; ++i) out.columns.push_back({-t[i], 0.3, false, false, false});
    for (int k = 0; k < kPhotos; ++k) {
      const MatrixXd own = photo(k)(Eigen::all, columns);
      const VectorXd left = r_[static_cast<size_t>(k)] + own * t;
      SeenPart part;
      part.kind = SeenPart::Kind::textured;
      part.held_out = k + 1 == kPhotos;
      part.count = part.effective = kCells;
      part.variance = left.squaredNorm() / kCells;
      part.H = own.transpose() * own;
      part.s = own.transpose() * left;
      out.misfit += part.variance;
      out.seen.push_back(std::move(part));
    }
    return out;
  }

 private:
  static constexpr int kPhotos = 4, kCells = 150, kColumns = 5;
  const MatrixXd& photo(int k) const { return J_[static_cast<size_t>(k)]; }
  MatrixXd drawn(int rows, int columns) {
    std::normal_distribution<double> normal;
    MatrixXd out(rows, columns);
    for (double& x : out.reshaped()) x = normal(engine_);
    return out;
  }
  std::mt19937 engine_;
  std::vector<MatrixXd> J_;
  std::vector<VectorXd> r_;
};

TEST(ModelScore, TheTruthIsFirstAndDifferencesAddUp) {
  int first = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    LinearPhotos photos(seed);
    photos.put_in(2, 0.3);
    const ScoredModel none = photos.fitted({0}), right = photos.fitted({0, 2}),
                      wrong = photos.fitted({0, 3}), wider = photos.fitted({0, 2, 4});
    const ResidualNoise noise = estimate_noise(wider.seen, Floor{});
    const auto of = [&](const ScoredModel& model) { return score(model, noise).total(); };
    first += of(right) > of(none) && of(right) > of(wrong) && of(right) > of(wider);
    // Whoever else is asked in between: the same number, bit for bit.
    const double alone = of(right);
    (void)of(wrong);
    EXPECT_EQ(of(right), alone);
    EXPECT_NEAR((of(right) - of(wrong)) + (of(wrong) - of(none)), of(right) - of(none), 1e-9);
  }
  EXPECT_GE(first, 36);
}

TEST(ModelScore, NoFittedModelExceedsItsCeiling) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    LinearPhotos photos(seed);
    const std::vector<std::vector<int>> models = {{0}, {0, 1}, {0, 1, 2, 3, 4}};
    for (const auto& columns : models) {
      const ScoredModel model = photos.fitted(columns, -2.0);
      const ModelScore of = score(model, estimate_noise(model.seen, Floor{}));
      EXPECT_LT(of.total(), of.ceiling);
      EXPECT_EQ(of.prior, -2.0);
    }
  }
}

/// What a held parameter shares with another one is the other one's, once; its own cost stays.
TEST(ModelScore, AParameterOnItsBoundSharesNothing) {
  const auto scored = [](bool at_bound, double correlation) {
    ScoredModel out;
    for (const bool bound : {false, at_bound}) out.columns.push_back({0.0, 1.0, false, bound});
    SeenPart part;
    part.kind = SeenPart::Kind::textured;
    part.count = part.effective = 100.0, part.variance = 4.0;
    part.H = MatrixXd::Constant(2, 2, 10.0 * correlation);
    part.H.diagonal().setConstant(10.0);
    part.s = VectorXd::Zero(2);
    out.seen.push_back(part);
    part.held_out = true;
    part.s << 60.0, 60.0 * correlation;  // 360 of its 400 lie along the first one
    out.seen.push_back(part);
    return out;
  };
  const ResidualNoise noise{{{1.0, 100.0, 1.0, 1.0}, {1.0, 100.0, 1.0, 1.0}}};
  const double alone = score(scored(true, 0.0), noise).held_out;
  ScoredModel one_column = scored(true, 0.0);
  one_column.columns.pop_back();
  for (SeenPart& part : one_column.seen)
    part.H = part.H.topLeftCorner(1, 1).eval(), part.s = part.s.head(1).eval();
  EXPECT_LT(alone, 0.0);
  EXPECT_NEAR(score(scored(true, 0.99), noise).held_out, alone, 1e-9);
  EXPECT_NE(score(scored(false, 0.99), noise).held_out, alone);
  EXPECT_LT(score(scored(true, 0.0), noise).fitted, score(one_column, noise).fitted - 0.5);
}

TEST(ResidualNoise, IsNeverBelowTheNoiseAndTrustsARimLess) {
  SeenPart texture;
  texture.kind = SeenPart::Kind::textured;
  texture.camera = "front";
  texture.count = 300.0, texture.effective = 60.0, texture.information = 3e4,
  texture.variance = 0.8;
  SeenPart rim = texture;
  rim.kind = SeenPart::Kind::silhouette;
  Floor floor;
  floor.cell_inflation = 10.0;
  const ResidualNoise noise = estimate_noise({texture, rim}, floor);
  EXPECT_EQ(noise.parts[0].variance, 1.0);
  EXPECT_EQ(noise.parts[1].variance, 1.0);
  EXPECT_NEAR(noise.parts[0].count, 30.0, 1e-9);  // rest photos: ten cells count as one
  // A rim tells its own correlation, and a quarter of a pixel is 2.5 deviations of a cell.
  EXPECT_NEAR(noise.parts[1].count, 60.0 / (1.0 + 6.25), 1e-9);
  // What misses more than the floor is no noise; what misses less shows that the floor is lower.
  floor.chi = 1.5, floor.cell_variance = 2.0;
  floor.by_camera["front"] = 3.0;
  const auto variance = [&](double left) {
    texture.variance = left;
    return estimate_noise({texture}, floor).parts[0].variance;
  };
  EXPECT_EQ(variance(30.0), 8.0);
  EXPECT_EQ(variance(1.7), 1.7);
  EXPECT_EQ(variance(0.1), 1.0);
}

/// A contour is no cell: what a column removes there is not taken from what cells have as noise.
TEST(ResidualNoise, CellsKeepTheirNoiseWhateverColumnsRemove) {
  SeenPart part;
  part.kind = SeenPart::Kind::textured;
  part.count = part.effective = 100.0, part.variance = 1.5;
  part.H = MatrixXd::Constant(1, 1, 4.0);
  part.s = VectorXd::Constant(1, 60.0);  // removes 900, of 150 that cells have
  const ResidualNoise noise{{{1.0, 100.0, 1.0, 1.0}}};
  EXPECT_NEAR(in_noise({part}, noise, false)[0].r2, 900.0 + 100.0, 1e-9);
  // Of 1800 that pixels have over their floor it is half: half of the cells' 50 stays.
  part.pixels = 5000.0, part.pixel_r2 = 6800.0;
  EXPECT_NEAR(in_noise({part}, noise, false)[0].r2, 900.0 + 100.0 + 25.0, 1e-9);
}

TEST(Posterior, IsASoftmax) {
  const auto sure = posterior({-1000.0, -1000.0 - std::log(3.0), -2000.0});
  EXPECT_NEAR(sure[0], 0.75, 1e-12);
  EXPECT_NEAR(sure[1], 0.25, 1e-12);
  EXPECT_EQ(sure[2], 0.0);
}

/// Every effect says how large it is as a rule, in the unit of its parameters.
TEST(TypicalSizes, AreThoseOfTheCatalogueInTheirUnits) {
  for (const TypicalSize& one : typical_sizes()) {
    EXPECT_NE(find_effect(one.effect), nullptr) << one.effect;
    EXPECT_GT(one.size, 0.0) << one.effect << one.parameter;
    EXPECT_FALSE(one.reason.empty() || one.source.empty()) << one.effect << one.parameter;
  }
  std::set<std::string> without;
  for (const Effect* effect : catalogue()) {
    bool any = false;
    for (const auto& form : effect->candidates(test::base_model(), nullptr))
      for (const Parameter& parameter : form->parameters()) {
        const auto prior = size_prior(effect->name(), parameter);
        any = any || prior;
        for (const TypicalSize& one : typical_sizes()) {
          if (prior && one.effect == effect->name() &&
              parameter.name.ends_with("." + one.parameter) && one.unit != "typical" &&
              one.unit != "log") {
            EXPECT_EQ(one.unit, parameter.unit) << parameter.name;
          }
        }
      }
    // A plane's stiffness may be anything: it takes unit information.
    if (!any && !effect->candidates(test::base_model(), nullptr).empty())
      without.insert(effect->name());
  }
  EXPECT_EQ(without, std::set<std::string>{"floor_contact"});
}

TEST(TypicalSizes, TwelvePercentOfSwellingIsHardToBelieve) {
  const Parameter s = find_effect("swelling")
                          ->candidates(test::base_model(), nullptr)
                          .front()
                          ->parameters()
                          .front();
  const SizePrior prior = size_prior("swelling", s).value();
  const auto cost = [&](double value) {
    return 0.5 * std::pow((value / s.typical - prior.mean) / prior.deviation, 2);
  };
  EXPECT_LT(cost(0.01), 0.5);
  EXPECT_GT(cost(0.12), 15.0);
}

}  // namespace
}  // namespace hookeye
