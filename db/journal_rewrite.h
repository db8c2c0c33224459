// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a journal again from the catalogue, for the rare case that the journal is the shorter of
// the two (a disk that was full at the wrong moment, a file deleted by hand). Internal to db/.
#pragma once

#include <string>

#include "db/database.h"
#include "db/file_ops.h"

namespace patina::db {

// Written to tmp/, synced, exchanged whole. Answers its length in bytes.
std::int64_t rewriteJournal(FileOps& files, const std::filesystem::path& archive,
                            Database& database, const std::string& name);

}  // namespace patina::db
