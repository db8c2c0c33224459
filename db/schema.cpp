// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/schema.h"

#include <array>
#include <string>

#include "db/failure.h"

namespace patina::db {
namespace {

// Version 1. Indices carry the questions of archive.h: newest frame of a run (frame_of_run, by id),
// frames between two times, frames of a step, steps with a decision. journal_mark holds how many
// bytes of each journal the catalogue contains: recovery reads only what lies behind.
constexpr const char* kVersion1 = R"sql(
CREATE TABLE device(id TEXT PRIMARY KEY NOT NULL, kind TEXT NOT NULL, backend TEXT NOT NULL,
  serial TEXT NOT NULL, description TEXT NOT NULL) STRICT;
CREATE TABLE specimen(id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE, process TEXT NOT NULL,
  description TEXT NOT NULL, licence TEXT NOT NULL) STRICT;
CREATE TABLE rig(id INTEGER PRIMARY KEY, name TEXT NOT NULL, sha256 TEXT NOT NULL UNIQUE,
  toml TEXT NOT NULL) STRICT;
CREATE TABLE run(id TEXT PRIMARY KEY NOT NULL, specimen_id INTEGER NOT NULL REFERENCES specimen(id),
  rig_id INTEGER NOT NULL REFERENCES rig(id), plan_toml TEXT NOT NULL, plan_sha256 TEXT NOT NULL,
  rig_toml TEXT NOT NULL, boot_id TEXT NOT NULL, t0_utc_ns INTEGER NOT NULL,
  t0_boot_ns INTEGER NOT NULL, seed INTEGER NOT NULL, state TEXT NOT NULL,
  interval_ns INTEGER NOT NULL, duration_ns INTEGER NOT NULL, number INTEGER NOT NULL) STRICT;
CREATE TABLE step(id INTEGER PRIMARY KEY, run_id TEXT NOT NULL REFERENCES run(id), number INTEGER,
  due_utc_ns INTEGER NOT NULL, decision TEXT NOT NULL CHECK(decision IN
  ('pending', 'captured', 'skipped', 'missed', 'failed', 'held')), reason TEXT NOT NULL,
  retries INTEGER NOT NULL, held_ns INTEGER NOT NULL, spread_ns INTEGER NOT NULL,
  shots_due INTEGER NOT NULL, shots_captured INTEGER NOT NULL, UNIQUE(run_id, number)) STRICT;
CREATE INDEX step_decision ON step(run_id, decision, number);
CREATE TABLE shot(id INTEGER PRIMARY KEY, step_id INTEGER NOT NULL REFERENCES step(id),
  device_id TEXT NOT NULL REFERENCES device(id), light_state TEXT NOT NULL,
  exposure_index INTEGER NOT NULL, attempt INTEGER NOT NULL, exposure_ns INTEGER NOT NULL, iso REAL,
  f_number REAL, began_utc_ns INTEGER NOT NULL, began_mono_ns INTEGER NOT NULL, state TEXT NOT NULL
  CHECK(state IN ('armed', 'captured', 'failed', 'lost')),
  UNIQUE(step_id, device_id, light_state, exposure_index, attempt)) STRICT;
CREATE INDEX shot_armed ON shot(id) WHERE state = 'armed';
CREATE TABLE frame(id INTEGER PRIMARY KEY, run_id TEXT NOT NULL REFERENCES run(id),
  shot_id INTEGER NOT NULL REFERENCES shot(id), file_index INTEGER NOT NULL, sha256 TEXT NOT NULL,
  ext TEXT NOT NULL, bytes INTEGER NOT NULL, width_px INTEGER NOT NULL, height_px INTEGER NOT NULL,
  utc_ns INTEGER NOT NULL, mono_ns INTEGER NOT NULL, acked_utc_ns INTEGER NOT NULL,
  saturated_fraction REAL, missing INTEGER NOT NULL, UNIQUE(shot_id, file_index)) STRICT;
CREATE INDEX frame_of_run ON frame(run_id);
CREATE INDEX frame_time ON frame(run_id, utc_ns);
CREATE INDEX frame_sha256 ON frame(sha256);
CREATE TABLE reading(id INTEGER PRIMARY KEY, run_id TEXT NOT NULL REFERENCES run(id),
  step_id INTEGER REFERENCES step(id), device_id TEXT NOT NULL REFERENCES device(id),
  quantity TEXT NOT NULL, unit TEXT NOT NULL, value REAL, utc_ns INTEGER NOT NULL,
  quality TEXT NOT NULL) STRICT;
CREATE INDEX reading_of_run ON reading(run_id);
CREATE TABLE light_check(id INTEGER PRIMARY KEY, run_id TEXT NOT NULL REFERENCES run(id),
  step_id INTEGER REFERENCES step(id), shot_id INTEGER REFERENCES shot(id),
  light_state TEXT NOT NULL, exposure_index INTEGER NOT NULL, source TEXT NOT NULL,
  channel TEXT NOT NULL, level REAL, baseline REAL, ratio REAL, gain REAL, verdict TEXT NOT NULL,
  utc_ns INTEGER NOT NULL) STRICT;
CREATE INDEX light_check_of_run ON light_check(run_id);
CREATE INDEX light_check_of_shot ON light_check(shot_id);
CREATE TABLE calibration(id INTEGER PRIMARY KEY, kind TEXT NOT NULL, device_id TEXT NOT NULL,
  exposure_ns INTEGER NOT NULL, iso REAL, width_px INTEGER NOT NULL, height_px INTEGER NOT NULL,
  temperature_c REAL, light_state TEXT NOT NULL, utc_ns INTEGER NOT NULL, sha256 TEXT NOT NULL, value_json TEXT NOT NULL)
  STRICT;
CREATE INDEX calibration_kind ON calibration(kind);
CREATE TABLE frame_calibration(frame_id INTEGER NOT NULL REFERENCES frame(id),
  calibration_id INTEGER NOT NULL REFERENCES calibration(id), distance_time_s REAL,
  distance_temperature_k REAL, within_tolerance INTEGER NOT NULL,
  PRIMARY KEY(frame_id, calibration_id)) STRICT, WITHOUT ROWID;
CREATE TABLE product(id TEXT PRIMARY KEY NOT NULL, kind TEXT NOT NULL,
  run_id TEXT REFERENCES run(id), path TEXT NOT NULL, command TEXT NOT NULL,
  options_json TEXT NOT NULL, version TEXT NOT NULL, sha256 TEXT NOT NULL, seed INTEGER NOT NULL,
  created_utc_ns INTEGER NOT NULL, metadata_json TEXT NOT NULL) STRICT;
CREATE INDEX product_kind ON product(kind);
CREATE TABLE product_input(product_id TEXT NOT NULL REFERENCES product(id),
  position INTEGER NOT NULL, sha256 TEXT NOT NULL, PRIMARY KEY(product_id, position))
  STRICT, WITHOUT ROWID;
CREATE TABLE event(id INTEGER PRIMARY KEY, run_id TEXT REFERENCES run(id), utc_ns INTEGER NOT NULL,
  kind TEXT NOT NULL, detail TEXT NOT NULL) STRICT;
CREATE INDEX event_of_run ON event(run_id);
CREATE TABLE journal_mark(journal TEXT PRIMARY KEY NOT NULL, bytes INTEGER NOT NULL)
  STRICT, WITHOUT ROWID;
)sql";

// kMigrations[v] makes version v + 1 out of version v.
constexpr std::array<const char*, kSchemaVersion> kMigrations = {kVersion1};

int versionOf(Database& database) {
  return static_cast<int>(database.number("PRAGMA user_version"));
}

void refuseNewer(Database& database, int version) {
  if (version <= kSchemaVersion) return;
  throw ArchiveError(Exit::kBadData, database.file().string() + " has schema version " +
                                         std::to_string(version) +
                                         "; this patina knows versions up to " +
                                         std::to_string(kSchemaVersion) + ": use a newer patina");
}

void refuseForeign(Database& database) {
  const auto id = database.number("PRAGMA application_id");
  const bool empty = database.number("SELECT count(*) FROM sqlite_schema") == 0;
  if (id == kApplicationId || (id == 0 && empty)) return;
  throw ArchiveError(Exit::kBadData, database.file().string() + " is not a catalogue of patina");
}

}  // namespace

