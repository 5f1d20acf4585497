#include "estimation/output/removed.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/base64.h"
#include "core/text_file.h"
#include "estimation/evaluation/photo_evaluation.h"
#include "estimation/output/compare_picture.h"
#include "estimation/output/page_data.h"

namespace hookeye {

using nlohmann::json;

namespace {

constexpr int kFinestCell = 8;   ///< [px]: finer than the cells that count, coarser than speckle
constexpr int kMostCells = 100;  ///< along a photo: what a page has room for
constexpr int kCoarseRays = 2;   ///< an axis of a pixel: cells are means over many pixels
constexpr double kFinestUnit = 1.0 / 16;  ///< standard deviations of one level, at least

/// The fitted form with the effect in it, and the values after the linear step.
std::pair<ModelForm, VectorXd> after_step(const Fitted& fitted, const EffectScore& score) {
  ModelForm form = fitted.form;
  form.ingredients.push_back(score.best);
  VectorXd p(form.size());
  const auto parameters = form.parameters();
  p << fitted.p, score.values;
  for (int i = 0; i < score.base_step.size(); ++i) {
    const Parameter& parameter = parameters[i];
    // a linear step may take a stiffness below zero; pictures are of the moved body all the same
    const double low = parameter.positive ? 0.1 * p[i] : parameter.low;
    p[i] = std::clamp(p[i] + score.base_step[i], low, parameter.high);
  }
  return {form, p};
}

ExampleEvaluation state_of(int example, const VectorXd& q) {
  ExampleEvaluation out;
  out.example = example;
  auto equilibrium = std::make_shared<Equilibrium>();
  equilibrium->q = q;
  out.equilibrium = std::move(equilibrium);
  return out;
}

/// In standard deviations; NaN: does not count.
struct Cells {
  int columns, rows;
  std::vector<double> now, removed;
};

/// A residual there is, and pictures before and after the step that tell what the step removes of
/// it: drawn alike, coarsely or not.
struct Change {
  const Image &now, &before, &after;
};

/// Edge of a cell [px], one for all photos.
int cell_edge(const Evaluation& evaluation) {
  int longest = 0;
  for (const auto& example : evaluation.examples)
    for (const auto& photo : example.photos)
      longest = std::max({longest, photo.residual.width, photo.residual.height});
  return kFinestCell * std::max(1, (longest - 1) / (kFinestCell * kMostCells) + 1);
}

/// What a coarse drawing adds to both squares before and after is in neither sum.
Cells cells_of(const Change& change, int edge) {
  const int width = change.now.width, height = change.now.height;
  Cells out{(width + edge - 1) / edge, (height + edge - 1) / edge, {}, {}};
  for (int row = 0; row < out.rows; ++row)
    for (int column = 0; column < out.columns; ++column) {
      double was = 0.0, is = 0.0, count = 0.0;
      for (int y = row * edge; y < std::min(height, (row + 1) * edge); ++y)
        for (int x = column * edge; x < std::min(width, (column + 1) * edge); ++x) {
          const double r = change.now.at(x, y), a = change.before.at(x, y),
                       b = change.after.at(x, y);
          if (std::isnan(r) || std::isnan(a) || std::isnan(b)) continue;
          was += r * r, is += r * r + b * b - a * a, count += 1.0;
        }
      const bool counts = count > 0.25 * edge * edge;
      const double rms = std::sqrt(was / std::max(count, 1.0));
      out.now.push_back(counts ? rms : std::nan(""));
      out.removed.push_back(counts ? rms - std::sqrt(std::max(is, 0.0) / count) : std::nan(""));
    }
  return out;
}

/// One level of all photos of an effect: nothing is cut off.
double unit_of(const std::map<std::string, Cells>& photos) {
  double unit = kFinestUnit;
  for (const auto& [name, cells] : photos) {
    for (double x : cells.now) unit = std::fmax(unit, x / 254.0);
    for (double x : cells.removed) unit = std::fmax(unit, std::abs(x) / 127.0);
  }
  return unit;
}

/// `now` from 1 on, `removed` about 128; 0: does not count.
json cells_json(const Cells& cells, double unit) {
  std::vector<unsigned char> bytes;
  const auto add = [&](double x, long zero) {
    bytes.push_back(std::isnan(x) ? 0
                                  : static_cast<unsigned char>(
                                        std::clamp(std::lround(x / unit) + zero, 1L, 255L)));
  };
  for (double x : cells.now) add(x, 1);
  for (double x : cells.removed) add(x, 128);
  return {{"columns", cells.columns},
          {"rows", cells.rows},
          {"bytes", base64(bytes.data(), bytes.size())}};
}

/// A model and where its texture was photographed; the mechanics are in states of their own.
struct Drawn {
  Model model;
  int reference = -1;  ///< example that the texture is a photo of
  ExampleEvaluation reference_state;

