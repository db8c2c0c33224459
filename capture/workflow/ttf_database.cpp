// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/ttf_database.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "capture/workflow/facts.h"
#include "capture/workflow/failure.h"
#include "capture/workflow/products.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;

TtfEntry entryOf(const db::ArchiveReader& reader, const db::ProductRow& row) {
  const Facts facts = Facts::parse(row.metadata_json);
  const auto count = [&](const char* key) {
    return static_cast<std::int64_t>(facts.number(key).value_or(0));
  };
  TtfEntry entry;
  entry.id = row.id;
  entry.run_id = row.run_id;
  entry.specimen = facts.text("specimen").value_or("");
  entry.process = facts.text("process").value_or("");
  entry.light = facts.text("light").value_or("");
  entry.camera = facts.text("camera").value_or("");
  entry.licence = facts.text("licence").value_or("");
  entry.sha256 = row.sha256;
  entry.path = pathOfProduct(reader.folder(), row);
  std::error_code none;
  entry.there = fs::is_regular_file(entry.path, none);
  entry.frames = count("frames");
  entry.width_px = static_cast<int>(count("width_px"));
  entry.height_px = static_cast<int>(count("height_px"));
  entry.interval = Nanoseconds(count("interval_ns"));
  entry.duration = Nanoseconds(count("duration_ns"));
  entry.humidity_percent = facts.number("humidity_percent");
  entry.temperature_c = facts.number("temperature_c");
  entry.t0_utc = utcFromNs(count("t0_utc_ns"));
  entry.created_utc = row.created_utc;
  entry.metadata_json = row.metadata_json;
  entry.options_json = row.options_json;
  return entry;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool holds(const std::string& text, const std::string& part) {
  return part.empty() || lower(text).find(lower(part)) != std::string::npos;
}

bool matches(const TtfEntry& entry, const TtfQuery& query) {
  const std::string all = entry.id + "\n" + entry.specimen + "\n" + entry.process + "\n" +
                          entry.light + "\n" + entry.camera + "\n" + entry.licence;
  for (const std::string& word : query.words)
    if (!holds(all, word)) return false;
  if (!holds(entry.process, query.process) || !holds(entry.specimen, query.specimen) ||
      !holds(entry.light, query.light) || !holds(entry.licence, query.licence))
    return false;
  if (entry.frames < query.frames_least) return false;
  if (query.interval_most && entry.interval > *query.interval_most) return false;
  if (query.duration_least && entry.duration < *query.duration_least) return false;
  if (!query.humidity_least && !query.humidity_most) return true;
  const std::optional<double> humidity = entry.humidity_percent;
  return humidity && *humidity >= query.humidity_least.value_or(*humidity) &&
         *humidity <= query.humidity_most.value_or(*humidity);
}

std::string readmeOf(const TtfEntry& entry, const std::string& licence) {
  std::string text = "# " + entry.id + "\n\nA time-varying texture: " + entry.specimen;
  if (!entry.process.empty()) text += ", " + entry.process;
  text += ".\n\n";
  const auto line = [&text](const std::string& name, const std::string& value) {
    if (!value.empty()) text += "- " + name + ": " + value + "\n";
  };
  line("frames", std::to_string(entry.frames) + " of " + std::to_string(entry.width_px) + "x" +
                     std::to_string(entry.height_px) + " pixels");
  line("interval", entry.interval > Nanoseconds{} ? formatDuration(entry.interval) : "irregular");
  line("duration", formatDuration(entry.duration));
  line("light", entry.light);
  if (entry.humidity_percent)
    line("humidity", std::to_string(std::lround(*entry.humidity_percent)) + " %");
  line("from", formatUtc(entry.t0_utc));
  line("sha256", entry.sha256);
  line("licence", licence);
  return text +
         "\nThe .h5 file is HDF5: `/frames [t][y][x][c]` linear light, `/time_s [t]` seconds since "
         "the start.\n";
}

}  // namespace

std::vector<TtfEntry> listTtfs(const db::ArchiveReader& reader) {
  std::vector<TtfEntry> entries;
  for (const db::ProductRow& row : reader.products("ttf")) entries.push_back(entryOf(reader, row));
  return entries;
}

TtfEntry findTtf(const db::ArchiveReader& reader, const std::string& id) {
  return entryOf(reader, findProduct(reader, "ttf", id));
}

std::vector<TtfEntry> searchTtfs(const db::ArchiveReader& reader, const TtfQuery& query) {
  std::vector<TtfEntry> found;
  for (TtfEntry& entry : listTtfs(reader))
    if (matches(entry, query)) found.push_back(std::move(entry));
  return found;
}

void publishTtf(const TtfEntry& entry, const std::string& licence, const fs::path& folder) {
  if (licence.empty())
    throw WorkflowError(Exit::kUsage,
                        entry.id + " has no licence; say who may use it, as --licence CC-BY-4.0");
  if (!entry.there)
    throw WorkflowError(Exit::kBadData,
                        "the file of " + entry.id + " is gone: " + entry.path.string());
  if (fs::exists(folder))
    throw WorkflowError(Exit::kCannotCreate, folder.string() + " is there already");
  if (sha256OfFile(entry.path).hex() != entry.sha256)
    throw WorkflowError(Exit::kBadData,
                        entry.path.string() + " is not the file that was recorded as " + entry.id);
  Facts facts = Facts::parse(entry.metadata_json);
  facts.text("licence", licence).text("id", entry.id).text("sha256", entry.sha256);
  fs::path unfinished = folder;
  unfinished += ".tmp" + std::to_string(getpid());
  std::error_code failed;
  fs::create_directories(unfinished, failed);
  if (!failed) fs::copy_file(entry.path, unfinished / (entry.id + ".h5"), failed);
  if (!failed) {
    writeFileAtomically(unfinished / (entry.id + ".json"), facts.json() + "\n");
    writeFileAtomically(unfinished / "README.md", readmeOf(entry, licence));
    fs::rename(unfinished, folder, failed);
  }
  if (!failed) return;
  std::error_code none;
  fs::remove_all(unfinished, none);
  throw WorkflowError(Exit::kCannotCreate,
                      "cannot write " + folder.string() + ": " + failed.message());
}

}  // namespace patina::workflow
