// SPDX-License-Identifier: GPL-3.0-or-later
// What is made from frames, and how it could be made again: command, options, seed, version and
// inputs by hash. The same inputs give the same bytes, so neither times nor folders nor the number
// of threads enter the file; the row in the catalogue knows when.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "capture/workflow/facts.h"
#include "db/archive.h"
#include "processing/image/units.h"

namespace patina::workflow {

// How a product came about.
struct Making {
  std::string command;  // "patina ttf build"
  Facts options;        // those that change the result
  std::uint64_t seed = 0;
  std::string version;
  std::vector<std::string> input_sha256s;
  Facts facts() const;  // for the file itself; long lists of inputs by one hash over them
};

// "ttf-20240501T120000Z-banana-1": kind, run (or another name), and the next number that is free.
std::string freeProductId(const db::ArchiveReader& reader, const std::string& kind,
                          const std::string& of);

struct ProductFile {
  std::string id;
  std::filesystem::path path;  // where the file is to be written
  bool inside = false;         // below products/<id>/; otherwise the caller's own place
};
// Inside the archive (its folder is made) unless `out` names a place.
ProductFile placeProduct(const std::filesystem::path& archive, const std::string& id,
                         const std::string& file_name, const std::filesystem::path& out);

// Adds the row of a file that is whole. Hashes it.
db::ProductRow recordProduct(const std::filesystem::path& archive, const ProductFile& file,
                             const std::string& kind, const std::string& run_id,
                             const Making& making, const Facts& metadata, UtcTime now);

// The file of a product row.
std::filesystem::path pathOfProduct(const std::filesystem::path& archive,
                                    const db::ProductRow& product);
// By id, by a unique prefix of one, or "latest" of the kind. Throws WorkflowError(kUsage).
db::ProductRow findProduct(const db::ArchiveReader& reader, const std::string& kind,
                           const std::string& id);

}  // namespace patina::workflow
