#include "estimation/output/compare_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace hookeye {

namespace {

/// Blue-white-red, safe for colour-blind eyes: ends of ColorBrewer's RdBu (Brewer 2003). RGB 0..1.
cv::Vec3f diverging(double t) {
  t = std::clamp(t, -1.0, 1.0);
  const cv::Vec3f blue(0.13f, 0.40f, 0.67f), red(0.70f, 0.09f, 0.17f), white(0.97f, 0.97f, 0.97f);
  const float a = static_cast<float>(std::abs(t));
  return white * (1.0f - a) + (t < 0.0 ? blue : red) * a;
}

/// Linear intensity to what a screen shows.
float display(float linear) {
  const float c = std::clamp(linear, 0.0f, 1.0f);
  return c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1.0f / 2.4f) - 0.055f;
}

cv::Mat grey_picture(const Image& image, double gain) {
  cv::Mat out(image.height, image.width, CV_32FC3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const float v = display(static_cast<float>(gain * image.at(x, y)));
      out.at<cv::Vec3f>(y, x) = {v, v, v};
    }
  return out;
}

cv::Mat residual_picture(const Image& residual) {
  cv::Mat out(residual.height, residual.width, CV_32FC3);
  for (int y = 0; y < residual.height; ++y)
    for (int x = 0; x < residual.width; ++x) {
      const float r = residual.at(x, y);
      out.at<cv::Vec3f>(y, x) =
          std::isnan(r) ? cv::Vec3f(0.55f, 0.55f, 0.55f) : diverging(r / kResidualScale);
    }
  return out;
}

/// Smaller where the panel has no room for it.
void label(cv::Mat& panel, const std::string& text, const cv::Point& at, double scale = 0.6) {
  const int width = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, 1, nullptr).width;
  scale *= std::min(1.0, static_cast<double>(panel.cols - at.x - 4) / std::max(width, 1));
  cv::putText(panel, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, cv::Scalar(0, 0, 0), 3,
              cv::LINE_AA);
  cv::putText(panel, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, cv::Scalar(1, 1, 1), 1,
              cv::LINE_AA);
}

void colour_bar(cv::Mat& panel) {
  const int height = 10, width = panel.cols / 3, x0 = 10, y0 = panel.rows - 26;
  for (int x = 0; x < width; ++x)
    cv::line(panel, {x0 + x, y0}, {x0 + x, y0 + height},
             cv::Scalar(diverging(2.0 * x / (width - 1) - 1.0)));
  std::string text = fmt::format("-{0:.0f}..+{0:.0f} sigma, model - photo", kResidualScale);
  const double scale = 0.45;
  const int room = panel.cols - (x0 + width + 8) - 2;
  if (cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, 1, nullptr).width > room)
    text = fmt::format("-{0:.0f}..+{0:.0f} sigma", kResidualScale);
  label(panel, text, {x0 + width + 8, y0 + height}, scale);
}

