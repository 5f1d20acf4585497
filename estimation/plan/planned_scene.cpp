#include "estimation/plan/planned_scene.h"

#include <cmath>

#include "estimation/evaluation/photo_evaluation.h"

namespace hookeye {

std::vector<int> fitted_examples(const Scene& scene) {
  std::vector<int> out;
  for (size_t e = 0; e < scene.capture.examples.size(); ++e)
    if (!scene.capture.examples[e].validate && !scene.photos[e].empty())
      out.push_back(static_cast<int>(e));
  return out;
}

std::shared_ptr<Scene> with_load(const Scene& now, const PlanCandidate& candidate) {
  auto scene = std::make_shared<Scene>(now);
  scene->capture.examples.push_back(candidate.load);
  scene->capture.examples.back().validate = true;
  scene->photos.emplace_back();
  return scene;
}

std::shared_ptr<Scene> with_views(const Scene& now, const std::vector<PlanCandidate>& candidates,
                                  ViewPhotos& of_photo) {
  auto scene = std::make_shared<Scene>(now);
  for (size_t c = 0; c < candidates.size(); ++c) {
    const PlanCandidate& candidate = candidates[c];
    if (candidate.kind != PlanCandidate::Kind::view) continue;
    if (!candidate.told) scene->capture.cameras.push_back(candidate.view);
    for (int e : fitted_examples(now)) {
      ExampleSpec& example = scene->capture.examples[e];
      PhotoSpec photo = now.capture.examples[e].photos.front();
      photo.camera = candidate.view.name;
      photo.mask.clear();
      of_photo[{e, static_cast<int>(example.photos.size())}] = static_cast<int>(c);
      example.photos.push_back(photo);
    }
  }
  return scene;
}

namespace {

/// sigma^2 = a + b I, as the noise of the photo `like` goes with its intensity.
Image sigma_like(const Image& I, const Image& like_I, const Image& like_sigma) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (size_t i = 0; i < like_I.pixels(); i += 3) {
    const double v = like_I.values[i], s2 = std::pow(like_sigma.values[i], 2);
    n += 1.0, x += v, y += s2, xx += v * v, xy += v * s2;
  }
  const double spread = xx - x * x / n;
  const double b = spread > 1e-9 * xx ? std::max(0.0, (xy - x * y / n) / spread) : 0.0;
  const double a = (y - b * x) / n, least = 0.1 * y / n;
  Image sigma = I;
  for (float& s : sigma.values)
    s = static_cast<float>(std::sqrt(std::max(least, a + b * static_cast<double>(s))));
  return sigma;
}

/// A photo that some camera has taken, preferably the camera itself.
const Photo& photo_like(const Scene& scene, const std::string& camera) {
  const Photo* any = nullptr;
  for (const auto& photos : scene.photos)
    for (const auto& photo : photos) {
      if (photo.camera == camera) return photo;
      if (!any) any = &photo;
    }
  return *any;
}

/// The model's pictures in place of photos.
Photo predicted_photo(PhotoComparer& comparer, const Model& model, int e, int k, const VectorXd& q,
                      const VectorXd* q_reference, const Photo& like) {
  const Scene& scene = *model.scene;
  Photo out = like;
  out.camera = scene.capture.examples[e].photos[k].camera;
  RenderOptions options = render_options(scene);
  options.derivatives = false;
  for (size_t plane = 0; plane < like.planes.size(); ++plane) {
    out.planes[plane] =
        comparer.render(model, q, q_reference, k, static_cast<int>(plane), options).I;
    out.sigma[plane] = sigma_like(out.planes[plane], like.planes[plane], like.sigma[plane]);
  }
  out.valid = std::vector<unsigned char>(out.planes.front()->pixels(), 1);
  return out;
}

}  // namespace

void take_photos(Scene& scene, const Scene& now, const Model& model,
                 const std::map<int, VectorXd>& states) {
  const Capture& capture = scene.capture;
  const int reference = capture.body.texture == BodySpec::Texture::rest
                            ? scene.example_index(capture.body.texture_example)
                            : -1;
  for (const auto& [e, q] : states) {
    PhotoComparer comparer(model.scene, e);
    auto& photos = scene.photos[e];
    for (size_t k = photos.size(); k < capture.examples[e].photos.size(); ++k)
      photos.push_back(predicted_photo(comparer, model, e, static_cast<int>(k), q,
                                       reference >= 0 ? &states.at(reference) : nullptr,
                                       photo_like(now, capture.examples[e].photos[k].camera)));
  }
}

}  // namespace hookeye
