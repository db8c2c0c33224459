// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a journal again from the catalogue, for the rare case that the journal is the shorter of
// the two (a disk that was full at the wrong moment, a file deleted by hand) or has damaged lines.
// Internal to db/.
#pragma once

#include <string>
#include <string_view>

#include "db/database.h"
#include "db/file_ops.h"

namespace patina::db {

// Written to tmp/, synced, exchanged whole. `tail`: lines that the catalogue does not contain, kept
// at the end. Answers its length in bytes.
std::int64_t rewriteJournal(FileOps& files, const std::filesystem::path& archive,
                            Database& database, const std::string& name,
                            std::string_view tail = {});

}  // namespace patina::db
