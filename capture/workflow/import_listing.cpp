// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/import_listing.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "capture/workflow/failure.h"
#include "capture/workflow/lights_file.h"
#include "capture/workflow/picture_times.h"
#include "processing/image/film_file.h"
#include "processing/image/sha256.h"
#include "processing/image/sidecar_file.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;

std::string lowerExtension(const fs::path& file) {
  std::string ext = file.extension().string();
  if (!ext.empty()) ext.erase(0, 1);
  std::transform(ext.begin(), ext.end(), ext.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ext;
}

template <std::size_t n>
bool isOneOf(const std::string& text, const std::array<const char*, n>& list) {
  return std::find(list.begin(), list.end(), text) != list.end();
}

constexpr std::array kRawExtensions = {"dng", "nef", "cr2", "cr3", "arw",
                                       "raf", "orf", "rw2", "pef", "srw"};

UtcTime modifiedTime(const fs::path& file) {
  struct stat info {};
  if (stat(file.c_str(), &info) != 0)
    throw WorkflowError(Exit::kIo, "cannot read " + file.string());
  return UtcTime{std::chrono::seconds(info.st_mtim.tv_sec) + Nanoseconds(info.st_mtim.tv_nsec)};
}

// Files of one shot: same stem, at most one of them raw, which comes first.
std::vector<std::vector<fs::path>> groupShots(std::vector<fs::path> files) {
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return naturalLess(a.filename().string(), b.filename().string());
  });
  std::vector<std::vector<fs::path>> shots;
  std::map<std::string, std::size_t> by_stem;
  for (const fs::path& file : files) {
    const bool raw = isOneOf(lowerExtension(file), kRawExtensions);
    const auto [at, is_new] = by_stem.try_emplace(file.stem().string(), shots.size());
    if (!is_new) {
      std::vector<fs::path>& shot = shots[at->second];
      const bool has_raw = isOneOf(lowerExtension(shot.front()), kRawExtensions);
      if (shot.size() == 1 && raw != has_raw) {
        shot.insert(raw ? shot.begin() : shot.end(), file);
        continue;
      }
    }
    shots.push_back({file});
  }
  return shots;
}

std::vector<fs::path> picturesOf(const fs::path& source) {
  if (fs::is_regular_file(source)) return {source};
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(source))
    if (entry.is_regular_file() && isPictureFile(entry.path()) &&
        entry.path().filename().string().front() != '.')
      files.push_back(entry.path());
  if (files.empty())
    throw WorkflowError(Exit::kBadData, "no picture lies in " + source.string() +
                                            " (JPEG, PNG, TIFF, EXR, DNG and raw files are)");
  return files;
}

std::optional<UtcTime> timeOf(const std::vector<fs::path>& shot, const ListingOptions& options) {
  if (options.times == TimesFrom::kNames)
    return timeFromName(shot.front().stem().string(), options.start_utc.value_or(UtcTime{}));
  // The whole file would be read again below; what a camera writes stands in its first megabytes.
  for (const fs::path& file : shot)
    if (const auto time = readMetadataOf(file, readFile(file)).taken_utc) return time;
  return std::nullopt;
}

void listByInterval(Listing& listing, const std::vector<std::vector<fs::path>>& shots,
                    const ListingOptions& options, const std::string& light) {
  listing.t0_utc = options.start_utc ? *options.start_utc : modifiedTime(shots.front().front());
  listing.interval = options.interval;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const UtcTime due = listing.t0_utc + static_cast<std::int64_t>(i) * options.interval;
    listing.steps.push_back({static_cast<std::int64_t>(i), due, {{shots[i], light, due}}});
  }
}

