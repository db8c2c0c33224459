// SPDX-License-Identifier: GPL-3.0-or-later
// trash/: what no row named for long enough, under the path it had, until it goes for good.
// Internal to db/.
//
// A frame may be named in the very moment it is moved there: a shot with equal bytes found the file
// in its place and commits now. Its journal line was written before it looked, so whoever moves a
// frame reads rows and journals afterwards and puts it back when one names it. A death in between
// is made good by the next start of the owner, or of the sweep.
#pragma once

#include <filesystem>
#include <vector>

#include "db/recovery.h"

namespace patina::db {

// Whether a row or a line of a journal's tail names the file.
bool isNamed(Database& database, const std::vector<JournalTail>& tails, const StoredName& name);

// Puts frames of trash/frames/ that are named back into their places. Answers the paths they have
// again.
std::vector<std::filesystem::path> returnNamedFrames(FileOps& files,
                                                     const std::filesystem::path& archive,
                                                     Database& database,
                                                     const std::vector<JournalTail>& tails);

}  // namespace patina::db
