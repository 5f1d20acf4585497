// The document of `json`: read back, it is the model.
#include <nlohmann/json.hpp>

#include "exporters/block.h"

namespace hookeye::test {
namespace {

using nlohmann::json;

TEST(JsonExport, IsTheModel) {
  const Block block;
  Model model = block.model();
  model.energy.parts.push_back({fibre(0.1, Vector3d::UnitX()), {}});
  const auto& pull = model.examples[static_cast<size_t>(model.scene->example_index("pull"))];
  const auto solved = solve_equilibrium(block.mesh(), model.energy, pull.loading);
  ASSERT_TRUE(solved.has_value());
  SolverModel solver = solver_model(model);
  set_found(solver, model.scene->example_index("pull"), solved->q);
  const Exported exported = export_model(*find_exporter("json"), solver);
  EXPECT_TRUE(exported.lacks.empty());
  const json document = json::parse(file_of(exported, "model.json"));

  const TetMesh& mesh = block.mesh();
  const json& told = document["mesh"];
  ASSERT_EQ(told["nodes"].size(), static_cast<size_t>(mesh.nodes()));
  ASSERT_EQ(told["elements"].size(), static_cast<size_t>(mesh.size()));
  for (int k = 0; k < 10; ++k) EXPECT_EQ(told["elements"][3][k], mesh.elements(k, 3));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(told["nodes"][7][i], mesh.X(i, 7));
  EXPECT_EQ(told["node_sets"]["grip"], block.region("grip").nodes);

  EXPECT_EQ(document["material"]["parts"][0]["law"], "neo-hookean");
  EXPECT_EQ(document["material"]["parts"][0]["parameters"][0]["value"], 0.05);
  EXPECT_EQ(document["material"]["parts"][1]["law"], "fibre");
  EXPECT_EQ(document["material"]["sets_lack"].size(), 1u);

  const json* of_pull = nullptr;
  for (const json& one : document["load_cases"])
    if (one["name"] == "pull") of_pull = &one;
  ASSERT_TRUE(of_pull);
  Vector3d sum = Vector3d::Zero();
  for (const json& force : (*of_pull)["nodal_forces"])
    for (int i = 0; i < 3; ++i) sum[i] += force["force"][static_cast<size_t>(i)].get<double>();
  EXPECT_LT((sum - Vector3d(0.3, 0.1, 4.0)).norm(), 1e-12);
  EXPECT_EQ((*of_pull)["prescribed"].size(), pull.loading.prescribed.size());
  const Eigen::MatrixXd u = solved->q.reshaped(3, mesh.nodes()) - mesh.X;
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ((*of_pull)["found"]["displacement"][9][static_cast<size_t>(i)], u(i, 9));
  EXPECT_LT((*of_pull)["found"]["volume_ratio"][0], (*of_pull)["found"]["volume_ratio"][1]);
}

}  // namespace
}  // namespace hookeye::test
