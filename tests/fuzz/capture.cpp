// capture.yaml, with files that it may name.
#include "capture_io/capture.h"

#include "fuzz.h"

namespace hookeye::fuzz {
namespace {

bool prepared() {
  write("rest.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  write("grip.txt", "0 1\n3\n");
  return true;
}

}  // namespace
}  // namespace hookeye::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const bool ready = hookeye::fuzz::prepared();
  (void)ready;
  return hookeye::fuzz::on_file("capture.yaml", data, size,
                                [](const auto& file) { hookeye::read_capture(file); });
}
