// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include "tests/db/many_rows.h"
#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

using patina::testing::TempFolder;

// One step of one shot: armed, a frame of 3 KB, three verdicts, acknowledged. On tmpfs.
void BM_CommitShot(benchmark::State& state) {
  const TempFolder folder = TempFolder::inMemory();
  Archive archive(optionsFor(folder / "archive"));
  beginRun(archive);
  std::int64_t number = 0;
  for (auto _ : state) {
    capture(archive, number, static_cast<std::uint64_t>(number));
    ++number;
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_CommitShot)->Iterations(20000)->Unit(benchmark::kMicrosecond);

// An archive with a million frames, made once for all questions.
constexpr std::int64_t kFrames = 1'000'000;
const std::filesystem::path& millionFrames() {
  static const TempFolder folder = TempFolder::inMemory();
  static const std::filesystem::path path = [] {
    auto archive = folder / "archive";
    {
      Archive owner(optionsFor(archive));
      beginRun(owner);
    }
    fillCatalogue(archive, kFrames);
    return archive;
  }();
  return path;
}

template <class Ask>
void askAMillion(benchmark::State& state, Ask ask) {
  const ArchiveReader reader(millionFrames());
  std::uint64_t question = 0;
  for (auto _ : state) {
    const auto number =
        1 + static_cast<std::int64_t>(uniformBelow(hashSeed(++question), kFrames - 1));
    benchmark::DoNotOptimize(ask(reader, number));
  }
}

void BM_MillionNewestFrame(benchmark::State& state) {
  askAMillion(state, [](const ArchiveReader& r, std::int64_t) { return r.newestFrame(kRunId); });
}
void BM_MillionFramesOfStep(benchmark::State& state) {
  askAMillion(state, [](const ArchiveReader& r, std::int64_t n) { return r.framesOfStep(n); });
}
void BM_MillionStep(benchmark::State& state) {
  askAMillion(state, [](const ArchiveReader& r, std::int64_t n) { return r.step(kRunId, n); });
}
// An hour of frames at 5 s.
void BM_MillionFramesBetween(benchmark::State& state) {
  askAMillion(state, [](const ArchiveReader& r, std::int64_t n) {
    return r.framesBetween(kRunId, at(5 * n), at(5 * n + 3600));
  });
}
// The few that need a look: no step failed, a hundred were held.
void BM_MillionStepsHeld(benchmark::State& state) {
  askAMillion(
      state, [](const ArchiveReader& r, std::int64_t) { return r.steps(kRunId, Decision::kHeld); });
}
// A start after a death: lock, probe, recovery.
void BM_MillionOpen(benchmark::State& state) {
  for (auto _ : state) const Archive archive(optionsFor(millionFrames()));
}
BENCHMARK(BM_MillionNewestFrame)->Unit(benchmark::kMicrosecond)->Repetitions(5);
BENCHMARK(BM_MillionFramesOfStep)->Unit(benchmark::kMicrosecond)->Repetitions(5);
BENCHMARK(BM_MillionStep)->Unit(benchmark::kMicrosecond)->Repetitions(5);
BENCHMARK(BM_MillionFramesBetween)->Unit(benchmark::kMicrosecond)->Repetitions(5);
BENCHMARK(BM_MillionStepsHeld)->Unit(benchmark::kMicrosecond)->Repetitions(5);
BENCHMARK(BM_MillionOpen)->Unit(benchmark::kMillisecond)->Iterations(5);

}  // namespace
}  // namespace patina::db::testing
