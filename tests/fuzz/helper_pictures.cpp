// Pictures, in the helper's own code; the reader is chosen by what the file begins with.
#define main helper_main
#include "capture_io/helpers/pictures.cpp"
#undef main
#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace hookeye;
  static const bool ready = OIIO::attribute("threads", 1) && OIIO::attribute("exr_threads", 1);
  (void)ready;
  return fuzz::on_file("a.png", data, size, [](const auto& file) {
    read_header(file);
    read_stored(file);
  });
}
