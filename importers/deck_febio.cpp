// Decks of FEBio (febio_spec 3.0 and 4.0): what they tell, as of any other deck.
//
// Written from FEBio's user manual and sources. Its uncoupled laws have c1 (I1bar - 3) + c2 (I2bar
// - 3), Ogden sum c_i/m_i^2 (...), which is mu_i/alpha_i (...) with c_i/m_i. Body forces act
// against the vector of the file. A boundary condition of a step holds in that step alone.
#include "importers/deck_febio.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "importers/deck_febio_mesh.h"

namespace hookeye::solver_deck {
namespace {

class FebioReader {
 public:
  explicit FebioReader(const std::filesystem::path& file) : file_(file), mesh_(file_) {
    materials();
    data();
    controllers();
    steps();
  }

  FebioFile file_;

 private:
  using Values = std::map<int, double>;  ///< by node, or by face of a surface from 1
  struct Curve {
    std::vector<std::pair<double, double>> points;
    bool holds = false;  ///< between points the value of the one before
  };

  void materials() {
    for (const XmlNode& material : file_.top().child("Material").all("material")) {
      if (!material.has("name")) continue;  // one within another
      DeckMaterial one;
      one.name = str(material.attribute("name")), one.place = file_.place(material);
      if (const XmlNode density = material.child("density"))
        one.density = std::max(0.0, file_.numbers(density, 1)[0]);
      one.law = febio_law(file_.xml(), material, file_.deck);
      file_.deck.materials.push_back(std::move(one));
    }
    for (const XmlNode& domain : file_.top().child("MeshDomains").children()) {
      if (domain.name() != "SolidDomain") {
        file_.leave(domain, fmt::format("<{}>", domain.name()));
        continue;
      }
      const LabelSet& set =
          set_called(file_.deck, false, str(domain.attribute("name")), file_.place(domain));
      file_.deck.sections.push_back(
          {set, capitals(str(domain.attribute("mat"))), file_.place(domain)});
    }
  }

  void data() {
    for (const XmlNode& node : file_.top().child("MeshData").children()) {
      const bool of_nodes = node.name() == "NodeData";
      if (!of_nodes && node.name() != "SurfaceData") continue;
      Values& values = data_[str(node.attribute("name"))];
      const std::vector<int>* order = mesh_.set(str(node.attribute("node_set")));
      if (of_nodes && !order)
        file_.fault(node, fmt::format("there is no node set `{}`", node.attribute("node_set")),
                    "a <NodeSet> of <Mesh>");
      for (const XmlNode& one : node.children()) {
        const int lid = whole(str(one.attribute("lid")), file_.place(one));
        if (of_nodes && (lid < 1 || lid > static_cast<int>(order->size())))
          file_.fault(one, fmt::format("the set has no node {}", lid), "lid from 1");
        const int key = of_nodes ? (*order)[static_cast<size_t>(lid) - 1] : lid;
        values[key] = file_.numbers(one, 1)[0];
      }
    }
  }

  void controllers() {
    for (const XmlNode& one : file_.top().child("LoadData").children()) {
      if (one.attribute("type") != "loadcurve") {
        file_.deck.say(file_.place(one), fmt::format("a load controller of type {} counts as 1",
                                                     one.attribute("type")));
        continue;
      }
      Curve& curve = curves_[file_.id_of(one)];
      curve.holds = capitals(str(one.child("interpolate").text())) == "STEP";
      for (const char* name : {"pt", "point"})
        for (const XmlNode& point : one.all(name)) {
          const std::vector<double> v = file_.numbers(point, 2);
          curve.points.emplace_back(v[0], v[1]);
        }
      std::sort(curve.points.begin(), curve.points.end());
    }
  }

  /// What the load curve of a number is at the end of the step.
  double share(const XmlNode& node) const {
    if (!node.has("lc")) return 1;
    const auto at = curves_.find(whole(str(node.attribute("lc")), file_.place(node)));
    if (at == curves_.end() || at->second.points.empty()) return 1;
    const auto& points = at->second.points;
    if (time_ <= points.front().first) return points.front().second;
    for (size_t i = 1; i < points.size(); ++i) {
      const auto [t0, v0] = points[i - 1];
      const auto [t1, v1] = points[i];
      if (time_ > t1 * (1 + 1e-12)) continue;
      if (time_ >= t1 * (1 - 1e-12)) return v1;
      return at->second.holds ? v0 : v0 + (v1 - v0) * (time_ - t0) / (t1 - t0);
    }
    return points.back().second;
  }

