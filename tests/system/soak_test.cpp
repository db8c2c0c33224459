// SPDX-License-Identifier: GPL-3.0-or-later
// The real daemon for days of rig time, a hundred times as fast as time, while things go wrong by a
// known script; what it takes of the machine is looked at from outside. PATINA_SOAK_MINUTES is how
// long, in minutes of the wall; unset: a short form of 13 steps.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "db/archive_reader.h"
#include "devices/scaled_clock.h"
#include "tests/capture/app/rehearsed.h"
#include "tests/support/resources.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

constexpr double kSpeed = 100;
constexpr int kShotsAStep = 2;
constexpr double kMegabyte = 1 << 20;

// Trouble of one kind, over every step of [from, to) and no other: it begins half an interval
// before the first and ends when the last must have given up and the next is not due.
struct Injected {
  enum Kind { kHang, kLampDead, kFrozen, kPaused, kLost };
  Kind kind;
  std::int64_t from, to;
};

struct Form {
  Nanoseconds interval{}, every{};  // of a step, in rig time; of a sample, in wall time
  std::int64_t steps = 0;
  std::vector<Injected> injected;
  bool is_long = false;
};

Form formAskedFor() {
  const char* text = std::getenv("PATINA_SOAK_MINUTES");
  Form form;
  form.is_long = text != nullptr;
  // A shot may be late by half an interval: 1 s of the wall in the short form, which runs beside
  // other tests, 0.6 s in the long one.
  form.interval = form.is_long ? 120s : 200s;
  form.every = form.is_long ? 1s : 100ms;
  const auto minutes = std::chrono::minutes(form.is_long ? std::atoi(text) : 0);
  form.steps = form.is_long ? minutes * static_cast<int>(kSpeed) / form.interval : 13;
  const std::int64_t lasts = form.is_long ? 10 : 1, apart = form.is_long ? 90 : 1;
  for (std::int64_t from = 3, i = 0; from + lasts < form.steps; from += lasts + apart, ++i)
    form.injected.push_back({static_cast<Injected::Kind>(i % 5), from, from + lasts});
  return form;
}

// The trouble as it was: a pause begins and ends at the steps its events name, for the word of a
// person may be late on a busy machine; the run must still have heeded each, and soon.
std::vector<Injected> asHeeded(const Form& form, const std::vector<db::EventRow>& events) {
  std::vector<std::int64_t> begun, ended;
  for (const db::EventRow& event : events) {
    if (event.kind != "paused" && event.kind != "continued") continue;
    const std::int64_t step = std::stoll(event.detail.substr(event.detail.rfind(' ') + 1));
    (event.kind == "paused" ? begun : ended).push_back(step);
  }
  constexpr std::int64_t kLateAtMost = 2;  // steps
  std::vector<Injected> heeded = form.injected;
  std::size_t n = 0;
  for (Injected& trouble : heeded) {
    if (trouble.kind != Injected::kPaused) continue;
    if (n >= begun.size() || n >= ended.size()) {
      ADD_FAILURE() << "not heeded: the pause of step " << trouble.from;
      break;
    }
    EXPECT_TRUE(begun[n] >= trouble.from && begun[n] <= trouble.from + kLateAtMost) << begun[n];
    EXPECT_TRUE(ended[n] >= trouble.to && ended[n] <= trouble.to + kLateAtMost) << ended[n];
    trouble.from = begun[n];
    trouble.to = ended[n++];
  }
  EXPECT_EQ(begun.size(), n);
  EXPECT_EQ(ended.size(), n);
  return heeded;
}

// What becomes of each step, derived by hand: whatever falls due while something is wrong, and
// nothing else, has the decision of its trouble.
std::map<std::int64_t, db::Decision> derivedByHand(std::int64_t steps,
                                                   const std::vector<Injected>& injected) {
  std::map<std::int64_t, db::Decision> decisions;
  for (std::int64_t k = 0; k < steps; ++k) decisions[k] = db::Decision::kCaptured;
  for (const Injected& trouble : injected)
    for (std::int64_t k = trouble.from; k < trouble.to; ++k) {
      constexpr db::Decision kBecomes[] = {db::Decision::kFailed, db::Decision::kHeld,
                                           db::Decision::kMissed, db::Decision::kSkipped,
                                           db::Decision::kFailed};
      decisions[k] = kBecomes[trouble.kind];
    }
  return decisions;
}

