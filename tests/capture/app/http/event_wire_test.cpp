// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/event_wire.h"

#include <gtest/gtest.h>

#include <vector>

namespace patina::http {
namespace {

std::vector<Event> parse(const std::string& text, std::size_t piece_bytes) {
  std::vector<Event> events;
  EventParser parser([&events](const Event& event) { events.push_back(event); });
  for (std::size_t at = 0; at < text.size(); at += piece_bytes)
    parser.feed(std::string_view(text).substr(at, piece_bytes));
  return events;
}

TEST(EventText, ComesBackThroughTheParserInPiecesOfAnySize) {
  const std::string text =
      eventText({"e-1", "step", "{\"a\":1}"}) + ":\n\n" + eventText({"e-2", "frame", "two\nlines"});
  for (std::size_t piece = 1; piece < text.size(); ++piece) {
    const auto events = parse(text, piece);
    ASSERT_EQ(events.size(), 2u) << piece;
    EXPECT_EQ(events[0].id, "e-1");
    EXPECT_EQ(events[0].name, "step");
    EXPECT_EQ(events[0].data, "{\"a\":1}");
    EXPECT_EQ(events[1].data, "two\nlines");
  }
}

TEST(EventText, LetsNoNameOrDataBeginAnotherEvent) {
  const auto events = parse(eventText({"1", "a\nevent: evil", "x\n\nevent: evil\r\ndata: y"}), 7);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].name, "aevent: evil");
  EXPECT_EQ(events[0].data, "x\n\nevent: evil\ndata: y");
}

TEST(EventParser, ReadsEveryKindOfLineEnd) {
  EXPECT_EQ(parse("event:a\r\ndata:1\r\n\r\nevent:b\rdata:2\r\r", 1).size(), 2u);
}

TEST(EventParser, GivesUpOnAnEventWithoutEnd) {
  EventParser parser([](const Event&) {});
  EXPECT_TRUE(parser.feed(std::string(1 << 20, 'x')));
  EXPECT_FALSE(parser.feed("x"));
  EXPECT_FALSE(parser.feed("\n\n"));
}

TEST(EventNumber, KnowsOnlyIdsOfItsOwnEpoch) {
  EXPECT_EQ(eventNumber(eventId("abc", 17), "abc"), 17u);
  for (const char* id :
       {"", "abc", "abc-", "abd-17", "abc-1x", "abc--1", "abc-99999999999999999999", "17"})
    EXPECT_FALSE(eventNumber(id, "abc")) << id;
}

}  // namespace
}  // namespace patina::http
