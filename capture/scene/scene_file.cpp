// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/scene/scene_file.h"

#include <cmath>
#include <string>
#include <utility>

#include "devices/config_file.h"
#include "processing/image/picture_file.h"
#include "processing/mesh/mesh_file.h"
#include "processing/mesh/shapes.h"

namespace patina::scene {
namespace {

using devices::ConfigTable;
using mesh::V3f;

constexpr double kFar = 1e6;     // mm
constexpr double kBright = 1e6;  // of light, where 1 makes a white surface white
constexpr double kStopsMost = 20;

V3f takeVector(ConfigTable& table, const std::string& key, std::optional<V3f> fallback = {}) {
  std::optional<std::vector<double>> numbers;
  if (fallback) numbers = std::vector<double>{fallback->x, fallback->y, fallback->z};
  const std::vector<double> v = table.takeNumbers(key, 3, numbers);
  for (const double one : v)
    if (std::abs(one) > kFar) table.reject(key, "holds a number beyond 1e6");
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

// One number for grey, or three.
V3f takeLight(ConfigTable& table, const std::string& key, double most,
              std::optional<V3f> fallback = {}) {
  if (fallback && !table.has(key)) return *fallback;
  std::vector<double> v = table.takeNumbers(key, 0);
  if (v.size() == 1) v.resize(3, v[0]);
  if (v.size() != 3) table.reject(key, "has one number, for grey, or three: red, green, blue");
  for (const double one : v)
    if (!(one >= 0 && one <= most)) {
      const std::string text = std::to_string(most);
      table.reject(key, "holds " + std::to_string(one) + "; allowed: 0 to " +
                            text.substr(0, text.find('.')));
    }
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

std::optional<double> takeStops(ConfigTable& table, const std::string& key) {
  if (!table.has(key)) return std::nullopt;
  return table.takeNumber(key, -kStopsMost, kStopsMost);
}

render::Camera takeCamera(ConfigTable& root) {
  render::Camera camera;
  camera.size = root.takeSize("size", 1, 16384, SizePx{640, 480});
  auto table = root.takeTable("camera");
  if (!table) return camera;
  camera.from_mm = takeVector(*table, "from_mm");
  camera.to_mm = takeVector(*table, "to_mm", V3f(0, 0, 0));
  camera.up = takeVector(*table, "up", V3f(0, 0, 1));
  camera.field_of_view_deg =
      static_cast<float>(table->takeNumber("field_of_view_deg", 0.01, 170, 35));
  table->finish();
  return camera;
}

void takeSuns(ConfigTable& root, SceneFile& out) {
  for (ConfigTable& table : root.takeTables("sun")) {
    render::Sun sun;
    std::optional<workflow::MovingLamp> path;
    sun.angle_deg = static_cast<float>(table.takeNumber("angle_deg", 0, 90, 0.53));
    sun.irradiance = takeLight(table, "irradiance", kBright);
    if (table.has("path")) {
      try {
        path = workflow::MovingLamp::parse(table.takeString("path"), true);
      } catch (const Failure& error) {
        table.reject("path", error.what());
      }
      path->radius = sun.angle_deg / 2.0;
    } else {
      sun.direction = takeVector(table, "direction");
    }
    table.finish();
    out.scene.suns.push_back(sun);
    out.sun_paths.push_back(path);
  }
}

void takeLamps(ConfigTable& root, render::Scene& scene) {
  for (ConfigTable& table : root.takeTables("area")) {
    render::AreaLight area;
    area.middle_mm = takeVector(table, "middle_mm");
    area.half_u_mm = takeVector(table, "half_u_mm");
    area.half_v_mm = takeVector(table, "half_v_mm");
    area.radiance = takeLight(table, "radiance", kBright);
    table.finish();
    scene.areas.push_back(area);
  }
  auto sky = root.takeTable("sky");
  if (!sky) return;
  if (sky->has("picture")) {
    scene.sky.picture =
        std::make_shared<Image<float>>(readPicture(sky->takePath("picture")).linear);
    scene.sky.picture_gain =
        static_cast<float>(std::exp2(takeStops(*sky, "gain_stops").value_or(0)));
  } else {
    scene.sky.zenith = takeLight(*sky, "zenith", kBright);
    scene.sky.horizon = takeLight(*sky, "horizon", kBright, scene.sky.zenith);
    scene.sky.ground = takeLight(*sky, "ground", kBright, V3f(0, 0, 0));
  }
  sky->finish();
}

mesh::TriangleMesh takeShape(ConfigTable& table) {
  const std::string shape = table.takeChoice("shape", {"plane", "ball", "cylinder"});
  if (shape == "plane") {
    const std::vector<double> size = table.takeNumbers("size_mm", 2);
    return mesh::planeMesh(size[0], size[1]);
  }
  const double radius = table.takeNumber("radius_mm", 1e-3, kFar);
  if (shape == "ball") return mesh::sphereMesh(radius, 128);
  return mesh::cylinderMesh(radius, table.takeNumber("height_mm", 1e-3, kFar), 256);
}

std::shared_ptr<const mesh::TriangleMesh> takeMesh(ConfigTable& table) {
  mesh::Placement where;
  where.turn_deg = takeVector(table, "turn_deg", V3f(0, 0, 0));
  where.move_mm = takeVector(table, "move_mm", V3f(0, 0, 0));
  where.scale = static_cast<float>(table.takeNumber("scale", 1e-6, 1e6, 1));
  if (!table.has("file"))
    return std::make_shared<mesh::TriangleMesh>(placed(takeShape(table), where));
  const double mm_per_unit = table.takeNumber("mm_per_unit", 0, 1e9, 0);
  return std::make_shared<mesh::TriangleMesh>(
      placed(mesh::readMesh(table.takePath("file"), {mm_per_unit}), where));
}

std::optional<workflow::MovingLamp> takeFormulaLamp(ConfigTable& table) {
  for (const bool directional : {true, false}) {
    const std::string key = directional ? "light" : "lamp";
    if (!table.has(key)) continue;
    try {
      auto lamp = workflow::MovingLamp::parse(table.takeString(key), directional);
      lamp.radius = table.takeNumber("lamp_radius", 0, kFar, 0);
      return lamp;
    } catch (const devices::ConfigError&) {
      throw;
    } catch (const Failure& error) {
      table.reject(key, error.what());
    }
  }
  return std::nullopt;
}

Ageing takeAgeing(ConfigTable& table) {
  Ageing out;
  out.ttf = table.takePath("ttf");
  out.control.rate = table.takeString("rate", "");
  out.control.start = table.takeString("start", "");
  if (table.has("map")) out.control.map = table.takePath("map");
  out.control.lamp = takeFormulaLamp(table);
  out.raw = table.takeBool("raw", false);
  const std::string between =
      table.takeChoice("between", {"nearest", "linear", "monotone"}, "monotone");
  out.between = between == "nearest"  ? ttf::Between::kNearest
                : between == "linear" ? ttf::Between::kLinear
                                      : ttf::Between::kMonotone;
  out.gain_stops = takeStops(table, "gain_stops");
  return out;
}

void takeMeshes(ConfigTable& root, SceneFile& out) {
  int number = 0;
  for (ConfigTable& table : root.takeTables("mesh")) {
    render::SceneMesh part;
    part.name = table.takeString("name", "mesh " + std::to_string(++number));
    part.mesh = takeMesh(table);
    render::Material& material = part.material;
    material.repeat = static_cast<float>(table.takeNumber("repeat", 0.01, 1e4, 1));
    material.specular = static_cast<float>(table.takeNumber("specular", 0, 1, 0));
    material.roughness = static_cast<float>(table.takeNumber("roughness", 0.03, 1, 0.3));
    std::optional<Ageing> ageing;
    if (table.has("ttf")) {
      ageing = takeAgeing(table);
      const bool is_controlled = !ageing->control.rate.empty() || !ageing->control.start.empty() ||
                                 !ageing->control.map.empty();
      if (material.repeat != 1 && is_controlled)
        table.reject("repeat", "must be 1 where places age at a pace of their own");
    } else if (table.has("picture")) {
      material.map = std::make_shared<Image<float>>(readPicture(table.takePath("picture")).linear);
      material.map_gain = static_cast<float>(std::exp2(takeStops(table, "gain_stops").value_or(0)));
    } else {
      material.colour = takeLight(table, "colour", 1, material.colour);
    }
    table.finish();
    out.scene.meshes.push_back(std::move(part));
    out.ageing.push_back(std::move(ageing));
  }
}

// What formulas ask after: the mesh itself, the others' shadows, the first sun unless told.
void tellSurroundings(SceneFile& out) {
  for (std::size_t i = 0; i < out.ageing.size(); ++i) {
    if (!out.ageing[i]) continue;
    workflow::TimeControl& control = out.ageing[i]->control;
    for (std::size_t j = 0; j < out.scene.meshes.size(); ++j)
      if (j == i)
        control.mesh = out.scene.meshes[j].mesh;
      else
        control.casters.push_back(out.scene.meshes[j].mesh);
    if (control.lamp || out.scene.suns.empty()) continue;
    const render::Sun& sun = out.scene.suns[0];
    control.lamp = out.sun_paths[0];
    if (!control.lamp)
      control.lamp =
          workflow::MovingLamp{true,
                               {std::to_string(sun.direction.x), std::to_string(sun.direction.y),
                                std::to_string(sun.direction.z)},
                               sun.angle_deg / 2.0};
  }
}

}  // namespace

SceneFile readScene(const std::filesystem::path& file) {
  ConfigTable root = devices::ConfigFile::read(file);
  SceneFile out;
  out.path = file;
  out.scene.camera = takeCamera(root);
  out.options.samples = static_cast<int>(root.takeInteger("samples", 1, 65536, 64));
  out.options.bounces = static_cast<int>(root.takeInteger("bounces", 1, 16, 3));
  out.exposure_stops = takeStops(root, "exposure_stops");
  takeSuns(root, out);
  takeLamps(root, out.scene);
  takeMeshes(root, out);
  root.finish();
  tellSurroundings(out);
  for (std::size_t i = 0; i < out.scene.meshes.size(); ++i)
    if (out.ageing[i] && out.scene.meshes[i].mesh->uv.empty())
      throw devices::ConfigError(file, 0, out.scene.meshes[i].name,
                                 "has a texture, but no texture coordinates: unwrap it in a "
                                 "modelling program");
  try {
    out.scene.check();
  } catch (const ProcessingError& error) {
    throw devices::ConfigError(file, 0, "", error.what());
  }
  return out;
}

}  // namespace patina::scene