// A fault file for what the twin can do; the rest is done to the daemon from outside.
std::string faultsOf(const Form& form) {
  std::string text = "seed = 5\n";
  const auto fault = [&](const char* kind, const char* device, Nanoseconds at, Nanoseconds lasts) {
    text += std::string("[[fault]]\nkind = \"") + kind + "\"\ndevice = \"" + device +
            "\"\nat = \"" + formatDuration(at) + "\"\n";
    if (lasts > 0s) text += "duration = \"" + formatDuration(lasts) + "\"\n";
  };
  for (const Injected& trouble : form.injected) {
    const Nanoseconds at = trouble.from * form.interval - form.interval / 2;
    const Nanoseconds lasts =
        (trouble.to - trouble.from) * form.interval + form.interval * 15 / 100;
    if (trouble.kind == Injected::kHang) fault("hang", "cam0", at, lasts);
    if (trouble.kind == Injected::kLost) fault("lost", "cam0", at, lasts);
    if (trouble.kind == Injected::kLampDead) fault("lamp_dead", "fill", at, lasts);
    // Cured within its step by another attempt, of a camera that was well before.
    if (form.is_long || &trouble == &form.injected.front())
      fault("partial_file", "cam0", at - 2 * form.interval, 0s);
  }
  return text;
}

std::string planOf(const TempFolder& folder, const Form& form) {
  writeFile(folder / "faults.toml", faultsOf(form));
  writeFile(folder / "rig.toml", readFile(sourceFolder() / "examples/quick/rig.toml") +
                                     "faults = \"faults.toml\"\n[[light]]\nid = \"fill\"\n"
                                     "backend = \"twin\"\nposition_mm = [200.0, 220.0, 420.0]\n"
                                     "between = \"on\"\nsettings = { kind = \"led\" }\n");
  writeFile(folder / "plan.toml", "rig = \"rig.toml\"\nspecimen = \"copper\"\ninterval = \"" +
                                      formatDuration(form.interval) + "\"\nduration = \"" +
                                      formatDuration(form.steps * form.interval) +
                                      "\"\n[[sweep]]\nlights = [[\"key\"], [\"fill\"]]\n"
                                      "exposures = [\"1/50\"]\n[light_check]\n"
                                      "mode = \"controlled\"\nband = 0.05\nmax_hold = \"20s\"\n");
  return folder / "plan.toml";
}

struct Sample {
  double rig_days = 0;
  Resources taken;
};

class Soak : public ::testing::Test {
 protected:
  Finished patina(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--archive", archive_});
    return runPatina(std::move(arguments), environment_);
  }
  // Returns when the run has begun.
  void begin();
  void untilTheEnd();
  void act(const Injected& trouble, bool begins);
  void look();
  void tell(std::int64_t minute);
  void judgeSamples();
  void judgeSteps();

  MonoTime due(std::int64_t number) const { return t0_ + number * form_.interval; }

  const Form form_ = formAskedFor();
  TempFolder files_ = TempFolder::inMemory(), folder_;
  const std::string archive_ = folder_ / "archive";
  const std::vector<std::string> environment_ = {
      "RUNTIME_DIRECTORY=" + (files_ / "run").string(),
      "DBUS_SYSTEM_BUS_ADDRESS=unix:path=" + (files_ / "no-bus").string()};
  devices::RealClock real_;
  devices::ScaledClock rig_{real_, kSpeed};
  std::optional<Child> daemon_;
  std::string run_;
  MonoTime t0_;
  std::vector<Sample> samples_;
};

