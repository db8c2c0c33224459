// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/daemon.h"

#include <gmock/gmock.h>

#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <thread>

#include "capture/app/daemon/places.h"
#include "capture/app/http/client.h"
#include "db/archive.h"
#include "db/product_writer.h"
#include "tests/support/temp_folder.h"

namespace patina::daemon {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

// A daemon in this process, on an archive with a finished run whose products are due.
class DaemonTest : public ::testing::Test {
 protected:
  DaemonTest() {
    setenv("RUNTIME_DIRECTORY", folder_.path().c_str(), 1);
    setenv("DBUS_SYSTEM_BUS_ADDRESS", "unix:path=/no/such/bus", 1);
    db::ArchiveOptions options;
    options.folder = folder_ / "a";
    db::Archive archive(options);
    db::RunRow run;
    run.id = "r";
    run.specimen = "card";
    run.state = "finished";
    run.plan_toml =
        "rig = \"rig.toml\"\nspecimen = \"card\"\ninterval = \"10min\"\nduration = \"2h\"\n"
        "[[sweep]]\nlights = [[\"key\"]]\nexposures = [\"1/50\"]\n[after]\nsteps = [\"ttf\"]\n";
    db::SpecimenRow specimen;
    specimen.name = "card";
    archive.beginRun(run, specimen);
  }
  ~DaemonTest() override {
    unsetenv("RUNTIME_DIRECTORY");
    unsetenv("DBUS_SYSTEM_BUS_ADDRESS");
  }
  // Runs until it has said `words`, then asks it for its alerts.
  std::string alertsAfter(const std::string& words, const std::vector<std::string>& after) {
    DaemonOptions options;
    options.archive = folder_ / "a";
    options.port = 0;
    options.after_command = after;
    options.say = [this](const std::string& line) {
      const std::lock_guard lock(mutex_);
      said_ += line + "\n";
      changed_.notify_all();
    };
    Daemon daemon(options, clock_);
    std::stop_source stop;
    std::thread thread([&] { daemon.run(stop.get_token()); });
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return said_.find(words) != std::string::npos; });
    }
    std::string alerts =
        http::Client(placesToCall(options.archive).socket).call("GET", "/api/v1/alerts").body;
    stop.request_stop();
    thread.join();
    return alerts;
  }
  std::vector<std::string> events() {
    std::vector<std::string> events;
    for (const db::EventRow& event : db::ArchiveReader(folder_ / "a").events("r"))
      events.push_back(event.kind + " " + event.detail);
    return events;
  }

  testing::TempFolder folder_ = testing::TempFolder::inMemory();
  devices::RealClock clock_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string said_;
};

TEST_F(DaemonTest, TellsOfProductsThatFailAndWhenTheyAreTriedAgain) {
  const std::string alerts = alertsAfter("tried again", {"/bin/sh", "-c", "exit 74"});
  EXPECT_THAT(alerts,
              AllOf(HasSubstr("products of r failed"), HasSubstr("exit 74; tried again in 1min")));
  EXPECT_THAT(events(), Contains("after failed: exit 74; tried again in 1min"));
}

TEST_F(DaemonTest, TellsOfDamageThatAScrubHasFound) {
  const std::vector<db::EventRow> damage = {
      {0, {}, utcFromNs(7), "scrub_damage", "hash frames/ab/cd.jpg: is not what it was"}};
  db::ProductWriter::addEvents(folder_ / "a", damage);
  EXPECT_THAT(alertsAfter("products of r: done", {"/bin/true"}),
              AllOf(HasSubstr("archive damaged"), HasSubstr("frames/ab/cd.jpg")));
}

}  // namespace
}  // namespace patina::daemon
