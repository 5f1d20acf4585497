// The grid of loads and views that `plan` rates.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>

#include "estimation/effects/toolbox.h"
#include "estimation/plan/plan.h"

namespace hookeye {

namespace {

const double kDegree = EIGEN_PI / 180.0;
constexpr double kTilt = 45.0;
/// A view nearer than this to one there is would hardly be another one.
constexpr double kOtherView = 20.0;

bool fixes_all(const SupportSpec& support) {
  return support.kind == SupportSpec::Kind::components &&
         std::all_of(support.displacement.begin(), support.displacement.end(),
                     [](const auto& u) { return u && *u == 0.0; });
}

/// From the first patch that is held fast into the body; z where nothing is held.
Vector3d standing_axis(const Model& model) {
  for (const auto& example : model.scene->capture.examples)
    for (const auto& support : example.supports)
      if (fixes_all(support)) {
        const Vector3d& n = model.scene->body->regions.at(support.region).normal;
        if (n.norm() > 0.5) return -n.normalized();
      }
  return Vector3d::UnitZ();
}

/// The photos that a new example would get: one by every camera that takes pictures.
std::vector<PhotoSpec> photos_by_all(const Capture& capture) {
  std::vector<PhotoSpec> all;
  std::set<std::string> seen;
  for (const auto& example : capture.examples)
    for (const auto& photo : example.photos)
      if (seen.insert(photo.camera).second) all.push_back(photo);
  for (auto& photo : all) photo.mask.clear();
  return all;
}

/// A fitted support as told by what was found: where the region's nodes stand now.
SupportSpec as_told(const Model& model, int example, SupportSpec support) {
  if (support.kind != SupportSpec::Kind::rigid_fit) return support;
  const Region& region = model.scene->body->regions.at(support.region);
  const Loading& loading = model.examples[example].loading;
  Eigen::Matrix3Xd from(3, region.nodes.size()), to;
  for (size_t i = 0; i < region.nodes.size(); ++i)
    from.col(i) = model.scene->body->mesh.X.col(region.nodes[i]);
  to = from;
  for (size_t k = 0; k < loading.prescribed.size(); ++k) {
    const auto at =
        std::lower_bound(region.nodes.begin(), region.nodes.end(), loading.prescribed[k] / 3);
    if (at != region.nodes.end() && *at == loading.prescribed[k] / 3)
      to(loading.prescribed[k] % 3, at - region.nodes.begin()) += loading.displacement[k];
  }
  const Eigen::Matrix4d motion = Eigen::umeyama(from, to, false);
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(motion.topLeftCorner<3, 3>()));
  support.kind = SupportSpec::Kind::rigid;
  support.rigid.axis = turn.axis();
  support.rigid.degrees = turn.angle() / kDegree;
  support.rigid.center = region.centroid;
  support.rigid.move = motion.topLeftCorner<3, 3>() * region.centroid +
                       motion.topRightCorner<3, 1>() - region.centroid;
  return support;
}

class LoadGrid {
 public:
  explicit LoadGrid(const Model& model)
      : model_(model), capture_(model.scene->capture), axis_(standing_axis(model)) {}

  std::vector<PlanCandidate> all() {
    for (size_t e = 0; e < capture_.examples.size(); ++e) {
      if (capture_.examples[e].validate || is_rest(capture_.examples[e])) continue;
      offer(copy(static_cast<int>(e)), capture_.examples[e].name + "_again",
            fmt::format("'{}' once more, after all the others", capture_.examples[e].name));
      scaled(static_cast<int>(e), 0.5, "half", "at half its load");
      scaled(static_cast<int>(e), 1.5, "more", "at 1.5 times its load");
      scaled(static_cast<int>(e), -1.0, "back", "with its load reversed");
      turned(static_cast<int>(e));
    }
    tilts();
    return std::move(out_);
  }

 private:
  ExampleSpec copy(int e) const {
    ExampleSpec example = capture_.examples[e];
    for (auto& support : example.supports) support = as_told(model_, e, support);
    example.photos = photos_by_all(capture_);
    example.validate = false;
    return example;
  }

  void offer(ExampleSpec load, const std::string& name, std::string words) {
    load.name = name;
    PlanCandidate candidate;
    candidate.name = name;
    candidate.words = std::move(words);
    candidate.load = std::move(load);
    out_.push_back(std::move(candidate));
  }

  void scaled(int e, double factor, const std::string& suffix, const std::string& words) {
    ExampleSpec example = copy(e);
    for (auto& load : example.loads) {
      if (load.force) load.force = factor * *load.force;
      if (load.pressure) load.pressure = factor * *load.pressure;
    }
    for (auto& support : example.supports) {
      for (auto& u : support.displacement)
        if (u) u = factor * *u;
      support.rigid.degrees *= factor;
      support.rigid.move *= factor;
    }
    const std::string& from = capture_.examples[e].name;
    offer(std::move(example), from + "_" + suffix, fmt::format("'{}' {}", from, words));
  }