void Soak::begin() {
  const std::string plan = planOf(files_, form_);
  daemon_.emplace(std::vector<std::string>{program(), "daemon", "--archive", archive_, "--rehearse",
                                           "--speed", "100", "--port", "0"},
                  environment_);
  Finished asked;
  do {
    ASSERT_TRUE(isAlive(daemon_->pid())) << daemon_->wait().err;
    real_.sleepUntil(real_.mono() + 50ms, {});
    asked = patina({"run", "start", plan, "--json"});
  } while (asked.exit == 69);  // it does not listen yet
  run_ = answerOf(asked).text("/items/0/id");
  t0_ = db::ArchiveReader(archive_).findRun(run_).t0_boot;
}

// Stopped as a suspended machine is, or paused as a person does.
void Soak::act(const Injected& trouble, bool begins) {
  if (trouble.kind == Injected::kFrozen) daemon_->signal(begins ? SIGSTOP : SIGCONT);
  if (trouble.kind != Injected::kPaused) return;
  const Finished asked = patina({"run", begins ? "pause" : "resume", run_});
  EXPECT_EQ(asked.exit, 0) << asked.err;
}

void Soak::look() {
  const auto taken = resourcesOf(daemon_->pid(), archive_);
  ASSERT_TRUE(taken) << "the daemon is gone: " << daemon_->wait().err;
  samples_.push_back({toSeconds(rig_.mono() - t0_) / 86400, *taken});
}

void Soak::tell(std::int64_t minute) {
  const Sample& s = samples_.back();
  if (minute <= 1)
    std::printf("%7s %8s %9s %6s %9s\n", "minute", "rig_h", "rss_MB", "fds", "wal_MB");
  std::printf("%7lld %8.2f %9.2f %6d %9.2f\n", static_cast<long long>(minute), s.rig_days * 24,
              s.taken.resident_bytes / kMegabyte, s.taken.descriptors,
              s.taken.wal_bytes / kMegabyte);
  std::fflush(stdout);
  EXPECT_EQ(patina({"run", "status", run_}).exit, 0);  // somebody looks, now and then
}

void Soak::untilTheEnd() {
  struct Deed {
    MonoTime at;
    const Injected* trouble;
    bool begins;
  };
  std::vector<Deed> deeds;
  for (const Injected& trouble : form_.injected) {
    if (trouble.kind != Injected::kFrozen && trouble.kind != Injected::kPaused) continue;
    deeds.push_back({due(trouble.from) - form_.interval / 2, &trouble, true});
    // Woken when a step is due: that one is shot, those before it are too late by a whole interval.
    deeds.push_back(
        {due(trouble.to) - (trouble.kind == Injected::kPaused ? form_.interval / 2 : 0s), &trouble,
         false});
  }
  const MonoTime began = real_.mono(), end = due(form_.steps) + form_.interval;
  auto deed = deeds.begin();
  bool frozen = false;
  for (std::int64_t n = 1, minutes = 0; rig_.mono() < end; ++n) {
    const MonoTime sample_at = began + n * form_.every;
    for (; deed != deeds.end() && rig_.mono() + (sample_at - real_.mono()) * 100 >= deed->at;
         ++deed) {
      rig_.sleepUntil(deed->at, {});
      act(*deed->trouble, deed->begins);
      frozen = deed->begins && deed->trouble->kind == Injected::kFrozen;
    }
    real_.sleepUntil(sample_at, {});
    ASSERT_NO_FATAL_FAILURE(look());
    if (!form_.is_long || frozen || real_.mono() - began < (minutes + 1) * 1min) continue;
    tell(++minutes);
  }
}

// The line of least squares through resident memory, in bytes a day.
double growthADay(std::span<const Sample> samples) {
  const auto n = static_cast<double>(samples.size());
  double days = 0, bytes = 0, days_bytes = 0, days_days = 0;
  for (const Sample& s : samples) {
    days += s.rig_days / n;
    bytes += s.taken.resident_bytes / n;
  }
  for (const Sample& s : samples) {
    days_bytes += (s.rig_days - days) * (s.taken.resident_bytes - bytes);
    days_days += (s.rig_days - days) * (s.rig_days - days);
  }
  return days_bytes / days_days;
}

