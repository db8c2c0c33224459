// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/ttf_database.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "capture/workflow/ttf_product.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using testing::TempFolder;

class TtfDatabase : public ::testing::Test {
 protected:
  TtfDatabase() {
    testing::makeRun(archive_, std::vector<testing::MadeStep>(4, {{testing::MadeShot{}}}));
    add("Ripening", "CC-BY-4.0", 1);
    add("rusting", "", 2);
  }
  void add(const std::string& process, const std::string& licence, int every) {
    TtfRequest request;
    request.run = "latest";
    request.process = process;
    request.licence = licence;
    request.selection.every = every;
    Progress progress;
    makeTtf(archive_, request, testing::now(), progress);
  }
  std::vector<std::string> processes(const TtfQuery& query) {
    std::vector<std::string> found;
    for (const TtfEntry& entry : searchTtfs(db::ArchiveReader(archive_), query))
      found.push_back(entry.process);
    return found;
  }
  TempFolder folder_ = TempFolder::inMemory();
  const std::filesystem::path archive_ = folder_ / "archive";
};

TEST_F(TtfDatabase, FindsByWordsWhateverTheirCase) {
  EXPECT_THAT(processes({}), ::testing::ElementsAre("Ripening", "rusting"));
  EXPECT_THAT(processes({.words = {"ripen"}}), ::testing::ElementsAre("Ripening"));
  EXPECT_THAT(processes({.words = {"MADE", "RUST"}}), ::testing::ElementsAre("rusting"));
  EXPECT_TRUE(processes({.words = {"rust", "ripen"}}).empty());
}

TEST_F(TtfDatabase, FindsByWhatWasMeasured) {
  EXPECT_THAT(processes({.frames_least = 3}), ::testing::ElementsAre("Ripening"));
  EXPECT_THAT(processes({.interval_most = std::chrono::minutes(10)}),
              ::testing::ElementsAre("Ripening"));
  EXPECT_THAT(processes({.licence = "cc"}), ::testing::ElementsAre("Ripening"));
  EXPECT_TRUE(processes({.humidity_least = 10}).empty());  // nothing measured it
}

TEST_F(TtfDatabase, PublishesAFolderThatStandsAlone) {
  const TtfEntry entry = findTtf(db::ArchiveReader(archive_), "ttf-20240501T000000Z-made-1");
  publishTtf(entry, entry.licence, folder_ / "out");
  EXPECT_EQ(sha256OfFile(folder_ / "out" / (entry.id + ".h5")).hex(), entry.sha256);
  EXPECT_THAT(testing::readFile(folder_ / "out/README.md"), ::testing::HasSubstr("CC-BY-4.0"));
  EXPECT_THAT(testing::readFile(folder_ / "out" / (entry.id + ".json")),
              ::testing::HasSubstr("\"process\":\"Ripening\""));
}

TEST_F(TtfDatabase, RefusesToPublishWithoutALicenceOrOverSomething) {
  const db::ArchiveReader reader(archive_);
  const TtfEntry entry = findTtf(reader, "latest");
  const auto exitOf = [&](const std::string& licence, const std::filesystem::path& folder) {
    try {
      publishTtf(entry, licence, folder);
    } catch (const WorkflowError& error) {
      return error.exit();
    }
    return Exit::kOk;
  };
  EXPECT_EQ(exitOf("", folder_ / "out"), Exit::kUsage);
  EXPECT_EQ(exitOf("CC0-1.0", archive_), Exit::kCannotCreate);
  testing::writeFile(entry.path, "other bytes");
  EXPECT_EQ(exitOf("CC0-1.0", folder_ / "out"), Exit::kBadData);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

}  // namespace
}  // namespace patina::workflow
