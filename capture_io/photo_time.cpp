#include "capture_io/photo_time.h"

#include <chrono>
#include <cstdio>

#include "core/helper.h"

namespace hookeye {

std::optional<PhotoTime> read_photo_time(const std::filesystem::path& file) {
  HelperRequest request;
  request.name = "pictures";
  request.content = Packer().put("time").put(file.string()).take();
  request.limits = limits_for(file);
  request.place = {file.string()};
  request.right = "hand over a complete PNG, TIFF, JPEG or EXR picture";
  const auto told = ask_helper(request, [](Unpacker& from) { return from.take<std::string>(); });
  int year = 0, month = 0, day = 0, hour = 0, minute = 0;
  double second = 0;
  // EXIF: 2024:05:01 12:30:05, and the fraction's digits behind a point.
  const int got = std::sscanf(told.c_str(), "%4d%*c%2d%*c%2d%*c%2d:%2d:%lf", &year, &month, &day,
                              &hour, &minute, &second);
  using namespace std::chrono;
  const year_month_day date{std::chrono::year(year) / month / day};
  if (got != 6 || !date.ok() || !(second >= 0 && second < 61)) return {};
  const double days = static_cast<double>(sys_days(date).time_since_epoch().count());
  return PhotoTime{86400.0 * days + 3600.0 * hour + 60.0 * minute + second,
                   told.find('.') == std::string::npos};
}

}  // namespace hookeye
