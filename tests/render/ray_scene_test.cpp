// Packets of rays as the renderer hands them over: half filled, with lanes that hold anything.
#include "render/ray_scene.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

namespace hookeye {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// A unit square in z = 0, in two triangles.
struct RayPackets : testing::TestWithParam<bool> {
  Eigen::Matrix3Xd corners =
      (Eigen::Matrix3Xd(3, 4) << 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0).finished();
  RayScene scene{{{0, 1, 2}, {1, 3, 2}}, corners};

  /// As memory may be: every byte of the lanes' rays is `garbage`.
  RayPacket packet(unsigned char garbage) const {
    RayPacket rays;
    std::memset(static_cast<void*>(&rays), garbage, sizeof rays);
    rays.reset(0, kFar);
    return rays;
  }
  void look_down(RayPacket& rays, int lane, double x) const {
    rays.set(lane, Eigen::Vector3d(x, 0.4, 2) - scene.centre(), {0, 0, -1});
  }
};

TEST_P(RayPackets, lanes_that_nobody_set_are_left_alone) {
  for (const unsigned char garbage : {0x00, 0x7f, 0xff})
    for (const int count : {1, 5, 8, 15}) {
      int wanted[16] = {};
      RayPacket rays = packet(garbage), shadow = packet(garbage);
      for (int i = 0; i < count; ++i) {
        look_down(rays, i, 0.05 + 0.1 * i);  // beyond the square from the tenth on
        look_down(shadow, i, 0.05 + 0.1 * i);
        wanted[i] = -1;
      }
      scene.intersect(rays, wanted, GetParam());
      scene.occluded(shadow, wanted, GetParam());
      for (int i = 0; i < 16; ++i) {
        const bool meets = i < count && i < 10;
        EXPECT_EQ(rays.triangle[i] != RayPacket::kNoTriangle, meets) << count << ", lane " << i;
        EXPECT_EQ(shadow.tfar[i] < 0, meets) << count << ", lane " << i;
        if (meets) {
          EXPECT_NEAR(rays.tfar[i], 2, 1e-5);
        }
      }
    }
}

TEST_P(RayPackets, lanes_that_are_no_rays_meet_nothing) {
  const auto spoilt = [&](auto spoil) {
    int wanted[16];
    RayPacket rays = packet(0);
    for (int i = 0; i < 16; ++i) {
      look_down(rays, i, 0.05 + 0.05 * i);
      wanted[i] = -1;
    }
    spoil(rays);
    RayPacket shadow = rays;
    scene.intersect(rays, wanted, GetParam());
    scene.occluded(shadow, wanted, GetParam());
    for (int i = 0; i < 16; ++i) {
      EXPECT_EQ(rays.triangle[i] != RayPacket::kNoTriangle, i != 3) << "lane " << i;
      EXPECT_EQ(shadow.tfar[i] < 0, i != 3) << "lane " << i;
    }
  };
  spoilt([](RayPacket& r) { r.org_y[3] = kNaN; });
  spoilt([](RayPacket& r) { r.dir_z[3] = kNaN; });
  spoilt([](RayPacket& r) { r.dir_x[3] = kFar; });
  spoilt([](RayPacket& r) { r.tnear[3] = kNaN; });
  spoilt([](RayPacket& r) { r.tnear[3] = -1; });
  spoilt([](RayPacket& r) { r.org_x[3] = 1e30f; });
}

INSTANTIATE_TEST_SUITE_P(Coherence, RayPackets, testing::Bool());

}  // namespace
}  // namespace hookeye
