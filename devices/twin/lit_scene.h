// SPDX-License-Identifier: GPL-3.0-or-later
// What one camera sees under each lamp: specimen, shadows, targets and grey patch, for one pose of
// the camera and of the specimen, at one time of the process.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "devices/twin/relief_shadow.h"
#include "devices/twin/scene_target.h"
#include "devices/twin/shading.h"
#include "devices/twin/specimen_pose.h"
#include "devices/twin/twin.h"
#include "devices/twin/world.h"

namespace patina::devices::twin {

// Border of near-black card around the grey patch.
int patchBorderPx(const RectPx& patch);
// Where a bumped camera sees it; may reach beyond the picture.
RectPx patchInPicture(const PictureLayout& layout, const CameraPose& pose, double mm_per_px);
// The card of the grey patch and its border: reflectance a pixel, below 0 where the specimen shows.
std::vector<float> patchCard(const PictureLayout& layout, const PatchProfile& profile,
                             const CameraPose& pose, double mm_per_px);

// Thread-bound. Keeps lamp fields and pictures between calls.
class LitScene {
 public:
  LitScene(const World& world, const PictureLayout& layout, const CameraPose& camera,
           const SpecimenPose& specimen);
  LitScene(const LitScene&) = delete;
  LitScene& operator=(const LitScene&) = delete;

  const CameraPose& cameraPose() const { return camera_; }
  const SpecimenPose& specimenPose() const { return specimen_; }
  const SampleGrid& grid() const { return view_.ground(); }
  std::size_t lampCount() const { return lamps_.size(); }
  // Where a lamp stands from here on; at first, where the rig has it.
  void placeLamp(std::size_t i, const LampPlace& place);
  const LampPlace& lampPlace(std::size_t i) const { return lamps_[i].place; }

  // Renders what is lit: [h][w] a lamp at level 1, in units of a white diffuser in the middle of
  // the specimen. `time` is the share of the process. Lamps that stay dark cost nothing; the
  // specimen is made older only when the time is another.
  void render(double time, const std::vector<bool>& lit);
  const std::vector<float>& lamp(std::size_t i) const { return lamps_[i].light; }
  // A lamp that moves, as the sun does, at the time rendered last.
  std::vector<float> under(const LampPlace& place) const;
  // Light of level 1 from all sides, at the time rendered last.
  std::vector<float> underSky() const;
  // What a white card that lies flat over everything reflects of a lamp.
  std::vector<float> whiteCard(const LampPlace& place) const;

 private:
  struct LampPicture {
    LampPlace place;
    std::unique_ptr<LampField> field;  // absent until the lamp is lit for the first time
    std::vector<float> light;
    bool fresh = false;  // of the time rendered last
  };
  void age(double time);
  std::vector<float> reliefHeights(double time) const;
  void shade(const LampPlace& place, const LampField& field, std::vector<float>& light) const;

  const World& world_;
  PictureLayout layout_;
  CameraPose camera_;
  SpecimenPose specimen_;
  CameraView view_;
  SampleGrid places_;  // on the specimen
  std::shared_ptr<const PreparedSurface> surface_;
  std::vector<SurfaceRow> rows_;  // of the time rendered last
  std::optional<ReliefShadow> relief_;
  SampleGrid relief_places_;
  std::shared_ptr<const PreparedSurface> relief_surface_;
  std::optional<GridReader> relief_reader_;
  TargetPixels targets_;
  std::vector<float> card_;
  double time_ = -1;
  bool keep_fields_;
  std::vector<LampPicture> lamps_;
};

}  // namespace patina::devices::twin
