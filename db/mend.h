// SPDX-License-Identifier: GPL-3.0-or-later
// A catalogue out of journals that lost lines. Internal to db/.
#pragma once

#include "db/database.h"

namespace patina::db {

// Parents that the rows left behind refer to, and that are gone, get rows that say "unknown": a
// run, its specimen, rig and devices. Rows that mean nothing without what they refer to (a shot
// without its step) go; their frames are files still. Inside a transaction.
void mendReferences(Database& catalogue);

}  // namespace patina::db
