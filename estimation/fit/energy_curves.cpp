#include "estimation/fit/energy_curves.h"

#include <algorithm>
#include <cmath>

#include "core/distributions.h"
#include "estimation/evaluation/normal_equations.h"

namespace hookeye {
namespace {

using nlohmann::json;

/// Calls visit(element, F) for every point of an example where a part of the energy acts, F in the
/// part's frame and without the swelling. Part -1: everywhere, in the frames of the first.
template <class Visit>
void for_each_point(const Scene& scene, const Model& model, const VectorXd& q, int part,
                    Visit&& visit) {
  const TetMesh& mesh = scene.body->mesh;
  const std::vector<Matrix3d> all = deformation_gradients(mesh, q);
  const EnergyModel::Part& own = model.energy.parts.at(static_cast<size_t>(std::max(part, 0)));
  const size_t points = all.size() / static_cast<size_t>(mesh.size());
  for (size_t i = 0; i < all.size(); ++i) {
    const int e = static_cast<int>(i / points);
    if (part >= 0 && own.weight.size() && !(own.weight[e] > 0)) continue;
    Matrix3d F = all[i];
    if (model.energy.swelling.size()) F /= model.energy.swelling[e];
    if (own.frames.size()) F = F * own.frame(e);
    visit(e, F);
  }
}

/// Strain along a curve: over what is visited and the control points, with a margin.
std::pair<double, double> curve_range(const Addend& addend, double low, double high) {
  if (!addend.fixed) {
    low = std::min(low, addend.at.front());
    high = std::max(high, addend.at.back());
  }
  if (addend.even) low = std::min(low, 0.0);
  const double margin = 0.1 * std::max(high - low, 1e-6);
  return {addend.even ? low : low - margin, high + margin};
}

}  // namespace

double quantile(std::vector<double>& values, double share) {
  const auto k = static_cast<size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(k), values.end());
  return values[k];
}

void push_band(json& curve, double value, double half, double reach) {
  curve["low"].push_back(value - half + std::min(reach, 0.0));
  curve["high"].push_back(value + half + std::max(reach, 0.0));
}

VisitedStrains visited_strains(const ModelForm& form, const Fitted& fitted,
                               const AdditiveModel& model, int part) {
  const Model realised = form.realise(fitted.p);
  std::vector<std::vector<double>> all(model.components.size());
  for (const auto& example : fitted.evaluation.examples) {
    if (example.held_out) continue;
    for_each_point(*form.scene, realised, example.equilibrium->q, part,
                   [&](int, const Matrix3d& F) {
                     const VectorXd e = strains(model, F);
                     for (size_t c = 0; c < all.size(); ++c)
                       all[c].push_back(e[static_cast<Eigen::Index>(c)]);
                   });
  }
  VisitedStrains out;
  for (auto& values : all) {
    out.low.push_back(values.empty() ? 0.0 : std::min(0.0, quantile(values, 0.01)));
    out.high.push_back(values.empty() ? 0.0 : std::max(0.0, quantile(values, 0.99)));
  }
  return out;
}

VectorXd addends_beyond(const Scene& scene, const AdditiveModel& model, const Model& realised,
                        const VectorXd& q, int part) {
  Eigen::MatrixXd flags = Eigen::MatrixXd::Zero(scene.body->mesh.size(), model.addends.size());
  for_each_point(scene, realised, q, part, [&](int e, const Matrix3d& F) {
    const std::vector<bool> beyond = beyond_control_points(model, strains(model, F));
    for (size_t a = 0; a < beyond.size(); ++a)
      if (beyond[a]) flags(e, static_cast<Eigen::Index>(a)) = 1.0;
  });
  return flags.rowwise().sum();
}

VectorXd addends_beyond(const Scene& scene, const Model& realised, const VectorXd& q) {
  VectorXd out;
  for (size_t part = 0; part < scene.capture.materials.size(); ++part)
    if (const AdditiveModel* own = additive_model(*realised.energy.parts.at(part).term)) {
      if (out.size() == 0) out.setZero(scene.body->mesh.size());
      out += addends_beyond(scene, *own, realised, q, static_cast<int>(part));
    }
  return out;
}

