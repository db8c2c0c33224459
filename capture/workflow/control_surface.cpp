// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/control_surface.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "processing/mesh/curvature.h"
#include "processing/mesh/height_map.h"
#include "processing/mesh/surface_light.h"
#include "processing/mesh/uv_bake.h"

namespace patina::workflow {
namespace {

using mesh::RayScene;
using mesh::SurfacePoint;

constexpr double kReliefReachTexels = 64;  // of a relief's horizon
constexpr int kSkyRays = 128;
constexpr float kFar = std::numeric_limits<float>::infinity();

std::vector<const mesh::TriangleMesh*> pointersTo(const std::vector<SharedMesh>& meshes) {
  std::vector<const mesh::TriangleMesh*> out;
  for (const SharedMesh& mesh : meshes) out.push_back(mesh.get());
  return out;
}

// The relief's own shadow and horizon by its grid; those of what stands about it by rays.
class Relief : public ControlSurface {
 public:
  Relief(Image<float> height_mm, double mm_per_texel, const std::vector<SharedMesh>& casters)
      : height_(std::move(height_mm)), mm_per_texel_(mm_per_texel) {
    map().check();
    if (casters.empty()) return;
    about_.emplace(pointersTo(casters));
    normals_ = mesh::normalsOf(map());
  }

  Image<float> height() const override { return height_; }
  Image<float> slope() const override { return mesh::slopeOf(map()); }
  Image<float> curvature() const override { return mesh::meanCurvatureOf(map()); }
  Image<float> sky() const override {
    return times(mesh::skyShareOf(map(), kReliefReachTexels * mm_per_texel_),
                 [&](const SurfacePoint& point) {
                   return mesh::skyShareAt(*about_, point, kSkyRays, kFar);
                 });
  }
  Image<float> light(const mesh::Lamp& lamp) const override {
    return mesh::lightRateOf(map(), lamp);
  }
  Image<float> shadow(const mesh::Lamp& lamp, const mesh::ShadowOptions& how) const override {
    const std::vector<mesh::Lamp> lamps = mesh::spreadOf(lamp, how);
    return times(mesh::shadowOf(map(), lamp, how),
                 [&](const SurfacePoint& point) { return mesh::shadowAt(*about_, point, lamps); });
  }

 private:
  mesh::HeightMap map() const { return {height_.view(), mm_per_texel_}; }

  template <class Of>
  Image<float> times(Image<float> own, const Of& of) const {
    if (!about_) return own;
    tbb::parallel_for(0, height_.height(), [&](int y) {
      for (int x = 0; x < height_.width(); ++x) {
        const mesh::V3f normal(normals_.at(x, y, 0), normals_.at(x, y, 1), normals_.at(x, y, 2));
        const mesh::V3f place(
            static_cast<float>((x + 0.5 - height_.width() / 2.0) * mm_per_texel_),
            static_cast<float>((height_.height() / 2.0 - y - 0.5) * mm_per_texel_),
            height_.at(x, y));
        own.at(x, y) *= of({place, normal, normal});
      }
    });
    return own;
  }

  Image<float> height_, normals_;
  double mm_per_texel_;
  std::optional<RayScene> about_;
};

class Unwrapped : public ControlSurface {
 public:
  Unwrapped(SharedMesh mesh, SizePx size, std::vector<SharedMesh> casters)
      : mesh_(std::move(mesh)), bake_(*mesh_, size) {
    casters.push_back(mesh_);
    scene_.emplace(pointersTo(casters));
  }

  Image<float> height() const override {
    float lowest = kFar;
    for (const mesh::V3f& p : mesh_->position_mm) lowest = std::min(lowest, p.z);
    return at([&](const SurfacePoint& point) { return point.position_mm.z - lowest; });
  }
  Image<float> slope() const override {
    return at([](const SurfacePoint& point) {
      return std::acos(std::clamp(point.normal.z, -1.0f, 1.0f)) * 180 / std::numbers::pi_v<float>;
    });
  }
  Image<float> curvature() const override { return bake_.map(mesh::meanCurvatureOf(*mesh_)); }
  Image<float> sky() const override {
    return at([&](const SurfacePoint& point) {
      return mesh::skyShareAt(*scene_, point, kSkyRays, kFar);
    });
  }
  Image<float> light(const mesh::Lamp& lamp) const override {
    if (lamp.directional) mesh::unitOf(lamp.at);
    return at([&](const SurfacePoint& point) { return mesh::lightRateAt(point, lamp); });
  }
  Image<float> shadow(const mesh::Lamp& lamp, const mesh::ShadowOptions& how) const override {
    const std::vector<mesh::Lamp> lamps = mesh::spreadOf(lamp, how);
    return at([&](const SurfacePoint& point) { return mesh::shadowAt(*scene_, point, lamps); });
  }

 private:
  template <class Of>
  Image<float> at(const Of& of) const {
    return bake_.map([&](const mesh::UvTexel& texel) {
      return of(mesh::pointOn(*mesh_, texel.triangle, texel.b1, texel.b2));
    });
  }

  SharedMesh mesh_;
  mesh::UvBake bake_;
  std::optional<RayScene> scene_;
};

}  // namespace

std::unique_ptr<ControlSurface> surfaceOfRelief(Image<float> height_mm, double mm_per_texel,
                                                const std::vector<SharedMesh>& casters) {
  return std::make_unique<Relief>(std::move(height_mm), mm_per_texel, casters);
}

std::unique_ptr<ControlSurface> surfaceOfMesh(const SharedMesh& mesh, SizePx size,
                                              const std::vector<SharedMesh>& casters) {
  return std::make_unique<Unwrapped>(mesh, size, casters);
}

}  // namespace patina::workflow