  void turned(int e) {
    ExampleSpec example = copy(e);
    const Eigen::Matrix3d Q = rotation_of(90.0 * kDegree * axis_);
    double change = 0.0;
    auto turn = [&](const Vector3d& v) {
      change = std::max(change, (Q * v - v).norm() / std::max(v.norm(), 1e-300));
      return Vector3d(Q * v);
    };
    for (auto& load : example.loads)
      if (load.force) load.force = turn(*load.force);
    for (auto& support : example.supports) {
      if (support.kind == SupportSpec::Kind::rigid) {
        support.rigid.axis = turn(support.rigid.axis);
        support.rigid.move = turn(support.rigid.move);
      }
      Vector3d u = Vector3d::Zero();
      bool whole = true;
      for (int i = 0; i < 3; ++i) {
        whole = whole && support.displacement[i];
        u[i] = support.displacement[i].value_or(0.0);
      }
      if (u.isZero(0.0)) continue;
      if (!whole) return;  // a component that is left free would turn with it
      const Vector3d v = turn(u);
      for (int i = 0; i < 3; ++i) support.displacement[i] = v[i];
    }
    if (change < 1e-3) return;
    const std::string& from = capture_.examples[e].name;
    offer(
        std::move(example), from + "_turned",
        fmt::format("'{}' with its load turned by 90 degrees about {}", from, vector_text(axis_)));
  }

  /// What is held fast turns with the table under it; weight and light stay.
  void tilts() {
    const auto held = std::find_if(
        capture_.examples.begin(), capture_.examples.end(), [](const ExampleSpec& example) {
          return std::any_of(example.supports.begin(), example.supports.end(), fixes_all);
        });
    if (held == capture_.examples.end()) return;
    const auto [first, second] = normal_axes(axis_);
    int count = 0;
    for (const Vector3d& about : {first, Vector3d(-first), second, Vector3d(-second)}) {
      ExampleSpec example;
      example.place = held->place;
      example.photos = photos_by_all(capture_);
      Vector3d centre = Vector3d::Zero();
      for (const auto& support : held->supports) {
        if (!fixes_all(support)) continue;
        if (example.supports.empty())
          centre = model_.scene->body->regions.at(support.region).centroid;
        SupportSpec tilted = support;
        tilted.kind = SupportSpec::Kind::rigid;
        tilted.displacement = {};
        tilted.rigid = {about, kTilt, centre, Vector3d::Zero()};
        example.supports.push_back(tilted);
      }
      offer(std::move(example), fmt::format("tilt_{}", ++count),
            fmt::format("the base tilted by {:.0f} degrees about {}, no other load", kTilt,
                        vector_text(about)));
    }
  }

  const Model& model_;
  const Capture& capture_;
  Vector3d axis_;
  std::vector<PlanCandidate> out_;
};

/// The camera carried around `centre` by a rotation of the world.
Camera carried(const Camera& camera, const Eigen::Matrix3d& Q, const Vector3d& centre) {
  Camera out = camera;
  out.R = camera.R * Q.transpose();
  out.t = camera.R * centre + camera.t - out.R * centre;
  return out;
}

double angle_between(const Camera& a, const Camera& b) {
  const double c = a.R.row(2).dot(b.R.row(2));
  return std::acos(std::clamp(c, -1.0, 1.0)) / kDegree;
}

std::vector<PlanCandidate> view_grid(const Model& model, const std::vector<Camera>& used) {
  std::vector<PlanCandidate> out;
  if (used.empty()) return out;
  const Camera& first = used.front();
  const BodySize body = body_size(*model.scene);
  const Vector3d axis = standing_axis(model);
  auto offer = [&](const Eigen::Matrix3d& Q, const std::string& name, const std::string& words) {
    PlanCandidate candidate;
    candidate.kind = PlanCandidate::Kind::view;
    candidate.name = name;
    candidate.view = carried(first, Q, body.centre);
    candidate.view.name = name;
    const bool other = std::all_of(used.begin(), used.end(), [&](const Camera& camera) {
      return angle_between(camera, candidate.view) > kOtherView;
    });
    candidate.words =
        fmt::format("a camera {}, at {}", words, vector_text(candidate.view.centre(), 0));
    if (other) out.push_back(std::move(candidate));
  };
  for (int degrees = 45; degrees < 360; degrees += 45)
    offer(rotation_of(degrees * kDegree * axis), fmt::format("view_{}", degrees),
          fmt::format("{} degrees around the body from '{}'", degrees, first.name));
  // Raised: turned about the horizontal that the camera itself has, towards the axis' end.
  const Vector3d backwards = -first.R.row(2).transpose();
  const Vector3d across = backwards.cross(axis);
  if (across.norm() > 0.1)
    offer(rotation_of(50.0 * kDegree * across.normalized()), "view_raised",
          fmt::format("raised by 50 degrees over '{}'", first.name));
  return out;
}

}  // namespace

