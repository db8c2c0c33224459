// SPDX-License-Identifier: GPL-3.0-or-later
// patina twin camera: a virtual DSLR on the wire, until a signal ends it.
#include "capture/app/verbs/twin_camera.h"

#include <cstdio>
#include <optional>
#include <stop_token>

#include "capture/app/context.h"
#include "devices/scaled_clock.h"
#include "devices/twin/dslr/artnet_lamps.h"
#include "devices/twin/dslr/faults_file.h"
#include "devices/twin/dslr/ptpip_server.h"
#include "devices/twin/dslr/world_rig.h"

namespace patina::app {
namespace {

namespace dslr = devices::twin::dslr;
using namespace std::chrono_literals;

struct Options {
  std::string ptpip = "127.0.0.1:0", faults, rig, camera, serial, model;
  int artnet_port = -1;
  std::optional<SizePx> size;
  double speed = 1;
};

struct Place {
  std::string address;
  int port = 0;
};

Place parsePlace(const std::string& text) {
  const auto colon = text.rfind(':');
  Place place{text.substr(0, colon), 0};
  char* end = nullptr;
  const std::string digits = colon == std::string::npos ? "" : text.substr(colon + 1);
  const long port = std::strtol(digits.c_str(), &end, 10);
  if (digits.empty() || *end != '\0' || port < 0 || port > 65535)
    throw AppError(Exit::kUsage, "--ptpip " + text +
                                     " is no address and port, such as 127.0.0.1:15740; port 0 "
                                     "takes any free one");
  place.port = static_cast<int>(port);
  return place;
}

// Two lamps, which are on where nobody is to switch them.
devices::RigSpec usualRig(bool lamps_listen) {
  const std::string between = lamps_listen ? "off" : "on";
  return devices::parseRig(
      "name = 'virtual'\n[[camera]]\nid = 'cam0'\nbackend = 'twin'\n"
      "[[light]]\nid = 'key'\nbackend = 'twin'\nposition_mm = [-200, 200, 400]\nbetween = '" +
          between +
          "'\n[[light]]\nid = 'fill'\nbackend = 'twin'\nposition_mm = [300, 100, 400]\n"
          "between = '" +
          between + "'\n[twin]\nspecimen = 'banana_ripening'\nsize = '512x512'\n",
      "rig");
}

devices::RigSpec rigOf(const Options& options) {
  devices::RigSpec rig =
      options.rig.empty() ? usualRig(options.artnet_port >= 0) : devices::readRig(options.rig);
  if (rig.cameras.empty())
    throw AppError(Exit::kConfig, options.rig + " has no [[camera]] to stand in for");
  if (options.size) {
    if (!rig.twin) rig.twin.emplace();
    rig.twin->size = *options.size;
  }
  return rig;
}

const devices::CameraSpec& cameraOf(const devices::RigSpec& rig, const std::string& id) {
  for (const devices::CameraSpec& camera : rig.cameras)
    if (id.empty() || camera.id == id) return camera;
  throw AppError(Exit::kUsage, "--camera " + id + ": the rig has no such camera; it has '" +
                                   rig.cameras.front().id + "'");
}

void say(const Context& context, const std::string& line) {
  if (!context.options.quiet) std::fprintf(stderr, "%s\n", line.c_str());
}

std::string lineOf(const dslr::TruePicture& picture) {
  std::string line = formatUtc(picture.begin_utc) + " picture " + std::to_string(picture.count) +
                     (picture.stale ? " again" : "") + ": " + formatExposure(picture.exposure.time);
  char text[64];
  std::snprintf(text, sizeof text, " f/%g ISO %g, lamps", picture.exposure.f_number.value,
                picture.exposure.iso.value);
  line += text;
  for (const double level : picture.levels) {
    std::snprintf(text, sizeof text, " %.3f", level);
    line += text;
  }
  for (const dslr::TrueFile& file : picture.files)
    line += ", " + file.name + " (" + std::to_string(file.bytes) + " bytes)";
  return line;
}

void serve(Context& context, const dslr::Dslr& camera) {
  std::stop_source stop;
  context.signals.onStop([&stop] { stop.request_stop(); });
  std::size_t told = 0;
  while (!stop.stop_requested()) {
    context.clock.sleepUntil(context.clock.mono() + (context.options.verbose ? 200ms : 1h),
                             stop.get_token());
    for (const dslr::TruePicture& picture : camera.picturesSince(told)) {
      context.verbose(lineOf(picture));
      ++told;
    }
  }
  context.signals.onStop({});
}

void run(Context& context, const Options& options) {
  const Place place = parsePlace(options.ptpip);
  const devices::RigSpec rig = rigOf(options);
  const devices::CameraSpec& spec = cameraOf(rig, options.camera);
  devices::ScaledClock clock(context.clock, options.speed);

  dslr::DslrScript script;
  if (!options.faults.empty()) script = dslr::readDslrFaults(options.faults, rig, spec.id);
  devices::twin::TwinOptions world_options;
  world_options.seed = context.seed();
  world_options.start_utc = clock.utc();
  world_options.faults = script.world;
  const auto world =
      std::make_shared<devices::twin::World>(dslr::worldRig(rig), world_options, clock);

  dslr::DslrOptions camera_options;
  camera_options.camera = spec.id;
  if (!spec.serial.empty()) camera_options.serial = spec.serial;
  if (!options.serial.empty()) camera_options.serial = options.serial;
  if (!options.model.empty()) camera_options.model = options.model;
  dslr::Dslr camera(world, camera_options);
  for (const dslr::DslrFault& fault : script.camera) camera.order(fault);

  std::optional<dslr::ArtNetLamps> lamps;
  if (options.artnet_port >= 0)
    lamps.emplace(world, dslr::dmxAddresses(rig), place.address, options.artnet_port);
  const dslr::PtpIpServer server(camera, place.address, place.port);
  say(context, camera_options.model + " " + camera_options.serial + " listens at " + place.address +
                   ":" + std::to_string(server.port()) + "; try\n  gphoto2 --port " +
                   server.gphotoPort() + " --capture-image-and-download");
  if (lamps)
    say(context, "its " + std::to_string(rig.lights.size()) + " lamps listen to Art-Net at " +
                     place.address + ":" + std::to_string(lamps->port()));
  serve(context, camera);

  const dslr::Truth truth = camera.truth();
  context.out.asList();
  context.out.add(std::move(Item()
                                .set("port", server.port())
                                .set("serial", camera_options.serial.c_str())
                                .set("pictures", truth.pictures.size())
                                .set("faults", truth.faults.size())
                                .set("sessions", truth.sessions)));
}

}  // namespace

void addTwinCameraVerb(Verb twin) {
  auto o = std::make_shared<Options>();
  twin.verb(
          "camera",
          "A virtual DSLR on the wire: any PTP/IP client takes pictures of the twin with it, until "
          "a signal ends it; --verbose tells of each",
          "patina twin camera --ptpip 127.0.0.1:15740", [o](Context& context) { run(context, *o); })
      .option("--ptpip", o->ptpip, "ADDRESS:PORT",
              "Where it listens (default: any free port of 127.0.0.1)")
      .option("--artnet", o->artnet_port, 0, 65535,
              "Port at which its lamps listen to Art-Net (OpDmx); lamp i of the rig is channel i, "
              "unless the rig says universe and channel")
      .option("--faults", o->faults, "FILE", "What it and its world do wrong, and when")
      .option("--rig", o->rig, "FILE", "Whose lamps and camera these are (default: two lamps)")
      .option("--camera", o->camera, "ID", "Of the rig: the one it stands in for (the first)")
      .option(
          "--size", o->size, [](const std::string& text) { return parseSize(text); }, "WxH",
          "Of its pictures, in pixels")
      .option("--serial", o->serial, "TEXT",
              "By which drivers know it (default: the rig's, or 1001)")
      .option("--model", o->model, "TEXT", "What it calls itself (default: Patina DSLR)")
      .option("--speed", o->speed, 1, 1000, "Of its time and its world's (default 1: real time)");
}

}  // namespace patina::app
