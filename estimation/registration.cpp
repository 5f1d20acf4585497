#include "estimation/registration.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace hookeye {

namespace {

cv::Mat wrap(const Image& image) {
  return {image.height, image.width, CV_32F, const_cast<float*>(image.values.data())};
}

/// Brightness compressed so that dark and bright parts count alike, in 8 bits.
cv::Mat eight_bits(const Image& image, float white) {
  cv::Mat out(image.height, image.width, CV_8U);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      out.at<unsigned char>(y, x) = static_cast<unsigned char>(
          std::lround(255.0f * std::sqrt(std::clamp(image.at(x, y) / white, 0.0f, 1.0f))));
  return out;
}

float white_level(const Image& photo) {
  std::vector<float> sorted = photo.values;
  const size_t high = sorted.size() - 1 - sorted.size() / 200;
  std::nth_element(sorted.begin(), sorted.begin() + high, sorted.end());
  return std::max(sorted[high], 1e-4f);
}

/// Fourth-order central difference, as flow.cpp takes it: what is added to the residual here as
/// gradient times motion is divided by the gradient there.
float slope(const Image& model, int x, int y, int dx, int dy) {
  return (8.0f * (model.at(x + dx, y + dy) - model.at(x - dx, y - dy)) -
          (model.at(x + 2 * dx, y + 2 * dy) - model.at(x - 2 * dx, y - 2 * dy))) /
         12.0f;
}

/// The search goes astray where the pictures differ in more than motion (rims, occlusions): a
/// motion that does not lower the misfit of its cell is none.
void drop_stray_motion(const Image& plain, Registration* out) {
  constexpr int kCell = 16;
  for (int y0 = 0; y0 < plain.height; y0 += kCell)
    for (int x0 = 0; x0 < plain.width; x0 += kCell) {
      const int x1 = std::min(x0 + kCell, plain.width), y1 = std::min(y0 + kCell, plain.height);
      double before = 0.0, after = 0.0;
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) {
          if (std::isnan(plain.at(x, y))) continue;
          before += std::pow(plain.at(x, y), 2);
          after += std::pow(out->residual.at(x, y), 2);
        }
      if (after < before) continue;
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) {
          out->u.at(x, y) = out->v.at(x, y) = 0.0f;
          out->residual.at(x, y) = out->linear.at(x, y) = plain.at(x, y);
        }
    }
}

}  // namespace

Registration register_pictures(const Image& model, const Image& photo, const Image& residual,
                               const Image& sigma) {
  const float white = white_level(photo);
  auto search = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM);
  search->setFinestScale(0);
  cv::Mat flow;
  // photo(x) = model(x + flow(x)): the model must move by -flow.
  search->calc(eight_bits(photo, white), eight_bits(model, white), flow);
  // Single pixels of the flow are noise; what physics moves is smooth over a cell.
  cv::GaussianBlur(flow, flow, cv::Size(), 6.0);

  cv::Mat from(flow.size(), CV_32FC2), moved;
  for (int y = 0; y < flow.rows; ++y)
    for (int x = 0; x < flow.cols; ++x)
      from.at<cv::Vec2f>(y, x) = flow.at<cv::Vec2f>(y, x) + cv::Vec2f(x, y);
  cv::remap(wrap(model), moved, from, cv::noArray(), cv::INTER_LANCZOS4, cv::BORDER_REPLICATE);

  Registration out;
  out.u = out.v = Image{model.width, model.height, 1, std::vector<float>(model.pixels(), 0.0f)};
  out.residual = out.linear = residual;
  for (int y = 0; y < model.height; ++y)
    for (int x = 0; x < model.width; ++x) {
      const cv::Vec2f& f = flow.at<cv::Vec2f>(y, x);
      out.u.at(x, y) = -f[0];
      out.v.at(x, y) = -f[1];
      if (std::isnan(residual.at(x, y)) || x < 2 || y < 2 || x + 2 >= model.width ||
          y + 2 >= model.height)
        continue;
      const float gx = slope(model, x, y, 1, 0), gy = slope(model, x, y, 0, 1);
      const float r = (moved.at<float>(y, x) - photo.at(x, y)) / sigma.at(x, y);
      out.residual.at(x, y) = r;
      out.linear.at(x, y) = r - (gx * f[0] + gy * f[1]) / sigma.at(x, y);
    }
  drop_stray_motion(residual, &out);
  return out;
}

}  // namespace hookeye
