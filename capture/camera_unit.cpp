// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/camera_unit.h"

#include <algorithm>
#include <cmath>

namespace patina::capture {
namespace {

using namespace std::chrono_literals;

bool close(double asked, double applied) {
  return std::abs(applied - asked) <= 0.01 * std::abs(asked);
}

bool taken(const devices::Exposure& asked, const devices::Exposure& applied) {
  return close(toSeconds(asked.time), toSeconds(applied.time)) &&
         close(asked.iso.value, applied.iso.value) &&
         close(asked.f_number.value, applied.f_number.value);
}

}  // namespace

CameraUnit::CameraUnit(devices::Camera& camera, std::optional<RectPx> patch)
    : camera_(camera), frames_(camera.caps(), patch) {}

devices::Result<void> CameraUnit::prepare(const devices::Exposure& exposure) {
  if (wanted_) {
    configured_.reset();
    if (auto up = camera_.recover(*wanted_); !up) return tl::make_unexpected(up.error());
    wanted_.reset();
  }
  if (configured_ == exposure) return {};
  const auto applied = camera_.configure(exposure);
  if (!applied) return tl::make_unexpected(applied.error());
  if (!taken(exposure, applied->exposure))
    return devices::fail(devices::Errc::kRefused, "camera '" + id() + "': asked for " +
                                                      formatExposure(exposure.time) + ", it set " +
                                                      formatExposure(applied->exposure.time));
  configured_ = exposure;
  return {};
}

Nanoseconds CameraUnit::shotTime(const devices::Exposure& exposure) const {
  return exposure.time + caps().cycle;
}

MonoTime CameraUnit::collectBy(const devices::Exposure& exposure, MonoTime now,
                               MonoTime slot_end) const {
  const MonoTime generous = now + shotTime(exposure) + caps().cycle + 5s;
  const MonoTime least = now + shotTime(exposure) + 500ms;
  return std::max(least, std::min(generous, slot_end));
}

void CameraUnit::failed(const devices::Error& error) {
  ladder_.failed(error);
  wanted_ = ladder_.rung();
}

void CameraUnit::succeeded() { ladder_.succeeded(); }

void CameraUnit::newStep() {
  if (ladder_.down()) wanted_ = ladder_.rungWhileDown();
}

}  // namespace patina::capture
