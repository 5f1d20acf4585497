// Steps as supports and loads on regions.
//
// Displacements that differ from node to node are a rigid motion or refused. Forces at nodes that
// are an even spread over regions become these; others keep their sum, and that is said.
#include "importers/deck_cases.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>

#include "capture_io/camera_text.h"

namespace hookeye::solver_deck {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// More groups of equal displacements than these are a field.
constexpr size_t kMostGroups = 12;

std::string list(const Vector3d& v) {
  return fmt::format("[{}, {}, {}]", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);
}

/// Without the digits that a sum over nodes or sides has lost.
double rounded(double value) { return std::stod(fmt::format("{:.9g}", value)); }

/// Prescribed components of a node or a region.
using Held = std::map<int, double>;

std::string support_text(const std::string& region, const Held& held) {
  std::vector<std::string> axes, moves;
  bool moved = false;
  for (const auto& [i, u] : held) {
    axes.emplace_back(1, "xyz"[i]);
    moves.push_back(fmt::format("{}: {}", "xyz"[i], u + 0.0));
    moved |= u != 0;
  }
  const std::string what = moved ? fmt::format("move: {{{}}}", fmt::join(moves, ", "))
                                 : fmt::format("fix: [{}]", fmt::join(axes, ", "));
  return fmt::format("      - {{region: {}, {}}}\n", yaml_name(region), what);
}

/// Rows of the motion X -> x that is nearest to the points; empty: it is none.
std::string rigid_text(const Matrix3Xd& X, const Matrix3Xd& x) {
  const Vector3d center = X.rowwise().mean(), moved = x.rowwise().mean();
  const Matrix3Xd A = X.colwise() - center, B = x.colwise() - moved;
  const Eigen::JacobiSVD<Matrix3d> svd(B * A.transpose(),
                                       Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3d flip = Matrix3d::Identity();
  flip(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const Matrix3d R = svd.matrixU() * flip * svd.matrixV().transpose();
  const double size = A.colwise().norm().maxCoeff();
  if ((R * A - B).colwise().norm().maxCoeff() > 1e-6 * size) return "";
  const Eigen::AngleAxisd turn(R);
  std::string out;
  if (std::abs(turn.angle()) > 1e-9)
    out = fmt::format("rotate: {{axis: {}, degrees: {:.10g}, center: {}}}, ", list(turn.axis()),
                      turn.angle() * 180 / EIGEN_PI, list(center));
  return out + "move: " + list(moved - center);
}

class CaseWriter {
 public:
  CaseWriter(const DeckStep& step, Deck& deck, Patches& patches)
      : step_(step), deck_(deck), patches_(patches) {}

  CaseText write() {
    supports();
    forces();
    pressures();
    CaseText out;
    if (!supports_.empty()) out.yaml += "    supports:\n" + supports_;
    if (!loads_.empty()) out.yaml += "    loads:\n" + loads_;
    out.supports = static_cast<size_t>(std::count(supports_.begin(), supports_.end(), '\n'));
    out.loads = static_cast<size_t>(std::count(loads_.begin(), loads_.end(), '\n'));
    return out;
  }

 private:
  void support(const std::string& hint, const std::set<int>& labels, const Held& held,
               const Place& place) {
    for (const std::string& region : patches_.of_nodes(hint, labels, place))
      supports_ += support_text(region, held);
  }

  void supports() {
    std::map<std::string, Held> of_sets;
    std::map<int, Held> of_nodes;
    std::map<std::string, Place> places;
    Place loose;
    for (const auto& [key, told] : step_.held) {
      if (is_label(key.first)) {
        of_nodes[std::stoi(key.first)][key.second] = told.value;
        loose = told.place;
      } else {
        of_sets[key.first][key.second] = told.value;
        places[key.first] = told.place;
      }
    }
    for (const auto& [name, held] : of_sets)
      for (const int label : deck_.node_sets.at(name).members)
        for (const auto& [i, u] : held) table_[label].try_emplace(i, u);
    for (const auto& [label, held] : of_nodes)
      for (const auto& [i, u] : held) table_[label][i] = u;
    const std::string turned = turned_sets(of_nodes);
    for (const auto& [name, held] : of_sets) {
      const LabelSet& set = deck_.node_sets.at(name);
      if (!std::includes(turned_.begin(), turned_.end(), set.members.begin(), set.members.end()))
        support(set.name, set.members, held, places.at(name));
    }
    supports_ += turned;
    node_by_node(of_nodes, loose);
  }

  /// Named regions that move as rigid bodies, of nodes that are told one by one:
  /// a turn about z has its move along z alike at all of them, which a deck may tell by the set.
  std::string turned_sets(std::map<int, Held>& left) {
    std::string out;
    std::vector<std::string> names = patches_.named();
    std::stable_sort(names.begin(), names.end(), [&](const auto& a, const auto& b) {
      return patches_.region(a).nodes.size() > patches_.region(b).nodes.size();
    });
    for (const std::string& name : names) {
      std::set<int> labels;
      for (const int column : patches_.region(name).nodes) labels.insert(patches_.label(column));
      const bool whole = std::all_of(labels.begin(), labels.end(), [&](int label) {
        const auto at = table_.find(label);
        return at != table_.end() && at->second.size() == 3;
      });
      const bool any = std::any_of(labels.begin(), labels.end(),
                                   [&](int label) { return left.contains(label); });
      const std::string text = whole && any ? rigid(name, labels) : "";
      if (text.empty()) continue;
      out += text;
      turned_.insert(labels.begin(), labels.end());
      for (const int label : labels) left.erase(label);
    }
    return out;
  }

  /// "": they move otherwise.
  std::string rigid(const std::string& region, const std::set<int>& labels) const {
    Matrix3Xd X(3, static_cast<Eigen::Index>(labels.size())), x = X;
    Eigen::Index k = 0;
    bool alike = true;
    const Held& first = table_.at(*labels.begin());
    for (const int label : labels) {
      const Held& u = table_.at(label);
      X.col(k) = deck_.nodes.at(label);
      x.col(k) = X.col(k) + Vector3d(u.at(0), u.at(1), u.at(2));
      alike &= u == first;
      ++k;
    }
    if (alike) return support_text(region, first);
    const std::string motion = labels.size() < 4 ? "" : rigid_text(X, x);
    if (motion.empty()) return "";
    return fmt::format("      - {{region: {}, rigid: {{{}}}}}\n", yaml_name(region), motion);
  }

  void say_loose(int label, const Place& place) {
    deck_.say(place,
              fmt::format("node {} is in no tetrahedron: what acts on it is left out", label));
  }

  void node_by_node(const std::map<int, Held>& left, const Place& place) {
    std::map<Held, std::set<int>> groups;
    for (const auto& [label, held] : left)
      if (patches_.column(label))
        groups[held].insert(label);
      else
        say_loose(label, place);
    if (groups.size() > kMostGroups)
      throw InputError(place,
                       "the displacements differ from node to node, and no node set that turns as "
                       "a rigid body holds them",
                       "a node set of each clamp, or equal displacements");
    for (const auto& [held, labels] : groups) support("held", labels, held, place);
  }

  /// Forces at the nodes as regions' total forces.
  void forces() {
    Matrix3Xd f = Matrix3Xd::Zero(3, patches_.mesh().nodes());
    for (const auto& [key, told] : step_.forces)
      for (const int label : targets(key.first))
        if (const auto at = patches_.column(label))
          f(key.second, *at) += told.value;
        else
          say_loose(label, told.place);
    if (f.isZero(0.0) || even_spread(f)) return;
    std::map<std::string, Vector3d> of_sets;
    std::map<std::string, Place> places;
    std::set<int> labels;  // of nodes that are told one by one
    for (const auto& [key, told] : step_.forces) {
      const std::set<int> nodes = targets(key.first);
      const auto of_body = std::count_if(nodes.begin(), nodes.end(), [&](int label) {
        return patches_.column(label).has_value();
      });
      if (of_body == 0) continue;
      const std::string target = is_label(key.first) ? "" : key.first;
      if (target.empty()) labels.insert(*nodes.begin());
      of_sets.try_emplace(target, Vector3d::Zero()).first->second[key.second] +=
          told.value * static_cast<double>(of_body);
      places[target] = told.place;
    }
    for (const auto& [target, total] : of_sets) {
      if (target.empty())
        total_force("loaded", labels, total, places.at(target));
      else
        total_force(deck_.node_sets.at(target).name, targets(target), total, places.at(target));
    }
  }

  void total_force(const std::string& hint, const std::set<int>& labels, const Vector3d& total,
                   const Place& place) {
    if (total.isZero(0.0)) {
      deck_.say(place, fmt::format("the forces on `{}` have no sum: left out", hint));
      return;
    }
    std::string region;
    for (const std::string& name : patches_.named()) {
      std::set<int> own;
      for (const int column : patches_.region(name).nodes) own.insert(patches_.label(column));
      if (own == labels) region = name;
    }
    if (region.empty()) region = patches_.about_nodes(hint, labels, place);
    deck_.say(place, fmt::format("the forces on the nodes of `{}` are no even spread: their sum is "
                                 "spread evenly over region {}",
                                 hint, region));
    load(region, total);
  }

  std::set<int> targets(const std::string& target) const {
    if (is_label(target)) return {std::stoi(target)};
    return deck_.node_sets.at(target).members;
  }

  void load(const std::string& region, const Vector3d& force) {
    loads_ += fmt::format("      - {{region: {}, force: {}}}\n", yaml_name(region), list(force));
  }

  /// Whether the forces are those of regions that take even loads; then they are written.
  bool even_spread(const Matrix3Xd& f) {
    const double most = f.cwiseAbs().maxCoeff();
    std::vector<std::string> names;
    for (const auto& [name, region] : patches_.all()) {
      if (!(region.area > 0)) continue;
      bool loaded = true;
      for (Eigen::Index n = 0; n < region.nodal_area.size(); ++n)
        loaded &= std::abs(region.nodal_area[n]) <= 1e-6 * region.area ||
                  f.col(n).cwiseAbs().maxCoeff() > 1e-9 * most;
      if (loaded) names.push_back(name);
    }
    if (names.empty()) return false;
    const auto m = static_cast<Eigen::Index>(names.size());
    Eigen::MatrixXd A(f.cols(), m);
    for (Eigen::Index i = 0; i < m; ++i) {
      const Region& region = patches_.region(names[static_cast<size_t>(i)]);
      A.col(i) = region.nodal_area / region.area;
    }
    const Eigen::MatrixXd total = A.colPivHouseholderQr().solve(f.transpose());
    if ((A * total - f.transpose()).cwiseAbs().maxCoeff() > 1e-6 * most) return false;
    const double largest = total.cwiseAbs().maxCoeff();
    for (Eigen::Index i = 0; i < m; ++i) {
      Vector3d force = total.row(i).transpose();
      for (double& one : force) one = std::abs(one) < 1e-9 * largest ? 0.0 : rounded(one);
      if (!force.isZero(0.0)) load(names[static_cast<size_t>(i)], force);
    }
    return true;
  }

  void pressures() {
    std::map<double, std::set<Side>> by_value;
    std::set<Side> all;
    Place place;
    for (const auto& [side, told] : step_.pressures) {
      if (told.value == 0) continue;
      by_value[told.value].insert(side);
      all.insert(side);
      place = told.place;
    }
    std::vector<std::pair<std::string, double>> pressed;
    for (const auto& [value, sides] : by_value) {
      if (by_value.size() > kMostGroups || !patches_.is_patch(sides, place)) {
        mean_pressure(all, place);
        return;
      }
      pressed.emplace_back(patches_.of_sides("pressed", sides, place), value);
    }
    for (const auto& [region, value] : pressed) pressure(region, value);
  }

  /// Of sides that are no patch by themselves, or of many pressures: the sum over their area stays.
  void mean_pressure(const std::set<Side>& sides, const Place& place) {
    double sum = 0;
    for (const Side& side : sides) sum += patches_.area(side) * step_.pressures.at(side).value;
    const std::string region = patches_.of_sides("pressed", sides, place);
    deck_.say(place, fmt::format("the pressure ends within region {}: its mean over the region's "
                                 "area is taken",
                                 region));
    pressure(region, rounded(sum / patches_.region(region).area));
  }

  void pressure(const std::string& region, double value) {
    loads_ += fmt::format("      - {{region: {}, pressure: {}}}\n", yaml_name(region), value);
  }

  const DeckStep& step_;
  Deck& deck_;
  Patches& patches_;
  std::map<int, Held> table_;  ///< of all nodes that are held
  std::set<int> turned_;       ///< those of sets that move as rigid bodies
  std::string supports_, loads_;
};

}  // namespace

CaseText case_text(const DeckStep& step, Deck& deck, Patches& patches) {
  return CaseWriter(step, deck, patches).write();
}

}  // namespace hookeye::solver_deck
