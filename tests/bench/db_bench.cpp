// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

// One step of one shot: armed, a frame of 3 KB, three verdicts, acknowledged. On tmpfs.
void BM_CommitShot(benchmark::State& state) {
  const auto folder = patina::testing::TempFolder::inMemory();
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

}  // namespace
}  // namespace patina::db::testing