double quantile(std::vector<double>& values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * double(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Arrow scale: a round number of times such that the longer arrows span about a cell. Noise does
/// not: they stand for ten standard deviations of a cell's motion at least.
double arrow_gain(const FlowField& flow) {
  std::vector<double> lengths, deviations;
  for (const auto& cell : flow.cells) {
    if (!cell.reliable) continue;
    lengths.push_back(cell.estimate.head<2>().norm());
    deviations.push_back(std::sqrt(0.5 * cell.information.inverse().topLeftCorner<2, 2>().trace()));
  }
  if (lengths.empty()) return 1.0;
  const double large = std::max({quantile(lengths, 0.9), 10.0 * quantile(deviations, 0.5), 1e-3});
  const double wanted = 1.5 * flow.cell_px / large;
  const double decade = std::pow(10.0, std::floor(std::log10(wanted)));
  for (double step : {5.0, 2.0, 1.0})
    if (step * decade <= wanted) return step * decade;
  return decade;
}

void arrows(cv::Mat& panel, const FlowField& flow, double length_per_px, const std::string& unit) {
  const double gain = arrow_gain(flow);
  for (const auto& cell : flow.cells) {
    if (!cell.reliable) continue;
    const Eigen::Vector2d tip = cell.centre_px + gain * cell.estimate.head<2>();
    cv::arrowedLine(panel, cv::Point2d(cell.centre_px.x(), cell.centre_px.y()),
                    cv::Point2d(tip.x(), tip.y()), cv::Scalar(1.0, 0.75, 0.0), 1, cv::LINE_AA, 0,
                    0.3);
  }
  const double legend_px = 30.0 / gain;
  const int y = panel.rows - 18;
  cv::arrowedLine(panel, cv::Point(12, y), cv::Point(42, y), cv::Scalar(1.0, 0.75, 0.0), 2,
                  cv::LINE_AA, 0, 0.3);
  std::string text = fmt::format("{:.3g} px", legend_px);
  if (length_per_px > 0.0) text += fmt::format(" = {:.2g} {}", legend_px * length_per_px, unit);
  label(panel, text + fmt::format("   rms {:.3f} px", flow.rms_px()), {50, y + 5}, 0.5);
}

void write(const std::filesystem::path& png, const cv::Mat& picture) {
  Image out{picture.cols, picture.rows, 3, {}};
  out.values.resize(out.pixels() * 3);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x)
      for (int c = 0; c < 3; ++c) out.at(x, y, c) = picture.at<cv::Vec3f>(y, x)[c];
  write_image(png, out, Encoding{Encoding::Kind::linear, 1.0});
}

}  // namespace

void write_residual_png(const std::filesystem::path& png, const Image& residual) {
  write(png, residual_picture(residual));
}

void write_removed_picture(const std::filesystem::path& png, const Image& residual,
                           const Image& left, const std::string& title, const std::string& effect) {
  Image removed = residual;
  double was = 0.0, is = 0.0, count = 0.0;
  for (size_t i = 0; i < removed.values.size(); ++i) {
    const double a = residual.values[i], b = left.values[i];
    removed.values[i] -= left.values[i];
    if (std::isnan(a) || std::isnan(b)) continue;
    was += a * a, is += b * b, count += 1.0;
  }
  auto chi = [&](double sum) { return std::sqrt(sum / std::max(count, 1.0)); };
  cv::Mat now = residual_picture(residual), gone = residual_picture(removed),
          rest = residual_picture(left), all;
  label(now, fmt::format("{}  residual, chi = {:.2f}", title, chi(was)), {10, 22}, 0.5);
  label(gone, fmt::format("{} would remove", effect), {10, 22}, 0.5);
  label(rest, fmt::format("would be left, chi = {:.2f}", chi(is)), {10, 22}, 0.5);
  colour_bar(now);
  cv::hconcat(std::vector<cv::Mat>{now, gone, rest}, all);
  write(png, all);
}

void write_compare_picture(const std::filesystem::path& png, const Image& photo,
                           const PhotoEvaluation& evaluation, const std::string& title,
                           double length_per_px, const std::string& length_unit) {
  // One exposure for photo and model: the photo's 99.5 % point shows as white.
  std::vector<float> sorted = photo.values;
  const size_t high = sorted.size() - 1 - sorted.size() / 200;
  std::nth_element(sorted.begin(), sorted.begin() + high, sorted.end());
  const double gain = 1.0 / std::max(sorted[high], 1e-3f);
  cv::Mat left = grey_picture(photo, gain), model = grey_picture(evaluation.model, gain);
  cv::Mat residual = residual_picture(evaluation.residual);
  cv::Mat flow = grey_picture(evaluation.model, 0.4 * gain);
  arrows(flow, evaluation.flow, length_per_px, length_unit);
  label(left, title + "  photo", {10, 22});
  label(model, "model", {10, 22});
  label(residual, fmt::format("residual, chi = {:.2f}", evaluation.chi()), {10, 22});
  label(flow, "displacement that would remove it", {10, 22});
  colour_bar(residual);
  cv::Mat top, bottom, all;
  cv::hconcat(left, model, top);
  cv::hconcat(residual, flow, bottom);
  cv::vconcat(top, bottom, all);
  write(png, all);
}

}  // namespace hookeye
