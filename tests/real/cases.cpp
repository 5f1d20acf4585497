#include "real/cases.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <stdexcept>

#include "estimation/evaluation/photo_evaluation.h"
#include "simulation/blocks.h"

namespace hookeye::real {

Case::Value Case::parameter(const std::string& name) const {
  const auto all = fitted.form.parameters();
  for (size_t i = 0; i < all.size(); ++i)
    if (all[i].name == name) return {fitted.p[i], fitted.low[i], fitted.high[i]};
  throw std::out_of_range("no parameter " + name);
}

Case fit_capture(const fs::path& folder) {
  Case out;
  out.scene = load_scene(read_capture(folder));
  out.workspace = std::make_unique<Workspace>(out.scene);
  const ModelForm form = base_form(out.scene);
  auto result = fit(*out.workspace, form, form.initial());
  if (!result) throw std::runtime_error(result.error().example + ": " + result.error().reason);
  out.fitted = *std::move(result);
  return out;
}

Diagnosis diagnose_case(Case& fitted) {
  auto result = diagnose(*fitted.workspace, fitted.fitted, {});
  if (!result) throw std::runtime_error(result.error().example + ": " + result.error().reason);
  return *std::move(result);
}

ReferenceBlock solve_reference(const fs::path& data, const fs::path& capture,
                               const std::string& deck) {
  write_reference(data, capture, deck);
  Capture told = read_capture(capture);
  PhotoSpec view;  // no photo: what `hookeye render` looks at
  view.camera = told.cameras.front().name;
  view.place = told.examples.front().place;
  told.examples.front().photos.push_back(view);
  const auto scene = load_scene(told, false);
  const ModelForm form = base_form(scene);
  const Model model = form.realise(form.initial());
  const TetMesh& mesh = scene->body->mesh;
  const auto solved = solve_equilibrium(mesh, model.energy_of(0), model.examples.front().loading);
  if (!solved) throw std::runtime_error(deck + ": " + solved.error().reason);
  const VectorXd& q = solved->q;
  ReferenceBlock out;
  out.nodes = mesh.nodes();
  out.distance_mm = test::distance_to_reference(data / (deck + ".csv"), mesh, q);
  out.largest_mm = (q - mesh.X.reshaped()).cwiseAbs().maxCoeff();
  RenderOptions options = render_options(*scene);
  options.derivatives = false;
  out.picture = PhotoComparer(scene, 0).render(model, q, nullptr, 0, 0, options).I;
  return out;
}

ChiByKind chi_by_kind(const Case& fitted) {
  double r2[3] = {}, count[3] = {};
  for (const auto& example : fitted.fitted.evaluation.examples) {
    const int kind = example.held_out                                           ? 2
                     : is_rest(fitted.scene->capture.examples[example.example]) ? 0
                                                                                : 1;
    for (const auto& photo : example.photos) r2[kind] += photo.r2, count[kind] += photo.count;
  }
  const auto chi = [&](int kind) { return std::sqrt(r2[kind] / count[kind]); };
  return {chi(0), chi(1), chi(2)};
}

std::string table(const Diagnosis& diagnosis) {
  std::string text = fmt::format("floor {:.3f} ({}), gate {:.1f}\n", diagnosis.floor.chi,
                                 diagnosis.floor.source, diagnosis.gate);
  for (const auto& effect : diagnosis.effects)
    if (effect.testable)
      text += fmt::format("  {:28} evidence {:8.1f}  explains {:5.1f} %  {}\n", effect.effect,
                          effect.evidence, 100.0 * effect.explains, effect.why);
  return text;
}

namespace {

/// Bilinear interpolation of the residual displacement between the centres of its cells.
bool motion_at(const FlowField& flow, const Vector2d& px, Vector2d* u) {
  std::map<std::pair<int, int>, const FlowCell*> at;
  for (const auto& cell : flow.cells)
    if (cell.reliable) at[{cell.row, cell.column}] = &cell;
  const double x = (px.x() + 0.5) / flow.cell_px - 0.5, y = (px.y() + 0.5) / flow.cell_px - 0.5;
  const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
  u->setZero();
  double weight = 0.0;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const auto cell = at.find({row + j, column + i});
      if (cell == at.end()) continue;
      const double w = (i ? x - column : 1 - x + column) * (j ? y - row : 1 - y + row);
      *u += w * cell->second->estimate.head<2>();
      weight += w;
    }
  if (weight < 0.5) return false;
  *u /= weight;
  return true;
}

/// Motion [px] of the face's point under a pixel of the first photo, where the body is at rest.
Vector2d model_motion(const TetMesh& mesh, const BoundaryLocator& boundary, const Camera& camera,
                      const VectorXd& q, const Vector2d& px) {
  const Vector3d origin = camera.ray(px).origin, X(origin.x(), origin.y(), 0.0);
  SurfacePoint point;
  boundary.locate(X, &point);
  const VectorXd N = shape_functions(mesh.order, point.barycentric);
  Vector3d u = Vector3d::Zero();
  for (int a = 0; a < N.size(); ++a) {
    const int node = mesh.elements(a, point.element);
    u += N[a] * (q.segment<3>(3 * node) - mesh.X.col(node));
  }
  return camera.project(X + u) - px;
}

}  // namespace

