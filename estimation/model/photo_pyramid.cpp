#include "estimation/model/photo_pyramid.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace hookeye {

Image halved(const Image& image) {
  Image half{image.width / 2, image.height / 2, 1, {}};
  half.values.resize(half.pixels());
  const cv::Mat source(image.height, image.width, CV_32F, const_cast<float*>(image.values.data()));
  cv::Mat target(half.height, half.width, CV_32F, half.values.data());
  cv::resize(source(cv::Rect(0, 0, 2 * half.width, 2 * half.height)), target, target.size(), 0, 0,
             cv::INTER_AREA);
  return half;
}

Image halved_sigma(const Image& sigma) {
  Image variance = sigma;
  for (float& s : variance.values) s *= s;
  Image half = halved(variance);
  for (float& v : half.values) v = 0.5f * std::sqrt(v);
  return half;
}

std::vector<unsigned char> halved_valid(const std::vector<unsigned char>& valid, int width,
                                        int height) {
  const int columns = width / 2, rows = height / 2;
  std::vector<unsigned char> half(static_cast<size_t>(columns) * rows);
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const size_t at = static_cast<size_t>(2 * y) * width + 2 * x;
      half[static_cast<size_t>(y) * columns + x] =
          valid[at] && valid[at + 1] && valid[at + width] && valid[at + width + 1];
    }
  return half;
}

std::vector<PhotoPlane> photo_pyramid(const Photo& photo, int plane, int levels) {
  std::vector<PhotoPlane> pyramid;
  pyramid.push_back({photo.planes[plane], {}, photo.valid, nullptr});
  if (!photo.sigma.empty()) pyramid[0].sigma = photo.sigma[plane];
  if (!photo.backdrop.empty()) pyramid[0].backdrop = photo.backdrop[plane].pointer();
  for (int level = 1; level < levels; ++level) {
    const PhotoPlane& fine = pyramid.back();
    PhotoPlane coarse;
    coarse.I = halved(fine.I);
    if (!photo.sigma.empty()) coarse.sigma = halved_sigma(fine.sigma);
    coarse.valid = halved_valid(fine.valid, fine.I->width, fine.I->height);
    if (fine.backdrop) coarse.backdrop = std::make_shared<const Image>(halved(*fine.backdrop));
    pyramid.push_back(std::move(coarse));
  }
  // Coarse levels only bring the fit near. Their averaged noise is far below what sampling and a
  // misplaced outline do, and would let dark pixels rule: 2 % of full scale stands for that.
  for (size_t level = 1; level < pyramid.size(); ++level)
    for (float& v : pyramid[level].sigma.own().values) v = std::hypot(v, 0.02f);
  return pyramid;
}

}  // namespace hookeye