// The page cache fills with the pages of a run's rows: what it may take is what a daemon of weeks
// grows by. Pages that fell out of it come from the kernel's.
void configureWriter(Database& database, Durability durability) {
  database.run("PRAGMA temp_store=MEMORY; PRAGMA cache_size=-4096; PRAGMA foreign_keys=ON");
  refuseForeign(database);
  refuseNewer(database, versionOf(database));
  database.run("PRAGMA journal_mode=WAL; PRAGMA wal_autocheckpoint=2000");
  const bool full = durability == Durability::kFull;
  database.run(full ? "PRAGMA synchronous=FULL" : "PRAGMA synchronous=NORMAL");
  database.gatherWrites(full);
}

void createTables(Database& database) {
  for (int version = versionOf(database); version < kSchemaVersion; ++version) {
    Transaction transaction(database);
    // Another process may have been faster.
    if (versionOf(database) != version) continue;
    database.run(kMigrations[static_cast<std::size_t>(version)]);
    database.run("PRAGMA user_version=" + std::to_string(version + 1) +
                 "; PRAGMA application_id=" + std::to_string(kApplicationId));
    transaction.commit();
  }
}

void migrate(Database& database) {
  refuseForeign(database);
  refuseNewer(database, versionOf(database));
  createTables(database);
}

std::shared_ptr<Database> openForReading(const std::filesystem::path& file) {
  try {
    auto database = std::make_shared<Database>(file, Database::Access::kRead, realFileOps());
    database->number("SELECT count(*) FROM sqlite_schema");
    return database;
  } catch (const ArchiveError& e) {
    // On a read-only medium SQLite cannot make its shared memory; without a WAL it needs none.
    std::error_code error;
    const auto wal = std::filesystem::file_size(file.string() + "-wal", error);
    if (e.exit() != Exit::kCannotCreate || (!error && wal > 0)) throw;
    return std::make_shared<Database>(file, Database::Access::kReadImmutable, realFileOps());
  }
}

void checkVersion(Database& database) {
  refuseForeign(database);
  const int version = versionOf(database);
  refuseNewer(database, version);
  if (version == kSchemaVersion) return;
  throw ArchiveError(Exit::kBadData, database.file().string() + " has schema version " +
                                         std::to_string(version) + "; this patina reads version " +
                                         std::to_string(kSchemaVersion) +
                                         ": the next capture or import migrates it");
}

}  // namespace patina::db