int medianOfDescriptors(std::span<const Sample> samples) {
  std::vector<int> counts;
  for (const Sample& s : samples) counts.push_back(s.taken.descriptors);
  std::nth_element(counts.begin(), counts.begin() + static_cast<int>(counts.size()) / 2,
                   counts.end());
  return counts[counts.size() / 2];
}

void Soak::judgeSamples() {
  // An eighth is for warming up: SQLite's page cache, the allocator's arenas.
  const std::span<const Sample> warm = std::span(samples_).subspan(samples_.size() / 8);
  const double days = warm.back().rig_days - warm.front().rig_days;
  const double grown = growthADay(warm) * days;
  const int early = medianOfDescriptors(warm.first(warm.size() / 3));
  const int late = medianOfDescriptors(warm.last(warm.size() / 3));
  double wal = 0, most = 0;
  for (const Sample& s : samples_) {
    wal = std::max(wal, s.taken.wal_bytes);
    most = std::max(most, s.taken.resident_bytes);
  }
  std::printf(
      "%.2f days of rig after %.2f of warm-up, %zu samples: resident at most %.2f MB, %+.3f MB a "
      "day (%+.3f MB in all); descriptors %d, at the end %d; WAL at most %.2f MB\n",
      days, warm.front().rig_days, samples_.size(), most / kMegabyte, growthADay(warm) / kMegabyte,
      grown / kMegabyte, early, late, wal / kMegabyte);
  // Half an hour of rig is too short for a slope.
  EXPECT_LT(grown, form_.is_long ? days * kMegabyte : 4 * kMegabyte);
  EXPECT_LE(late, early + 1);
  EXPECT_LT(wal, 64 * kMegabyte);
}

void Soak::judgeSteps() {
  const db::ArchiveReader archive(archive_);
  const auto expected = derivedByHand(form_.steps, asHeeded(form_, archive.events(run_)));
  std::map<std::int64_t, db::Decision> found;
  std::map<db::Decision, std::int64_t> counts;
  std::int64_t frames = 0, retries = 0;
  for (const db::StepRow& step : archive.steps(run_)) {
    ASSERT_TRUE(step.number);
    ++counts[step.decision];
    frames += step.shots_captured;
    retries += step.retries;
    found[*step.number] = step.decision;
    const auto right = expected.find(*step.number);
    ASSERT_NE(right, expected.end()) << *step.number;
    EXPECT_EQ(db::name(step.decision), std::string(db::name(right->second)))
        << "step " << *step.number << ": " << step.reason;
  }
  EXPECT_EQ(found.size(), expected.size());
  std::int64_t injected = 0;
  for (const auto& [number, decision] : expected) injected += decision != db::Decision::kCaptured;
  EXPECT_EQ(static_cast<std::int64_t>(expected.size()) - counts[db::Decision::kCaptured], injected);
  EXPECT_GE(frames, kShotsAStep * counts[db::Decision::kCaptured]);
  EXPECT_GT(retries, 0);
  std::printf(
      "%zu steps, %lld frames, %lld further attempts; %lld of them not captured, %lld injected:",
      found.size(), static_cast<long long>(frames), static_cast<long long>(retries),
      static_cast<long long>(found.size()) -
          static_cast<long long>(counts[db::Decision::kCaptured]),
      static_cast<long long>(injected));
  for (const auto& [decision, count] : counts)
    std::printf(" %s %lld", db::name(decision), static_cast<long long>(count));
  std::printf("\n");
}

TEST_F(Soak, TakesNoMoreAsDaysGoByAndMissesWhatIsMadeToBeMissed) {
  ASSERT_NO_FATAL_FAILURE(begin());
  ASSERT_NO_FATAL_FAILURE(untilTheEnd());
  EXPECT_EQ(db::ArchiveReader(archive_).findRun(run_).state, "finished");
  daemon_->signal(SIGTERM);
  const Finished finished = daemon_->wait();
  EXPECT_EQ(finished.exit, 0) << finished.err;
  judgeSamples();
  judgeSteps();
  EXPECT_EQ(patina({"archive", "verify"}).exit, 0);
}

}  // namespace
}  // namespace patina::testing
