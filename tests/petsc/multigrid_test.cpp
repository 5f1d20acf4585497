// Bodies solved by multigrid and MUMPS are those that CHOLMOD solves.
#include "simulation/petsc/multigrid.h"

#include <gmock/gmock.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <numeric>
#include <sstream>

#include "core/memory_left.h"
#include "simulation/bent_block.h"
#include "simulation/sparse_factor.h"

namespace hookeye {
namespace {

using Eigen::MatrixXd;
using test::BentBlock;
using test::hold;
using test::plane;
using testing::HasSubstr;
using testing::Not;

/// Solves by what the test asks for, and hears what is said of it.
class Multigrid : public testing::Test {
 protected:
  void SetUp() override {
    static const PetscSession session;  // one a process
    auto logger = std::make_shared<spdlog::logger>(
        "test", std::make_shared<spdlog::sinks::ostream_sink_st>(said_));
    logger->set_level(spdlog::level::debug);
    before_ = spdlog::default_logger();
    spdlog::set_default_logger(logger);
  }
  void TearDown() override {
    spdlog::set_default_logger(before_);
    use_large_solver(SolverChoice::direct, nullptr);
    set_memory_limit(0.0);
  }
  static void choose(SolverChoice when) { use_large_solver(when, petsc_solver); }
  std::string said() const { return said_.str(); }

