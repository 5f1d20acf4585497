#include "estimation/inspection/codes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "estimation/model/photo_again.h"

namespace hookeye::inspection {

namespace {

void add(const Image& image, Codes* codes) {
  const double most = std::exp2(codes->bits) - 1.0;
  for (const float value : image.values) {
    const int code = static_cast<int>(std::lround(std::clamp(double(value), 0.0, 1.0) * most));
    codes->used[static_cast<size_t>(code)] = 1;
  }
}

}  // namespace

int Codes::used_between(int low, int high) const {
  return static_cast<int>(std::count(used.begin() + low, used.begin() + high, 1));
}

std::vector<Codes> stored_codes(const Sight& sight) {
  constexpr int kPhotos =
      4;  // of a camera: all are of one kind, and reading them takes as long again
  std::map<std::string, Codes> by_camera;
  std::vector<PhotoIndex> photos = sight.photos();
  std::sort(photos.begin(), photos.end(), [&](const PhotoIndex& a, const PhotoIndex& b) {
    return sight.spec(a).file < sight.spec(b).file;
  });
  for (const PhotoIndex& photo : photos) {
    const PhotoSpec& spec = sight.spec(photo);
    const ImageHeader header = header_of(spec);
    if (header.floating || spec.kind != PhotoSpec::Kind::image) continue;
    Codes& codes = by_camera[spec.camera];
    if (codes.photos == kPhotos) continue;
    if (codes.photos == 0) {
      codes.bits = header.bits <= 8 ? 8 : 16;
      codes.first = photo;
      codes.used.assign(size_t{1} << codes.bits, 0);
    }
    if (codes.bits != (header.bits <= 8 ? 8 : 16)) continue;
    add(read_image(NamedFile{spec.file, spec.place}, Encoding{}), &codes);
    read_again(sight.scene(), photo.first, photo.second, Weighed::no);  // it is the one looked at
    ++codes.photos;
  }
  std::vector<Codes> out;
  for (auto& [camera, codes] : by_camera) {
    for (size_t code = 0; code < codes.used.size(); ++code)
      if (codes.used[code])
        codes.largest = int(code), codes.divisor = std::gcd(codes.divisor, int(code));
    out.push_back(std::move(codes));
  }
  return out;
}

}  // namespace hookeye::inspection
