// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace patina::render {
namespace {

[[noreturn]] void refuse(const std::string& why) { throw ProcessingError(Exit::kUsage, why); }

bool isLight(const V3f& v) {
  return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x <= 1e9f && v.y <= 1e9f && v.z <= 1e9f;
}

float lightOf(const V3f& v) { return v.x + v.y + v.z; }

int wrapped(int i, int n) { return ((i % n) + n) % n; }

// Bilinear; x and y in texels from the picture's corner.
V3f lookUp(const Image<float>& map, float x, float y, bool wraps_x, bool wraps_y) {
  const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
  const float u = x - 0.5f - left, v = y - 0.5f - top;
  V3f sum(0);
  for (int dy = 0; dy < 2; ++dy)
    for (int dx = 0; dx < 2; ++dx) {
      const int i = static_cast<int>(left) + dx, j = static_cast<int>(top) + dy;
      const int column = wraps_x ? wrapped(i, map.width()) : std::clamp(i, 0, map.width() - 1),
                row = wraps_y ? wrapped(j, map.height()) : std::clamp(j, 0, map.height() - 1);
      const float* texel = &map.at(column, row);
      const float weight = (dx == 1 ? u : 1 - u) * (dy == 1 ? v : 1 - v);
      const bool is_colour = map.channels() == 3;
      sum += V3f(texel[0], texel[is_colour ? 1 : 0], texel[is_colour ? 2 : 0]) * weight;
    }
  return sum;
}

void checkMaterial(const SceneMesh& part) {
  const Material& m = part.material;
  const std::string where = "mesh '" + part.name + "': ";
  if (!isLight(m.colour) || m.colour.x > 1 || m.colour.y > 1 || m.colour.z > 1)
    refuse(where + "its colour is three numbers of 0 to 1");
  if (m.map && part.mesh->uv.empty())
    refuse(where +
           "it has a texture, but no texture coordinates: unwrap it in a modelling program");
  if (m.map && (m.map->empty() || (m.map->channels() != 1 && m.map->channels() != 3)))
    refuse(where + "its texture has 1 or 3 channels");
  if (!(m.repeat > 0 && m.repeat <= 1e4f)) refuse(where + "its texture repeats 0 to 10000 times");
  if (!(m.map_gain >= 0 && m.map_gain < 1e6f)) refuse(where + "its texture's gain is 0 to 1e6");
  if (!(m.specular >= 0 && m.specular <= 1)) refuse(where + "specular is 0 to 1");
  if (!(m.roughness >= 0.03f && m.roughness <= 1)) refuse(where + "roughness is 0.03 to 1");
}

void checkLights(const Scene& scene) {
  float light = lightOf(scene.sky.zenith) + lightOf(scene.sky.horizon) + lightOf(scene.sky.ground);
  if (!isLight(scene.sky.zenith) || !isLight(scene.sky.horizon) || !isLight(scene.sky.ground))
    refuse("the sky's light is three numbers of 0 or more");
  if (scene.sky.picture) {
    const Image<float>& picture = *scene.sky.picture;
    if (picture.channels() != 3) refuse("a picture of the sky is in colour");
    for (const float v : picture.texels())
      if (!(v >= 0 && v < 1e9f)) refuse("the picture of the sky holds what is no light");
    light += 1;
  }
  for (const Sun& sun : scene.suns) {
    if (!(sun.direction.length() > 0) || !(sun.angle_deg >= 0 && sun.angle_deg <= 90))
      refuse("a sun has a direction, and is 0 to 90 degrees wide");
    if (!isLight(sun.irradiance)) refuse("a sun's light is three numbers of 0 or more");
    light += lightOf(sun.irradiance);
  }
  for (const AreaLight& area : scene.areas) {
    if (!(area.half_u_mm.cross(area.half_v_mm).length() > 0)) refuse("an area light has no area");
    if (!isLight(area.radiance)) refuse("an area light shines with 0 or more");
    light += lightOf(area.radiance);
  }
  if (!(light > 0)) refuse("the scene has no light: give it a sun, an area or a sky");
}

}  // namespace

void Scene::check() const {
  if (meshes.empty()) refuse("the scene has no mesh");
  for (const SceneMesh& part : meshes) checkMaterial(part);
  checkLights(*this);
  const V3f view = camera.to_mm - camera.from_mm;
  if (!(view.length() > 0) || !(view.normalized().cross(camera.up.normalized()).length() > 1e-4f))
    refuse("the camera looks nowhere, or straight along 'up'");
  if (!(camera.field_of_view_deg >= 0.01f && camera.field_of_view_deg <= 170))
    refuse("the camera's field of view is 0.01 to 170 degrees");
  if (camera.size.width < 1 || camera.size.height < 1 || camera.size.width > 16384 ||
      camera.size.height > 16384)
    refuse("a picture is 1x1 to 16384x16384 pixels");
}

V3f skyRadiance(const Sky& sky, const V3f& direction) {
  if (sky.picture) {
    const Image<float>& picture = *sky.picture;
    const float u = 0.5f + std::atan2(direction.x, direction.y) / (2 * std::numbers::pi_v<float>),
                v = std::acos(std::clamp(direction.z, -1.0f, 1.0f)) / std::numbers::pi_v<float>;
    return lookUp(picture, u * static_cast<float>(picture.width()),
                  v * static_cast<float>(picture.height()), true, false) *
           sky.picture_gain;
  }
  const float rise = std::clamp(direction.z, -1.0f, 1.0f), share = std::abs(rise);
  return sky.horizon * (1 - share) + (rise > 0 ? sky.zenith : sky.ground) * share;
}

V3f colourAt(const Material& material, const mesh::V2f& uv) {
  if (!material.map) return material.colour;
  const Image<float>& map = *material.map;
  const bool repeats = material.repeat != 1;
  const auto place = [&](float at, int texels) {
    float share = at * material.repeat;
    share = repeats ? share - std::floor(share) : std::clamp(share, 0.0f, 1.0f);
    return share * static_cast<float>(texels);
  };
  const V3f value =
      lookUp(map, place(uv.x, map.width()), place(uv.y, map.height()), repeats, repeats) *
      material.map_gain;
  return {std::clamp(value.x, 0.0f, 1.0f), std::clamp(value.y, 0.0f, 1.0f),
          std::clamp(value.z, 0.0f, 1.0f)};
}

}  // namespace patina::render