namespace {

/// Six digits, zeros without a sign.
std::string number(double x) { return fmt::format("{:.6g}", std::abs(x) < 1e-12 ? 0.0 : x); }

std::string list(const Vector3d& v) {
  return fmt::format("[{}, {}, {}]", number(v.x()), number(v.y()), number(v.z()));
}

std::string support_line(const SupportSpec& support) {
  if (support.kind != SupportSpec::Kind::components) {
    const RigidMotion& m = support.rigid;
    return fmt::format(
        "      - {{region: {}, rigid: {{rotate: {{axis: {}, degrees: {}, center: {}}}, move: "
        "{}}}}}\n",
        support.region, list(m.axis), number(m.degrees), list(m.center), list(m.move));
  }
  std::string moves;
  for (int i = 0; i < 3; ++i)
    if (support.displacement[i])
      moves += fmt::format("{}{}: {}", moves.empty() ? "" : ", ", "xyz"[i],
                           number(*support.displacement[i]));
  return fmt::format("      - {{region: {}, move: {{{}}}}}\n", support.region, moves);
}

}  // namespace

std::string capture_lines(const PlanCandidate& candidate) {
  if (candidate.kind == PlanCandidate::Kind::view) {
    const Camera& c = candidate.view;
    const Eigen::Matrix3d& R = c.R;
    return fmt::format(
        "  {}:\n    size: [{}, {}]\n    projection: {}\n"
        "    intrinsics: {}\n"
        "    pose: {{rotation: [{}, {}, {}],\n           translation: {}}}\n",
        candidate.name, c.width, c.height, c.model->name(), intrinsics_text(c, number),
        list(R.row(0).transpose()), list(R.row(1).transpose()), list(R.row(2).transpose()),
        list(c.t));
  }
  std::string text = fmt::format("  {}:\n", candidate.name);
  if (!candidate.load.supports.empty()) text += "    supports:\n";
  for (const auto& support : candidate.load.supports) text += support_line(support);
  if (!candidate.load.loads.empty()) text += "    loads:\n";
  for (const auto& load : candidate.load.loads)
    text += load.force
                ? fmt::format("      - {{region: {}, force: {}}}\n", load.region, list(*load.force))
                : fmt::format("      - {{region: {}, pressure: {}}}\n", load.region,
                              number(load.pressure.value_or(0.0)));
  return text;
}

std::vector<PlanCandidate> plan_candidates(const Model& model, bool grid_too) {
  const Capture& capture = model.scene->capture;
  std::vector<PlanCandidate> loads, views;
  std::vector<Camera> used;
  for (const auto& photo : photos_by_all(capture)) used.push_back(capture.camera(photo.camera));
  for (size_t e = 0; e < capture.examples.size(); ++e) {
    const ExampleSpec& example = capture.examples[e];
    if (!example.photos.empty() || !example.measured.empty()) continue;
    PlanCandidate told;
    told.name = example.name;
    told.words = fmt::format("'{}' as told in the capture", example.name);
    told.told = true;
    told.load = example;
    for (auto& support : told.load.supports) support = as_told(model, static_cast<int>(e), support);
    told.load.photos = photos_by_all(capture);
    loads.push_back(std::move(told));
  }
  const bool blind = capture.body.texture == BodySpec::Texture::rest;
  for (const auto& camera : capture.cameras) {
    if (blind || std::any_of(used.begin(), used.end(),
                             [&](const Camera& one) { return one.name == camera.name; }))
      continue;
    PlanCandidate told;
    told.kind = PlanCandidate::Kind::view;
    told.name = camera.name;
    told.words = fmt::format("camera '{}' as told in the capture", camera.name);
    told.told = true;
    told.view = camera;
    views.push_back(std::move(told));
  }
  std::vector<PlanCandidate> all = loads;
  if (loads.empty() || grid_too)
    for (auto& one : LoadGrid(model).all()) all.push_back(std::move(one));
  all.insert(all.end(), views.begin(), views.end());
  if (!blind && (views.empty() || grid_too))
    for (auto& one : view_grid(model, used)) all.push_back(std::move(one));
  return all;
}

}  // namespace hookeye
