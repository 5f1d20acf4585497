#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <set>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

bool holds_fully(const SupportSpec& support) {
  if (support.kind != SupportSpec::Kind::components) return false;
  return std::all_of(support.displacement.begin(), support.displacement.end(),
                     [](const auto& u) { return u && *u == 0.0; });
}

/// Nodes that the clamp on `region` holds in this example, or none. Nodes that another support
/// holds too stay held.
std::set<int> clamped_nodes(const Scene& scene, int example, const std::string& region) {
  const auto& supports = scene.capture.examples[example].supports;
  const bool held = std::any_of(supports.begin(), supports.end(), [&](const SupportSpec& s) {
    return s.region == region && holds_fully(s);
  });
  if (!held) return {};
  const auto& nodes = scene.body->regions.at(region).nodes;
  std::set<int> own(nodes.begin(), nodes.end());
  for (const auto& support : supports)
    if (support.region != region)
      for (int node : scene.body->regions.at(support.region).nodes) own.erase(node);
  return own;
}

/// Integrals of products of a face's shape functions over its area (straight triangles).
Eigen::MatrixXd face_mass(int nodes, double area) {
  if (nodes == 3) return area / 12.0 * (Eigen::Matrix3d::Ones() + Eigen::Matrix3d::Identity());
  Eigen::MatrixXd M(6, 6);
  M << 6, -1, -1, 0, -4, 0,  //
      -1, 6, -1, 0, 0, -4,   //
      -1, -1, 6, -4, 0, 0,   //
      0, 0, -4, 32, 16, 16,  //
      -4, 0, 0, 16, 32, 16,  //
      0, -4, 0, 16, 16, 32;
  return area / 180.0 * M;
}

/// Traction t [stress] at the region's nodes whose consistent nodal forces are the reactions:
/// sum_b (int N_a N_b dA) t_b = R_a. Row sums would do for linear faces; corner nodes of quadratic
/// ones have none (integral N_a = 0) although they carry load, hence the full matrix. It is what a
/// bed of springs of vanishing compliance feels. Nodes without a face keep t = 0.
struct PatchTraction {
  std::vector<int> nodes;
  Matrix3Xd normal;  ///< outward, unit, mean over the faces at the node
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor;

  PatchTraction(const TetMesh& mesh, const Region& region) {
    std::map<int, int> local;
    for (const auto& [face, fraction] : region.faces)
      for (int k = 0; k < mesh.boundary.rows(); ++k) local[mesh.boundary(k, face)] = 0;
    for (auto& [node, index] : local) {
      index = static_cast<int>(nodes.size());
      nodes.push_back(node);
    }
    normal = Matrix3Xd::Zero(3, static_cast<int>(nodes.size()));
    std::vector<Eigen::Triplet<double>> triplets;
    for (const auto& [face, fraction] : region.faces) {
      const auto ids = mesh.boundary.col(face);
      const Vector3d a = mesh.X.col(ids[0]), b = mesh.X.col(ids[1]), c = mesh.X.col(ids[2]);
      const Vector3d area_vector = 0.5 * (b - a).cross(c - a);
      const Eigen::MatrixXd M =
          face_mass(static_cast<int>(ids.size()), fraction * area_vector.norm());
      for (int i = 0; i < ids.size(); ++i) {
        normal.col(local[ids[i]]) += area_vector;
        for (int j = 0; j < ids.size(); ++j)
          triplets.emplace_back(local[ids[i]], local[ids[j]], M(i, j));
      }
    }
    normal.colwise().normalize();
    Eigen::SparseMatrix<double> mass(nodes.size(), nodes.size());
    mass.setFromTriplets(triplets.begin(), triplets.end());
    factor.compute(mass);
  }

  /// Rows as `nodes`.
  Eigen::MatrixX3d operator()(const VectorXd& R) const {
    Eigen::MatrixX3d force(nodes.size(), 3);
    for (size_t i = 0; i < nodes.size(); ++i) force.row(i) = R.segment<3>(3 * nodes[i]);
    return factor.solve(force);
  }
};

/// Springs instead of the clamp, in every example where it stands.
void soften(Model& model, const std::string& region, double k_normal, double k_tangent) {
  const Scene& scene = *model.scene;
  const TetMesh& mesh = scene.body->mesh;
  const VectorXd rest = Eigen::Map<const VectorXd>(mesh.X.data(), mesh.X.size());
  const auto springs =
      elastic_foundation(scene.body->regions.at(region), k_normal, k_tangent, rest);
  for (size_t e = 0; e < model.examples.size(); ++e) {
    const std::set<int> freed = clamped_nodes(scene, static_cast<int>(e), region);
    if (freed.empty()) continue;
    Loading& loading = model.examples[e].loading;
    std::vector<int> kept;
    std::vector<double> displacement;
    for (size_t i = 0; i < loading.prescribed.size(); ++i) {
      if (freed.count(loading.prescribed[i] / 3)) continue;
      kept.push_back(loading.prescribed[i]);
      displacement.push_back(loading.displacement[i]);
    }
    loading.prescribed = std::move(kept);
    loading.displacement = Eigen::Map<VectorXd>(displacement.data(), displacement.size());
    loading.forces.push_back(springs);
  }
}

/// A clamp that gives: elastic foundation between the region and the ground. Scored by compliance
/// (0: rigid, displacement = -c times the support's traction), refitted by log stiffness.
class SoftClamp final : public Effect {
 public:
  std::string name() const override { return "soft_clamp"; }
  EffectGroup group() const override { return EffectGroup::supports; }
  std::string title() const override { return "a clamp that gives"; }
  bool several() const override { return true; }
  std::string manual() const override {
    return "A support told as rigid yields under load like a bed of springs: glue, a soft plate, "
           "a loose jaw. Easily taken for a softer material near the support, for anisotropy or "
           "for a misaligned load; photos of the support's edge tell.";
  }

