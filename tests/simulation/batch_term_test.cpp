// A law that is asked for many points at once is the same law.
#include "simulation/batch_term.h"

#include <gtest/gtest.h>

#include "simulation/blocks.h"
#include "simulation/energy_parts.h"
#include "simulation/equilibrium.h"

namespace hookeye {
namespace {

/// Another law, asked column by column. Counts its calls.
class Together final : public BatchTerm {
 public:
  explicit Together(std::shared_ptr<const EnergyTerm> law) : law_(std::move(law)) {}
  std::string name() const override { return "together"; }
  Eigen::RowVectorXd psi_of(const Matrix9Xd& F) const override {
    ++calls;
    Eigen::RowVectorXd out(F.cols());
    for (Eigen::Index k = 0; k < F.cols(); ++k) out[k] = law_->psi(F.col(k).reshaped(3, 3));
    return out;
  }
  Matrix9Xd P_of(const Matrix9Xd& F) const override {
    ++calls;
    Matrix9Xd out(9, F.cols());
    for (Eigen::Index k = 0; k < F.cols(); ++k)
      out.col(k) = law_->P(F.col(k).reshaped(3, 3)).reshaped();
    return out;
  }
  Eigen::MatrixXd dP_dF_of(const Matrix9Xd& F) const override {
    ++calls;
    Eigen::MatrixXd out(81, F.cols());
    for (Eigen::Index k = 0; k < F.cols(); ++k)
      out.col(k) = law_->dP_dF(F.col(k).reshaped(3, 3)).reshaped();
    return out;
  }
  mutable int calls = 0;

 private:
  std::shared_ptr<const EnergyTerm> law_;
};

/// Neo-Hooke and a term beside it in some elements, swollen unevenly.
struct Pair {
  TetMesh mesh;
  VectorXd q;
  EnergyModel single, batch;
  std::shared_ptr<const Together> together =
      std::make_shared<const Together>(yeoh(0.01, 0.02, 0.003, 0.1));

  explicit Pair(int order, int cells = 3) : mesh(test::block(cells, 2, 3, {9, 6, 9}, order, 0.2)) {
    q = mesh.X.reshaped() + 0.1 * test::noise(mesh.X.size(), 5);
    const VectorXd weight = test::noise(mesh.size(), 2).cwiseMax(0.0);
    single.parts = {{neo_hookean(0.02, 0.2), {}}, {yeoh(0.01, 0.02, 0.003, 0.1), weight}};
    single.swelling = VectorXd::Ones(mesh.size()) + 0.05 * test::noise(mesh.size(), 3);
    batch = single;
    batch.parts[1].term = together;
  }
};

TEST(BatchTerm, IsTheSameLaw) {
  for (const int order : {1, 2}) {
    const Pair pair(order);
    const double energy = internal_energy(pair.mesh, pair.single, pair.q);
    EXPECT_NEAR(internal_energy(pair.mesh, pair.batch, pair.q), energy, 1e-13 * energy);
    const VectorXd R = residual(pair.mesh, pair.single, {}, pair.q);
    EXPECT_LT((residual(pair.mesh, pair.batch, {}, pair.q) - R).norm(), 1e-13 * R.norm());
    const SparseMatrix K = tangent(pair.mesh, pair.single, {}, pair.q);
    EXPECT_LT((tangent(pair.mesh, pair.batch, {}, pair.q) - K).norm(), 1e-13 * K.norm());
    const auto expected = element_state(pair.mesh, pair.single, pair.q);
    const auto found = element_state(pair.mesh, pair.batch, pair.q);
    EXPECT_LT((found.cauchy_stress - expected.cauchy_stress).norm(),
              1e-13 * expected.cauchy_stress.norm());
    EXPECT_LT((found.energy_density - expected.energy_density).norm(),
              1e-13 * expected.energy_density.norm());
  }
}

TEST(BatchTerm, IsAskedForBlocksOfElements) {
  const Pair pair(2, 120);  // 4320 elements of four points: several blocks
  pair.together->calls = 0;
  const VectorXd R = residual(pair.mesh, pair.single, {}, pair.q);
  EXPECT_LT((residual(pair.mesh, pair.batch, {}, pair.q) - R).norm(), 1e-13 * R.norm());
  EXPECT_GT(pair.together->calls, 1);
  EXPECT_LT(pair.together->calls, 10);
}

TEST(BatchTerm, ItsStiffnessIsThatOfItsParts) {
  const Pair pair(1);
  const auto F = deformation_gradients(pair.mesh, pair.q);
  Matrix9Xd columns(9, pair.mesh.size());
  std::vector<int> element;
  for (int e = 0; e < pair.mesh.size(); ++e) columns.col(e) = F[e].reshaped(), element.push_back(e);
  const EnergyParts single(pair.single), batch(pair.batch);
  EXPECT_EQ(single.dP_dF_together(element, columns).norm(), 0.0);
  const Eigen::MatrixXd together = batch.dP_dF_together(element, columns);
  for (int e = 0; e < pair.mesh.size(); ++e) {
    const Matrix9d D = batch.dP_dF(e, F[e]) + Matrix9d(together.col(e).reshaped(9, 9));
    EXPECT_LT((D - single.dP_dF(e, F[e])).norm(), 1e-13 * D.norm());
  }
}

TEST(BatchTerm, HasNoParametersOfItsOwn) {
  const auto term = std::make_shared<const Together>(neo_hookean(1.0, 5.0));
  EXPECT_EQ(term->size(), 0);
  EXPECT_TRUE(term->parameters({}).empty());
  EXPECT_EQ(term->with({}), term);
  const Matrix3d F = Eigen::Vector3d(1.2, 0.9, 1.0).asDiagonal();
  EXPECT_EQ(term->psi(F), neo_hookean(1.0, 5.0)->psi(F));
  EXPECT_EQ(term->P(F), neo_hookean(1.0, 5.0)->P(F));
  EXPECT_EQ(term->dP_dF(F), neo_hookean(1.0, 5.0)->dP_dF(F));
}

}  // namespace
}  // namespace hookeye