 private:
  std::ostringstream said_;
  std::shared_ptr<spdlog::logger> before_;
};

/// So many bytes more than the process has.
void leave(double bytes) {
  set_memory_limit(2e9);
  set_memory_limit(2e9 - memory_left().bytes + bytes);
}

/// What CHOLMOD and multigrid find.
struct Both {
  Equilibrium direct, iterated;
  double distance() const { return (direct.q - iterated.q).cwiseAbs().maxCoeff(); }
};

template <class Scene>
Both both_of(const Scene& scene, double tolerance) {
  Both out;
  use_large_solver(SolverChoice::direct, petsc_solver);
  out.direct = test::solve(scene.mesh, scene.energy(), scene.loading(), tolerance);
  use_large_solver(SolverChoice::multigrid, petsc_solver);
  out.iterated = test::solve(scene.mesh, scene.energy(), scene.loading(), tolerance);
  EXPECT_FALSE(out.direct.factor->iterates());
  EXPECT_TRUE(out.iterated.factor->iterates());
  EXPECT_EQ(out.direct.stable, out.iterated.stable);
  return out;
}

/// A beam that sags by a third of its length, at the tolerance of the program.
struct Beam {
  explicit Beam(int order, double bulk = 0.14)
      : mesh(test::block(12, 4, 3, {100, 30, 20}, order, 0.2)), kappa(bulk) {}
  TetMesh mesh;
  double kappa;
  EnergyModel energy() const { return test::of(neo_hookean(0.03, kappa)); }
  Loading loading() const {
    Loading l;
    hold(mesh, plane(mesh, 0, 0), l);
    l.forces.push_back(self_weight(mesh, 1.07e-9, Vector3d(0, 0, -9810)));
    return l;
  }
  double sag(const Equilibrium& e) const { return (e.q - mesh.X.reshaped()).cwiseAbs().maxCoeff(); }
};

TEST_F(Multigrid, SagsAsAFactorLetsIt) {
  for (const int order : {1, 2}) {
    const Beam beam(order);
    const Both both = both_of(beam, EquilibriumOptions{}.tolerance);
    const double sag = beam.sag(both.direct);
    EXPECT_GT(sag, 20.0) << order;
    EXPECT_LT(both.distance(), 1e-8 * sag) << order;
  }
  EXPECT_THAT(said(), HasSubstr("iterations to"));
  EXPECT_THAT(said(), Not(HasSubstr("MUMPS")));
}

/// Prescribed motion, pressure, springs and swelling.
TEST_F(Multigrid, EveryLoadAtOnce) {
  const BentBlock block;
  const Both both = both_of(block, 1e-9);
  EXPECT_LT(both.distance(), 1e-8 * 0.6);
  EXPECT_THAT(said(), Not(HasSubstr("MUMPS")));
}

TEST_F(Multigrid, NearlyIncompressibleIsFactoredByMumps) {
  const Beam beam(2, 300.0);
  const Both both = both_of(beam, EquilibriumOptions{}.tolerance);
  const double sag = beam.sag(both.direct);
  EXPECT_GT(sag, 20.0);
  EXPECT_LT(both.distance(), 1e-8 * sag);
  EXPECT_THAT(said(), HasSubstr("factored by MUMPS"));
  const std::string all = said();
  const size_t first = all.find("stagnates");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(all.find("stagnates", first + 1), std::string::npos) << "it is learned once:\n" << all;
}

/// Columns side by side and one by one: three of them are not four.
TEST_F(Multigrid, SensitivitiesAreThoseOfAFactor) {
  const Beam beam(2);
  const Both both = both_of(beam, EquilibriumOptions{}.tolerance);
  const auto of = [&](const Equilibrium& e) {
    MatrixXd dR(e.q.size(), 7);
    dR.leftCols(2) = all_dR_dtheta(beam.mesh, beam.energy(), e.q, 0);
    for (int k = 0; k < 3; ++k) {
      Loading unit;
      unit.forces.push_back(self_weight(beam.mesh, 1e-9, Vector3d::Unit(k)));
      dR.col(2 + k) = residual(beam.mesh, {}, unit, e.q);
    }
    dR.col(5).setZero();  // moves nothing
    dR.col(6) = dR.col(0) + dR.col(3);
    return sensitivities(e, beam.loading(), dR, {});
  };
  const MatrixXd expected = of(both.direct), S = of(both.iterated);
  for (int k = 0; k < S.cols(); ++k) {
    const double size = expected.col(k).cwiseAbs().maxCoeff();
    EXPECT_EQ(size > 0, k != 5);
    EXPECT_LE((S.col(k) - expected.col(k)).cwiseAbs().maxCoeff(), 1e-8 * size) << k;
  }
}

/// K of a beam that sags, and its smallest eigenvalue.
class Shifted : public Multigrid {
 protected:
  void SetUp() override {
    Multigrid::SetUp();
    choose(SolverChoice::direct);
    e_ = test::solve(beam_.mesh, beam_.energy(), beam_.loading());
    VectorXd x = VectorXd::Ones(static_cast<Eigen::Index>(free().size())), y;
    for (int i = 0; i < 100; ++i) {
      e_.factor->solve(x, y);
      least_ = 1.0 / y.norm();
      x = y / y.norm();
    }
    choose(SolverChoice::multigrid);
  }
  const std::vector<int>& free() const { return e_.factor->free(); }
  std::shared_ptr<TangentFactor> factor() const {
    return std::make_shared<TangentFactor>(
        std::make_shared<SymbolicFactor>(e_.K, free(), ends_of(beam_.mesh)));
  }

