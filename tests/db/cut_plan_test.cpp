// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/cut_plan.h"

#include <gmock/gmock.h>

#include <set>

namespace patina::db {
namespace {

using Kind = UndoEntry::Kind;

UndoEntry entry(std::uint64_t seq, Kind kind, const char* path, const char* to = "") {
  UndoEntry e;
  e.kind = kind;
  e.seq = seq;
  e.path = path, e.to = to;
  return e;
}

std::set<std::uint64_t> lostOf(const Unsynced& unsynced, std::uint64_t seed) {
  std::set<std::uint64_t> lost;
  for (const UndoEntry& e : planCut(unsynced, seed).names) lost.insert(e.seq);
  return lost;
}

TEST(CutPlan, LosesASuffixOfEachFolderAndWhatRestsUponIt) {
  Unsynced unsynced;
  unsynced.apply(entry(1, Kind::kCreate, "/tmp/x"));
  unsynced.apply(entry(2, Kind::kCreate, "/tmp/y"));
  unsynced.apply(entry(3, Kind::kMakeFolder, "/frames/ab"));
  unsynced.apply(entry(4, Kind::kRename, "/tmp/x", "/frames/ab/x"));
  unsynced.apply(entry(5, Kind::kCreate, "/tmp/x"));
  std::set<std::set<std::uint64_t>> seen;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const auto lost = lostOf(unsynced, seed);
    seen.insert(lost);
    if (lost.contains(1)) {
      EXPECT_TRUE(lost.contains(2) && lost.contains(4) && lost.contains(5));
    }
    if (lost.contains(3)) {
      EXPECT_TRUE(lost.contains(4)) << "its folder is gone";
    }
    if (lost.contains(4)) {
      EXPECT_TRUE(lost.contains(5)) << "the name is taken again";
    }
  }
  EXPECT_GE(seen.size(), 6u);
  EXPECT_TRUE(seen.contains({}));
}

TEST(CutPlan, ListsLostNamesNewestFirst) {
  Unsynced unsynced;
  for (std::uint64_t seq = 1; seq < 20; ++seq)
    unsynced.apply(entry(seq, Kind::kCreate, ("/a/" + std::to_string(seq)).c_str()));
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    std::uint64_t last = 100;
    for (const UndoEntry& e : planCut(unsynced, seed).names) {
      EXPECT_LT(e.seq, last);
      last = e.seq;
    }
  }
}

TEST(CutPlan, KeepsOneNumberOfChangesASector) {
  Unsynced unsynced;
  for (std::uint64_t seq = 1; seq <= 8; ++seq) {
    UndoEntry e = entry(seq, Kind::kWrite, "/a");
    e.file = 1;
    e.bytes = 1 << 16;
    unsynced.apply(e);
  }
  std::set<FileCut::Tear> tears;
  for (std::uint64_t seed = 0; seed < 300; ++seed)
    for (const FileCut& cut : planCut(unsynced, seed).files) {
      tears.insert(cut.tear);
      for (std::int64_t at = 0; at < 1 << 16; at += cut.sector)
        for (std::size_t i = 1; i < 8; ++i)
          if (cut.survives(i, at)) {
            ASSERT_TRUE(cut.survives(i - 1, at));
          }
    }
  EXPECT_EQ(tears.size(), 3u);
}

TEST(CutPlan, NeverReordersAcrossATruncation) {
  Unsynced unsynced;
  for (std::uint64_t seq = 1; seq <= 4; ++seq) {
    UndoEntry e = entry(seq, seq == 2 ? Kind::kTruncate : Kind::kWrite, "/a");
    e.file = 1;
    unsynced.apply(e);
  }
  for (std::uint64_t seed = 0; seed < 300; ++seed)
    for (const FileCut& cut : planCut(unsynced, seed).files) {
      EXPECT_NE(cut.tear, FileCut::Tear::kReordered);
      if (cut.kept == 1) {
        EXPECT_EQ(cut.tear, FileCut::Tear::kNone) << "a truncation is whole";
      }
    }
}

}  // namespace
}  // namespace patina::db
