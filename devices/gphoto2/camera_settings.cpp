// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/camera_settings.h"

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "devices/config_file.h"
#include "devices/settings.h"

namespace patina::devices::gphoto2 {

namespace {

using namespace std::chrono_literals;

constexpr int kPtpIpPort = 15740;

std::string significant(const std::string& serial) {
  const auto begin = serial.find_first_not_of("0 \t");
  if (begin == std::string::npos) return "";
  return serial.substr(begin, serial.find_last_not_of(" \t") - begin + 1);
}

// "10.0.0.5, 10.0.0.6:15741": each with a port of its own, or with the common one.
std::vector<Attached> addressesOf(Settings& settings) {
  const std::string hosts = settings.takeText("host", "");
  const int common = settings.takeInteger("port", 1, 65535, kPtpIpPort);
  std::vector<Attached> addresses;
  std::istringstream in(hosts);
  for (std::string host; std::getline(in, host, ',');) {
    std::erase(host, ' ');
    int port = common;
    if (const auto colon = host.rfind(':'); colon != std::string::npos) {
      const std::string digits = host.substr(colon + 1);
      char* end = nullptr;
      const long v = std::strtol(digits.c_str(), &end, 10);
      if (digits.empty() || *end != '\0' || v < 1 || v > 65535)
        settings.reject("host", "'" + host + "': the port is out of range (1 to 65535)");
      port = static_cast<int>(v);
      host.resize(colon);
    }
    if (host.empty() || host.find_first_of(":/") != std::string::npos)
      settings.reject("host", "'" + hosts + "' is not \"HOST[:PORT]\" or a list of such");
    addresses.push_back(networkCamera(host, port));
  }
  return addresses;
}

void takeFormat(Settings& settings, CameraSettings& s) {
  const std::string format = settings.takeText("format", "raw");
  const std::string lower = lowerCase(format);
  if (lower == "raw" || lower == "jpeg" || lower == "raw+jpeg") {
    s.files = {lower != "jpeg", lower != "raw"};
  } else if (const auto kinds = fileKindsOf(format)) {
    s.files = *kinds;
    s.format_word = format;
  } else {
    settings.reject("format", "'" + format +
                                  "' does not say which files it gives; allowed are raw, jpeg, "
                                  "raw+jpeg and the camera's own word for one of them");
  }
  s.raw_extension = lowerCase(settings.takeText("raw_extension", "raw"));
}

}  // namespace

std::vector<std::string> CameraSettings::extensions() const {
  std::vector<std::string> all;
  if (files.raw) all.push_back(raw_extension);
  if (files.jpeg) all.emplace_back("jpg");
  return all;
}

CameraSettings readCameraSettings(const CameraSpec& spec, const std::filesystem::path& rig_file) {
  Settings settings(spec.settings, "camera '" + spec.id + "'", rig_file);
  CameraSettings s;
  s.serial = settings.takeText("serial", spec.serial);
  s.model = settings.takeText("model", "");
  s.addresses = addressesOf(settings);
  takeFormat(settings, s);
  if (const std::string white = settings.takeText("white_balance", ""); !white.empty())
    s.white_balance = white;
  s.target =
      settings.takeChoice("target", {"card", "memory"}) == "card" ? Target::kCard : Target::kMemory;
  s.keep = settings.takeChoice("keep", {"false", "true"}) == "true";
  s.external_shutter = settings.takeChoice("shutter", {"usb", "external"}) == "external";
  s.manual_aperture = settings.takeChoice("f_number", {"camera", "manual"}) == "manual";
  s.cycle = settings.takeExposure("cycle", 1500ms);
  s.exposure_min = settings.takeExposure("exposure_min", 125us);
  s.exposure_max = settings.takeExposure("exposure_max", 30s);
  s.config = settings.takePrefixed("config.");
  settings.finish();

  if (!spec.serial.empty() && !sameSerial(spec.serial, s.serial))
    settings.reject(
        "serial", "'" + s.serial + "' is not the serial '" + spec.serial + "' of the same camera");
  if (s.addresses.size() > 1 && s.serial.empty())
    settings.reject("host", "several addresses need a serial: which of the cameras is it?");
  if (s.target == Target::kMemory && s.keep)
    settings.reject("keep", "a camera's memory keeps nothing; target must be card");
  if (!(s.cycle > 0s && s.cycle <= 10min))
    settings.reject("cycle", "is out of range (above 0 to 600s)");
  if (!(s.exposure_min > 0s) || s.exposure_min > s.exposure_max)
    settings.reject("exposure_min", "must be above 0 and not above exposure_max");
  return s;
}

bool sameSerial(const std::string& a, const std::string& b) {
  return significant(a) == significant(b);
}

bool meansNothing(const std::string& serial) {
  return significant(serial).empty() || lowerCase(significant(serial)) == "none";
}

}  // namespace patina::devices::gphoto2
