// SPDX-License-Identifier: GPL-3.0-or-later
// A new catalogue in the place of an old one, which may be damaged or have a WAL. Internal to db/.
#pragma once

#include <filesystem>

#include "db/file_ops.h"

namespace patina::db {

// `fresh`, whole and in no journal mode that leaves files beside it, becomes catalog.sqlite. Under
// the archive's lock. A crash in between leaves the old catalogue, the new one, or none, and then
// the journals tell all.
void exchangeCatalogue(FileOps& files, const std::filesystem::path& archive,
                       const std::filesystem::path& fresh);

}  // namespace patina::db
