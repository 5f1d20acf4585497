#include "render/processor.h"

#include <fmt/format.h>
#include <hwy/highway.h>

#include "render/ray_scene.h"

namespace hookeye {

Vectors vectors_in_use() {
  const RayDevice device = ray_device();  // first: it obeys HOOKEYE_ISA
  Vectors out;
  out.rays = device.rays;
  out.version = fmt::format("{}.{}.{}", device.version / 10000, device.version / 100 % 100,
                            device.version % 100);
  const int64_t all = hwy::SupportedTargets();
  out.embree = device.rays >= 16                             ? "avx512"
               : device.rays < 8                             ? "sse2"
               : (all & (HWY_AVX2 | HWY_AVX3 | HWY_AVX3_DL)) ? "avx2"
                                                             : "avx";
  out.pixels = hwy::TargetName(all & -all);  // the best has the lowest bit
  return out;
}

}  // namespace hookeye
