// OpenCV's calibrations, in the helper's own code; yml, xml and json are told by their first bytes.
#define main helper_main
#include "capture_io/helpers/calibration.cpp"
#undef main
#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return hookeye::fuzz::on_file("a.yml", data, size, [](const auto& file) { hookeye::read(file); });
}
