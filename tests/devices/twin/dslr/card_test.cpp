// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/card.h"

#include <gtest/gtest.h>

#include <set>

namespace patina::devices::twin::dslr {
namespace {

std::vector<CardObject> picture(std::size_t bytes, bool pair = false) {
  std::vector<CardObject> files(pair ? 2 : 1);
  for (CardObject& file : files) {
    file.format = ObjectFormat::kJpeg;
    file.bytes = std::make_shared<const Bytes>(bytes);
  }
  if (pair) files[0].format = ObjectFormat::kDng;
  return files;
}

TEST(Card, NeverGivesAHandleOrANameTwice) {
  Card card(1'000'000, 1000, 1);
  std::set<std::uint32_t> handles;
  std::set<std::string> names;
  for (int i = 0; i < 200; ++i)
    for (const std::uint32_t handle : card.add(kCardStore, picture(10, i % 3 == 0))) {
      EXPECT_TRUE(handles.insert(handle).second);
      EXPECT_TRUE(names.insert(card.find(handle)->name).second);
      EXPECT_EQ(i % 2 == 0 && card.remove(handle), i % 2 == 0);
    }
}

TEST(Card, NamesBothFilesOfAPairAlike) {
  Card card(1'000'000, 1000, 42);
  const auto pair = card.add(kCardStore, picture(10, true));
  EXPECT_EQ(card.find(pair.at(0))->name, "PATN0042.DNG");
  EXPECT_EQ(card.find(pair.at(1))->name, "PATN0042.JPG");
}

TEST(Card, GoesOnInANewFolderAfterNumber9999) {
  Card card(1'000'000, 1000, 9999);
  const auto last = card.add(kCardStore, picture(1)), next = card.add(kCardStore, picture(1));
  EXPECT_EQ(card.find(last[0])->name, "PATN9999.JPG");
  EXPECT_EQ(card.find(next[0])->name, "PATN0001.JPG");
  EXPECT_EQ(card.find(card.find(last[0])->parent)->name, "100PATNA");
  EXPECT_EQ(card.find(card.find(next[0])->parent)->name, "101PATNA");
}

TEST(Card, ListsByStoreFormatAndFolder) {
  Card card(1'000'000, 1000, 1);
  const auto on_card = card.add(kCardStore, picture(10, true));
  const auto in_memory = card.add(kMemoryStore, picture(10));
  EXPECT_EQ(card.handles(kMemoryStore, ObjectFormat::kAny, 0), in_memory);
  EXPECT_EQ(card.handles(kAllStores, ObjectFormat::kDng, 0), std::vector{on_card[0]});
  EXPECT_EQ(card.handles(kCardStore, ObjectFormat::kAny, card.find(on_card[0])->parent), on_card);
  const auto root = card.handles(kCardStore, ObjectFormat::kAny, kRootOnly);
  ASSERT_EQ(root.size(), 1u);
  EXPECT_EQ(card.find(root[0])->name, "DCIM");
}

TEST(Card, IsAsFullAsItsFilesAreLong) {
  Card card(1000, 100, 1);
  const auto file = card.add(kCardStore, picture(300));
  EXPECT_EQ(card.free(kCardStore), 700);
  EXPECT_EQ(card.free(kMemoryStore), 100);
  EXPECT_TRUE(card.remove(file[0]));
  EXPECT_FALSE(card.remove(file[0]));
  EXPECT_EQ(card.free(kCardStore), 1000);
}

TEST(Card, KeepsItsFoldersWhateverIsRemoved) {
  Card card(1000, 100, 1);
  const auto folders = card.handles(kCardStore, ObjectFormat::kFolder, 0);
  card.add(kCardStore, picture(10));
  EXPECT_EQ(card.removeAll(kCardStore).size(), 1u);
  EXPECT_FALSE(card.remove(folders[0]));
  EXPECT_EQ(card.handles(kCardStore, ObjectFormat::kAny, 0), folders);
}

}  // namespace
}  // namespace patina::devices::twin::dslr