namespace {

/// Energy along a curve and its derivative by the control values of the addend.
struct CurvePoint {
  double value;
  VectorXd gradient;
};

CurvePoint on_curve(const AdditiveModel& model, int addend, double e, double second) {
  const Addend& a = model.addends[addend];
  if (a.second < 0) {
    const Eigen::MatrixX3d basis = addend_curve_basis(model, addend, e);
    return {basis.col(0).dot(a.stiffness), basis.col(0)};
  }
  CurvePoint out;
  out.gradient = addend_energy_basis(model, addend, e, second);
  out.value = out.gradient.dot(a.stiffness);
  return out;
}

/// Functions whose curves are drawn: a material's, or what an effect adds.
struct Drawn {
  AdditiveModel model;
  Eigen::MatrixXd by_p;  ///< values() = by_p * p
  int part = 0;          ///< as for_each_point
  std::string label;     ///< "", "head", "strain_stiffening"
};

/// values() by p of a material of the capture whose named values are fitted or none: it is linear
/// in them, so that differences over a step of one are exact.
Eigen::MatrixXd by_p(const Fitted& fitted, size_t part) {
  const auto values = [&](Eigen::Index k, double h) -> VectorXd {
    VectorXd p = fitted.p;
    p[k] += h;
    return additive_model(*fitted.form.realise(p).energy.parts[part].term)->values();
  };
  Eigen::MatrixXd out(values(0, 0.0).size(), fitted.p.size());
  for (Eigen::Index k = 0; k < out.cols(); ++k) {
    const double h = 1e-3 * (std::abs(fitted.p[k]) + 1e-6);
    out.col(k) = (values(k, h) - values(k, -h)) / (2.0 * h);
  }
  return out;
}

std::vector<Drawn> drawn(const Fitted& fitted) {
  std::vector<Drawn> all;
  const Eigen::Index n = fitted.p.size();
  for (const AdditivePart& one : additive_parts(fitted.form, fitted.p)) {
    Eigen::MatrixXd by_p = Eigen::MatrixXd::Zero(one.model.size(), n);
    by_p.middleCols(one.offset, one.model.size()).setIdentity();
    all.push_back({one.model, std::move(by_p), one.place.part, one.place.label});
  }
  const Model realised = fitted.form.realise(fitted.p);
  const auto& materials = fitted.form.scene->capture.materials;
  for (size_t i = 0; all.empty() && i < materials.size(); ++i)
    if (const AdditiveModel* told = additive_model(*realised.energy.parts.at(i).term))
      all.push_back({*told, by_p(fitted, i), static_cast<int>(i),
                     materials.size() > 1 ? materials[i].region : ""});
  for (const AddedPart& one : added_parts(fitted.form, fitted.p))
    all.push_back({one.functions.model, one.functions.by_x, -1, one.name});
  return all;
}

/// What the values of a fit are known to.
struct Known {
  const Eigen::MatrixXd& covariance;
  const VectorXd& mesh_reach;  ///< empty: none
};

/// `first`: row of by_p of the addend's first control value.
json curve_json(const Drawn& of, int addend, int first, const VisitedStrains& visited,
                const Known& known) {
  const Addend& a = of.model.addends[addend];
  const double low = visited.low[a.first], high = visited.high[a.first];
  const auto [from, to] = curve_range(a, low, high);
  double second = 0.0;
  if (a.second >= 0)
    second = visited.high[a.second] > -visited.low[a.second] ? visited.high[a.second]
                                                             : visited.low[a.second];
  json one = {{"name", of.label.empty() ? a.name : of.label + "." + a.name},
              {"axis", of.model.components[a.first].name},
              {"visited", {low, high}}};
  if (a.second >= 0) one["at"] = {{of.model.components[a.second].name, second}};
  for (int i = 0; i < kCurvePoints; ++i) {
    const double e = from + (to - from) * i / (kCurvePoints - 1);
    const CurvePoint point = on_curve(of.model, addend, e, second);
    double half = 0.0, reach = 0.0;
    if (!a.fixed) {
      const VectorXd by_p =
          of.by_p.middleRows(first, point.gradient.size()).transpose() * point.gradient;
      half = kNormal95 * std::sqrt(std::max(0.0, by_p.dot(known.covariance * by_p)));
      if (known.mesh_reach.size()) reach = by_p.dot(known.mesh_reach);
    }
    one["stretch"].push_back(e);
    one["value"].push_back(point.value);
    push_band(one, point.value, half, reach);
  }
  return one;
}

/// Elements of all examples beyond the control points, by addend.
std::map<std::string, int> count_beyond(const Scene& scene, const Drawn& of, const Model& realised,
                                        const Fitted& fitted, int* elements) {
  std::map<std::string, int> count;
  *elements = 0;
  for (const auto& example : fitted.evaluation.examples) {
    for (const Addend& a : of.model.addends) {
      AdditiveModel one = of.model;
      one.addends = {a};
      const VectorXd beyond = addends_beyond(scene, one, realised, example.equilibrium->q, of.part);
      count[a.name] += static_cast<int>(beyond.sum());
    }
    const VectorXd everywhere;
    const VectorXd& weight = of.part < 0 ? everywhere : realised.energy.parts[of.part].weight;
    *elements +=
        weight.size() ? static_cast<int>((weight.array() > 0.0).count()) : scene.body->mesh.size();
  }
  return count;
}

}  // namespace

