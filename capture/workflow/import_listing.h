// SPDX-License-Identifier: GPL-3.0-or-later
// What an import will bring: the pictures of a source, when each was taken, and which step it is.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "processing/image/picture_file.h"

namespace patina::workflow {

enum class TimesFrom { kInterval, kNames, kExif };

struct ListingOptions {
  std::filesystem::path source;  // a folder, a GIF, a film, or one picture
  TimesFrom times = TimesFrom::kInterval;
  Nanoseconds interval{};            // of kInterval
  std::optional<UtcTime> start_utc;  // of kInterval and "day 3"; default: the first file's mtime
  std::optional<std::filesystem::path> lights;  // .lp: the whole source is one step
};

// One shot to be: RAW+JPEG of one stem are two files of it.
struct ListedShot {
  std::vector<std::filesystem::path> files;  // empty: the next frame of the film
  std::string light;                         // a light id
  UtcTime utc;
};
struct ListedStep {
  std::optional<std::int64_t> number;  // nothing: an extra picture between two steps
  UtcTime due_utc;
  std::vector<ListedShot> shots;  // empty: nobody took it (missed)
};
struct ListedLight {
  std::string id;
  std::optional<std::array<double, 3>> direction;
};
struct Listing {
  bool film = false;  // steps are made as frames come: `steps` stays empty
  std::int64_t film_frames = 0;
  std::vector<ListedStep> steps;
  std::vector<ListedLight> lights;
  Nanoseconds interval{};                 // zero: the times have no rhythm
  UtcTime t0_utc;                         // of step 0
  std::vector<std::string> without_time;  // files left out because nothing says when
  std::string fingerprint;                // SHA-256 of all this: the same import again is seen
};

// Reads names and, where it must, metadata; no picture is decoded. Throws WorkflowError: kUsage
// (no such source, options that do not go together), kBadData (nothing usable in it).
Listing listSource(const ListingOptions& options);

bool isFilmFile(const std::filesystem::path& file);     // by its extension; GIF included
bool isPictureFile(const std::filesystem::path& file);  // by its extension
// Those of a folder, in natural order of their names. Throws WorkflowError(kBadData) when there is
// none.
std::vector<std::filesystem::path> picturesIn(const std::filesystem::path& folder);

}  // namespace patina::workflow
