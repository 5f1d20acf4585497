#include "estimation/inspection/load_variants.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <set>

namespace hookeye::inspection {

namespace {

const ExampleSpec& spec_of(const CoarseModel& coarse, int e) {
  return coarse.scene().capture.examples[static_cast<size_t>(e)];
}

const Loading& told(const CoarseModel& coarse, int e) {
  return coarse.model().examples[static_cast<size_t>(e)].loading;
}

void reverse_supports(const CoarseModel& coarse, int e, std::vector<LoadVariant>* out) {
  const Body& body = *coarse.scene().body;
  for (const SupportSpec& support : spec_of(coarse, e).supports) {
    const Region& region = body.regions.at(support.region);
    const std::string on = fmt::format("of `{}`", support.region);
    const auto add = [&](const std::string& what, const std::string& right) -> Loading& {
      out->push_back({support.place, fmt::format("the {} {} has the other sign", what, on), right,
                      told(coarse, e)});
      return out->back().loading;
    };
    if (support.kind == SupportSpec::Kind::rigid && support.rigid.degrees != 0.0) {
      RigidMotion motion = support.rigid;
      motion.degrees = -motion.degrees;
      add("rotation",
          "a rotation by `degrees` is counter-clockwise seen against its axis: change the "
          "sign")
          .prescribe_rigid(body.mesh, region, motion);
    }
    if (support.kind == SupportSpec::Kind::rigid && !support.rigid.move.isZero(0.0)) {
      RigidMotion motion = support.rigid;
      motion.move = -motion.move;
      add("motion", "change the sign of `move`").prescribe_rigid(body.mesh, region, motion);
    }
    if (support.kind != SupportSpec::Kind::components) continue;
    for (int i = 0; i < 3; ++i) {
      const double u = support.displacement[static_cast<size_t>(i)].value_or(0.0);
      if (u != 0.0)
        add(fmt::format("motion along {}", "xyz"[i]), "change the sign of `move`")
            .prescribe(body.mesh, region, i, -u);
    }
  }
}

/// Loads are the loading's first forces, in the example's order.
std::shared_ptr<const ForceTerm> force_term(const Region& region, const LoadSpec& load,
                                            double sign) {
  return load.force ? dead_force(region, sign * *load.force)
                    : follower_pressure(region, sign * load.pressure.value_or(0.0));
}

/// The forces of a load are two where it has both, a force and a pressure; captures allow one.
void reverse_loads(const CoarseModel& coarse, int e, std::vector<LoadVariant>* out) {
  const auto& loads = spec_of(coarse, e).loads;
  for (size_t j = 0; j < loads.size(); ++j) {
    LoadVariant variant{loads[j].place,
                        fmt::format("the {} on `{}` has the other sign",
                                    loads[j].force ? "force" : "pressure", loads[j].region),
                        loads[j].force ? "a force is what acts on the body: change its sign"
                                       : "a pressure pushes inwards: change its sign",
                        told(coarse, e)};
    variant.loading.forces[j] =
        force_term(coarse.scene().body->regions.at(loads[j].region), loads[j], -1.0);
    out->push_back(std::move(variant));
  }
}

Vector3d area_vector(const TetMesh& mesh, Eigen::Index face) {
  const Vector3d a = mesh.X.col(mesh.boundary(0, face)), b = mesh.X.col(mesh.boundary(1, face)),
                 c = mesh.X.col(mesh.boundary(2, face));
  return 0.5 * (b - a).cross(c - a);
}

/// All of the boundary that is connected with the region and turned as it is.
Region whole_face(const TetMesh& mesh, const Region& region, double flat_cosine) {
  std::set<int> nodes(region.nodes.begin(), region.nodes.end());
  std::vector<char> taken(static_cast<size_t>(mesh.boundary.cols()), 0);
  Region out = region;
  out.nodal_area.setZero();
  out.area = 0.0;
  out.faces.clear();
  for (bool more = true; more;) {
    more = false;
    for (Eigen::Index f = 0; f < mesh.boundary.cols(); ++f) {
      const Vector3d area = area_vector(mesh, f);
      const int touching =
          static_cast<int>(nodes.count(mesh.boundary(0, f)) + nodes.count(mesh.boundary(1, f)) +
                           nodes.count(mesh.boundary(2, f)));  // corners
      if (taken[static_cast<size_t>(f)] || touching < 2 ||
          area.dot(region.normal) < flat_cosine * area.norm())
        continue;
      taken[static_cast<size_t>(f)] = 1;
      more = true;
      out.area += area.norm();
      out.faces.emplace_back(static_cast<int>(f), 1.0);
      // Of a quadratic face the middles of its edges carry all.
      const auto rows = static_cast<int>(mesh.boundary.rows());
      for (int k = 0; k < rows; ++k) {
        nodes.insert(mesh.boundary(k, f));
        if (k >= rows - 3) out.nodal_area[mesh.boundary(k, f)] += area.norm() / 3.0;
      }
    }
  }
  out.nodes.assign(nodes.begin(), nodes.end());
  return out;
}

/// The support holds the region `grown`, too.
void hold(const TetMesh& mesh, const SupportSpec& support, const Region& grown, Loading* loading) {
  if (support.kind == SupportSpec::Kind::components) {
    for (int i = 0; i < 3; ++i)
      if (support.displacement[static_cast<size_t>(i)])
        loading->prescribe(mesh, grown, i, *support.displacement[static_cast<size_t>(i)]);
  } else {
    loading->prescribe_rigid(mesh, grown, support.rigid);
  }
}

}  // namespace

std::vector<LoadVariant> reversed(const CoarseModel& coarse, int e) {
  std::vector<LoadVariant> out;
  reverse_loads(coarse, e, &out);
  reverse_supports(coarse, e, &out);
  return out;
}

std::vector<LoadVariant> grown(const CoarseModel& coarse, int e, double flat_cosine,
                               double most_of_face) {
  std::vector<LoadVariant> out;
  const Body& body = *coarse.scene().body;
  std::set<std::string> names;
  const ExampleSpec& spec = spec_of(coarse, e);
  for (const SupportSpec& support : spec.supports) names.insert(support.region);
  for (const LoadSpec& load : spec.loads) names.insert(load.region);
  for (const std::string& name : names) {
    const Region& region = body.regions.at(name);
    if (region.normal.isZero(0.0)) continue;
    const Region face = whole_face(body.mesh, region, flat_cosine);
    if (region.area > most_of_face * face.area) continue;
    LoadVariant variant{
        coarse.scene().capture.region(name)->place,
        fmt::format("`{}` reaches over the whole of its flat face, of which it covers "
                    "{:.0f} %",
                    name, 100.0 * region.area / face.area),
        "look at where the drawn region ends (`check -o DIR`)", told(coarse, e)};
    for (const SupportSpec& support : spec.supports)
      if (support.region == name) hold(body.mesh, support, face, &variant.loading);
    for (size_t j = 0; j < spec.loads.size(); ++j)
      if (spec.loads[j].region == name)
        variant.loading.forces[j] = force_term(face, spec.loads[j], 1.0);
    out.push_back(std::move(variant));
  }
  return out;
}

}  // namespace hookeye::inspection
