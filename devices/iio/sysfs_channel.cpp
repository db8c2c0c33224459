// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/iio/sysfs_channel.h"

#include <fcntl.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <optional>
#include <tuple>

#include "devices/descriptor.h"
#include "devices/poll_until.h"

namespace fs = std::filesystem;

namespace patina::devices::iio {
namespace {

constexpr double kMilli = 1e-3;  // the kernel's unit of temperature and humidity

std::string lineOf(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

std::string stemOf(Kernel kernel, Quantity quantity) {
  const bool iio = kernel == Kernel::kIio;
  switch (quantity) {
    case Quantity::kIlluminance:
      return iio ? "in_illuminance" : "";  // hwmon knows no light
    case Quantity::kTemperature:
      return iio ? "in_temp" : "temp";
    case Quantity::kHumidity:
      return iio ? "in_humidityrelative" : "humidity";
  }
  return "";
}

// "temp1" of "temp1_input" when `stem` and a number, or nothing, stand before the suffix.
std::optional<std::string> prefixOf(const std::string& file, const std::string& stem) {
  for (const std::string suffix : {"_input", "_raw"}) {
    if (!file.ends_with(suffix) || !file.starts_with(stem)) continue;
    const std::string prefix = file.substr(0, file.size() - suffix.size());
    if (prefix.find_first_not_of("0123456789", stem.size()) == std::string::npos) return prefix;
  }
  return std::nullopt;
}

// Where it hangs: the last two folders above the device's own, without its number.
std::string placeOf(const fs::path& device) {
  std::error_code error;
  fs::path real = fs::canonical(device, error);
  if (error) return "";
  fs::path owner = real.parent_path();
  if (owner.filename() == "hwmon") owner = owner.parent_path();
  return (owner.parent_path().filename() / owner.filename()).string();
}

tl::unexpected<Error> broken(const fs::path& file, int error) {
  const std::string what = file.string() + ": " + std::strerror(error);
  switch (error) {
    case EAGAIN:
    case EBUSY:
    case EINTR:
      return fail(Errc::kBusy, what);
    case ETIMEDOUT:
      return fail(Errc::kTimeout, what);
    case EIO:
    case EREMOTEIO:
      return fail(Errc::kCorrupt, what + ": look at its wiring");
    default:
      return fail(Errc::kLost, what + ": is it still there?");
  }
}

Result<double> numberIn(const fs::path& file, Clock& clock, MonoTime deadline) {
  const Descriptor fd(open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  if (fd.fd() < 0) return broken(file, errno);
  std::array<char, 64> text{};
  ssize_t n = read(fd.fd(), text.data(), text.size());
  if (n < 0 && errno == EAGAIN) {
    if (pollUntil(fd.fd(), POLLIN, clock, deadline) == Polled::kTimeout)
      return fail(Errc::kTimeout, file.string() + ": nothing by the deadline");
    n = read(fd.fd(), text.data(), text.size());
  }
  if (n < 0) return broken(file, errno);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + n, value);
  const bool ends = end == text.data() + n || *end == '\n';
  if (error != std::errc{} || !ends)
    return fail(Errc::kCorrupt, file.string() + " holds no number");
  return value;
}

}  // namespace

const char* name(Kernel kernel) { return kernel == Kernel::kIio ? "iio" : "hwmon"; }

std::string Channel::describe() const {
  return device + " " + prefix + (label.empty() ? "" : " \"" + label + "\"") + " (" + place + ")";
}

std::vector<Channel> channels(Kernel kernel, Quantity quantity, const fs::path& root) {
  std::vector<Channel> found;
  const std::string stem = stemOf(kernel, quantity);
  if (stem.empty()) return found;
  const fs::path top = root / (kernel == Kernel::kIio ? "sys/bus/iio/devices" : "sys/class/hwmon");
  std::error_code error;
  for (fs::directory_iterator device(top, error), end; !error && device != end;
       device.increment(error)) {
    std::error_code unreadable;
    for (fs::directory_iterator file(device->path(), unreadable); !unreadable && file != end;
         file.increment(unreadable)) {
      const auto prefix = prefixOf(file->path().filename(), stem);
      if (!prefix) continue;
      Channel channel;
      channel.folder = device->path();
      channel.device = lineOf(device->path() / "name");
      channel.label = lineOf(device->path() / (*prefix + "_label"));
      if (channel.label.empty()) channel.label = lineOf(device->path() / "label");
      channel.place = placeOf(device->path());
      channel.prefix = *prefix;
      found.push_back(std::move(channel));
    }
  }
  const auto key = [](const Channel& c) { return std::tie(c.place, c.device, c.prefix); };
  std::ranges::sort(found, {}, key);
  const auto twice = std::ranges::unique(found, {}, key);  // _input beside _raw
  found.erase(twice.begin(), twice.end());
  return found;
}

Result<double> readChannel(const Channel& channel, Kernel kernel, Quantity quantity, Clock& clock,
                           MonoTime deadline) {
  const double unit = quantity == Quantity::kIlluminance ? 1 : kMilli;
  const auto file = [&](const char* suffix) { return channel.folder / (channel.prefix + suffix); };
  std::error_code error;
  if (kernel == Kernel::kHwmon || fs::exists(file("_input"), error)) {
    const auto value = numberIn(file("_input"), clock, deadline);
    if (!value) return value;
    return *value * unit;
  }
  const auto raw = numberIn(file("_raw"), clock, deadline);
  if (!raw) return raw;
  // Both are missing where they are 1 and 0; a kind's own stands for all its channels.
  const std::string kind =
      channel.prefix.substr(0, channel.prefix.find_last_not_of("0123456789") + 1);
  const auto factor = [&](const char* suffix, double missing) -> Result<double> {
    for (const fs::path& place : {file(suffix), channel.folder / (kind + suffix)})
      if (fs::exists(place, error)) return numberIn(place, clock, deadline);
    return missing;
  };
  const auto offset = factor("_offset", 0);
  if (!offset) return offset;
  const auto scale = factor("_scale", 1);
  if (!scale) return scale;
  return (*raw + *offset) * *scale * unit;
}

}  // namespace patina::devices::iio
