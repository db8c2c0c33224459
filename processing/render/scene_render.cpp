// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/scene_render.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "processing/mesh/ray_scene.h"
#include "processing/mesh/surface_light.h"
#include "processing/render/reflection.h"
#include "processing/render/sample_points.h"

namespace patina::render {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr int kTilePx = 16;
constexpr float kDarkest = 1e-5f;  // what a path still carries when it is given up

// Two directions square to `n` and to each other (Duff et al. 2017).
struct Frame {
  explicit Frame(const V3f& normal) : n(normal) {
    const float sign = std::copysign(1.0f, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
    s = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
    t = {b, sign + n.y * n.y * a, -n.y};
  }
  V3f outer(const V3f& v) const { return s * v.x + t * v.y + n * v.z; }
  V3f inner(const V3f& v) const { return {v.dot(s), v.dot(t), v.dot(n)}; }
  V3f n, s, t;
};

V3f product(const V3f& a, const V3f& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

mesh::TriangleMesh meshOfArea(const AreaLight& area) {
  const V3f a = area.middle_mm - area.half_u_mm - area.half_v_mm, u = area.half_u_mm * 2.0f,
            v = area.half_v_mm * 2.0f;
  return mesh::meshOfCorners({{a}, {a + u}, {a + u + v}, {a}, {a + u + v}, {a + v}});
}

// Directions through the pixels of a camera.
class View {
 public:
  explicit View(const Camera& camera)
      : ahead_((camera.to_mm - camera.from_mm).normalized()),
        middle_(static_cast<float>(camera.size.width) / 2,
                static_cast<float>(camera.size.height) / 2) {
    const float scale = std::tan(camera.field_of_view_deg * kPi / 360) / middle_.y;
    const V3f right = ahead_.cross(camera.up).normalized();
    across_ = right * scale;
    up_ = right.cross(ahead_) * scale;
  }
  V3f through(float x, float y) const {
    return (ahead_ + across_ * (x - middle_.x) + up_ * (middle_.y - y)).normalized();
  }

 private:
  V3f ahead_, across_, up_;
  mesh::V2f middle_;
};

// Where a ray arrived.
struct Place {
  V3f position, facet;  // the facet on the side the ray came from
  Frame frame;          // as shaded, on that side too
  Reflection reflection;
};

}  // namespace

struct SceneRenderer::State {
  Scene scene;
  std::vector<mesh::TriangleMesh> area_meshes;
  std::optional<mesh::RayScene> rays;

  // Numbers of the meshes, then of the area lights.
  void prepare() {
    std::vector<const mesh::TriangleMesh*> all;
    for (const SceneMesh& part : scene.meshes) all.push_back(part.mesh.get());
    for (const AreaLight& area : scene.areas) area_meshes.push_back(meshOfArea(area));
    for (const mesh::TriangleMesh& area : area_meshes) all.push_back(&area);
    rays.emplace(all);
  }

  Place placeOf(const mesh::RayHit& hit, const V3f& direction) const {
    const SceneMesh& part = scene.meshes[hit.mesh];
    const mesh::TriangleMesh& mesh = *part.mesh;
    const mesh::SurfacePoint at = mesh::pointOn(mesh, hit.triangle, hit.b1, hit.b2);
    const V3f facet = at.facet.dot(direction) < 0 ? at.facet : -at.facet;
    V3f normal = at.normal.dot(facet) > 0 ? at.normal : -at.normal;
    // A smooth normal that looks away from the eye would show a black rim.
    if (normal.dot(direction) > -1e-3f)
      normal = (normal - direction * (normal.dot(direction) + 1e-3f)).normalized();
    mesh::V2f uv(0, 0);
    if (part.material.map) {
      const auto& [a, b, c] = mesh.triangle[hit.triangle];
      uv = mesh.uv[a] * (1 - hit.b1 - hit.b2) + mesh.uv[b] * hit.b1 + mesh.uv[c] * hit.b2;
    }
    return {at.position_mm + facet * rays->clearance_mm(),
            facet,
            Frame(normal),
            {colourAt(part.material, uv), part.material.specular, part.material.roughness}};
  }

  // Light from a direction that is lit from there, through the reflection.
  V3f lit(const Place& at, const V3f& view, const V3f& to, float within_mm) const {
    if (to.dot(at.facet) <= 0) return V3f(0);
    const V3f sent = at.reflection.towards(at.frame.inner(to), view);
    if (!(std::max({sent.x, sent.y, sent.z}) > 0) || rays->isBlocked(at.position, to, within_mm))
      return V3f(0);
    return sent;
  }

  V3f fromSun(const Sun& sun, const Place& at, const V3f& view, std::array<float, 2> p) const {
    const float least = std::cos(sun.angle_deg * kPi / 360), z = 1 - p[0] * (1 - least),
                r = std::sqrt(std::max(0.0f, 1 - z * z)), around = 2 * kPi * p[1];
    const V3f to =
        Frame(sun.direction.normalized()).outer({r * std::cos(around), r * std::sin(around), z});
    return product(sun.irradiance, lit(at, view, to, std::numeric_limits<float>::infinity()));
  }

