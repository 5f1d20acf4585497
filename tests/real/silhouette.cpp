#include "real/silhouette.h"

#include <stdexcept>

namespace hookeye::real {

Image silhouette(const Image& stored, int seed_x, int seed_y,
                 const std::function<bool(const float* pixel)>& inside) {
  Image out{stored.width, stored.height, 1, std::vector<float>(stored.pixels(), 0.0f)};
  std::vector<std::pair<int, int>> open{{seed_x, seed_y}};
  while (!open.empty()) {
    const auto [x, y] = open.back();
    open.pop_back();
    if (x < 0 || y < 0 || x >= stored.width || y >= stored.height || out.at(x, y) > 0.0f) continue;
    if (!inside(&stored.values[(static_cast<size_t>(y) * stored.width + x) * stored.channels]))
      continue;
    out.at(x, y) = 1.0f;
    for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
      open.push_back({x + dx, y + dy});
  }
  if (out.at(seed_x, seed_y) == 0.0f)
    throw std::runtime_error("silhouette: the seed lies outside the patch");
  return out;
}

Image stored_values(const std::filesystem::path& file) { return read_image(file, Encoding{}); }

}  // namespace hookeye::real