  Beam beam_{2};
  Equilibrium e_;
  double least_ = 0.0;
};

TEST_F(Shifted, IsPositiveUpToTheSmallestEigenvalue) {
  const auto f = factor();
  ASSERT_TRUE(f->iterates());
  EXPECT_TRUE(f->factorize(e_.K, -0.9 * least_, e_.q));
  EXPECT_TRUE(f->positive());
  EXPECT_FALSE(f->factorize(e_.K, -1.1 * least_, e_.q));
  EXPECT_FALSE(f->positive());
  EXPECT_THAT(said(), Not(HasSubstr("MUMPS")));
}

TEST_F(Shifted, SolvesWithTheShift) {
  const auto f = factor();
  ASSERT_TRUE(f->factorize(e_.K, 0.5, e_.q));
  const VectorXd b = test::noise(static_cast<Eigen::Index>(free().size()), 3);
  VectorXd x;
  f->solve(b, x);
  choose(SolverChoice::direct);
  const auto direct = factor();
  ASSERT_TRUE(direct->factorize(e_.K, 0.5));
  VectorXd expected;
  direct->solve(b, expected);
  EXPECT_LT((x - expected).norm(), 1e-9 * expected.norm());
}

TEST_F(Shifted, IndefiniteIsSolvedExactly) {
  SparseMatrix K = e_.K;
  K.diagonal().array() -= 1.1 * least_;
  const auto f = factor();
  ASSERT_FALSE(f->factorize(K, 0.0, e_.q));
  ASSERT_TRUE(f->factorize_indefinite(K));
  EXPECT_FALSE(f->positive());
  const VectorXd b = test::noise(static_cast<Eigen::Index>(free().size()), 3);
  VectorXd x;
  f->solve(b, x);
  VectorXd all = VectorXd::Zero(K.cols());
  for (size_t i = 0; i < free().size(); ++i) all[free()[i]] = x[static_cast<Eigen::Index>(i)];
  const VectorXd r = K * all;
  for (size_t i = 0; i < free().size(); ++i)
    ASSERT_NEAR(r[free()[i]], b[static_cast<Eigen::Index>(i)], 1e-8) << i;
}

/// By memory: before the analysis where a block would not fit, else by what the analysis tells.
TEST_F(Multigrid, IsChosenWhereAFactorDoesNotFit) {
  const Beam beam(2);
  choose(SolverChoice::automatic);
  const Equilibrium there = test::solve(beam.mesh, beam.energy(), beam.loading());
  EXPECT_FALSE(there.factor->iterates());
  const double unknowns = static_cast<double>(there.factor->free().size());
  leave(0.5 * factor_estimate(unknowns));
  const SymbolicFactor before(there.K, there.factor->free(), ends_of(beam.mesh));
  EXPECT_TRUE(before.large());
  EXPECT_THAT(said(), HasSubstr("a factor needs about"));
  leave(2.0 * factor_estimate(unknowns));
  const SymbolicFactor fits(there.K, there.factor->free(), ends_of(beam.mesh));
  EXPECT_FALSE(fits.large());
}

/// Springs from everywhere to everywhere fill the factor as no body does.
TEST_F(Multigrid, IsChosenWhereTheAnalysisTellsSo) {
  constexpr int kNodes = 1500;
  std::vector<Eigen::Triplet<double>> entries;
  for (int a = 0; a < kNodes; ++a)
    for (int k = 0; k < 12; ++k)
      for (int c = 0; c < 3; ++c) {
        const int b = (a * 7919 + (k + 1) * (k + 3) * 104729 + a * a % 1009) % kNodes;
        entries.emplace_back(3 * a + c, 3 * b + c, -1.0);
        entries.emplace_back(3 * b + c, 3 * a + c, -1.0);
        entries.emplace_back(3 * a + c, 3 * a + c, 30.0);
      }
  SparseMatrix K(3 * kNodes, 3 * kNodes);
  K.setFromTriplets(entries.begin(), entries.end());
  std::vector<int> free(K.cols());
  std::iota(free.begin(), free.end(), 0);
  Eigen::Matrix2Xi ends(2, kNodes);
  for (int a = 0; a < kNodes; ++a) ends.col(a).setConstant(a);
  choose(SolverChoice::automatic);
  const double needed = SymbolicFactor(K, free).memory().factor;
  ASSERT_GT(needed, 1.1 * factor_estimate(3.0 * kNodes));
  leave(1.05 * factor_estimate(3.0 * kNodes));
  EXPECT_TRUE(SymbolicFactor(K, free, ends).large());
  EXPECT_THAT(said(), HasSubstr("a factor needs"));
  EXPECT_THAT(said(), Not(HasSubstr("a factor needs about")));
}

}  // namespace
}  // namespace hookeye
