// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/mesh/ray_scene.h"

#include <embree3/rtcore.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "processing/image/failure.h"

namespace patina::mesh {
namespace {

constexpr float kClearance = 2e-5f;  // of the reach: some 200 roundings of a coordinate

struct Close {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, Close>;
using Scene = std::unique_ptr<std::remove_pointer_t<RTCScene>, Close>;

[[noreturn]] void refuse(RTCDevice device) {
  throw ProcessingError(Exit::kUnavailable, "Embree cannot build the scene (error " +
                                                std::to_string(rtcGetDeviceError(device)) +
                                                "); is there enough memory?");
}

template <class T>
T* bufferOf(RTCDevice device, RTCGeometry geometry, RTCBufferType type, RTCFormat format,
            std::size_t count) {
  void* const data = rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(T), count);
  if (!data) refuse(device);
  return static_cast<T*>(data);
}

void attach(RTCDevice device, RTCScene scene, const TriangleMesh& mesh) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  std::copy(mesh.position_mm.begin(), mesh.position_mm.end(),
            bufferOf<V3f>(device, geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3,
                          mesh.position_mm.size()));
  std::copy(mesh.triangle.begin(), mesh.triangle.end(),
            bufferOf<TriangleMesh::Triangle>(device, geometry, RTC_BUFFER_TYPE_INDEX,
                                             RTC_FORMAT_UINT3, mesh.triangle.size()));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
}

RTCRay rayOf(const V3f& from, const V3f& direction, float within_mm) {
  RTCRay ray{};
  ray.org_x = from.x;
  ray.org_y = from.y;
  ray.org_z = from.z;
  ray.dir_x = direction.x;
  ray.dir_y = direction.y;
  ray.dir_z = direction.z;
  ray.tfar = within_mm;
  ray.mask = ~0u;
  return ray;
}

}  // namespace

struct RayScene::State {
  Device device;
  Scene scene;
  float clearance_mm = 0;
};

// Embree's builders split the work by the number of threads, and rays that meet an edge take the
// triangle that comes first in the tree: one thread builds, so that pictures do not depend on it.
RayScene::RayScene(const std::vector<const TriangleMesh*>& meshes)
    : state_(std::make_unique<State>()) {
  state_->device.reset(rtcNewDevice("threads=1"));
  if (!state_->device)
    throw ProcessingError(Exit::kUnavailable, "Embree cannot start on this machine (error " +
                                                  std::to_string(rtcGetDeviceError(nullptr)) + ")");
  RTCDevice device = state_->device.get();
  state_->scene.reset(rtcNewScene(device));
  rtcSetSceneFlags(state_->scene.get(), RTC_SCENE_FLAG_ROBUST);
  float reach = 0;
  for (const TriangleMesh* mesh : meshes) {
    attach(device, state_->scene.get(), *mesh);
    for (const V3f& p : mesh->position_mm)
      reach = std::max({reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  state_->clearance_mm = reach * kClearance;
  tbb::task_arena(1).execute([&] { rtcCommitScene(state_->scene.get()); });
  if (rtcGetDeviceError(device) != RTC_ERROR_NONE) refuse(device);
}

RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

std::optional<RayHit> RayScene::nearest(const V3f& from, const V3f& direction) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{};
  query.ray = rayOf(from, direction, std::numeric_limits<float>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(state_->scene.get(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return RayHit{query.ray.tfar, query.hit.geomID, query.hit.primID, query.hit.u, query.hit.v};
}

bool RayScene::isBlocked(const V3f& from, const V3f& direction, float within_mm) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray = rayOf(from, direction, within_mm);
  rtcOccluded1(state_->scene.get(), &context, &ray);
  return ray.tfar < 0;
}

float RayScene::clearance_mm() const { return state_->clearance_mm; }

}  // namespace patina::mesh
