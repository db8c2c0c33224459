// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of the catalogue, their version and how an older one becomes the newest.
#pragma once

#include <filesystem>
#include <memory>

#include "db/database.h"

namespace patina::db {

constexpr int kSchemaVersion = 1;
constexpr int kApplicationId = 0x50544e41;  // "PTNA": file(1) and a wrong database are told apart

enum class Durability { kFull, kNormal /* a mutant of the tests */ };

// Settings of a connection that writes: WAL, foreign keys, short waits, sane checkpoints.
void configureWriter(Database& database, Durability durability);
// Makes the tables in an empty database and migrates older ones, each version in a transaction of
// its own. ArchiveError(kBadData), naming both versions, when the schema is newer than ours, or
// when the database is not a catalogue.
void migrate(Database& database);
// For readers, who cannot migrate: throws unless the version is exactly ours.
void checkVersion(Database& database);
// A connection that only reads, also of an archive on a read-only medium.
std::shared_ptr<Database> openForReading(const std::filesystem::path& file);
// Tables alone, without WAL: for a catalogue that is being rebuilt and for comparisons.
void createTables(Database& database);

}  // namespace patina::db
