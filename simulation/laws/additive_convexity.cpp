// Convexity of additive models over their strain components: test and projection (Miguel, Miraut,
// Otaduy 2016, section 5; method.md, Model).
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "simulation/laws/additive_addends.h"
#include "simulation/laws/least_distance.h"

namespace hookeye {
namespace {

using laws::CompiledAddend;
using laws::Side;

/// The softest strain at rest over the stiffest, at least: softer, equilibria at rest are singular
/// to rounding, and no photo of a loaded body tells so soft a strain from one that is softer.
constexpr double kSoftest = 1e-5;
/// More places than this: the middles of the cells are left out.
constexpr size_t kManyPlaces = 20000;

struct Spot {
  double e;
  Side side;
};

/// Components tied by two-component addends, with the strains to test along each.
struct Group {
  std::vector<int> components;
  std::vector<std::vector<Spot>> spots;  ///< per component
  std::vector<const CompiledAddend*> addends;
};

std::vector<int> group_of_components(const AdditiveModel& model) {
  std::vector<int> group(model.components.size());
  std::iota(group.begin(), group.end(), 0);
  for (const Addend& a : model.addends)
    if (a.second >= 0) {
      const int from = group[a.second], to = group[a.first];
      std::replace(group.begin(), group.end(), from, to);
    }
  return group;
}

/// Control points of a component: both limits where a bilinear cell ends there, and the middles.
std::vector<Spot> spots_of(const AdditiveModel& model, int component, bool middles) {
  std::vector<double> points;
  bool jumps = false;
  for (const Addend& a : model.addends)
    for (int k = 0; k < 2; ++k) {
      if ((k == 0 ? a.first : a.second) != component) continue;
      const auto& at = k == 0 ? a.at : a.at_second;
      points.insert(points.end(), at.begin(), at.end());
      jumps |= a.second >= 0 && at.size() > 1;
      if (a.even && a.second < 0 && model.components[component].shear())
        for (double x : at) points.push_back(-x);
    }
  points.push_back(0.0);
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (model.components[component].kind == StrainComponent::Kind::i1bar)
    points.erase(points.begin(), std::lower_bound(points.begin(), points.end(), 0.0));
  std::vector<Spot> spots;
  for (size_t i = 0; i < points.size(); ++i) {
    spots.push_back({points[i], Side::above});
    if (jumps) spots.push_back({points[i], Side::below});
    if (middles && i > 0) spots.push_back({0.5 * (points[i - 1] + points[i]), Side::above});
  }
  return spots;
}

std::vector<Group> groups_of(const AdditiveModel& model,
                             const std::vector<CompiledAddend>& addends) {
  const std::vector<int> group = group_of_components(model);
  std::vector<Group> all;
  for (int g = 0; g < static_cast<int>(group.size()); ++g) {
    Group one;
    for (int c = 0; c < static_cast<int>(group.size()); ++c)
      if (group[c] == g) one.components.push_back(c);
    if (one.components.empty()) continue;
    for (const CompiledAddend& a : addends)
      if (group[a.first()] == g) one.addends.push_back(&a);
    for (bool middles : {true, false}) {
      one.spots.clear();
      size_t places = 1;
      for (int c : one.components) {
        one.spots.push_back(spots_of(model, c, middles));
        places *= one.spots.back().size();
      }
      if (places <= kManyPlaces) break;
    }
    all.push_back(std::move(one));
  }
  return all;
}

/// The Hessian over a group's components at one choice of spots.
Eigen::MatrixXd hessian_at(const Group& group, const laws::Strains& e,
                           const std::array<Side, laws::kMostComponents>& side,
                           const std::array<int, laws::kMostComponents>& local) {
  const auto m = static_cast<Eigen::Index>(group.components.size());
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(m, m);
  for (const CompiledAddend* a : group.addends) {
    const int i = a->first(), j = std::max(a->second(), 0);
    const Eigen::Vector3d h = a->hessian(e, side[i], side[j]);
    H(local[i], local[i]) += h[0];
    if (a->second() < 0) continue;
    H(local[j], local[j]) += h[1];
    H(local[i], local[j]) += h[2];
    H(local[j], local[i]) += h[2];
  }
  return H;
}

ConvexityTest finished_test(const AdditiveModel& model, const Group& group, const laws::Strains& e,
                            const std::array<Side, laws::kMostComponents>& side,
                            const std::array<int, laws::kMostComponents>& local, double eigenvalue,
                            const Eigen::VectorXd& v) {
  ConvexityTest out;
  out.smallest = eigenvalue;
  out.gradient.setZero(model.size());
  for (const CompiledAddend* a : group.addends) {
    if (a->offset() < 0) continue;
    const int i = a->first(), j = std::max(a->second(), 0);
    const Eigen::MatrixX3d B = a->hessian_basis(e, side[i], side[j]);
    auto mine = out.gradient.segment(a->offset(), a->size());
    mine += v[local[i]] * v[local[i]] * B.col(0);
    if (a->second() >= 0)
      mine += v[local[j]] * v[local[j]] * B.col(1) + 2.0 * v[local[i]] * v[local[j]] * B.col(2);
  }
  std::vector<std::string> where;
  for (int c : group.components)
    where.push_back(fmt::format("{} = {:.4g}", model.components[c].name, e[c]));
  out.where = fmt::format("{}", fmt::join(where, ", "));
  return out;
}

/// Calls `visit(group, e, side, local, smallest eigenvalue, its vector)` for every test.
template <class Visit>
void for_each_test(const AdditiveModel& model, Visit&& visit) {
  const std::vector<CompiledAddend> addends = laws::compile(model);
  for (const Group& group : groups_of(model, addends)) {
    if (group.addends.empty()) continue;
    const size_t m = group.components.size();
    std::array<int, laws::kMostComponents> local{};
    for (size_t c = 0; c < m; ++c) local[group.components[c]] = static_cast<int>(c);
    std::vector<size_t> index(m, 0);
    laws::Strains e{};
    std::array<Side, laws::kMostComponents> side{};
    while (true) {
      for (size_t c = 0; c < m; ++c) {
        e[group.components[c]] = group.spots[c][index[c]].e;
        side[group.components[c]] = group.spots[c][index[c]].side;
      }
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian_at(group, e, side, local));
      visit(group, e, side, local, eigen.eigenvalues()[0], eigen.eigenvectors().col(0));
      size_t c = 0;
      while (c < m && ++index[c] == group.spots[c].size()) index[c++] = 0;
      if (c == m) break;
    }
  }
}

}  // namespace

