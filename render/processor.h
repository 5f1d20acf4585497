// What of the processor rays and pixels use.
#pragma once

#include <string>

namespace hookeye {

struct Vectors {
  int rays = 0;         ///< that Embree traces at once: 4, 8 or 16
  std::string embree;   ///< its instructions, as HOOKEYE_ISA names them: sse2, avx, avx2, avx512
  std::string version;  ///< Embree's
  std::string pixels;   ///< the instructions of pixels, as Highway names them: SSE4, AVX2, AVX3
};

/// Obeys HOOKEYE_ISA. Throws InputError where that is no instruction set of this processor.
Vectors vectors_in_use();

}  // namespace hookeye
