// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <csignal>
#include <map>

#include "capture/workflow/lights_file.h"
#include "tests/capture/workflow/dome_run.h"
#include "tests/support/child.h"
#include "tests/support/places.h"

namespace patina::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

// Lights of the dome by lamp, for a run that has no rig.
std::string domeLights(const TempFolder& folder) {
  std::vector<workflow::LightDirection> lights;
  for (const auto& [lamp, at] : domeRig()) lights.push_back({lamp, at});
  workflow::writeLights(folder / "dome.lp", lights);
  return folder / "dome.lp";
}

std::map<std::string, std::string> bytesBelow(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      files[fs::relative(entry.path(), folder)] = sha256OfFile(entry.path()).hex();
  return files;
}

// Waits until a step's folder has got its name.
class StepWatch {
 public:
  explicit StepWatch(const std::string& set) : fd_(::inotify_init1(IN_CLOEXEC)) {
    EXPECT_GE(::inotify_add_watch(fd_, set.c_str(), IN_MOVED_TO), 0);
  }
  ~StepWatch() { ::close(fd_); }
  StepWatch(const StepWatch&) = delete;
  StepWatch& operator=(const StepWatch&) = delete;
  void wait() const {
    pollfd ready{fd_, POLLIN, 0};
    EXPECT_EQ(::poll(&ready, 1, 60'000), 1);
  }

 private:
  int fd_;
};

TEST(BrdfFitRun, GoesOnAfterAKillAndGivesTheBytesOfAnUndisturbedOne) {
  const TempFolder folder = TempFolder::inMemory();
  const std::string archive = folder / "archive", lights = domeLights(folder);
  const std::string run = makeDomeRun(archive, 4);
  const auto words = [&](const std::string& out) {
    return std::vector<std::string>{"brdf",     "fit",  run,     "--archive", archive,
                                    "--lights", lights, "--out", out,         "--quiet"};
  };
  const std::string killed = folder / "killed", undisturbed = folder / "undisturbed";
  fs::create_directories(killed);
  std::vector<std::string> command = words(killed);
  command.insert(command.begin(), program());
  const StepWatch watch(killed);
  Child child(command);
  watch.wait();
  child.signal(SIGKILL);
  child.wait();
  EXPECT_FALSE(fs::exists(killed + "/manifest.json"));
  ASSERT_EQ(runPatina(words(killed)).exit, 0);
  ASSERT_EQ(runPatina(words(undisturbed)).exit, 0);
  EXPECT_EQ(bytesBelow(killed), bytesBelow(undisturbed));
  EXPECT_EQ(runPatina(words(killed)).exit, 73);
}

TEST(BrdfFitRun, NamesPartialStepsAndRefusesWhatDoesNotGoTogether) {
  const TempFolder folder = TempFolder::inMemory();
  const std::string archive = folder / "archive", lights = domeLights(folder);
  const std::string run = makeDomeRun(archive, 3, 1);
  const std::vector<std::string> words{"brdf",  "fit",      run,   "--archive",
                                       archive, "--lights", lights};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), words.begin(), words.end());
    return runPatina(more);
  };
  const Finished fit = with({});
  EXPECT_EQ(fit.exit, 0) << fit.err;
  EXPECT_THAT(fit.err, HasSubstr("not whole were left out: 1"));
  EXPECT_EQ(with({"--texels-per-mm", "4"}).exit, 64);
  EXPECT_EQ(with({"--leave-out", "3"}).exit, 64);
  EXPECT_EQ(with({"--fiducial", "0,0,4,4"}).exit, 64) << "without --register";
  EXPECT_EQ(with({"--register", "translation", "--fiducial", "0,0,4"}).exit, 64);
  EXPECT_EQ(runPatina({"brdf", "fit", run, "--archive", archive}).exit, 65);  // no lamp is known
  EXPECT_EQ(runPatina({"brdf", "fit", run}).exit, 64);
}

}  // namespace
}  // namespace patina::testing
