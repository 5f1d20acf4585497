#include "real/pictures.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace hookeye::real {

namespace {

using Colour = std::array<float, 3>;
constexpr Colour kGrey{0.6f, 0.6f, 0.6f}, kBlue{0.13f, 0.40f, 0.67f}, kRed{0.70f, 0.09f, 0.17f};

Colour diverging(double t) {
  const float a = static_cast<float>(std::min(1.0, std::abs(t)));
  const Colour& end = t < 0.0 ? kBlue : kRed;
  Colour out;
  for (int c = 0; c < 3; ++c) out[c] = 0.97f * (1.0f - a) + end[c] * a;
  return out;
}

void paint(Image& image, int x, int y, const Colour& colour) {
  for (int c = 0; c < 3; ++c) image.at(x, y, c) = colour[c];
}

Image grey_picture(int width, int height) {
  Image image{width, height, 3, std::vector<float>(static_cast<size_t>(width) * height * 3)};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) paint(image, x, y, kGrey);
  return image;
}

}  // namespace

void write_motion(const std::filesystem::path& png, const FlowField& flow, double largest_px,
                  int cell) {
  int columns = 0, rows = 0;
  for (const auto& one : flow.cells)
    columns = std::max(columns, one.column + 1), rows = std::max(rows, one.row + 1);
  Image image = grey_picture((2 * columns + 2) * cell, rows * cell);
  for (const auto& one : flow.cells) {
    if (!one.reliable) continue;
    for (int axis = 0; axis < 2; ++axis) {
      const Colour colour = diverging(one.estimate[axis] / largest_px);
      const int x0 = (one.column + axis * (columns + 2)) * cell, y0 = one.row * cell;
      for (int y = y0; y < y0 + cell; ++y)
        for (int x = x0; x < x0 + cell; ++x) paint(image, x, y, colour);
    }
  }
  write_image(png, image);
}

void write_overlay(const std::filesystem::path& png, const Image& model, const Image& photo,
                   const std::vector<unsigned char>& valid) {
  Image image = grey_picture(model.width / 2, model.height / 2);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const size_t at = static_cast<size_t>(2 * y) * model.width + 2 * x;
      if (!valid[at]) continue;
      const bool a = model.values[at] > 0.5f, b = photo.values[at] > 0.5f;
      paint(image, x, y, a && b ? Colour{1, 1, 1} : a ? kBlue : b ? kRed : Colour{0, 0, 0});
    }
  write_image(png, image);
}

Image side_by_side(const std::vector<Image>& pictures) {
  constexpr int kGap = 8;
  int width = -kGap;
  for (const auto& one : pictures) width += one.width + kGap;
  Image all{width, pictures.at(0).height, 3, {}};
  all.values.assign(all.pixels() * 3, 1.0f);
  int left = 0;
  for (const auto& one : pictures) {
    for (int y = 0; y < one.height; ++y)
      for (int x = 0; x < one.width; ++x)
        for (int c = 0; c < 3; ++c)
          all.at(left + x, y, c) = one.at(x, y, one.channels == 3 ? c : 0);
    left += one.width + kGap;
  }
  return all;
}

Image residual_picture(const PhotoEvaluation& seen) {
  Image image = grey_picture(seen.residual.width / 2, seen.residual.height / 2);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const float residual = seen.residual.at(2 * x, 2 * y);
      if (std::isfinite(residual)) paint(image, x, y, diverging(residual / kResidualScale));
    }
  return image;
}

}  // namespace hookeye::real