  /// A number, or one by node or face.
  struct Told {
    double all = 0;
    const Values* each = nullptr;
    double factor = 1;
    double of(int key) const {
      if (!each) return factor * all;
      const auto at = each->find(key);
      return at == each->end() ? 0 : factor * at->second;
    }
  };
  Told told(const XmlNode& node) const {
    Told out;
    out.factor = share(node);
    if (node.attribute("type") == "math")
      file_.fault(node, "a value by a formula is not read", "a number, or a map of <MeshData>");
    if (node.attribute("type") != "map") {
      out.all = file_.numbers(node, 1)[0];
      return out;
    }
    const auto at = data_.find(words_of(node.text()).empty() ? "" : words_of(node.text())[0]);
    if (at == data_.end()) file_.fault(node, "there is no such map", "one of <MeshData>");
    out.each = &at->second;
    return out;
  }

  const std::vector<int>& set_of(const XmlNode& node) const {
    const std::string name = str(node.attribute("node_set"));
    const std::vector<int>* set = mesh_.set(name);
    if (!set)
      file_.fault(node, fmt::format("there is no node set `{}`", name),
                  "a <NodeSet> or @surface:NAME");
    return *set;
  }

  static std::optional<int> component(const std::string& dof) {
    if (dof == "x" || dof == "y" || dof == "z") return dof[0] - 'x';
    return {};
  }

  void hold(const XmlNode& condition, int i, const Told& value, bool relative) {
    const Place place = file_.place(condition);
    const std::vector<int>& nodes = set_of(condition);
    if (relative && !file_.deck.steps.empty() && !nodes.empty() && !before_.contains({nodes[0], i}))
      file_.deck.say(place,
                     "what moves on from the step before was free there: it counts from rest");
    const std::string set = file_.key_of(str(condition.attribute("node_set")));
    if (!value.each && !relative) {
      now_.held[{set, i}] = {value.of(0), place};
      for (const int node : set_of(condition)) reached_[{node, i}] = value.of(0);
      return;
    }
    for (const int node : set_of(condition)) {
      const auto before = before_.find({node, i});
      const double u =
          value.of(node) + (relative && before != before_.end() ? before->second : 0.0);
      now_.held[{std::to_string(node), i}] = {u, place};
      reached_[{node, i}] = u;
    }
  }

  void boundary(const XmlNode& section) {
    for (const XmlNode& one : section.children()) {
      const std::string type = str(one.attribute("type"));
      if (type == "zero displacement" || type == "fix") {
        for (int i = 0; i < 3; ++i) {
          const XmlNode dof = one.child(i == 0 ? "x_dof" : i == 1 ? "y_dof" : "z_dof");
          const std::vector<std::string> dofs = words_of(one.child("dofs").text());
          const bool fixed =
              dof ? words_of(dof.text()) == std::vector<std::string>{"1"}
                  : std::find(dofs.begin(), dofs.end(), std::string(1, "xyz"[i])) != dofs.end();
          if (fixed) set_of(one), hold(one, i, {}, false);
        }
      } else if (type == "prescribed displacement" || type == "prescribe") {
        const auto words = words_of(one.child("dof").text());
        const auto i = component(words.empty() ? "" : words[0]);
        if (!i) {
          file_.leave(one, "a prescribed " + (words.empty() ? std::string("freedom") : words[0]));
          continue;
        }
        const XmlNode value = one.child("value") ? one.child("value") : one.child("scale");
        if (!value) file_.fault(one, "there is no value", "<value lc=\"1\">0.5</value>");
        hold(one, *i, told(value),
             words_of(one.child("relative").text()) == std::vector<std::string>{"1"});
      } else {
        file_.leave(one, fmt::format("a boundary condition of type {}", type));
      }
    }
  }

  void push(const XmlNode& load, int i, const Told& value) {
    const Place place = file_.place(load);
    const std::string set = file_.key_of(str(load.attribute("node_set")));
    if (!value.each) {
      now_.forces[{set, i}].value += value.of(0), now_.forces[{set, i}].place = place;
      return;
    }
    for (const int node : set_of(load)) {
      auto& force = now_.forces[{std::to_string(node), i}];
      force.value += value.of(node), force.place = place;
    }
  }

