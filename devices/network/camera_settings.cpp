// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/network/camera_settings.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "devices/descriptor.h"
#include "devices/settings.h"

namespace patina::devices::network {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kSecretBytesMost = 1024;

class Reading {
 public:
  Reading(const CameraSpec& spec, const std::filesystem::path& rig_file)
      : spec_(spec),
        rig_file_(rig_file),
        settings_(spec.settings, "camera '" + spec.id + "'", rig_file) {}

  CameraSettings all();

 private:
  std::string takePath(const std::string& key);
  Nanoseconds takeTime(const std::string& key, Nanoseconds least, Nanoseconds most,
                       Nanoseconds fallback);
  std::optional<double> takeFixed(const std::string& key, double most);
  std::string readSecret(const std::string& file) const;
  void takeUrl(CameraSettings& s);
  void takeExposure(CameraSettings& s);

  const CameraSpec& spec_;
  const std::filesystem::path& rig_file_;
  Settings settings_;
};

std::string Reading::takePath(const std::string& key) {
  const std::string path = settings_.takeText(key, "");
  return path.empty() ? path : (rig_file_.parent_path() / path).string();
}

Nanoseconds Reading::takeTime(const std::string& key, Nanoseconds least, Nanoseconds most,
                              Nanoseconds fallback) {
  const Nanoseconds time = settings_.takeExposure(key, fallback);
  if (time < least || time > most)
    settings_.reject(key, formatDuration(time) + " is out of range (" + formatDuration(least) +
                              " to " + formatDuration(most) + ")");
  return time;
}

std::optional<double> Reading::takeFixed(const std::string& key, double most) {
  const double value = settings_.takeNumber(key, 0.1, most, 0);
  return value > 0 ? std::optional(value) : std::nullopt;
}

// No message repeats what it holds.
std::string Reading::readSecret(const std::string& file) const {
  // Without blocking, should it be a pipe.
  const Descriptor opened(open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat is {};
  if (opened.fd() < 0 || fstat(opened.fd(), &is) != 0)
    settings_.reject("credentials", file + " cannot be read: " + std::strerror(errno));
  if (!S_ISREG(is.st_mode)) settings_.reject("credentials", file + " is no regular file");
  if ((is.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    settings_.reject("credentials", file + " can be read by others: chmod 600 " + file);
  std::string text(kSecretBytesMost + 1, '\0');
  const ssize_t got = read(opened.fd(), text.data(), text.size());
  text.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  if (text.size() > kSecretBytesMost || text.find(':') == std::string::npos ||
      std::any_of(text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }))
    settings_.reject("credentials", file + " must hold one line \"user:password\"");
  return text;
}

void Reading::takeUrl(CameraSettings& s) {
  s.url = settings_.takeText("url", "");
  const auto begins = [&](const char* with) { return s.url.rfind(with, 0) == 0; };
  s.rtsp = begins("rtsp://");
  if (hostOf(s.url).empty() || !(s.rtsp || begins("http://") || begins("https://")))
    settings_.reject("url", "must begin with http://, https:// or rtsp:// and name a host");
  const std::string authority = s.url.substr(0, s.url.find('/', s.url.find("://") + 3));
  if (authority.find('@') != std::string::npos)
    settings_.reject("url", "must not hold a password: put it in a file, settings.credentials");
  const std::string format = settings_.takeChoice("format", {"jpeg", "png"});
  s.ext = s.rtsp || format == "png" ? "png" : "jpg";
}

void Reading::takeExposure(CameraSettings& s) {
  const Nanoseconds time = settings_.takeExposure("fixed_exposure", 0ns);
  if (spec_.settings.contains("fixed_exposure")) {
    if (time <= 0ns) settings_.reject("fixed_exposure", "must be above 0");
    s.fixed_exposure = time;
  }
  s.fixed_iso = takeFixed("fixed_iso", 1e7);
  s.fixed_f_number = takeFixed("fixed_f_number", 1000);
}

CameraSettings Reading::all() {
  CameraSettings s;
  s.who = "network '" + spec_.id + "'";
  takeUrl(s);
  if (const std::string file = takePath("credentials"); !file.empty())
    s.credentials = readSecret(file);
  s.ca_file = takePath("ca_file");
  takeExposure(s);
  s.latency = takeTime("latency", 0ns, 60s, 1s);
  s.cycle = takeTime("cycle", 1ms, 60s, 2s);
  s.connect_timeout = takeTime("connect_timeout", 10ms, 60s, 5s);
  try {
    s.bytes_max = parseBytes(settings_.takeText("bytes_max", "32MB"));
  } catch (const Failure& problem) {
    settings_.reject("bytes_max", problem.what());
  }
  s.skip_key_frames = settings_.takeInteger("skip_key_frames", 0, 100, s.skip_key_frames);
  settings_.finish();
  return s;
}

}  // namespace

CameraSettings readCameraSettings(const CameraSpec& spec, const std::filesystem::path& rig_file) {
  return Reading(spec, rig_file).all();
}

std::string hostOf(const std::string& url) {
  const std::size_t scheme = url.find("://");
  if (scheme == std::string::npos) return {};
  const std::string rest = url.substr(scheme + 3);
  const std::string authority = rest.substr(0, rest.find_first_of("/?#"));
  const std::size_t at = authority.rfind('@');
  std::string host = at == std::string::npos ? authority : authority.substr(at + 1);
  std::transform(host.begin(), host.end(), host.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return host;
}

}  // namespace patina::devices::network
