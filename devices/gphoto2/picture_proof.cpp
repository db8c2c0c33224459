// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/picture_proof.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

namespace patina::devices::gphoto2 {

namespace {

using namespace std::chrono_literals;

constexpr std::size_t kFilesMost = 1024;
constexpr Nanoseconds kZoneStep = 15min;
constexpr Nanoseconds kForgotten = 20s;  // no camera writes a picture that long after

struct NumberedName {
  std::string series;  // folder and prefix
  long number = 0;
};

// "/store_00010001/DCIM/100NIKON", "DSC_0042.NEF" -> ".../DSC_", 42.
std::optional<NumberedName> numbered(const CardFile& file) {
  if (file.folder.find("DCIM") == std::string::npos) return std::nullopt;
  const std::string stem = file.stem();
  std::size_t begin = stem.size();
  while (begin > 0 && std::isdigit(static_cast<unsigned char>(stem[begin - 1])) != 0) --begin;
  if (begin == stem.size() || stem.size() - begin > 9) return std::nullopt;
  return NumberedName{file.folder + "/" + stem.substr(0, begin),
                      std::strtol(stem.c_str() + begin, nullptr, 10)};
}

}  // namespace

void SeenNames::note(const CardFile& file) {
  if (const auto name = numbered(file)) {
    long& highest = highest_.try_emplace(name->series, name->number).first->second;
    highest = std::max(highest, name->number);
  }
  if (!files_.insert(file.path()).second) return;
  in_order_.push_back(file.path());
  if (in_order_.size() <= kFilesMost) return;
  files_.erase(in_order_.front());
  in_order_.pop_front();
}

void SeenNames::erased(const CardFile& file) { files_.erase(file.path()); }

bool SeenNames::rises(const CardFile& file) const {
  const auto name = numbered(file);
  if (!name) return true;
  const auto known = highest_.find(name->series);
  return known == highest_.end() || name->number >= known->second;
}

Proof judge(const ClockOffset::Span& taken, const ShotWindow& window) {
  if (taken.latest < window.told) return Proof::kEarlier;
  if (taken.earliest > window.arrived) return Proof::kLater;
  if (window.fence && taken.earliest <= *window.fence) return Proof::kUncertain;
  return Proof::kOurs;
}

// The picture of a trigger at t may read as early as t - width - resolution.
MonoTime tellableFrom(MonoTime fence, const ClockOffset& offset, Nanoseconds resolution) {
  if (!offset.known()) return fence;
  return fence + offset.width(fence) + resolution + 1ms;
}

void TimeResolution::observe(UtcTime shown) {
  const auto fraction = shown.time_since_epoch() % 1s;
  const Nanoseconds step = fraction == 0s            ? Nanoseconds(1s)
                           : fraction % 100ms == 0ms ? Nanoseconds(100ms)
                           : fraction % 10ms == 0ms  ? Nanoseconds(10ms)
                                                     : Nanoseconds(1ms);
  value_ = value_ ? std::min(*value_, step) : step;
}

MonoTime PictureJudge::tellable() const {
  return fence_ ? tellableFrom(*fence_, offset, resolution_.value()) : MonoTime{};
}

// The camera's clock as it was shown then. A picture that names its zone tells UTC: the zone is
// what makes it fit, and stays.
std::optional<UtcTime> PictureJudge::shownBy(const PictureMetadata& picture, MonoTime at) const {
  if (!picture.taken_utc) return std::nullopt;
  if (!picture.has_utc_offset || !offset.known()) return picture.taken_utc;
  if (zone_) return *picture.taken_utc + *zone_;
  const auto apart = offset.when(*picture.taken_utc, {}, at).latest - at;
  const double zones = std::round(toSeconds(-apart) / toSeconds(kZoneStep));
  return *picture.taken_utc + kZoneStep * static_cast<long>(zones);
}

Proof PictureJudge::judge(const PictureMetadata& picture, Moment moment, bool rises) {
  const auto shown = shownBy(picture, moment.arrived);
  if (!shown || !offset.known()) {
    const bool long_after = !fence_ || moment.told >= *fence_ + kForgotten;
    return rises && (long_after || !offset.known()) ? Proof::kOurs : Proof::kUncertain;
  }
  resolution_.observe(*shown);
  return gphoto2::judge(offset.when(*shown, resolution_.value(), moment.arrived),
                        {moment.told, moment.arrived, fence_});
}

void PictureJudge::accept(const PictureMetadata& picture, Moment moment) {
  const auto shown = shownBy(picture, moment.arrived);
  if (!shown) return;
  if (picture.has_utc_offset && offset.known()) zone_ = *shown - *picture.taken_utc;
  resolution_.observe(*shown);
  offset.observe(*shown, resolution_.value(), moment.told, moment.arrived);
}

std::optional<MonoTime> PictureJudge::exposedAt(const PictureMetadata& picture,
                                                MonoTime arrived) const {
  const auto shown = shownBy(picture, arrived);
  if (!shown || !offset.known()) return std::nullopt;
  const auto span = offset.when(*shown, resolution_.value(), arrived);
  return span.earliest + (span.latest - span.earliest) / 2;
}

const char* name(Proof proof) {
  switch (proof) {
    case Proof::kOurs:
      return "of this shot";
    case Proof::kEarlier:
      return "exposed before the trigger";
    case Proof::kLater:
      return "of a time that is not yet, by the camera's clock";
    case Proof::kUncertain:
      return "perhaps of a shot that was given up";
  }
  return "?";
}

}  // namespace patina::devices::gphoto2
