// What a factor takes is known before, and told where it is not there.
#include <gmock/gmock.h>
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <iostream>
#include <regex>

#include "simulation/blocks.h"
#include "simulation/equilibrium.h"
#include "simulation/sparse_factor.h"

namespace hookeye {
namespace {

/// A cube of 10 mm, n cells along each side, held below and pulled aside by its weight.
struct Cube {
  explicit Cube(int n) : mesh(test::block(n, n, n, {10, 10, 10}, 2, 0.1)) {
    energy.parts.push_back({neo_hookean(0.03, 0.14), {}});
    const Region base = test::region_where(mesh, [](const Vector3d& X) { return X[2] < 1e-9; });
    for (int i = 0; i < 3; ++i) loading.prescribe(mesh, base, i, 0.0);
    loading.forces.push_back(self_weight(mesh, 1.07e-9, Vector3d(9810, 0, 0)));
  }
  Result<Equilibrium> solved() const { return solve_equilibrium(mesh, energy, loading); }

  TetMesh mesh;
  EnergyModel energy;
  Loading loading;
};

double allocated() {
  const struct mallinfo2 now = mallinfo2();
  return static_cast<double>(now.uordblks) + static_cast<double>(now.hblkhd);
}

TEST(Memory, OfAFactorIsKnownBefore) {
  const Cube cube(9);
  const Equilibrium e = cube.solved().value();
  if (allocated() == 0.0) GTEST_SKIP() << "a sanitizer's malloc counts nothing";
  const double before = allocated(), factors = memory_of_factors();
  TangentFactor factor(e.factor->symbolic());
  ASSERT_TRUE(factor.factorize(e.K));
  const double told = factor.symbolic()->memory().factor;
  EXPECT_GT(told, 20e6);
  EXPECT_NEAR(allocated() - before, told, 0.05 * told);
  EXPECT_EQ(memory_of_factors() - factors, std::floor(told));
}

/// In a process that may take `megabytes` more than it has.
[[noreturn]] void solve_within(const Cube& cube, double megabytes) {
  std::ifstream in("/proc/self/statm");
  double pages = 0.0;
  in >> pages;
  rlimit limit{};
  limit.rlim_cur = limit.rlim_max =
      static_cast<rlim_t>(pages * static_cast<double>(sysconf(_SC_PAGESIZE)) + 1e6 * megabytes);
  setrlimit(RLIMIT_AS, &limit);
  const auto solved = cube.solved();
  if (!solved) {
    std::cerr << solved.error().reason << std::endl;
    _exit(3);
  }
  _exit(0);
}

TEST(MemoryDeathTest, IsToldWithWhatWouldFit) {
  constexpr double kThere = 530.0;  // [MB]; the factor of 13 cells and what OpenBLAS takes are more
  std::string told;
  EXPECT_EXIT(solve_within(Cube(13), kThere), testing::ExitedWithCode(3),
              testing::ResultOf([&](const std::string& said) { return told = said; },
                                testing::HasSubstr("out of memory")));
  std::smatch found;
  const std::regex sentence(
      R"(out of memory: 59049 unknowns need (\d+) MB more, and `ulimit -v` has (\d+) MB left; )"
      R"(tetrahedra with an edge of (\S+) would fit \(`edge: (\S+)`, now (\S+)\))");
  ASSERT_TRUE(std::regex_search(told, found, sentence)) << told;
  EXPECT_GT(std::stod(found[1]), std::stod(found[2]));
  EXPECT_EQ(found[3], found[4]);
  const double factor = std::stod(found[4]) / std::stod(found[5]);
  EXPECT_GT(factor, 1.0);
  EXPECT_LT(factor, 3.0);
  EXPECT_EXIT(solve_within(Cube(static_cast<int>(13.0 / factor)), kThere),
              testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace hookeye
