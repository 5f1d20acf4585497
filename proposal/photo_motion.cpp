#include "proposal/photo_motion.h"

#include <algorithm>
#include <cmath>

#include "capture_io/image.h"
#include "capture_io/photo_time.h"
#include "proposal/patch_track.h"

namespace hookeye {

namespace fs = std::filesystem;

namespace {

constexpr size_t kMostRead = 300;  ///< photos that are looked at for the first that moved
constexpr size_t kBehind = 5;      ///< photos read after it
constexpr int kSide = 640;         ///< [px] of the reduced picture
/// Change over that of still photos from which a photo moved: noise alone repeats to a few percent.
constexpr double kMoved = 1.25;

double rms_difference(const Image& a, const Image& b) {
  double sum = 0;
  for (size_t i = 0; i < a.values.size(); ++i) sum += std::pow(a.values[i] - b.values[i], 2);
  return std::sqrt(sum / static_cast<double>(std::max<size_t>(a.values.size(), 1)));
}

/// What two photos of one scene differ by, if noise is all.
double expected_change(const Image& image) {
  const NoiseModel noise = estimate_noise(image);
  double sum = 0;
  for (const float value : image.values) sum += std::pow(noise.sigma(value), 2);
  return std::sqrt(2 * sum / static_cast<double>(std::max<size_t>(image.values.size(), 1)));
}

/// Whole seconds of an even pace: the line through them, within the second that each was cut to.
void even_out(std::vector<double>& t) {
  const auto n = static_cast<double>(t.size());
  double mean = 0, xy = 0, xx = 0;
  for (const double value : t) mean += value / n;
  for (size_t i = 0; i < t.size(); ++i) {
    const double x = static_cast<double>(i) - (n - 1) / 2;
    xy += x * (t[i] - mean), xx += x * x;
  }
  std::vector<double> line;
  for (size_t i = 0; i < t.size(); ++i) {
    line.push_back(mean + xy / xx * (static_cast<double>(i) - (n - 1) / 2));
    if (std::abs(line.back() - t[i]) > 0.75) return;
  }
  t = line;
}

}  // namespace

PhotoClock photo_clock(const PhotoSeries& series) {
  PhotoClock clock;
  for (const auto& [number, file] : series.photos) {
    const auto time = read_photo_time(file);
    if (!time || (!clock.seconds.empty() && time->seconds < clock.seconds.back())) return {};
    clock.seconds.push_back(time->seconds);
    clock.whole_seconds |= time->whole_seconds;
  }
  // One time for all is that of a conversion.
  if (clock.seconds.size() < 2 || clock.seconds.front() == clock.seconds.back()) return {};
  if (clock.whole_seconds && clock.seconds.size() > 3) even_out(clock.seconds);
  return clock;
}

PhotoMotion photo_motion(const PhotoSeries& series) {
  PhotoMotion out;
  Image first;
  std::vector<Image> moving;  // from the last that is still
  double expected = 0, sum = 0;
  size_t k = 0;
  for (const auto& [number, file] : series.photos) {
    Image image = reduced(luminance(read_image(file, Encoding{})), kSide);
    if (k == 0) {
      first = image;
      expected = expected_change(image);
    }
    if (image.values.size() != first.values.size()) break;  // told where sizes are checked
    if (out.moved > 0) {
      moving.push_back(std::move(image));
      if (k++ >= out.moved + kBehind) break;
      continue;
    }
    const double change = rms_difference(image, first);
    const double still = k > 1 ? sum / static_cast<double>(k - 1) : expected;
    // The second photo has only the noise that one photo shows to be held against.
    if (k > 0 && still > 0 && change > (k > 1 ? kMoved : 3.0) * still) {
      if (k == 1) return out;
      out.moved = k;
      moving.push_back(std::move(image));
    } else {
      moving = {std::move(image)};
    }
    sum += change;
    if (++k > kMostRead) break;
  }
  if (out.moved > 0) out.gone = tracked_motion(moving);
  return out;
}

}  // namespace hookeye