ConvexityTest smallest_eigenvalue(const AdditiveModel& model) {
  ConvexityTest least;
  double smallest = std::numeric_limits<double>::infinity();
  for_each_test(model, [&](const Group& group, const laws::Strains& e, const auto& side,
                           const auto& local, double eigenvalue, const Eigen::VectorXd& v) {
    if (eigenvalue >= smallest) return;
    smallest = eigenvalue;
    least = finished_test(model, group, e, side, local, eigenvalue, v);
  });
  if (least.gradient.size() == 0) least.gradient.setZero(model.size());
  return least;
}

namespace {

bool is_rest(const Group& group, const laws::Strains& e) {
  return std::all_of(group.components.begin(), group.components.end(),
                     [&](int c) { return e[c] == 0.0; });
}

/// Largest second derivative of one addend at rest.
double stiffest_at_rest(const AdditiveModel& model) {
  double stiffest = 0.0;
  for (const CompiledAddend& a : laws::compile(model))
    if (a.second() < 0)
      stiffest = std::max(stiffest, a.hessian(laws::Strains{}, Side::above, Side::above)[0]);
  return stiffest;
}

/// All tests that want more: below zero, or at rest below `at_rest`. `smallest` is over what is
/// wanted.
std::vector<ConvexityTest> violated_tests(const AdditiveModel& model, double at_rest) {
  std::vector<ConvexityTest> all;
  for_each_test(model, [&](const Group& group, const laws::Strains& e, const auto& side,
                           const auto& local, double eigenvalue, const Eigen::VectorXd& v) {
    const double over = eigenvalue - (is_rest(group, e) ? at_rest : 0.0);
    if (over < 0.0) all.push_back(finished_test(model, group, e, side, local, over, v));
  });
  return all;
}

/// A part while it is being made convex.
struct PartInWork {
  const ConvexPart& told;
  AdditiveModel trial;
  double margin, at_rest;
  PartInWork(const ConvexPart& part, const Eigen::VectorXd& target)
      : told(part), trial(part.model), at_rest(kSoftest * stiffest_at_rest(part.model)) {
    // Cuts ask for a little more than zero, so that the search ends.
    margin = 1e-9 * std::max(1e-300, (part.by_x * target).lpNorm<Eigen::Infinity>());
  }
  /// Adds half-spaces of x that keep the worst tests; how many.
  int cut(const Eigen::VectorXd& x, std::vector<Eigen::VectorXd>& normals,
          std::vector<double>& heights) {
    const Eigen::VectorXd values = told.by_x * x;
    trial.set_values(values);
    std::vector<ConvexityTest> violated = violated_tests(trial, at_rest);
    // The worst tests first; the others are often satisfied with them.
    const size_t most = std::min<size_t>(violated.size(), 8);
    std::partial_sort(
        violated.begin(), violated.begin() + static_cast<std::ptrdiff_t>(most), violated.end(),
        [](const ConvexityTest& a, const ConvexityTest& b) { return a.smallest < b.smallest; });
    for (size_t k = 0; k < most; ++k) {
      normals.push_back(told.by_x.transpose() * violated[k].gradient);
      heights.push_back(violated[k].gradient.dot(values) - violated[k].smallest + margin);
    }
    return static_cast<int>(most);
  }
};

}  // namespace

ConvexProjection project_convex(const std::vector<ConvexPart>& parts, const Eigen::VectorXd& target,
                                const Eigen::MatrixXd& metric, const Eigen::VectorXd& low) {
  const Eigen::LLT<Eigen::MatrixXd> factor(metric);
  ConvexProjection out;
  out.x = target;
  if (factor.info() != Eigen::Success) return out;
  std::vector<Eigen::VectorXd> normals;
  std::vector<double> heights;
  for (Eigen::Index i = 0; i < low.size(); ++i)
    if (std::isfinite(low[i])) {
      normals.push_back(Eigen::VectorXd::Unit(target.size(), i));
      heights.push_back(low[i]);
    }
  std::vector<PartInWork> work;
  for (const ConvexPart& part : parts) work.emplace_back(part, target);
  for (int round = 0; round < 200; ++round) {
    if (!normals.empty()) {
      Eigen::MatrixXd G(normals.size(), target.size());
      for (size_t k = 0; k < normals.size(); ++k) G.row(static_cast<Eigen::Index>(k)) = normals[k];
      const auto nearest =
          nearest_within(factor, target, G,
                         Eigen::Map<const Eigen::VectorXd>(
                             heights.data(), static_cast<Eigen::Index>(heights.size())));
      if (!nearest) return out;
      out.x = *nearest;
      if (low.size() != 0) out.x = out.x.cwiseMax(low);
    }
    int cuts = 0;
    for (PartInWork& part : work) cuts += part.cut(out.x, normals, heights);
    if (cuts == 0) {
      out.converged = true;
      return out;
    }
    out.cuts += cuts;
  }
  return out;
}

}  // namespace hookeye
