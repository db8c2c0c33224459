// SPDX-License-Identifier: GPL-3.0-or-later
// Server-sent events as bytes, both ways.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace patina::http {

struct Event {
  std::string id, name, data;
};

// "id: ..\nevent: ..\ndata: ..\n\n". Line ends in the data begin a data line of their own; in the
// id or the name they would begin another event, so they are dropped.
std::string eventText(const Event& event);

// An id is "<epoch>-<number>": the epoch is drawn at each start, so that a number of an earlier
// process is not taken for one of ours.
std::string eventId(const std::string& epoch, std::uint64_t number);
std::optional<std::uint64_t> eventNumber(std::string_view id, std::string_view epoch);

// Feeds on pieces of any size and calls for every whole event; comments are skipped. An event of
// more than 1 MiB ends it: feed() then gives false for good.
class EventParser {
 public:
  explicit EventParser(std::function<void(const Event&)> call) : call_(std::move(call)) {}
  bool feed(std::string_view bytes);

 private:
  void takeLine(std::string_view line);
  std::function<void(const Event&)> call_;
  std::string line_;
  Event event_;
  bool has_data_ = false, broken_ = false, after_return_ = false;
};

}  // namespace patina::http
