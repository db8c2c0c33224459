// SPDX-License-Identifier: GPL-3.0-or-later
// The one file that knows libgpiod (1.6: version 2 has other calls).
#include "devices/gpio/output_line.h"

#include <gpiod.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace patina::devices::gpio {
namespace {

struct CloseChip {
  void operator()(gpiod_chip* chip) const { gpiod_chip_close(chip); }
};
using OpenChip = std::unique_ptr<gpiod_chip, CloseChip>;

std::string text(const char* maybe) { return maybe == nullptr ? "" : maybe; }

std::string chipList() {
  std::string list;
  for (const Chip& chip : chips())
    list += (list.empty() ? "" : ", ") + (chip.label.empty() ? chip.name : chip.label) +
            (chip.trouble.empty() ? "" : " (" + chip.trouble + ")");
  return list.empty() ? "none" : list;
}

class GpiodLine final : public OutputLine {
 public:
  GpiodLine(OpenChip chip, gpiod_line* line, std::string who)
      : chip_(std::move(chip)), line_(line), who_(std::move(who)) {}
  ~GpiodLine() override {
    gpiod_line_set_value(line_, 0);
    gpiod_line_release(line_);
  }

  Result<void> set(bool active) override {
    const int value = active ? 1 : 0;
    if (gpiod_line_set_value(line_, value) != 0)
      return fail(Errc::kLost, who_ + ": " + std::strerror(errno));
    const int now = gpiod_line_get_value(line_);
    if (now < 0) return fail(Errc::kLost, who_ + ": " + std::strerror(errno));
    if (now != value) return fail(Errc::kRefused, who_ + " does not follow: is the pin shorted?");
    return {};
  }

 private:
  const OpenChip chip_;
  gpiod_line* const line_;  // the chip's
  const std::string who_;
};

gpiod_line* findLine(gpiod_chip* chip, const std::string& name) {
  const bool offset =
      !name.empty() && name.size() < 6 && name.find_first_not_of("0123456789") == std::string::npos;
  return offset ? gpiod_chip_get_line(chip, static_cast<unsigned>(std::stoul(name)))
                : gpiod_chip_find_line(chip, name.c_str());
}

}  // namespace

Result<std::unique_ptr<OutputLine>> requestLine(const LineName& name) {
  const std::string who = "line " + name.line + " of " + name.chip;
  OpenChip chip(gpiod_chip_open_by_label(name.chip.c_str()));
  if (!chip) chip.reset(gpiod_chip_open_by_name(name.chip.c_str()));
  if (!chip)
    return fail(Errc::kLost,
                "no GPIO chip " + name.chip + " can be opened; there are: " + chipList());
  gpiod_line* line = findLine(chip.get(), name.line);
  if (line == nullptr) return fail(Errc::kLost, name.chip + " has no line " + name.line);
  if (gpiod_line_is_used(line))
    return fail(Errc::kBusy, who + " is used by '" + text(gpiod_line_consumer(line)) + "'");
  const int flags = name.active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;
  if (gpiod_line_request_output_flags(line, "patina", flags, 0) != 0)
    return fail(errno == EBUSY ? Errc::kBusy : Errc::kLost, who + ": " + std::strerror(errno));
  return std::unique_ptr<OutputLine>(std::make_unique<GpiodLine>(std::move(chip), line, who));
}

std::vector<Chip> chips() {
  std::vector<Chip> found;
  std::error_code error;
  for (std::filesystem::directory_iterator it("/dev", error), end; !error && it != end;
       it.increment(error)) {
    Chip chip;
    chip.name = it->path().filename();
    if (!chip.name.starts_with("gpiochip")) continue;
    if (const OpenChip open{gpiod_chip_open(it->path().c_str())}) {
      chip.label = text(gpiod_chip_label(open.get()));
      chip.lines = gpiod_chip_num_lines(open.get());
    } else {
      chip.trouble = std::strerror(errno);
    }
    found.push_back(std::move(chip));
  }
  std::ranges::sort(found, {}, &Chip::name);
  return found;
}

}  // namespace patina::devices::gpio
