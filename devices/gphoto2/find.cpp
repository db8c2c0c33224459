// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "devices/gphoto2/applied_settings.h"
#include "devices/gphoto2/connect.h"
#include "devices/gphoto2/gphoto2.h"
#include "devices/gphoto2/health.h"
#include "devices/gphoto2/troubles.h"

namespace patina::devices::gphoto2 {

namespace {

std::string secondsText(Nanoseconds d) {
  char text[32];
  std::snprintf(text, sizeof text, "%+.1f s", toSeconds(d));
  return text;
}

// Not an error of the camera: what cannot be read is left out.
std::optional<Setting> ask(Session& session, const std::string& thing) {
  const auto setting = readAny(session, thing, "found");
  if (!setting) return std::nullopt;
  return setting->second;
}

void addFact(FoundDevice& out, const std::string& name, const std::optional<Setting>& setting) {
  if (setting && !setting->value.empty()) out.facts.emplace_back(name, setting->value);
}

void addChoices(Session& session, FoundDevice& out) {
  for (const auto& [name, thing] :
       std::vector<std::pair<std::string, std::string>>{{"exposures", "exposure"},
                                                        {"iso", "iso"},
                                                        {"f_number", "f_number"},
                                                        {"white_balance", "white_balance"},
                                                        {"format", "format"},
                                                        {"target", "target"}}) {
    const auto setting = ask(session, thing);
    if (!setting) continue;
    addFact(out, name, setting);
    if (!setting->choices.empty()) out.choices.emplace_back(name, setting->choices);
  }
}

std::size_t filesBelow(Session& session, const std::string& folder, int depth) {
  std::size_t files = 0;
  if (const auto here = session.list(folder)) files += here->size();
  if (depth == 0) return files;
  const auto inner = session.listFolders(folder);
  for (const std::string& name : inner ? *inner : std::vector<std::string>{})
    files += filesBelow(session, (folder == "/" ? "" : folder) + "/" + name, depth - 1);
  return files;
}

void addTroubles(FoundDevice& out, std::vector<Trouble> troubles) {
  out.troubles.insert(out.troubles.end(), troubles.begin(), troubles.end());
}

void look(Session& session, FoundDevice& out, Clock& clock) {
  const auto serial = serialOf(session, "found");
  if (serial) out.serial = *serial;
  if (const auto model = ask(session, "model"); model && !model->value.empty())
    out.model = model->value;
  SettingsSeen seen;
  const std::vector<std::string> has = session.settingNames();
  for (const std::string& name : telltaleSettings()) {
    if (std::find(has.begin(), has.end(), name) == has.end()) continue;
    if (auto setting = session.read(name)) seen.emplace(name, std::move(*setting));
  }
  const auto battery = ask(session, "battery");
  addFact(out, "battery", battery);
  addFact(out, "shutter counter", ask(session, "shutter counter"));
  addFact(out, "lens", ask(session, "lens"));
  ClockOffset offset;
  if (measureClock(session, offset, clock))
    out.facts.emplace_back("clock",
                           secondsText(offset.aheadOfUtc(clock.utc(), clock.mono())) + " off UTC");
  const auto cards = session.cards();
  const std::size_t files = filesBelow(session, "/", 3);
  out.facts.emplace_back("files on card", std::to_string(files));
  for (const CardSpace& card : cards ? *cards : std::vector<CardSpace>{})
    out.facts.emplace_back("card '" + card.label + "'", formatBytes(card.free_bytes) + " free of " +
                                                            formatBytes(card.capacity_bytes));
  addChoices(session, out);

  addTroubles(out, troublesOfSettings(seen));
  const auto mains = seen.find("acpower");
  const bool on_mains = mains != seen.end() && lowerCase(mains->second.value) == "on";
  if (battery) addTroubles(out, troublesOfBattery(battery->value, on_mains));
  if (cards) addTroubles(out, troublesOfCards(*cards, files));
  if (meansNothing(out.serial))
    out.troubles.push_back({false, "it says no serial: it can only be the one camera of its rig",
                            "attach no other camera to this machine"});
  out.state = "ready";
}

FoundDevice lookAt(const Attached& where, Clock& clock) {
  FoundDevice out;
  out.kind = "camera";
  out.backend = "gphoto2";
  out.model = where.model;
  out.address = where.port;
  out.serial = usbSerial(where.port);
  const auto node = usbNode(where.port);
  auto session = Session::open(where, where.model);
  if (session) {
    look(**session, out, clock);
  } else if (node && !mayOpen(*node)) {
    out.state = "no permission";
    out.troubles.push_back(noPermission(node->string()));
  } else if (node && session.error().code == Errc::kBusy) {
    out.state = "busy";
    out.troubles.push_back(heldByOthers(holdersOf(*node)));
  } else {
    out.state = "silent";
    out.troubles.push_back({true, session.error().what,
                            node ? "switch it off and on; try another cable and port"
                                 : "check its address, that its Wi-Fi is on, that no other program "
                                   "is connected to it"});
  }
  addTroubles(out, troublesOfLibrary(libraryVersion()));
  return out;
}

}  // namespace

std::vector<FoundDevice> find(Clock& clock) { return find({}, clock); }

std::vector<FoundDevice> find(const std::vector<CameraSpec>& cameras, Clock& clock) {
  std::vector<Attached> places = attachedOnUsb();
  for (const CameraSpec& camera : cameras) {
    if (camera.backend != "gphoto2") continue;
    const std::vector<Attached> network = readCameraSettings(camera, {}).addresses;
    places.insert(places.end(), network.begin(), network.end());
  }
  std::vector<FoundDevice> found;
  found.reserve(places.size());
  for (const Attached& place : places) found.push_back(lookAt(place, clock));
  findTwins(found);
  return found;
}

}  // namespace patina::devices::gphoto2
