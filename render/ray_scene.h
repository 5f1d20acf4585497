// Rays against the triangles of one state of a surface. Internal to render; the only translation
// unit that sees Embree is ray_scene.cpp.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

namespace hookeye {

/// Sixteen rays origin + t direction with their hits. The layout is RTCRayHit16 (asserted in
/// ray_scene.cpp), so that nothing is copied on the way in or out.
struct alignas(64) RayPacket {
  float org_x[16], org_y[16], org_z[16], tnear[16];
  float dir_x[16], dir_y[16], dir_z[16], time[16];
  float tfar[16];  ///< after intersect(): t of the hit; after occluded(): negative where blocked
  unsigned mask[16], id[16], flags[16];
  float ng_x[16], ng_y[16], ng_z[16], u[16], v[16];
  unsigned triangle[16];  ///< kNoTriangle: none
  unsigned geometry[16], instance[16];

  static constexpr unsigned kNoTriangle = ~0u;
  /// All lanes empty with the given range; positions and directions are to be set by lane. Lanes
  /// that are not wanted afterwards need not be.
  void reset(float near, float far);
  void set(int lane, const Eigen::Vector3d& from, const Eigen::Vector3d& direction);
};

/// What Embree uses of this processor.
struct RayDevice {
  int rays;     ///< traced at once: 4, 8 or 16
  int version;  ///< 31305: 3.13.5
};
RayDevice ray_device();

/// Triangles that move: built once, refitted for every later set of positions.
class RayScene {
 public:
  RayScene(const std::vector<std::array<int, 3>>& triangles, const Eigen::Matrix3Xd& x);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  void set_positions(const Eigen::Matrix3Xd& x);
  /// First hits. Lanes with wanted[i] == 0, unset ones among them, and lanes that hold no finite
  /// ray with 0 <= tnear and 0 <= tfar hit nothing; their origin, direction and tnear are
  /// overwritten. `coherent`: rays of one eye or light.
  void intersect(RayPacket& rays, const int* wanted, bool coherent = true) const;
  /// Any hit: tfar < 0 where blocked.
  void occluded(RayPacket& rays, const int* wanted, bool coherent = true) const;
  /// Subtracted (in double) from positions before they become float; ray origins need the same.
  const Eigen::Vector3d& centre() const { return centre_; }
  /// Length below which two points of the surface are taken for one [length].
  double epsilon() const { return epsilon_; }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  Eigen::Vector3d centre_;
  double epsilon_;
};

}  // namespace hookeye
