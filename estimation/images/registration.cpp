#include "estimation/images/registration.h"

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
          255.0f * std::sqrt(std::clamp(image.at(x, y) / white, 0.0f, 1.0f)) + 0.5f);
  return out;
}

float white_level(const Image& photo) {
  std::vector<float> sorted = photo.values;
  const size_t high = sorted.size() - 1 - sorted.size() / 200;
  std::nth_element(sorted.begin(), sorted.begin() + high, sorted.end());
  return std::max(sorted[high], 1e-4f);
}

float slope(const Image& model, int x, int y, int dx, int dy) {
  return (8.0f * (model.at(x + dx, y + dy) - model.at(x - dx, y - dy)) -
          (model.at(x + 2 * dx, y + 2 * dy) - model.at(x - 2 * dx, y - 2 * dy))) /
         12.0f;
}

/// The search goes astray where the pictures differ in more than motion (rims, occlusions): a
/// motion that does not lower the misfit of its cell is none. Nor is one below kStillPx: the
/// interpolation that would take it out and put it back errs alike in all pixels of a kind, which a
/// small signature adds up.
/// Returns the rms motion that is left.
double drop_stray_motion(const Image& plain, const cv::Rect& box, const cv::Mat& flow,
                         Registration* out) {
  constexpr int kCell = 16;
  double motion = 0.0, count = 0.0;
  for (int y0 = box.y; y0 < box.br().y; y0 += kCell)
    for (int x0 = box.x; x0 < box.br().x; x0 += kCell) {
      const int x1 = std::min(x0 + kCell, box.br().x), y1 = std::min(y0 + kCell, box.br().y);
      double before = 0.0, after = 0.0, moved = 0.0, pixels = 0.0;
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) {
          if (std::isnan(plain.at(x, y))) continue;
          before += std::pow(plain.at(x, y), 2);
          after += std::pow(out->residual.at(x, y), 2);
          const cv::Vec2f& f = flow.at<cv::Vec2f>(y - box.y, x - box.x);
          moved += f.dot(f);
          pixels += 1.0;
        }
      count += pixels;
      if (after < before && moved > kStillPx * kStillPx * pixels) {
        motion += moved;
        continue;
      }
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x)
          out->residual.at(x, y) = out->linear.at(x, y) = plain.at(x, y);
    }
  return count > 0.0 ? std::sqrt(motion / count) : 0.0;
}

/// Box around the pixels that count, widened by what the search may look at beyond them.
cv::Rect around_counted(const Image& residual) {
  int x0 = residual.width, y0 = residual.height, x1 = 0, y1 = 0;
  for (int y = 0; y < residual.height; ++y)
    for (int x = 0; x < residual.width; ++x)
      if (!std::isnan(residual.at(x, y))) {
        x0 = std::min(x0, x), x1 = std::max(x1, x + 1);
        y0 = std::min(y0, y), y1 = std::max(y1, y + 1);
      }
  constexpr int kMargin = 24;
  const cv::Rect box(x0 - kMargin, y0 - kMargin, x1 - x0 + 2 * kMargin, y1 - y0 + 2 * kMargin);
  return x0 < x1 ? box & cv::Rect(0, 0, residual.width, residual.height) : cv::Rect();
}

/// photo(x) = model(x + flow(x)) within the box.
cv::Mat find_flow(const Image& model, const Image& photo, const cv::Rect& box) {
  const float white = white_level(photo);
  auto search = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM);
  search->setFinestScale(1);  // half size: the flow is blurred below, and the residual linear in it
  cv::Mat flow;
  search->calc(eight_bits(photo, white)(box).clone(), eight_bits(model, white)(box).clone(), flow);
  // Single pixels of the flow are noise; what physics moves is smooth over a cell.
  cv::GaussianBlur(flow, flow, cv::Size(), 6.0);
  return flow;
}

}  // namespace

Eigen::Vector2d picture_slope(const Image& picture, int x, int y) {
  return {slope(picture, x, y, 1, 0), slope(picture, x, y, 0, 1)};
}

Registration register_pictures(const Image& model, const Image& photo, const Image& residual,
                               const Image& sigma) {
  Registration out;
  out.residual = out.linear = residual;
  const cv::Rect box = around_counted(residual);
  // The search works on patches of 8 px over three octaves.
  if (box.width < 32 || box.height < 32) return out;
  const cv::Mat flow = find_flow(model, photo, box);
  cv::Mat from(flow.size(), CV_32FC2), moved;
  for (int y = 0; y < flow.rows; ++y)
    for (int x = 0; x < flow.cols; ++x)
      from.at<cv::Vec2f>(y, x) = flow.at<cv::Vec2f>(y, x) + cv::Vec2f(x + box.x, y + box.y);
  cv::remap(wrap(model), moved, from, cv::noArray(), cv::INTER_LANCZOS4, cv::BORDER_REPLICATE);
  for (int y = std::max(box.y, 2); y < std::min(box.br().y, model.height - 2); ++y)
    for (int x = std::max(box.x, 2); x < std::min(box.br().x, model.width - 2); ++x) {
      if (std::isnan(residual.at(x, y))) continue;
      // the model must move by -flow
      const cv::Vec2f& f = flow.at<cv::Vec2f>(y - box.y, x - box.x);
      const Eigen::Vector2d g = picture_slope(model, x, y);
      const float r = (moved.at<float>(y - box.y, x - box.x) - photo.at(x, y)) / sigma.at(x, y);
      out.residual.at(x, y) = r;
      out.linear.at(x, y) = r - static_cast<float>(g.x() * f[0] + g.y() * f[1]) / sigma.at(x, y);
    }
  out.rms_px = drop_stray_motion(residual, box, flow, &out);
  return out;
}

}  // namespace hookeye
