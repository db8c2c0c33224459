// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/products.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using testing::TempFolder;

class Products : public ::testing::Test {
 protected:
  Products() { testing::makeRun(folder_.path(), {{{testing::MadeShot{}}}}); }
  db::ProductRow add(const std::string& of) {
    const db::ArchiveReader reader(folder_.path());
    const ProductFile file =
        placeProduct(folder_.path(), freeProductId(reader, "sheet", of), "sheet.png", {});
    testing::writeFile(file.path, "picture of " + file.id);
    Making making;
    making.command = "patina sheet";
    making.version = "0";
    return recordProduct(folder_.path(), file, "sheet", "", making, {},
                         testing::now() + std::chrono::minutes(++added_));
  }
  TempFolder folder_ = TempFolder::inMemory();
  int added_ = 0;
};

TEST_F(Products, CountTheirIdsUp) {
  EXPECT_EQ(add("moss").id, "sheet-moss-1");
  EXPECT_EQ(add("moss").id, "sheet-moss-2");
  EXPECT_EQ(add("fern").id, "sheet-fern-1");
}

TEST_F(Products, AreFoundByIdPrefixOrAsTheLatest) {
  add("moss");
  add("fern");
  const db::ArchiveReader reader(folder_.path());
  EXPECT_EQ(findProduct(reader, "sheet", "sheet-moss-1").id, "sheet-moss-1");
  EXPECT_EQ(findProduct(reader, "sheet", "sheet-f").id, "sheet-fern-1");
  EXPECT_EQ(findProduct(reader, "sheet", "latest").id, "sheet-fern-1");
  EXPECT_THROW(findProduct(reader, "sheet", "sheet-"), WorkflowError);
  EXPECT_THROW(findProduct(reader, "film", "latest"), WorkflowError);
}

TEST_F(Products, KnowTheirFileAndItsHash) {
  const db::ProductRow row = add("moss");
  const auto path = pathOfProduct(folder_.path(), row);
  EXPECT_EQ(testing::readFile(path), "picture of sheet-moss-1");
  EXPECT_EQ(row.sha256, sha256OfFile(path).hex());
}

TEST(Making, NamesItsInputsAndNoTimeOrPlace) {
  Making making;
  making.command = "patina film";
  making.input_sha256s = {"aa", "bb"};
  const Facts facts = making.facts();
  EXPECT_EQ(facts.number("inputs"), 2);
  making.input_sha256s = {"aa", "bc"};
  EXPECT_NE(making.facts().text("inputs_sha256"), facts.text("inputs_sha256"));
}

}  // namespace
}  // namespace patina::workflow