DicDifference compare_with_dic(const Case& openhole, const fs::path& data, int step) {
  const Scene& scene = *openhole.scene;
  const int e = scene.example_index(fmt::format("step{:02d}", step));
  const ExampleEvaluation& seen = *openhole.fitted.evaluation.find(e);
  const Camera& camera = scene.capture.camera("front");
  const BoundaryLocator boundary(scene.body->mesh);
  DicDifference out;
  double model2 = 0.0, both2 = 0.0;
  for (const auto& point : published_displacements(data, step)) {
    const Vector2d px(point.x_px, point.y_px), published(point.u_px, point.v_px);
    const Vector2d model =
        model_motion(scene.body->mesh, boundary, camera, seen.equilibrium->q, px);
    Vector2d lacking;
    if (!motion_at(seen.photos.at(0).flow, px + model, &lacking)) {
      ++out.outside;
      continue;
    }
    ++out.points;
    model2 += (model - published).squaredNorm() / 2.0;
    both2 += (model + lacking - published).squaredNorm() / 2.0;
    out.largest_px = std::max(out.largest_px, (model + lacking - published).norm());
  }
  out.model_px = std::sqrt(model2 / out.points);
  out.with_residual_px = std::sqrt(both2 / out.points);
  return out;
}

double pull_N(const Case& sheet, int example) {
  return -support_force(*sheet.fitted.evaluation.find(example)->equilibrium,
                        sheet.scene->body->regions.at("left"))
              .x();
}

double overlap(const Case& fitted, int example) {
  const Image& model = fitted.fitted.evaluation.find(example)->photos.at(0).model;
  const Photo& photo = fitted.scene->photos[example][0];
  double both = 0, any = 0;
  for (size_t i = 0; i < model.pixels(); ++i) {
    if (!(*photo.valid)[i]) continue;
    const bool a = model.values[i] > 0.5f, b = photo.planes[0]->values[i] > 0.5f;
    both += a && b;
    any += a || b;
  }
  return both / any;
}

double mouth_px(const Image& inside, int below) {
  int first = inside.width, last = 0;
  for (int x = 0; x < inside.width; ++x)
    if (inside.at(x, inside.height / 2) > 0.5f)
      first = std::min(first, x), last = std::max(last, x);
  const int middle = (first + last) / 2;
  // The lips: highest row of the sheet around its middle, where the notch is.
  int top = inside.height;
  for (int x = middle - 25; x <= middle + 25; ++x)
    for (int y = 0; y < top; ++y)
      if (inside.at(x, y) > 0.5f) top = y;
  // Grey rims count by what they leave free.
  double best = 0.0, run = 0.0;
  for (int x = middle - 25; x <= middle + 25; ++x) {
    const double open = 1.0 - std::clamp(inside.at(x, top + below), 0.0f, 1.0f);
    run = open > 0.02 ? run + open : 0.0;
    best = std::max(best, run);
  }
  return best;
}

std::vector<NotchFrame> predict_notched(const fs::path& data, const fs::path& capture, double mu) {
  Tension tension;
  tension.frames = {20, 40, 60};
  tension.fit_jaw = false;
  tension.material = fmt::format("{{law: neo-hookean, mu: {}, kappa_over_mu: 100}}", mu);
  tension.fit = "";
  write_tango_notched(data, capture, tension);
  const Case sheet = fit_capture(capture);
  std::vector<NotchFrame> out;
  for (const auto& frame : tango_frames(data, true)) {
    const int e = sheet.scene->example_index(fmt::format("f{:03d}", frame.frame));
    if (e < 0) continue;
    out.push_back({frame.frame, pull_N(sheet, e), frame.force_N - tension.load_cell_zero_N,
                   mouth_px(sheet.fitted.evaluation.find(e)->photos.at(0).model, 2),
                   mouth_px(sheet.scene->photos[e][0].planes[0], 2)});
  }
  return out;
}

}  // namespace hookeye::real
