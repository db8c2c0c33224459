// SPDX-License-Identifier: GPL-3.0-or-later
// care/gc-marks: since when each unnamed file has been seen, so that only what stayed unnamed and
// unchanged for the grace period goes. Losing it only makes things wait again. Internal to
// db/care/.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "db/file_ops.h"
#include "processing/image/units.h"

namespace patina::db::care {

// What tells a file, or all of a folder's files, from another one of the same name.
struct Identity {
  std::uint64_t inode = 0;
  std::int64_t bytes = 0, changed_ns = 0;  // the newest change of content or name
  bool operator==(const Identity&) const = default;
};
Identity identityOf(const std::filesystem::path& path);  // of a folder: of all that lies in it

struct Mark {
  Identity identity;
  UtcTime since;
};
using Marks = std::map<std::string, Mark>;  // by path below the archive

Marks readMarks(FileOps& files, const std::filesystem::path& archive);  // none: empty
void writeMarks(FileOps& files, const std::filesystem::path& archive, const Marks& marks);

// A small text of care/, whole or as it was.
void writeWhole(FileOps& files, const std::filesystem::path& path, const std::string& text);
std::string readWhole(FileOps& files, const std::filesystem::path& path);  // not there: empty

}  // namespace patina::db::care
