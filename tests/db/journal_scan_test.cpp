// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "db/journal.h"
#include "db/journal_lines.h"
#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

using patina::testing::TempFolder;
using patina::testing::writeFile;

class JournalScan : public ::testing::Test {
 protected:
  // Three transactions of two rows.
  JournalScan() {
    for (int i = 0; i < 3; ++i) {
      JournalLines lines;
      StepRow step = stepRow(i);
      step.id = i + 1;
      step.reason = "line \"quoted\" and \\ with\nbreaks \xC3\xA4";
      lines.add(step);
      LightCheckRow check = checksOf(shotRow(step))[0];
      check.ratio = std::nan("");
      lines.add(check);
      text_ += lines.finish();
      ends_.push_back(static_cast<std::int64_t>(text_.size()));
    }
  }
  std::int64_t scan(const std::string& text, std::int64_t from = 0) {
    writeFile(file_, text);
    batches_.clear();
    return scanJournal(realFileOps(), file_, from, static_cast<std::int64_t>(text.size()),
                       [&](JournalBatch&& batch) { batches_.push_back(std::move(batch)); });
  }
  TempFolder folder_ = TempFolder::inMemory();
  std::filesystem::path file_ = folder_ / "run.jsonl";
  std::string text_;
  std::vector<std::int64_t> ends_;
  std::vector<JournalBatch> batches_;
};

TEST_F(JournalScan, RowsComeBackAsTheyWereWritten) {
  EXPECT_EQ(scan(text_), ends_[2]);
  ASSERT_EQ(batches_.size(), 3u);
  const auto& step = std::get<StepRow>(batches_[1].rows[0]);
  EXPECT_EQ(step.id, 2);
  EXPECT_EQ(step.number, 1);
  EXPECT_EQ(step.reason, "line \"quoted\" and \\ with\nbreaks \xC3\xA4");
  const auto& check = std::get<LightCheckRow>(batches_[1].rows[1]);
  EXPECT_EQ(check.baseline, 1.0 / 3);
  EXPECT_TRUE(std::isnan(check.ratio));
  EXPECT_EQ(batches_[1].begin, ends_[0]);
  EXPECT_EQ(batches_[1].end, ends_[1]);
}

TEST_F(JournalScan, BeginsInTheMiddle) {
  EXPECT_EQ(scan(text_, ends_[1]), ends_[2]);
  EXPECT_EQ(batches_.size(), 1u);
}

TEST_F(JournalScan, ATailTornAtAnyByteGivesOnlyWholeTransactions) {
  for (std::int64_t bytes = ends_[1]; bytes < ends_[2]; ++bytes) {
    EXPECT_EQ(scan(text_.substr(0, static_cast<std::size_t>(bytes))), ends_[1]);
    ASSERT_EQ(batches_.size(), 2u) << bytes;
  }
}

TEST_F(JournalScan, ANumberThatIsNoWholeOneMakesABadLine) {
  for (const char* number : {"1e23", "1.5", "null", "\"1\""}) {
    std::string line = text_.substr(0, text_.find(",\"crc32\""));
    line.replace(line.find("\"id\":1"), 6, std::string("\"id\":") + number);
    char crc[32];
    std::snprintf(crc, sizeof crc, ",\"crc32\":\"%08x\"}\n", crc32(line));
    scan(line + crc + text_.substr(text_.find('\n') + 1));
    ASSERT_EQ(batches_.size(), 3u);
    EXPECT_EQ(batches_[0].bad_lines, 1) << number;
  }
}

TEST_F(JournalScan, AFlippedBitAnywhereIsNoticed) {
  for (std::size_t at = 0; at < static_cast<std::size_t>(ends_[0]); ++at) {
    std::string damaged = text_;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x04);
    scan(damaged);
    int bad = 0;
    for (const auto& batch : batches_) bad += batch.bad_lines;
    ASSERT_GE(bad, 1) << "byte " << at;
    // What lies behind the damage is still read.
    ASSERT_EQ(std::get<StepRow>(batches_.back().rows[0]).id, 3);
  }
}

}  // namespace
}  // namespace patina::db::testing
