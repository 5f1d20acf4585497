#include "capture_io/coded_photo.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/helper.h"
#include "core/parcels.h"

namespace hookeye {
namespace {

HelperRequest request_of(const std::filesystem::path& file) {
  HelperRequest request;
  request.name = "pictures";
  request.limits = limits_for(file);
  request.place = {file.string()};
  request.right = "hand over a complete PNG, TIFF, JPEG or EXR picture";
  return request;
}

}  // namespace

void write_coded_photo(const std::filesystem::path& file, const CodedPhoto& photo) {
  StoredImage stored{
      photo.width, photo.height, photo.channels, photo.bits > 8 ? StoredAs::words : StoredAs::bytes,
      6,           photo.codes};
  const long microseconds = std::lround(1e6 * std::clamp(photo.seconds, 0.0, 86399.0));
  const long seconds = microseconds / 1000000;
  stored.taken =
      fmt::format("1970:01:01 {:02}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60);
  stored.fraction = fmt::format("{:06}", microseconds % 1000000);
  stored.srgb = photo.srgb;
  HelperRequest request = request_of(file);
  Packer what;
  what.put(std::string("write")).put(file.string());
  pack(what, stored);
  request.content = what.take();
  request.limits = unlimited;
  const std::string why = ask_helper(request, [](Unpacker& from) {
    auto told = from.take<std::string>();
    (void)from.take<std::string>();
    return told;
  });
  if (!why.empty()) throw cannot_write(file.string(), why);
}

bool is_told_srgb(const std::filesystem::path& file) {
  HelperRequest request = request_of(file);
  request.content = Packer().put("srgb").put(file.string()).take();
  return ask_helper(request, [](Unpacker& from) { return from.take<std::string>(); }) == "srgb";
}

}  // namespace hookeye
