// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/relight.h"

#include "processing/brdf/ggx.h"
#include "processing/brdf/model_conversion.h"
#include "processing/brdf/ward.h"
#include "processing/image/parallel_rows.h"

namespace patina::brdf {
namespace {

constexpr float kSmoothest = 1e-3f;

Vec3 normalAt(const BrdfMaps& maps, int x, int y) {
  if (maps.normal.empty()) return {0, 0, 1};
  const auto n = maps.normal.view().texel(x, y);
  return normalized({n[0], n[1], n[2]});
}

const Image<float>* extraOf(const BrdfMaps& maps, const char* name) {
  const auto at = maps.extra.find(name);
  return at == maps.extra.end() ? nullptr : &at->second;
}

// h in the frame of the surface, its x along the tangent (projected onto the surface).
Vec3 intoFrame(const Vec3& h, const Vec3& n, const Vec3& tangent) {
  const float along = dot(tangent, n);
  const Vec3 t = normalized(
      {tangent.x - along * n.x, tangent.y - along * n.y, tangent.z - along * n.z + 1e-9f});
  const Vec3 b{n.y * t.z - n.z * t.y, n.z * t.x - n.x * t.z, n.x * t.y - n.y * t.x};
  return {dot(h, t), dot(h, b), dot(h, n)};
}

struct Gloss {
  float value = 0, schlick = 0;  // f_s = (ks + (1 - ks) schlick) value
};

class Relighter {
 public:
  Relighter(const BrdfMaps& maps, const BrdfSetInfo& info)
      : maps_(maps),
        info_(info),
        across_(extraOf(maps, "RoughnessY")),
        tangent_(extraOf(maps, "Tangent")) {}

  Gloss glossAt(int x, int y, const Vec3& n, const LightRay& ray, float n_l, float n_v) const {
    if (info_.model == Model::kLambert) return {};
    const float stored = maps_.roughness.at(x, y);
    const float r = std::max(
        info_.roughness == RoughnessKind::kPerceptual ? stored * stored : stored, kSmoothest);
    if (info_.model == Model::kWardAnisotropic && across_ && tangent_) {
      const auto t = tangent_->view().texel(x, y);
      const Vec3 h = intoFrame(ray.h, n, {t[0], t[1], t[2]});
      return {wardAnisotropic(h, ray.v_h, r, std::max(across_->at(x, y), kSmoothest)), 0};
    }
    const float n_h = std::min(std::max(dot(n, ray.h), kSmoothest), 1.0f);
    const float value = lobeOf(info_.model, {n_l, n_v, n_h, ray.v_h}, r).value;
    return {value, info_.model == Model::kGgx ? schlickWeight(ray.v_h) : 0.0f};
  }

  void row(int y, const SurfaceLight& light, const Vec3& view, float mm_per_texel,
           Image<float>& out) const {
    const SizePx size = out.size();
    LightRay ray = rayAt(light, view, 0, 0);
    for (int x = 0; x < size.width; ++x) {
      if (light.near) {
        const PlaceMm place = placeOf(x, y, size, mm_per_texel);
        ray = rayAt(light, view, place.x, place.y);
      }
      const Vec3 n = normalAt(maps_, x, y);
      const float n_l = dot(n, ray.l), n_v = std::max(dot(n, view), kSmoothest);
      if (!(n_l > 0)) continue;
      const Gloss gloss = glossAt(x, y, n, ray, std::min(n_l, 1.0f), std::min(n_v, 1.0f));
      for (int c = 0; c < out.channels(); ++c) {
        float level = maps_.diffuse.at(x, y, c);
        if (info_.model != Model::kLambert) {
          const float ks = maps_.specular.at(x, y, std::min(c, maps_.specular.channels() - 1));
          level += kPi * gloss.value * (ks + (1 - ks) * gloss.schlick);
        }
        out.at(x, y, c) = level * n_l * ray.irradiance;
      }
    }
  }

 private:
  const BrdfMaps& maps_;
  const BrdfSetInfo& info_;
  const Image<float>*across_, *tangent_;
};

}  // namespace

Image<float> relight(const BrdfMaps& maps, const BrdfSetInfo& info, const SurfaceLight& light,
                     const Vec3& view, float mm_per_texel) {
  Image<float> out(maps.diffuse.width(), maps.diffuse.height(), maps.diffuse.channels());
  const Relighter relighter(maps, info);
  forEachRow(out.height(), std::int64_t{out.width()} * 60,
             [&](int y) { relighter.row(y, light, view, mm_per_texel, out); });
  return out;
}

}  // namespace patina::brdf
