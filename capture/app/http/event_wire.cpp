// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/event_wire.h"

#include <algorithm>
#include <charconv>

namespace patina::http {
namespace {

constexpr std::size_t kEventBytesMax = 1 << 20;

std::string oneLine(std::string text) {
  std::erase_if(text, [](char c) { return c == '\n' || c == '\r' || c == '\0'; });
  return text;
}

}  // namespace

std::string eventText(const Event& event) {
  std::string text;
  if (!event.id.empty()) text += "id: " + oneLine(event.id) + "\n";
  if (!event.name.empty()) text += "event: " + oneLine(event.name) + "\n";
  text += "data: ";
  for (const char c : event.data) {
    if (c == '\r') continue;
    text += c;
    if (c == '\n') text += "data: ";
  }
  return text + "\n\n";
}

std::string eventId(const std::string& epoch, std::uint64_t number) {
  return epoch + "-" + std::to_string(number);
}

std::optional<std::uint64_t> eventNumber(std::string_view id, std::string_view epoch) {
  if (!id.starts_with(epoch) || id.size() < epoch.size() + 2 || id[epoch.size()] != '-')
    return std::nullopt;
  id.remove_prefix(epoch.size() + 1);
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(id.data(), id.data() + id.size(), number);
  if (error != std::errc{} || end != id.data() + id.size()) return std::nullopt;
  return number;
}

bool EventParser::feed(std::string_view bytes) {
  for (const char c : bytes) {
    if (broken_) return false;
    const bool second_half = c == '\n' && after_return_;  // of "\r\n"
    after_return_ = c == '\r';
    if (second_half) continue;
    if (c == '\n' || c == '\r') {
      takeLine(line_);
      line_.clear();
    } else {
      line_ += c;
      broken_ = line_.size() + event_.data.size() > kEventBytesMax;
    }
  }
  return !broken_;
}

void EventParser::takeLine(std::string_view line) {
  if (line.empty()) {
    if (has_data_) call_(event_);
    event_.name.clear();
    event_.data.clear();
    has_data_ = false;
    return;
  }
  const std::size_t colon = line.find(':');
  const std::string_view field = line.substr(0, colon);
  std::string_view value = colon == std::string_view::npos ? "" : line.substr(colon + 1);
  if (value.starts_with(' ')) value.remove_prefix(1);
  if (field == "id") event_.id = value;
  if (field == "event") event_.name = value;
  if (field == "data") {
    if (has_data_) event_.data += '\n';
    event_.data += value;
    has_data_ = true;
  }
}

}  // namespace patina::http
