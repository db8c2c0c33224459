// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/unsynced.h"

#include <gmock/gmock.h>

namespace patina::db {
namespace {

using Kind = UndoEntry::Kind;
using ::testing::ElementsAre;

class Model : public ::testing::Test {
 protected:
  UndoEntry entry(Kind kind, const char* path, const char* to = "") {
    UndoEntry e;
    e.kind = kind;
    e.seq = ++seq_;
    e.path = path, e.to = to;
    return e;
  }
  void write(std::uint64_t file, const char* path) {
    UndoEntry e = entry(Kind::kWrite, path);
    e.file = file, e.bytes = 16;
    model_.apply(e);
  }
  void names(Kind kind, const char* path, const char* to = "") {
    model_.apply(entry(kind, path, to));
  }
  void says(Kind kind, std::uint64_t file, const char* folder, std::uint64_t upto) {
    UndoEntry e = entry(kind, folder);
    e.file = file, e.upto = upto;
    model_.apply(e);
  }
  std::uint64_t seq_ = 0;
  Unsynced model_;
};

TEST_F(Model, ForgetsOnlyWhatWasWrittenBeforeASyncBegan) {
  write(1, "/a/x");
  write(1, "/a/x");  // while the sync below was under way
  says(Kind::kSynced, 1, "", 1);
  EXPECT_EQ(model_.files().at(1).changes.size(), 1u);
  says(Kind::kSynced, 1, "", 2);
  EXPECT_TRUE(model_.empty());
}

TEST_F(Model, FollowsAFileThroughRenamesOfItAndOfItsFolder) {
  write(1, "/a/tmp/x");
  names(Kind::kRename, "/a/tmp/x", "/a/tmp/y");
  names(Kind::kRename, "/a/tmp", "/a/done");
  EXPECT_EQ(model_.fileAt("/a/done/y"), 1u);
  EXPECT_EQ(model_.fileAt("/a/tmp/y"), std::nullopt);
}

TEST_F(Model, KeepsWithASyncedFolderWhatItsNamesRestUpon) {
  names(Kind::kCreate, "/a/tmp/x");
  names(Kind::kCreate, "/a/tmp/other");
  names(Kind::kRename, "/a/tmp/x", "/a/done/x");
  says(Kind::kFolderSynced, 0, "/a/done", seq_);
  ASSERT_EQ(model_.names().size(), 1u);
  EXPECT_EQ(model_.names()[0].path, "/a/tmp/other");
}

TEST_F(Model, DoesNotKeepAFolderWhenOnlyItsOwnNamesAreSynced) {
  names(Kind::kMakeFolder, "/a/new");
  names(Kind::kCreate, "/a/new/x");
  says(Kind::kFolderSynced, 0, "/a/new", seq_);
  ASSERT_EQ(model_.names().size(), 1u);
  EXPECT_EQ(model_.names()[0].kind, Kind::kMakeFolder);
}

TEST_F(Model, DropsTheBytesOfAFileWhoseRemovalIsKept) {
  write(1, "/a/x");
  UndoEntry removal = entry(Kind::kRemove, "/a/x");
  removal.saved = 1;
  model_.apply(removal);
  write(2, "/a/x");  // another file under the same name
  EXPECT_EQ(model_.fileAt("/a/x"), 2u);
  says(Kind::kFolderSynced, 0, "/a", removal.seq);
  EXPECT_FALSE(model_.files().contains(1));
  EXPECT_TRUE(model_.files().contains(2));
  EXPECT_THAT(model_.takeSpentGraves(), ElementsAre(removal.seq));
  EXPECT_THAT(model_.takeSpentGraves(), ElementsAre());
}

TEST_F(Model, TakesACancelledRenameBackWithTheFileItWouldHaveReplaced) {
  write(1, "/a/x");
  write(2, "/a/y");
  names(Kind::kRename, "/a/x", "/a/y");
  EXPECT_EQ(model_.fileAt("/a/y"), 1u);
  says(Kind::kCancelled, 0, "", seq_);
  EXPECT_EQ(model_.fileAt("/a/x"), 1u);
  EXPECT_EQ(model_.fileAt("/a/y"), 2u);
  EXPECT_TRUE(model_.names().empty());
}

TEST_F(Model, NeverBelievesASyncAfterAFailedOne) {
  write(1, "/a/x");
  says(Kind::kSyncFailed, 1, "", 1);
  says(Kind::kSynced, 1, "", seq_);
  EXPECT_EQ(model_.files().at(1).changes.size(), 1u);
}

TEST_F(Model, BelievesTheSyncOfWhatWasWrittenAgainAfterAFailedOne) {
  write(1, "/a/x");
  says(Kind::kSyncFailed, 1, "", 1);
  write(1, "/a/x");
  says(Kind::kSynced, 1, "", seq_);
  EXPECT_TRUE(model_.empty());
}

}  // namespace
}  // namespace patina::db
