#include "render/ray_scene.h"

#include <embree3/rtcore.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>

#include "meshing/extent.h"
#include "render/instruction_set.h"

namespace hookeye {

static_assert(sizeof(RayPacket) == sizeof(RTCRayHit16));
static_assert(offsetof(RayPacket, tfar) == offsetof(RTCRay16, tfar));
static_assert(offsetof(RayPacket, ng_x) == offsetof(RTCRayHit16, hit));
static_assert(offsetof(RayPacket, triangle) ==
              offsetof(RTCRayHit16, hit) + offsetof(RTCHit16, primID));

namespace {

/// One device a process. Its number of threads is left alone: any limit here would be TBB's for the
/// whole process.
RTCDevice device() {
  struct Holder {
    RTCDevice handle = rtcNewDevice(("set_affinity=0," + limited_instruction_set()).c_str());
    ~Holder() {
      if (handle) rtcReleaseDevice(handle);
    }
  };
  static Holder holder;
  if (!holder.handle) throw std::runtime_error("Embree gives no device on this processor");
  return holder.handle;
}

/// Beyond that Embree takes a number for a mistake.
constexpr float kLargest = 1.8e18f;

/// Where the processor's vectors are narrower than a packet, Embree takes it for a stream of rays:
/// it does not look at `active`, and its assertions (Debian has them on) end the process at a lane
/// that nobody has set. What leaves such lanes out everywhere is a range that is empty. They, and
/// lanes that hold no ray, get one while this lives.
class IdleLanes {
 public:
  IdleLanes(RayPacket& rays, const int* wanted) : rays_(rays) {
    const auto within = [](float value) { return int{std::abs(value) < kLargest}; };  // not NaN
    for (int i = 0; i < 16; ++i) {  // no branches: vectors
      const int sound = within(rays.org_x[i]) & within(rays.org_y[i]) & within(rays.org_z[i]) &
                        within(rays.dir_x[i]) & within(rays.dir_y[i]) & within(rays.dir_z[i]) &
                        within(rays.tnear[i]) & int{rays.tnear[i] >= 0} & int{rays.tfar[i] >= 0};
      active_[i] = -(int{wanted[i] != 0} & sound);
      far_[i] = rays.tfar[i];
    }
    for (int i = 0; i < 16; ++i) {
      if (active_[i]) continue;
      rays.org_x[i] = rays.org_y[i] = rays.org_z[i] = 0;
      rays.dir_x[i] = rays.dir_y[i] = 0;
      rays.dir_z[i] = 1;
      rays.tnear[i] = 1;
      rays.tfar[i] = 0;
    }
  }
  ~IdleLanes() {
    for (int i = 0; i < 16; ++i)
      if (!active_[i]) rays_.tfar[i] = far_[i];
  }
  IdleLanes(const IdleLanes&) = delete;
  IdleLanes& operator=(const IdleLanes&) = delete;
  const int* active() const { return active_; }

 private:
  RayPacket& rays_;
  alignas(64) int active_[16];
  float far_[16];
};

RTCIntersectContext context(bool coherent) {
  RTCIntersectContext c;
  rtcInitIntersectContext(&c);
  c.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return c;
}

}  // namespace

RayDevice ray_device() {
  const auto has = [](RTCDeviceProperty what) { return rtcGetDeviceProperty(device(), what) != 0; };
  return {has(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)  ? 16
          : has(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) ? 8
                                                           : 4,
          static_cast<int>(rtcGetDeviceProperty(device(), RTC_DEVICE_PROPERTY_VERSION))};
}

void RayPacket::reset(float near, float far) {
  for (int i = 0; i < 16; ++i) {
    tnear[i] = near;
    time[i] = 0;
    tfar[i] = far;
    mask[i] = ~0u;
    id[i] = flags[i] = 0;
    triangle[i] = geometry[i] = instance[i] = kNoTriangle;
  }
}

void RayPacket::set(int lane, const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
  org_x[lane] = static_cast<float>(from.x());
  org_y[lane] = static_cast<float>(from.y());
  org_z[lane] = static_cast<float>(from.z());
  dir_x[lane] = static_cast<float>(direction.x());
  dir_y[lane] = static_cast<float>(direction.y());
  dir_z[lane] = static_cast<float>(direction.z());
}

struct RayScene::Impl {
  RTCScene scene = nullptr;
  RTCGeometry geometry = nullptr;
  float* vertices = nullptr;
  ~Impl() {
    if (geometry) rtcReleaseGeometry(geometry);
    if (scene) rtcReleaseScene(scene);
  }
};

RayScene::RayScene(const std::vector<std::array<int, 3>>& triangles, const Eigen::Matrix3Xd& x)
    : impl_(std::make_unique<Impl>()) {
  const Eigen::Vector3d low = x.rowwise().minCoeff(), high = x.rowwise().maxCoeff();
  centre_ = (low + high) / 2;
  epsilon_ = 1e-5 * extent(x);
  Impl& m = *impl_;
  m.scene = rtcNewScene(device());
  // A LOW quality dynamic scene really refits; a MEDIUM one silently rebuilds at ten times the
  // cost.
  rtcSetSceneFlags(m.scene, RTCSceneFlags(RTC_SCENE_FLAG_DYNAMIC | RTC_SCENE_FLAG_ROBUST));
  rtcSetSceneBuildQuality(m.scene, RTC_BUILD_QUALITY_LOW);
  m.geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(m.geometry, RTC_BUILD_QUALITY_REFIT);
  m.vertices = static_cast<float*>(rtcSetNewGeometryBuffer(m.geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                           RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                           std::max<size_t>(1, x.cols())));
  auto* index = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(m.geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(unsigned), std::max<size_t>(1, triangles.size())));
  if (!m.vertices || !index) throw std::runtime_error("Embree gives no memory for the surface");
  for (const auto& triangle : triangles)
    for (int k : triangle) *index++ = static_cast<unsigned>(k);
  rtcAttachGeometry(m.scene, m.geometry);
  set_positions(x);
}

RayScene::~RayScene() = default;

void RayScene::set_positions(const Eigen::Matrix3Xd& x) {
  Impl& m = *impl_;
  Eigen::Map<Eigen::Matrix3Xf>(m.vertices, 3, x.cols()) = (x.colwise() - centre_).cast<float>();
  rtcUpdateGeometryBuffer(m.geometry, RTC_BUFFER_TYPE_VERTEX, 0);
  rtcCommitGeometry(m.geometry);
  rtcCommitScene(m.scene);
}

void RayScene::intersect(RayPacket& rays, const int* wanted, bool coherent) const {
  RTCIntersectContext c = context(coherent);
  const IdleLanes idle(rays, wanted);
  rtcIntersect16(idle.active(), impl_->scene, &c, reinterpret_cast<RTCRayHit16*>(&rays));
}

void RayScene::occluded(RayPacket& rays, const int* wanted, bool coherent) const {
  RTCIntersectContext c = context(coherent);
  const IdleLanes idle(rays, wanted);
  rtcOccluded16(idle.active(), impl_->scene, &c, reinterpret_cast<RTCRay16*>(&rays));
}

}  // namespace hookeye