  std::vector<PhotoEvaluation> compare(PhotoComparer& comparer, int example, const VectorXd& q,
                                       bool coarsely) const {
    EvaluationOptions options;
    options.residuals = true;
    if (coarsely) options.rays_per_axis = kCoarseRays;
    return comparer.compare(model, state_of(example, q),
                            {reference, reference >= 0 ? &reference_state : nullptr}, nullptr,
                            options);
  }
};

/// The model after an effect's linear step, everywhere but in the mechanics: those are in
/// EffectScore::displaced.
struct Prediction {
  const EffectScore* score;
  Drawn after;
};

/// -1: the texture is not of a photo.
int reference_example(const Scene& scene) {
  return scene.capture.body.texture == BodySpec::Texture::rest
             ? scene.example_index(scene.capture.body.texture_example)
             : -1;
}

std::vector<Prediction> predictions(const Step& step) {
  const int index = reference_example(*step.fitted.form.scene);
  std::vector<Prediction> out;
  for (const auto& score : step.diagnosis.effects) {
    if (score.displaced.empty() || (index >= 0 && !score.displaced.count(index))) continue;
    const auto [form, p] = after_step(step.fitted, score);
    out.push_back({&score, {form.realise(p), index, {}}});
    if (index >= 0) out.back().after.reference_state = state_of(index, score.displaced.at(index));
  }
  return out;
}

/// The model as it is.
Drawn drawn(const Fitted& fitted) {
  Drawn out{fitted.form.realise(fitted.p), reference_example(*fitted.form.scene), {}};
  for (const auto& example : fitted.evaluation.examples)
    if (example.example == out.reference)
      out.reference_state = state_of(out.reference, example.equilibrium->q);
  return out;
}

/// Pictures of one example after each step, and their cells by photo. An effect that no picture is
/// kept of is drawn coarsely, and so is the model as it is, once.
class RemovedInExample {
 public:
  RemovedInExample(const std::filesystem::path& folder, const Fitted& fitted,
                   const ExampleEvaluation& example, int edge)
      : folder_(folder),
        fitted_(fitted),
        example_(example),
        edge_(edge),
        comparer_(fitted.form.scene, example.example) {}

  std::map<std::string, Cells> by(const Prediction& prediction) {
    std::map<std::string, Cells> out;
    const EffectScore& score = *prediction.score;
    const auto state = score.displaced.find(example_.example);
    if (state == score.displaced.end()) return out;
    const auto after =
        prediction.after.compare(comparer_, example_.example, state->second, !score.pictured);
    const std::vector<PhotoEvaluation>& before = score.pictured ? example_.photos : coarse();
    for (size_t k = 0; k < std::min(after.size(), example_.photos.size()); ++k) {
      const PhotoEvaluation& photo = example_.photos[k];
      const std::string name = photo_name(*fitted_.form.scene, photo);
      if (score.pictured)
        write_removed_picture(folder_ / score.effect / (name + ".png"), photo.residual,
                              after[k].residual, name, score.effect);
      out[name] = cells_of({photo.residual, before[k].residual, after[k].residual}, edge_);
    }
    return out;
  }

 private:
  const std::vector<PhotoEvaluation>& coarse() {
    if (coarse_.empty())
      coarse_ = drawn(fitted_).compare(comparer_, example_.example, example_.equilibrium->q, true);
    return coarse_;
  }

  const std::filesystem::path& folder_;
  const Fitted& fitted_;
  const ExampleEvaluation& example_;
  const int edge_;
  PhotoComparer comparer_;
  std::vector<PhotoEvaluation> coarse_;
};

}  // namespace

bool has_pictures(const Diagnosis& diagnosis) {
  for (const auto& score : diagnosis.effects)
    if (!score.displaced.empty()) return true;
  return false;
}

void write_removed(const std::filesystem::path& folder, const Step& step) {
  const std::vector<Prediction> all = predictions(step);
  for (const Prediction& one : all)
    if (one.score->pictured) std::filesystem::create_directories(folder / one.score->effect);
  const int edge = cell_edge(step.fitted.evaluation);
  std::vector<std::map<std::string, Cells>> cells(all.size());
  std::mutex mutex;
  const auto& examples = step.fitted.evaluation.examples;
  tbb::parallel_for(size_t{0}, examples.size(), [&](size_t e) {
    RemovedInExample removed(folder, step.fitted, examples[e], edge);
    for (size_t i = 0; i < all.size(); ++i) {
      auto photos = removed.by(all[i]);
      const std::lock_guard lock(mutex);
      cells[i].merge(photos);
    }
  });
  for (size_t i = 0; i < all.size(); ++i) {
    const double unit = unit_of(cells[i]);
    json document = {{"cell_px", edge}, {"unit", unit}, {"photos", json::object()}};
    for (const auto& [name, photo] : cells[i]) document["photos"][name] = cells_json(photo, unit);
    write_text(folder / (all[i].score->effect + ".json"), document.dump());
  }
}

}  // namespace hookeye
