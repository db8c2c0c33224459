// SPDX-License-Identifier: GPL-3.0-or-later
// The time-varying textures of an archive as a database: what ages, how, for how long, under which
// light, and who may use it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "db/archive.h"

namespace patina::workflow {

struct TtfEntry {
  std::string id, run_id, specimen, process, light, camera, licence, sha256;
  std::filesystem::path path;
  bool there = false;  // its file is where the row says
  std::int64_t frames = 0;
  int width_px = 0, height_px = 0;
  Nanoseconds interval{}, duration{};
  std::optional<double> humidity_percent, temperature_c;
  UtcTime t0_utc, created_utc;
  std::string metadata_json, options_json;
};
std::vector<TtfEntry> listTtfs(const db::ArchiveReader& reader);           // oldest first
TtfEntry findTtf(const db::ArchiveReader& reader, const std::string& id);  // prefix or "latest"

struct TtfQuery {
  std::vector<std::string> words{};  // each in any of the text fields, whatever its case
  std::string process{}, specimen{}, light{}, licence{};  // parts of them
  std::int64_t frames_least = 0;
  std::optional<Nanoseconds> interval_most{}, duration_least{};
  std::optional<double> humidity_least{}, humidity_most{};
};
std::vector<TtfEntry> searchTtfs(const db::ArchiveReader& reader, const TtfQuery& query);

// A folder NAME.h5, NAME.json and README.md that stands alone; whole or not at all. Refused without
// a licence (kUsage) and when the folder is there (kCannotCreate).
void publishTtf(const TtfEntry& entry, const std::string& licence,
                const std::filesystem::path& folder);

}  // namespace patina::workflow