  Ingredients candidates(const Model& model, std::string* why_not) const override {
    const Scene& scene = *model.scene;
    Ingredients all;
    for (const auto& [region, patch] : scene.body->regions.all()) {
      if (patch.faces.empty()) continue;
      for (size_t e = 0; e < scene.capture.examples.size(); ++e)
        if (!scene.capture.examples[e].validate &&
            !clamped_nodes(scene, static_cast<int>(e), region).empty()) {
          all.push_back(compliance_form(model, region));
          break;
        }
    }
    if (all.empty() && why_not) *why_not = "no region is held in all components";
    return all;
  }

  std::shared_ptr<const Ingredient> rebuild(const Model& model,
                                            const std::string& variant) const override {
    const std::string start = "springs under ";
    if (!starts_with(variant, start)) return nullptr;
    const std::string region = variant.substr(start.size());
    if (!model.scene->body->regions.all().count(region)) return nullptr;
    return spring_form(model, region);
  }

  std::vector<NextForm> forms_from(FormEdge edge, const Model& model, const Ingredient& from,
                                   const VectorXd& values) const override {
    if (edge != FormEdge::refit || starts_with(from.variant(), "springs")) return {};
    const double typical = typical_compliance(model);
    VectorXd stiffnesses = values;
    for (double& c : stiffnesses) c = 1.0 / std::clamp(c, 1e-2 * typical, 1e2 * typical);
    return {{spring_form(model, from.variant()), std::move(stiffnesses)}};
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    const bool springs = starts_with(ingredient.variant(), "springs under ");
    const std::string region =
        springs ? ingredient.variant().substr(std::string("springs under ").size())
                : ingredient.variant();
    auto stiffness = [&](double v) {
      if (!springs && v <= 0.0) return std::string("rigid");
      return fmt::format("{} {}/{}", figure(springs ? v : 1.0 / v),
                         model.scene->capture.units.stress(), model.scene->capture.units.length);
    };
    return fmt::format("'{}' gives like a bed of springs: {} along its normal, {} across", region,
                       stiffness(values[0]), stiffness(values[1]));
  }

 private:
  /// Under a strain of a tenth (traction mu/3) the clamp gives 1 % of the body's size.
  static double typical_compliance(const Model& model) {
    return 0.03 * body_size(*model.scene).size / initial_shear_modulus(model.energy);
  }

  std::shared_ptr<const Ingredient> compliance_form(const Model& model,
                                                    const std::string& region) const {
    const Scene& scene = *model.scene;
    const double typical = typical_compliance(model);
    const std::string unit = scene.capture.units.length + "/" + scene.capture.units.stress();
    const auto patch =
        std::make_shared<const PatchTraction>(scene.body->mesh, scene.body->regions.at(region));
    IngredientSpec spec;
    spec.name = name();
    spec.variant = region;
    for (const char* part : {"normal", "tangent"})
      spec.parameters.push_back({fmt::format("soft_clamp.{}.{}", region, part), unit,
                                 fmt::format("compliance of '{}', {}", region, part), 0.0, 0.0,
                                 1e4 * typical, typical, false});
    spec.touches = {.loading = true};
    spec.apply = [region, typical](const VectorXd& c, Model& m) {
      const double least = 1e-8 * typical;  // as good as rigid, and still solvable
      soften(m, region, 1.0 / std::max(c[0], least), 1.0 / std::max(c[1], least));
    };
    spec.derivative = [region, patch](const VectorXd& c, const Model& m, int example,
                                      const Equilibrium& equilibrium, int k,
                                      MechanicsDerivative& out) {
      if (!c.isZero(0.0)) return false;
      const std::set<int> own = clamped_nodes(*m.scene, example, region);
      if (own.empty()) return true;
      const Eigen::MatrixX3d traction = (*patch)(equilibrium.R);
      VectorXd u = VectorXd::Zero(equilibrium.q.size());
      for (size_t i = 0; i < patch->nodes.size(); ++i) {
        if (!own.count(patch->nodes[i])) continue;
        const Vector3d t = traction.row(i), n = patch->normal.col(i);
        const Vector3d along = t.dot(n) * n;
        u.segment<3>(3 * patch->nodes[i]) = k == 0 ? Vector3d(-along) : Vector3d(along - t);
      }
      const auto& prescribed = m.examples[example].loading.prescribed;
      out.dqc_dt.resize(prescribed.size());
      for (size_t i = 0; i < prescribed.size(); ++i) out.dqc_dt[i] = u[prescribed[i]];
      return true;
    };
    return make_ingredient(std::move(spec));
  }

  std::shared_ptr<const Ingredient> spring_form(const Model& model,
                                                const std::string& region) const {
    const double typical = 1.0 / typical_compliance(model);
    const Units& units = model.scene->capture.units;
    IngredientSpec spec;
    spec.name = name();
    spec.variant = "springs under " + region;
    spec.has_null = false;
    for (const char* part : {"k_normal", "k_tangent"})
      spec.parameters.push_back({fmt::format("soft_clamp.{}.{}", region, part),
                                 units.stress() + "/" + units.length,
                                 fmt::format("spring stiffness of '{}', {}", region, part + 2),
                                 100.0 * typical, 1e-4 * typical, 1e5 * typical, typical, true});
    spec.touches = {.loading = true};
    spec.apply = [region](const VectorXd& k, Model& m) { soften(m, region, k[0], k[1]); };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(soft_clamp, SoftClamp)
