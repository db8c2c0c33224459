// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/catalogue_write.h"

#include <algorithm>

#include "db/failure.h"

namespace patina::db {

CatalogueWriter::CatalogueWriter(Database& database)
    : database_(database),
      settle_shot_(database,
                   "UPDATE shot SET exposure_ns = ?6, iso = ?7, f_number = ?8, began_utc_ns = ?9, "
                   "began_mono_ns = ?10, state = ?11 WHERE id = ?1 AND step_id = ?2 AND "
                   "device_id = ?3 AND light_state = ?4 AND exposure_index = ?5 AND attempt = ?12 "
                   "AND state = 'armed'"),
      finish_step_(database,
                   "UPDATE step SET due_utc_ns = ?4, decision = ?5, reason = ?6, retries = ?7, "
                   "held_ns = ?8, spread_ns = ?9, shots_due = ?10, shots_captured = ?11 "
                   "WHERE id = ?1 AND run_id = ?2 AND number IS ?3"),
      drop_inputs_(database, "DELETE FROM product_input WHERE product_id = ?"),
      mark_(database,
            "INSERT INTO journal_mark(journal, bytes) VALUES(?1, ?2) "
            "ON CONFLICT(journal) DO UPDATE SET bytes = ?2"),
      mark_of_(database, "SELECT bytes FROM journal_mark WHERE journal = ?") {}

void CatalogueWriter::replay(const AnyRow& any) {
  std::visit(
      [this]<class Row>(const Row& row) {
        if constexpr (std::same_as<Row, ProductRow>) dropInputs(row.id);
        upsert(row);
      },
      any);
}

void CatalogueWriter::settleShot(const ShotRow& shot) {
  RowBinder binder(settle_shot_);
  for (const std::int64_t id : {shot.id, shot.step_id}) binder.integer(id);
  binder.text(shot.device_id);
  binder.text(shot.light_state);
  binder.integer(shot.exposure_index);
  put(binder, shot.exposure);
  put(binder, shot.iso);
  put(binder, shot.f_number);
  put(binder, shot.began_utc);
  put(binder, shot.began_mono);
  put(binder, shot.state);
  put(binder, shot.attempt);
  settle_shot_.run();
  if (database_.changes() == 1) return;
  throw ArchiveError(Exit::kBadData, "shot " + std::to_string(shot.id) + " of " + shot.device_id +
                                         ", light " + shot.light_state +
                                         " is not armed: its outcome is known already, or its "
                                         "row is another");
}

void CatalogueWriter::finishStep(const StepRow& step) {
  runWith(finish_step_, step);
  if (database_.changes() == 1) return;
  throw ArchiveError(Exit::kBadData, "step " + std::to_string(step.id) + " of run " + step.run_id +
                                         " was never begun");
}

void CatalogueWriter::dropInputs(const std::string& product_id) {
  drop_inputs_.bind(1, product_id).run();
}

void CatalogueWriter::mark(const std::string& journal, std::int64_t bytes) {
  mark_.bind(1, journal).bind(2, bytes).run();
}

std::int64_t CatalogueWriter::markOf(const std::string& journal) {
  const Reading reading(mark_of_);
  mark_of_.bind(1, journal);
  return mark_of_.step() ? mark_of_.integer(0) : 0;
}

RowId CatalogueWriter::nextId(const char* table) {
  return std::max<RowId>(0, database_.number(std::string("SELECT max(id) FROM ") + table)) + 1;
}

RowId CatalogueWriter::lowestId(const char* table) {
  return std::min<RowId>(0, database_.number(std::string("SELECT min(id) FROM ") + table));
}

}  // namespace patina::db