// Missed steps go where the rhythm has a place and no picture fills it.
void listByTimes(Listing& listing, const std::vector<std::vector<fs::path>>& shots,
                 const ListingOptions& options, const std::string& light) {
  std::vector<std::pair<UtcTime, const std::vector<fs::path>*>> timed;
  for (const auto& shot : shots) {
    if (const auto time = timeOf(shot, options))
      timed.emplace_back(*time, &shot);
    else
      listing.without_time.push_back(shot.front().filename().string());
  }
  if (timed.empty())
    throw WorkflowError(
        Exit::kBadData,
        "no file of " + options.source.string() +
            (options.times == TimesFrom::kNames
                 ? " has a time in its name (as 2023-05-17, 20230517_123015, day 3); give "
                   "--interval instead"
                 : " says in its EXIF data when it was taken; give --times names or --interval"));
  std::stable_sort(timed.begin(), timed.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<UtcTime> times;
  for (const auto& [time, shot] : timed) times.push_back(time);
  const Rhythm rhythm = findRhythm(times);
  listing.interval = rhythm.interval;
  if (!rhythm.regular) listing.interval = Nanoseconds{};
  listing.t0_utc = times.front();
  std::int64_t next = 0;
  UtcTime last = times.front();
  for (std::size_t i = 0; i < timed.size(); ++i) {
    const std::optional<std::int64_t> number = rhythm.numbers[i];
    if (number) {
      for (std::int64_t gap = 1; next < *number; ++next, ++gap)
        listing.steps.push_back({next, last + gap * rhythm.interval, {}});
      next = *number + 1;
      last = times[i];
    }
    listing.steps.push_back({number, times[i], {{*timed[i].second, light, times[i]}}});
  }
}

std::string lightId(const std::string& file) {
  std::string id = fs::path(file).stem().string();
  std::replace(id.begin(), id.end(), '+', '_');
  return id;
}

void listByLights(Listing& listing, const ListingOptions& options) {
  const std::vector<LightDirection> lights = readLights(*options.lights);
  const fs::path folder =
      fs::is_directory(options.source) ? options.source : options.source.parent_path();
  ListedStep step;
  step.number = 0;
  std::set<std::string> ids;
  for (const LightDirection& light : lights) {
    std::string id = lightId(light.file);
    if (!ids.insert(id).second) ids.insert(id = light.file);
    listing.lights.push_back({id, light.direction});
    step.shots.push_back({{folder / light.file}, id, {}});
  }
  listing.t0_utc = options.start_utc.value_or(UtcTime{});
  if (!options.start_utc)
    for (const ListedShot& shot : step.shots)
      if (fs::exists(shot.files.front())) {
        listing.t0_utc = modifiedTime(shot.files.front());
        break;
      }
  step.due_utc = listing.t0_utc;
  for (ListedShot& shot : step.shots) shot.utc = listing.t0_utc;
  listing.steps.push_back(std::move(step));
}

// By decoding them: what a container says of itself may be wrong.
std::int64_t countFrames(const fs::path& film) {
  FilmReader reader(film);
  std::int64_t frames = 0;
  while (reader.next()) ++frames;
  return frames;
}

std::string fingerprintOf(const Listing& listing, const ListingOptions& options) {
  std::string text = "import/1\n";
  if (listing.film) text += sha256OfFile(options.source).hex() + "\n";
  text +=
      std::to_string(listing.interval.count()) + " " + std::to_string(toNs(listing.t0_utc)) + "\n";
  for (const ListedStep& step : listing.steps)
    for (const ListedShot& shot : step.shots)
      for (const fs::path& file : shot.files) {
        std::error_code none;
        const std::uintmax_t bytes = fs::file_size(file, none);
        text += file.filename().string() + "\t" + std::to_string(none ? 0 : bytes) + "\t" +
                std::to_string(toNs(shot.utc)) + "\t" + shot.light + "\n";
      }
  return sha256(text).hex();
}

}  // namespace

bool isFilmFile(const fs::path& file) {
  return isOneOf(lowerExtension(file), std::array{"gif", "avi", "mp4", "mov", "mkv", "webm", "m4v",
                                                  "mpg", "mpeg", "wmv", "mts", "ogv"});
}

bool isPictureFile(const fs::path& file) {
  const std::string ext = lowerExtension(file);
  return isOneOf(ext, kRawExtensions) ||
         isOneOf(ext, std::array{"jpg", "jpeg", "png", "tif", "tiff", "exr"});
}

Listing listSource(const ListingOptions& options) {
  if (!fs::exists(options.source))
    throw WorkflowError(Exit::kUsage, "there is no " + options.source.string());
  Listing listing;
  if (options.lights) {
    listByLights(listing, options);
    listing.fingerprint = fingerprintOf(listing, options);
    return listing;
  }
  const std::string light = "ambient";
  listing.lights.push_back({light, std::nullopt});
  if (fs::is_regular_file(options.source) && isFilmFile(options.source)) {
    if (options.times != TimesFrom::kInterval)
      throw WorkflowError(Exit::kUsage, options.source.string() +
                                            " is a film: its frames have no times of their own; "
                                            "give --interval, as --interval 10min");
    listing.film = true;
    listing.film_frames = countFrames(options.source);
    listing.interval = options.interval;
    listing.t0_utc = options.start_utc ? *options.start_utc : modifiedTime(options.source);
  } else {
    const auto shots = groupShots(picturesOf(options.source));
    if (options.times == TimesFrom::kInterval)
      listByInterval(listing, shots, options, light);
    else
      listByTimes(listing, shots, options, light);
  }
  listing.fingerprint = fingerprintOf(listing, options);
  return listing;
}

std::vector<fs::path> picturesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && isPictureFile(entry.path())) files.push_back(entry.path());
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return naturalLess(a.string(), b.string());
  });
  if (files.empty()) throw WorkflowError(Exit::kBadData, "no picture lies in " + folder.string());
  return files;
}

}  // namespace patina::workflow
