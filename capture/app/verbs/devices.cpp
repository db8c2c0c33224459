// SPDX-License-Identifier: GPL-3.0-or-later
// patina devices: what is attached, what it can do, and what is wrong with it.
#include "capture/app/context.h"
#include "capture/app/rig/attached.h"
#include "capture/app/verbs/verbs.h"

namespace patina::app {
namespace {

constexpr Nanoseconds kLimit = std::chrono::seconds(20);

std::vector<std::string> linesOf(const devices::FoundDevice& device) {
  std::vector<std::string> lines;
  for (const devices::Trouble& trouble : device.troubles)
    lines.push_back(trouble.what + ": " + trouble.do_this);
  return lines;
}

rig::Attached look(Context& context) {
  context.progress.status("looking for devices");
  rig::Attached attached = rig::findAll(kLimit);
  context.progress.clear();
  for (const auto& [backend, why] : attached.failures)
    context.warn("backend " + backend + " could not look: " + why);
  return attached;
}

void list(Context& context) {
  const rig::Attached attached = look(context);
  for (const devices::FoundDevice& d : attached.devices) {
    const std::vector<std::string> troubles = linesOf(d);
    context.out.add(std::move(
        Item()
            .set("kind", d.kind.c_str())
            .set("backend", d.backend.c_str())
            .set("model", d.model.c_str())
            .set("serial", d.serial.c_str())
            .set("address", d.address.c_str())
            .set("state", d.state.c_str())
            .set("troubles", Value{troubles}, troubles.empty() ? "-" : troubles.front())));
  }
  if (attached.devices.empty())
    context.out.say(
        "Nothing is attached that Patina knows; `patina doctor` says what may be in "
        "its way.");
}

Item detailsOf(const devices::FoundDevice& d) {
  Item item;
  item.set("kind", d.kind.c_str())
      .set("backend", d.backend.c_str())
      .set("model", d.model.c_str())
      .set("serial", d.serial.c_str())
      .set("address", d.address.c_str())
      .set("state", d.state.c_str());
  for (const auto& [key, value] : d.facts) item.set(key, value.c_str());
  for (const auto& [key, values] : d.choices) item.set(key + " choices", Value{values});
  item.set("troubles", Value{linesOf(d)});
  return item;
}

void show(Context& context, const std::string& id) {
  const rig::Attached attached = look(context);
  std::string there;
  for (const devices::FoundDevice& d : attached.devices) {
    if (d.serial == id || d.address == id) {
      context.out.asList();
      context.out.add(detailsOf(d));
    }
    there += (there.empty() ? "" : ", ") + (d.serial.empty() ? d.address : d.serial);
  }
  if (context.out.empty())
    throw AppError(Exit::kUnavailable, "no device '" + id + "'; there are: " +
                                           (there.empty() ? std::string("none") : there));
}

}  // namespace

void addDevicesVerbs(Verb root) {
  Verb group = root.group("devices", "What is attached, and what is wrong with it");
  group.byDefault([](Context& context) { list(context); });
  auto id = std::make_shared<std::string>();
  group
      .verb("show", "Everything a device says of itself: settings, choices, troubles",
            "patina devices show 0123456789", [id](Context& context) { show(context, *id); })
      .required("ID", *id, "Its serial number or address");
}

}  // namespace patina::app