json energy_curves(const Scene& scene, const Fitted& fitted) {
  json out = json::array();
  const auto parameters = fitted.form.parameters();
  const Eigen::MatrixXd covariance =
      parameter_covariance(fitted.evaluation, parameters, fitted.p).all();
  const Model realised = fitted.form.realise(fitted.p);
  for (const Drawn& of : drawn(fitted)) {
    const VisitedStrains visited = visited_strains(fitted.form, fitted, of.model, of.part);
    int elements = 0, first = 0;
    const auto beyond = count_beyond(scene, of, realised, fitted, &elements);
    for (size_t a = 0; a < of.model.addends.size(); ++a) {
      const Addend& addend = of.model.addends[a];
      json one =
          curve_json(of, static_cast<int>(a), first, visited, {covariance, fitted.mesh_reach});
      one["unit"] = scene.capture.units.stress();
      one["beyond"] = beyond.at(addend.name);
      one["elements"] = elements;
      out.push_back(std::move(one));
      if (!addend.fixed) first += static_cast<int>(addend.stiffness.size());
    }
  }
  return out;
}

json additive_metrics(const Fitted& fitted) {
  const Model realised = fitted.form.realise(fitted.p);
  if (!has_additive(realised)) return {};
  const ConvexityTest convex = *smallest_eigenvalue(realised);
  double least = fitted.smallest_eigenvalue;
  for (const RefinementStage& stage : fitted.refinements)
    if (stage.kept) least = std::min(least, stage.smallest_eigenvalue);
  json out = {{"smallest_eigenvalue", convex.smallest},
              {"at", convex.where},
              {"least_over_accepted_steps", std::isnan(least) ? json() : json(least)},
              {"refinements", json::array()}};
  for (const RefinementStage& stage : fitted.refinements)
    out["refinements"].push_back(
        {{"what", stage.what},
         {"evidence", stage.evidence},
         {"values", stage.values},
         {"misfit_fit", stage.misfit_fit},
         {"misfit_held_out", stage.misfit_held_out ? json(*stage.misfit_held_out) : json()},
         {"smallest_eigenvalue", stage.smallest_eigenvalue},
         {"kept", stage.kept}});
  return out;
}

}  // namespace hookeye