  V3f fromArea(const AreaLight& area, const Place& at, const V3f& view,
               std::array<float, 2> p) const {
    const V3f cross = area.half_u_mm.cross(area.half_v_mm);
    const V3f way = area.middle_mm + area.half_u_mm * (2 * p[0] - 1) +
                    area.half_v_mm * (2 * p[1] - 1) - at.position;
    const float distance = way.length();
    if (!(distance > 0)) return V3f(0);
    const V3f to = way / distance;
    const float seen = -to.dot(cross) * 4 / (distance * distance);  // solid angle
    if (seen <= 0) return V3f(0);
    return product(area.radiance, lit(at, view, to, distance - 2 * rays->clearance_mm())) * seen;
  }

  V3f directLight(const Place& at, const V3f& view, SamplePoints& points) const {
    V3f sum(0);
    for (const Sun& sun : scene.suns) sum += fromSun(sun, at, view, points.next());
    for (const AreaLight& area : scene.areas) sum += fromArea(area, at, view, points.next());
    return sum;
  }

  V3f alongRay(V3f from, V3f direction, int bounces, SamplePoints& points) const {
    V3f light(0), carried(1, 1, 1);
    for (int depth = 0;; ++depth) {
      const std::optional<mesh::RayHit> hit = rays->nearest(from, direction);
      if (!hit) return light + product(carried, skyRadiance(scene.sky, direction));
      if (hit->mesh >= scene.meshes.size()) {  // a lamp; bounced rays have looked for it already
        const std::size_t area = hit->mesh - scene.meshes.size();
        const bool is_front = area_meshes[area].facetNormal(hit->triangle).dot(direction) < 0;
        return depth == 0 && is_front ? scene.areas[area].radiance : light;
      }
      const Place at = placeOf(*hit, direction);
      const V3f view = at.frame.inner(-direction);
      light += product(carried, directLight(at, view, points));
      const std::array<float, 2> which = points.next(), where = points.next();
      const V3f l = at.reflection.draw(view, which, where);
      const float density = at.reflection.density(l, view);
      direction = at.frame.outer(l);
      if (!(density > 0) || direction.dot(at.facet) <= 0) return light;
      carried = product(carried, at.reflection.towards(l, view) / density);
      if (std::max({carried.x, carried.y, carried.z}) < kDarkest) return light;
      if (depth + 1 == bounces) {  // no further place is lit, but the sky is still seen
        if (rays->isBlocked(at.position, direction)) return light;
        return light + product(carried, skyRadiance(scene.sky, direction));
      }
      from = at.position;
    }
  }
};

void RenderOptions::check() const {
  if (samples < 1 || samples > 65536)
    throw ProcessingError(Exit::kUsage, "a picture takes 1 to 65536 samples a pixel");
  if (bounces < 1 || bounces > 16)
    throw ProcessingError(Exit::kUsage, "light takes 1 to 16 bounces");
}

SceneRenderer::SceneRenderer(Scene scene) : state_(std::make_unique<State>()) {
  scene.check();
  state_->scene = std::move(scene);
  state_->prepare();
}
SceneRenderer::~SceneRenderer() = default;
SceneRenderer::SceneRenderer(SceneRenderer&&) noexcept = default;

Material& SceneRenderer::material(std::size_t mesh) {
  PATINA_CHECK(mesh < state_->scene.meshes.size());
  return state_->scene.meshes[mesh].material;
}

Sun& SceneRenderer::sun(std::size_t i) {
  PATINA_CHECK(i < state_->scene.suns.size());
  return state_->scene.suns[i];
}

Image<float> SceneRenderer::render(const RenderOptions& options, Progress& progress) const {
  options.check();
  state_->scene.check();
  const SizePx size = state_->scene.camera.size;
  Image<float> out(size.width, size.height, 3);
  const int across = (size.width + kTilePx - 1) / kTilePx,
            down = (size.height + kTilePx - 1) / kTilePx;
  progress.begin("rendering", static_cast<std::int64_t>(across) * down);
  const auto n = static_cast<std::uint32_t>(options.samples);
  const View view(state_->scene.camera);
  tbb::parallel_for(0, across * down, [&](int tile) {
    const int x0 = tile % across * kTilePx, y0 = tile / across * kTilePx;
    for (int y = y0; y < std::min(y0 + kTilePx, size.height); ++y)
      for (int x = x0; x < std::min(x0 + kTilePx, size.width); ++x) {
        Imath::V3d sum(0);
        for (std::uint32_t i = 0; i < n; ++i) {
          SamplePoints points(hashSeed(options.seed, x, y), i, n);
          const std::array<float, 2> in_pixel = points.next();
          const V3f to = view.through(static_cast<float>(x) + in_pixel[0],
                                      static_cast<float>(y) + in_pixel[1]);
          sum += Imath::V3d(
              state_->alongRay(state_->scene.camera.from_mm, to, options.bounces, points));
        }
        for (int c = 0; c < 3; ++c)
          out.at(x, y, c) = static_cast<float>(sum[static_cast<unsigned>(c)] / n);
      }
    progress.step();
  });
  return out;
}

}  // namespace patina::render
