// SPDX-License-Identifier: GPL-3.0-or-later
// What a camera is told to be, and whether it is. Every setting is read back after it was set; what
// does not stick is refused, naming asked and got.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "devices/camera.h"
#include "devices/gphoto2/camera_settings.h"
#include "devices/gphoto2/session.h"

namespace patina::devices::gphoto2 {

// The names that makers have for one thing, best first.
const std::vector<std::string>& namesFor(const std::string& thing);
// The first of them this camera has, with its setting; kUnsupported when it has none.
Result<std::pair<std::string, Setting>> readAny(Session& session, const std::string& thing,
                                                const std::string& who);

class AppliedSettings {
 public:
  AppliedSettings(const CameraSettings& wanted, std::string who);

  // Target, format, white balance and the free ones. What already is as asked is not set again.
  Result<void> applyFixed(Session& session);
  // Those, then the exposure.
  Result<Applied> apply(Session& session, const Exposure& exposure);
  // What the camera is set to now; of `fallback` what it does not tell.
  Result<Exposure> present(Session& session, const Exposure& fallback) const;
  // All of them once more: kRefused when one has changed since.
  Result<void> verify(Session& session) const;
  void forget() { in_force_.clear(); }  // another session: it may be anything now

 private:
  using Match = Result<std::string>;
  Result<void> ensure(Session& session, const std::string& name, const Setting& now,
                      const std::string& value);
  Result<std::string> ensureThing(Session& session, const std::string& thing,
                                  const std::function<Match(const Choices&)>& match);
  Result<void> applyTarget(Session& session);
  tl::unexpected<Error> changed(const std::string& name, const std::string& was,
                                const std::string& is) const;

  const CameraSettings& wanted_;
  std::string who_;
  std::map<std::string, std::string> in_force_;  // name and value, as read back
};

// Does a picture's own account of its exposure agree? Makers round: a sixth of a stop is allowed.
bool agrees(double told, double applied);

}  // namespace patina::devices::gphoto2
