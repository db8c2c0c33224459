// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/system/reflectance_dome.h"

#include <algorithm>
#include <cmath>

#include "devices/twin/specimen.h"
#include "devices/twin/twin.h"

namespace patina::testing {
namespace {

namespace twin = devices::twin;

constexpr double kReachDeg = 72, kGolden = 2.399963229728653;
constexpr int kCardBelowPx = 3;  // within the patch's border
constexpr int kRun = 18000;      // s, whatever the steps: a sweep takes the same part of it

std::string cardText(const Loop& loop, Card card) {
  const double width_mm = 1.5 * viewMm(loop);
  double bottom_mm = -width_mm / 2;
  if (card == Card::kBesideThePatch) {
    const devices::RigSpec rig = wholeRig(loop, false);
    const twin::PictureLayout layout = twin::pictureLayout(rig, rig.cameras.front());
    const RectPx& specimen = layout.specimen_px;
    bottom_mm = viewMm(loop) / layout.size.width *
                (layout.size.height / 2.0 - specimen.y - specimen.height - kCardBelowPx);
  }
  return "[[twin.target]]\nkind = \"grey_card\"\nreflectance = " +
         std::to_string(kCardReflectance) + "\nwidth_mm = " + std::to_string(width_mm) +
         "\nposition_mm = [0.0, " + std::to_string(bottom_mm + width_mm / 2) + ", 0.0]\n";
}

}  // namespace

std::string idOf(int lamp) { return (lamp < 10 ? "l0" : "l") + std::to_string(lamp); }

int intervalOf(const Loop& loop) { return kRun / loop.steps; }

int lampsOf(const Loop& loop) { return loop.lights + loop.left_out; }

bool isLeftOut(const Loop& loop, int lamp) {
  if (loop.left_out == 0) return false;
  const int period = lampsOf(loop) / loop.left_out;
  return lamp % period == period / 2 && lamp / period < loop.left_out;
}

double viewMm(const Loop& loop) {
  return twin::makeSpecimen(loop.specimen, 1)->info().width_mm / loop.closer;
}

std::string rigText(const Loop& loop, Card card, bool all) {
  const std::string side = std::to_string(loop.side_px);
  std::string text =
      "name = \"dome\"\n[[camera]]\nid = \"cam0\"\nbackend = \"twin\"\n"
      "settings = { format = \"dng\", view_mm = " +
      std::to_string(viewMm(loop)) + " }\n";
  for (int i = 0; i < lampsOf(loop); ++i) {
    if (!all && isLeftOut(loop, i)) continue;
    const double z = 1 - (1 - std::cos(kReachDeg * M_PI / 180)) * (i + 0.5) / lampsOf(loop);
    const double s = std::sqrt(1 - z * z);
    text += "[[light]]\nid = \"" + idOf(i) + "\"\nbackend = \"twin\"\nposition_mm = [" +
            std::to_string(kDistanceMm * s * std::cos(i * kGolden)) + ", " +
            std::to_string(kDistanceMm * s * std::sin(i * kGolden)) + ", " +
            std::to_string(kDistanceMm * z) + "]\nsettings = { kind = \"led\", radius_mm = 4.0 }\n";
  }
  text += "[twin]\nspecimen = \"" + loop.specimen + "\"\nsize = \"" + side + "x" + side +
          "\"\nshadows = " + (loop.shadows && !all ? "true" : "false") + "\n";
  if (card != Card::kNone) return text + cardText(loop, card);
  return loop.bump_px > 0 && !all ? text + "faults = \"faults.toml\"\n" : text;
}

std::string bumpText(const Loop& loop) {
  return "[[fault]]\nat = \"" + std::to_string(intervalOf(loop) * (2 * (loop.steps / 2) - 1) / 2) +
         "s\"\ndevice = \"cam0\"\nkind = \"camera_bumped\"\namount = " +
         std::to_string(loop.bump_px * viewMm(loop) / loop.side_px) + "\n";
}

std::string planText(const Loop& loop, const std::string& rig, const std::string& specimen,
                     int steps, const std::string& rest) {
  std::string lights;
  for (int i = 0; i < lampsOf(loop); ++i)
    if (!isLeftOut(loop, i)) lights += (lights.empty() ? "[\"" : ", [\"") + idOf(i) + "\"]";
  std::string exposures = "\"1/50\"";
  for (int i = 1; i < loop.frames; ++i) exposures += ", \"1/50\"";
  return "rig = \"" + rig + "\"\nspecimen = \"" + specimen + "\"\nseed = 1\ninterval = \"" +
         std::to_string(intervalOf(loop)) + "s\"\nduration = \"" +
         std::to_string(steps * intervalOf(loop)) + "s\"\n[[sweep]]\nlights = [" + lights +
         "]\nexposures = [" + exposures + "]\n" + rest;
}

std::string noisePlanText(const std::string& rig) {
  return "rig = \"" + rig +
         "\"\nspecimen = \"card\"\nseed = 2\ninterval = \"60s\"\nduration = \"240s\"\n"
         "[[sweep]]\nlights = [[\"" +
         idOf(0) +
         "\"]]\nexposures = [\"1/50\", \"1/100\", \"1/200\", \"1/400\"]\n"
         "[[sweep]]\nlights = [[]]\nexposures = [\"1/50\"]\n"
         "[light_check]\nmode = \"uncontrolled\"\n";
}

std::string plainName(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

devices::RigSpec wholeRig(const Loop& loop, bool shadows) {
  devices::RigSpec rig = devices::parseRig(rigText(loop, Card::kNone, true), "rig.toml");
  rig.twin->shadows = shadows;
  return rig;
}

}  // namespace patina::testing
