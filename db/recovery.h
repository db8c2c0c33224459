// SPDX-License-Identifier: GPL-3.0-or-later
// Brings catalogue, journals and frames together again. Internal to db/.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "db/archive_state.h"

namespace patina::db {

// What one journal holds behind its mark in the catalogue.
struct JournalTail {
  std::string name;
  std::int64_t mark = 0, size = 0;  // size < mark: the journal lost what the catalogue has
  std::vector<JournalBatch> batches;
};
std::vector<JournalTail> readTails(FileOps& files, const std::filesystem::path& archive,
                                   Database& database, CatalogueWriter& writer);
// Removes what died processes left in tmp/; answers how many. Under the archive's lock.
int sweepTemporaries(FileOps& files, const std::filesystem::path& archive);
// Whether every frame of a transaction lies in its place with the bytes it should have.
bool hasItsFrames(const std::filesystem::path& archive, const JournalBatch& batch);
void cutJournal(FileOps& files, const std::filesystem::path& journal, std::int64_t size);

// A file below frames/ as its hash and extension; nothing when its name is no such thing.
struct StoredName {
  Sha256 sha256;
  std::string ext;
};
std::optional<StoredName> parseFramePath(const std::filesystem::path& path);

// Moves frame files that no row and no line of a tail knows to quarantine/. kNewest looks only into
// folders that changed after the journals did: a frame that was placed and not journalled is newer
// than the last line. Into those of `dropped`, lines about to be cut off, it looks in any case, and
// syncs them: a frame that was taken away must not come back without its line. Answers the names
// of what was moved.
enum class OrphanSearch { kNewest, kEverywhere };
std::vector<std::string> quarantineOrphans(FileOps& files, const std::filesystem::path& archive,
                                           Database& database,
                                           const std::vector<JournalTail>& tails,
                                           OrphanSearch search,
                                           const std::vector<JournalBatch>& dropped = {});

}  // namespace patina::db
