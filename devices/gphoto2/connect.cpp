// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/connect.h"

#include <algorithm>
#include <vector>

#include "devices/gphoto2/applied_settings.h"
#include "devices/gphoto2/usb_bus.h"

namespace patina::devices::gphoto2 {

namespace {

using namespace std::chrono_literals;

using Opened = Result<std::unique_ptr<Session>>;

// Another process that looks for its own camera holds this one for less than that.
constexpr int kClaimTries = 4;
constexpr Nanoseconds kClaimPause = 250ms;

Opened openPatiently(const Attached& where, const std::string& who, Clock& clock) {
  for (int i = 1;; ++i) {
    auto session = Session::open(where, who);
    if (session || session.error().code != Errc::kBusy || i == kClaimTries) return session;
    clock.sleepUntil(clock.mono() + kClaimPause, {});
  }
}

Error heldBy(const Error& error, const Attached& where) {
  const auto node = usbNode(where.port);
  if (!node) return error;
  if (!mayOpen(*node))
    return {Errc::kLost, error.what + ": no permission for " + node->string() +
                             ": install packaging/udev's rules and join the group they name"};
  if (error.code != Errc::kBusy) return error;
  return {Errc::kBusy, error.what + ": held by " + describe(holdersOf(*node))};
}

std::string named(const Attached& camera, const std::string& serial) {
  return camera.model + " at " + camera.port + (serial.empty() ? "" : " (serial " + serial + ")");
}

// Where to look, the likeliest first.
std::vector<Attached> candidates(const CameraSettings& wanted) {
  std::vector<Attached> places = wanted.addresses;
  if (places.empty()) places = attachedOnUsb();
  if (!wanted.model.empty())
    std::erase_if(places, [&](const Attached& a) {
      return a.port.starts_with("usb:") &&
             lowerCase(a.model).find(lowerCase(wanted.model)) == std::string::npos;
    });
  std::stable_partition(places.begin(), places.end(), [&](const Attached& a) {
    return !wanted.serial.empty() && sameSerial(usbSerial(a.port), wanted.serial);
  });
  return places;
}

std::string listedPlaces(const std::vector<Attached>& places) {
  std::string text;
  for (const Attached& place : places)
    text += (text.empty() ? "" : ", ") + named(place, usbSerial(place.port));
  return text.empty() ? "nothing: is it on, is its cable in?" : text;
}

Opened connectOnly(const std::vector<Attached>& places, const std::string& who, Clock& clock) {
  if (places.size() > 1)
    return fail(Errc::kRefused, "camera '" + who +
                                    "': several are attached and the rig file names no serial; "
                                    "add serial = \"...\" of one of: " +
                                    listedPlaces(places));
  auto session = openPatiently(places.front(), who, clock);
  if (!session) return tl::make_unexpected(heldBy(session.error(), places.front()));
  return session;
}

}  // namespace

Result<std::string> serialOf(Session& session, const std::string& who) {
  const auto serial = readAny(session, "serial", who);
  if (!serial) {
    if (serial.error().code == Errc::kUnsupported) return std::string();
    return tl::make_unexpected(serial.error());
  }
  return meansNothing(serial->second.value) ? std::string() : serial->second.value;
}

Opened connect(const CameraSettings& wanted, const std::string& who, Clock& clock) {
  const std::vector<Attached> places = candidates(wanted);
  if (places.empty())
    return fail(Errc::kLost, "camera '" + who + "': no " +
                                 (wanted.model.empty() ? "camera" : wanted.model) +
                                 " is attached; there is: " + listedPlaces(attachedOnUsb()));
  if (wanted.serial.empty()) return connectOnly(places, who, clock);

  std::string others;
  std::optional<Error> in_the_way;
  bool nameless = false;
  for (const Attached& place : places) {
    auto session = openPatiently(place, who, clock);
    if (!session) {
      if (!in_the_way) in_the_way = heldBy(session.error(), place);
      continue;
    }
    const auto serial = serialOf(**session, who);
    if (!serial) {
      if (!in_the_way) in_the_way = serial.error();
      continue;
    }
    if (sameSerial(*serial, wanted.serial) && !serial->empty()) return session;
    nameless |= serial->empty();
    others += (others.empty() ? "" : ", ") + named(place, *serial);
  }
  if (others.empty() && in_the_way) return tl::make_unexpected(*in_the_way);
  return fail(nameless ? Errc::kRefused : Errc::kLost,
              "camera '" + who + "': no camera with serial " + wanted.serial +
                  " is there; there are: " + others +
                  (in_the_way ? "; and " + in_the_way->what : "") +
                  (nameless ? "; a camera that tells no serial cannot be told apart" : ""));
}

}  // namespace patina::devices::gphoto2
