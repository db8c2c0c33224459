// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/doctor/commit_probe.h"

#include <unistd.h>

#include <algorithm>
#include <string>
#include <vector>

#include "db/archive.h"
#include "processing/image/random.h"

namespace patina::doctor {
namespace {

class Scratch {
 public:
  explicit Scratch(const std::filesystem::path& folder)
      : path_(folder / (".patina-doctor-" + std::to_string(::getpid()))) {}
  ~Scratch() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace

CommitLatency probeCommits(const std::filesystem::path& folder, devices::Clock& clock, int shots,
                           std::int64_t frame_bytes) {
  const Scratch scratch(folder);
  db::ArchiveOptions options;
  options.folder = scratch.path();
  options.owner = "patina doctor";
  options.allow_network_file_system = true;  // judged elsewhere
  db::Archive archive(options);
  db::RunRow run;
  run.id = run.specimen = run.rig = "doctor";
  run.state = "running";
  archive.beginRun(run, {});
  Bytes bytes(static_cast<std::size_t>(frame_bytes));
  std::vector<Nanoseconds> took;
  for (int number = 0; number < shots; ++number) {
    for (std::size_t i = 0; i < bytes.size(); i += sizeof(std::uint64_t))
      bytes[i] = static_cast<std::byte>(hashSeed(static_cast<std::uint64_t>(number), i));
    db::StepRow step;
    step.run_id = run.id;
    step.number = number;
    step.shots_due = 1;
    const MonoTime began = clock.mono();
    step.id = archive.beginStep(step);
    db::ShotRow shot;
    shot.step_id = step.id;
    shot.device_id = "none";
    shot.light_state = "off";
    shot.id = archive.armShot(shot);
    db::PendingFrame frame;
    frame.ext = "bin";
    frame.bytes = bytes;
    step.decision = db::Decision::kCaptured;
    step.shots_captured = 1;
    archive.acknowledge(shot, {&frame, 1}, {}, clock.utc(), &step);
    took.push_back(clock.mono() - began);
  }
  std::ranges::sort(took);
  return {took[took.size() / 2], took.back()};
}

}  // namespace patina::doctor
