// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/system/dslr_oracle.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "db/archive_reader.h"
#include "devices/rig.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;
using devices::twin::dslr::TruePicture;
using devices::twin::dslr::Truth;

// The exposure that gave these bytes; a stale picture is a copy of one, and none itself.
const TruePicture* exposureOf(const Sha256& sha256, const Truth& truth) {
  for (const TruePicture& picture : truth.pictures) {
    if (picture.stale) continue;
    for (const auto& file : picture.files)
      if (file.hash == sha256) return &picture;
  }
  return nullptr;
}

std::string lampsOf(const TruePicture& picture, const std::vector<std::string>& lamps) {
  std::vector<std::string> on;
  for (std::size_t i = 0; i < lamps.size(); ++i)
    if (picture.levels.at(i) > 0.5) on.push_back(lamps[i]);
  return devices::lightStateName(on);
}

}  // namespace

DslrVerdict judge(const std::filesystem::path& archive, const std::vector<std::string>& run_ids,
                  const Truth& truth, const std::vector<std::string>& lamps, Nanoseconds slack) {
  DslrVerdict verdict;
  std::set<Sha256> archived;
  std::map<std::uint64_t, db::RowId> shot_of_picture;
  const db::ArchiveReader reader(archive);
  const auto look = [&](const db::ArchiveReader::CapturedFrame& row) {
    ++verdict.frames;
    archived.insert(row.frame.sha256);
    const std::string which = "step " + std::to_string(row.step.number.value_or(-1)) + ", shot " +
                              std::to_string(row.shot.id) + ": ";
    const auto broken = [&](const std::string& what) { verdict.broken.push_back(which + what); };
    const TruePicture* picture = exposureOf(row.frame.sha256, truth);
    if (!picture) return broken("the camera never took this picture");
    const auto [other, first] = shot_of_picture.emplace(picture->count, row.shot.id);
    if (!first && other->second != row.shot.id)
      broken("has the picture of shot " + std::to_string(other->second));
    if (picture->begin_mono + slack < row.shot.began_mono)
      broken("its picture was exposed before it began");
    if (picture->exposure.time != row.shot.exposure ||
        picture->exposure.iso.value != row.shot.iso ||
        picture->exposure.f_number.value != row.shot.f_number)
      broken("taken with " + formatExposure(picture->exposure.time) + ", its row says " +
             formatExposure(row.shot.exposure));
    if (lampsOf(*picture, lamps) != row.shot.light_state)
      broken("lit by " + lampsOf(*picture, lamps) + ", its row says " + row.shot.light_state);
  };
  for (const std::string& run_id : run_ids) reader.eachFrame(run_id, look);
  for (const TruePicture& picture : truth.pictures) {
    for (const auto& file : picture.files) {
      const bool is_archived = archived.contains(file.hash);
      verdict.lost_with_power += file.lost && !is_archived;
      if (file.deleted_utc && !is_archived)
        verdict.broken.push_back("picture " + std::to_string(picture.count) + ", " + file.name +
                                 ": the camera had it, and it is lost");
      verdict.on_card += !file.deleted_utc && !file.lost;
    }
  }
  return verdict;
}

}  // namespace patina::testing
