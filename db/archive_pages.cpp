// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/archive_pages.h"

#include <algorithm>

#include "db/catalogue_read.h"
#include "db/row_statements.h"

namespace patina::db {
namespace {

template <class Row>
std::vector<Row> pageOf(Statement& statement, const std::string& run_id,
                        const ArchivePages::Page& page) {
  const Reading reading(statement);
  statement.bind(1, run_id).bind(2, page.after);
  statement.bind(3, std::int64_t{std::clamp(page.rows, 1, kPageRowsMax)});
  std::vector<Row> rows;
  while (statement.step()) rows.push_back(readRow<Row>(statement));
  return rows;
}

}  // namespace

std::vector<StepRow> ArchivePages::steps(const std::string& run_id, const Page& page) const {
  const auto guard = reader_.state_->guard();
  return pageOf<StepRow>(reader_.state_->statement(Query::kStepsPage), run_id, page);
}

std::vector<StepRow> ArchivePages::stepsByHand(const std::string& run_id, int limit) const {
  const auto guard = reader_.state_->guard();
  Statement& statement = reader_.state_->statement(Query::kStepsByHand);
  const Reading reading(statement);
  statement.bind(1, run_id).bind(2, std::int64_t{std::clamp(limit, 1, kPageRowsMax)});
  std::vector<StepRow> rows;
  while (statement.step()) rows.push_back(readRow<StepRow>(statement));
  return rows;
}

std::vector<ArchivePages::ShotFrame> ArchivePages::frames(const std::string& run_id,
                                                          const Page& page) const {
  const auto guard = reader_.state_->guard();
  Statement& statement = reader_.state_->statement(Query::kFramesPage);
  const Reading reading(statement);
  statement.bind(1, run_id).bind(2, page.after);
  statement.bind(3, std::int64_t{std::clamp(page.rows, 1, kPageRowsMax)});
  std::vector<ShotFrame> rows;
  while (statement.step()) {
    ShotFrame found;
    RowReader reader(statement);
    columns(reader, found.shot);
    FrameRecord frame;
    columns(reader, frame);
    found.frame = frame.row;
    rows.push_back(std::move(found));
  }
  return rows;
}

std::vector<LightCheckRow> ArchivePages::lightChecks(const std::string& run_id,
                                                     const Page& page) const {
  const auto guard = reader_.state_->guard();
  return pageOf<LightCheckRow>(reader_.state_->statement(Query::kLightChecksPage), run_id, page);
}

std::vector<EventRow> ArchivePages::events(const std::string& run_id, const Page& page) const {
  const auto guard = reader_.state_->guard();
  return pageOf<EventRow>(reader_.state_->statement(Query::kEventsPage), run_id, page);
}

std::vector<DeviceRow> ArchivePages::devices() const {
  const auto guard = reader_.state_->guard();
  Statement& statement = reader_.state_->statement(Query::kDevices);
  const Reading reading(statement);
  std::vector<DeviceRow> rows;
  while (statement.step()) rows.push_back(readRow<DeviceRow>(statement));
  return rows;
}

std::optional<FrameRow> ArchivePages::frameOf(const Sha256& sha256) const {
  const auto guard = reader_.state_->guard();
  Statement& statement = reader_.state_->statement(Query::kFrameBySha256);
  const Reading reading(statement);
  statement.bind(1, sha256.hex());
  if (!statement.step()) return std::nullopt;
  return readRow<FrameRecord>(statement).row;
}

}  // namespace patina::db