  void nodal_load(const XmlNode& one, const std::string& type) {
    set_of(one);
    if (type == "nodal_force") {
      const XmlNode value = one.child("value");
      const std::vector<double> f = file_.numbers(value, 3);
      for (int i = 0; i < 3; ++i) push(one, i, {f[static_cast<size_t>(i)], nullptr, share(value)});
      return;
    }
    const auto words = words_of(one.child("dof").text());
    const auto i = component(words.empty() ? "" : words[0]);
    const XmlNode value = one.child("scale") ? one.child("scale") : one.child("value");
    if (i && value)
      push(one, *i, told(value));
    else
      file_.leave(one, "a load that is no force");
  }

  void pressure(const XmlNode& one) {
    const std::string name = str(one.attribute("surface"));
    const std::vector<std::set<Side>>* faces = mesh_.surface(name);
    if (!faces)
      file_.fault(one, fmt::format("there is no surface `{}`", name), "a <Surface> of <Mesh>");
    const XmlNode node = one.child("pressure") ? one.child("pressure") : one.child("scale");
    if (!node) file_.fault(one, "there is no pressure", "<pressure lc=\"1\">0.01</pressure>");
    const Told value = told(node);
    for (size_t f = 0; f < (*faces).size(); ++f)
      for (const Side& side : (*faces)[f]) {
        auto& there = now_.pressures[side];
        there.value += value.of(static_cast<int>(f) + 1), there.place = file_.place(one);
      }
  }

  void body_force(const XmlNode& one) {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    if (const XmlNode vector = one.child("force")) {
      const std::vector<double> v = file_.numbers(vector, 3);
      force = share(vector) * Eigen::Vector3d(v[0], v[1], v[2]);
    }
    for (int i = 0; i < 3; ++i)
      if (const XmlNode part = one.child(i == 0 ? "x" : i == 1 ? "y" : "z"))
        force[i] = share(part) * file_.numbers(part, 1)[0];
    now_.gravity -= force;
  }

  void loads(const XmlNode& section) {
    for (const XmlNode& one : section.children()) {
      const std::string type = str(one.attribute("type"));
      if (one.name() == "nodal_load")
        nodal_load(one, type);
      else if (one.name() == "surface_load" && type == "pressure")
        pressure(one);
      else if (one.name() == "body_load" && (type == "body force" || type == "const"))
        body_force(one);
      else
        file_.leave(one, fmt::format("a load of type {}", type));
    }
  }

  /// How long a step lasts.
  double duration(const XmlNode& control) const {
    const XmlNode steps = control.child("time_steps"), size = control.child("step_size");
    if (!steps || !size) return 1;
    return file_.numbers(steps, 1)[0] * file_.numbers(size, 1)[0];
  }

  void act(const XmlNode& own, const std::string& name) {
    now_ = {};
    now_.name = name, now_.place = file_.place(own);
    reached_.clear();
    boundary(file_.top().child("Boundary"));
    loads(file_.top().child("Loads"));
    if (own.name() == "step") boundary(own.child("Boundary")), loads(own.child("Loads"));
    before_ = reached_;
    file_.deck.steps.push_back(now_);
  }

  void steps() {
    for (const char* name :
         {"Contact", "Constraints", "Rigid", "Discrete", "Initial", "MeshAdaptor"})
      if (const XmlNode section = file_.top().child(name); section && !section.children().empty())
        file_.leave(section, fmt::format("<{}>", name));
    const std::vector<XmlNode> steps = file_.top().child("Step").all("step");
    if (steps.empty()) {
      time_ = duration(file_.top().child("Control"));
      act(file_.top(), "");
      return;
    }
    for (const XmlNode& one : steps) {
      time_ += duration(one.child("Control"));
      act(one, steps.size() > 1 ? str(one.attribute("name")) : "");
    }
  }

  FebioMesh mesh_;
  std::map<std::string, Values> data_;
  std::map<int, Curve> curves_;
  std::map<std::pair<int, int>, double> before_, reached_;  ///< displacements by node, component
  double time_ = 0;
  DeckStep now_;
};

}  // namespace

Deck read_febio(const std::filesystem::path& file) {
  return std::move(FebioReader(file).file_.deck);
}

}  // namespace hookeye::solver_deck
