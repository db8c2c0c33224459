// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/disk/archive_life.h"

#include <chrono>
#include <cstring>
#include <set>

#include "processing/image/random.h"

namespace patina::testing {
namespace {

using db::ShotRow;
using db::StepRow;
constexpr const char* kRun = "20240501T120000Z-victim";
constexpr int kShots = 2;
const char* const kLights[kShots] = {"key", "off"};

UtcTime dueOf(std::int64_t step) {
  return utcFromNs(1'714'564'800'000'000'000 + step * 5'000'000'000);
}

// 1 to 12 KiB of noise.
Bytes frameOf(std::uint64_t seed, std::int64_t step, int shot) {
  const std::uint64_t own = hashSeed(seed, static_cast<std::uint64_t>(step), shot);
  Bytes bytes(1024 + uniformBelow(own, 11 * 1024));
  for (std::size_t i = 0; i < bytes.size(); i += sizeof own) {
    const std::uint64_t word = hashSeed(own, i);
    std::memcpy(bytes.data() + i, &word, std::min(sizeof word, bytes.size() - i));
  }
  return bytes;
}

std::int64_t openRun(db::Archive& archive, std::uint64_t seed) {
  const auto state = archive.runState(kRun);
  if (!state) {
    db::RunRow run;
    run.id = kRun;
    run.specimen = "noise";
    run.t0_utc = dueOf(0);
    run.seed = seed;
    run.state = "running";
    run.rig = "victim";
    archive.beginRun(run, {});
    return 0;
  }
  if (state->unfinished) {
    StepRow step = *state->unfinished;
    step.decision = db::Decision::kFailed;
    step.reason = "interrupted";
    step.shots_captured = 0;
    for (const ShotRow& shot : archive.reader().shotsOfStep(step.id))
      step.shots_captured += shot.state == db::ShotState::kCaptured;
    archive.finishStep(step);
  }
  return state->last_number.value_or(-1) + 1;
}

void shoot(db::Archive& archive, StepRow& step, int index, std::uint64_t seed,
           const std::function<void(const Acked&)>& acked) {
  ShotRow shot;
  shot.step_id = step.id;
  shot.device_id = "cam0";
  shot.light_state = kLights[index];
  shot.exposure = std::chrono::milliseconds(10);
  shot.began_utc = step.due_utc;
  shot.id = archive.armShot(shot);
  const Bytes bytes = frameOf(seed, *step.number, index);
  db::PendingFrame frame;
  frame.ext = "dng";
  frame.bytes = bytes;
  frame.size = {64, 48};
  frame.utc = step.due_utc;
  step.shots_captured = index + 1;
  step.decision = db::Decision::kCaptured;
  const bool last = index + 1 == kShots;
  const auto rows =
      archive.acknowledge(shot, {&frame, 1}, {}, step.due_utc, last ? &step : nullptr);
  acked({rows.at(0).sha256.hex(), *step.number, index, shot.id});
}

}  // namespace

void liveOn(const db::ArchiveOptions& options, std::int64_t steps, std::uint64_t seed,
            const std::function<void(const Acked&)>& acked) {
  db::Archive archive(options);
  const std::int64_t first = openRun(archive, seed);
  for (std::int64_t number = first; number < first + steps; ++number) {
    StepRow step;
    step.run_id = kRun;
    step.number = number;
    step.due_utc = dueOf(number);
    step.shots_due = kShots;
    step.id = archive.beginStep(step);
    for (int index = 0; index < kShots; ++index) shoot(archive, step, index, seed, acked);
  }
}

std::vector<std::string> Judge::judgeCatalogue(const std::filesystem::path& archive) const {
  std::vector<std::string> problems;
  std::map<std::string, int> seen;
  std::set<std::string> places;
  const db::ArchiveReader reader(archive);
  const auto runs = reader.runs();
  if (runs.empty()) {
    if (!acked_.empty()) problems.push_back("the run is gone");
    return problems;
  }
  std::int64_t expected = 0;
  for (const StepRow& step : reader.steps(runs.back().id))
    if (step.number != expected++)
      problems.push_back("step " + std::to_string(step.number.value_or(-1)) + " instead of " +
                         std::to_string(expected - 1));
  reader.eachFrame(runs.back().id, [&](const db::ArchiveReader::CapturedFrame& captured) {
    const std::string hash = captured.frame.sha256.hex();
    ++seen[hash];
    const db::ShotRow& shot = captured.shot;
    const std::string place = "step " + std::to_string(captured.step.number.value_or(-1)) + " " +
                              shot.device_id + " " + shot.light_state + " " +
                              std::to_string(shot.exposure_index) + " file " +
                              std::to_string(captured.frame.file_index);
    if (captured.step.number && !places.insert(place).second)
      problems.push_back(place + " is there twice");
    const auto it = acked_.find(hash);
    if (it == acked_.end()) return;  // its process died before it could tell
    if (it->second.step >= 0 && it->second.step != captured.step.number)
      problems.push_back(hash + " is in another step");
    if (it->second.shot_id != 0 && it->second.shot_id != shot.id)
      problems.push_back(hash + " is of another shot");
    try {
      if (reader.read(captured.frame).size() != static_cast<std::size_t>(captured.frame.bytes))
        problems.push_back(hash + " has another size");
    } catch (const db::ArchiveError& e) {
      problems.push_back(hash + ": " + e.what());
    }
  });
  for (const auto& [hash, acked] : acked_) {
    const auto it = seen.find(hash);
    if (it == seen.end())
      problems.push_back("step " + std::to_string(acked.step) + " lost " + hash);
    else if (it->second != 1)
      problems.push_back(hash + " has " + std::to_string(it->second) + " rows");
  }
  return problems;
}

std::vector<std::string> Judge::judgeRecovered(const std::filesystem::path& archive) const {
  std::vector<std::string> problems = judgeCatalogue(archive);
  Progress progress;
  for (const db::VerifyProblem& p : db::verify(archive, progress).problems)
    problems.push_back("verify: " + p.what + " " + p.path + ": " + p.detail);
  return problems;
}

}  // namespace patina::testing
