// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/journal_rewrite.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "db/journal.h"
#include "tests/db/dump.h"
#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

using patina::testing::TempFolder;
using ::testing::IsEmpty;

TEST(JournalRewrite, AJournalThatLostLinesIsMadeAgainAtTheNextStart) {
  const TempFolder folder = TempFolder::inMemory();
  const auto path = folder / "archive";
  {
    Archive archive(optionsFor(path));
    beginRun(archive);
    for (int number = 0; number < 3; ++number)
      capture(archive, number, static_cast<std::uint64_t>(number));
  }
  const auto journal = journalPath(path, kRunId);
  for (const std::uintmax_t left : {std::uintmax_t{0}, std::filesystem::file_size(journal) / 2}) {
    std::filesystem::resize_file(journal, left);
    Progress progress;
    EXPECT_FALSE(verify(path, progress).problems.empty());
    { const Archive archive(optionsFor(path)); }
    EXPECT_THAT(verify(path, progress).problems, IsEmpty());
    const auto before = dumpOf(path);
    rebuild(path, progress);
    EXPECT_EQ(dumpOf(path), before);
  }
}

}  // namespace
}  // namespace patina::db::testing
