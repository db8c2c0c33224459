// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/catalogue_exchange.h"

#include <gtest/gtest.h>

#include "db/database.h"
#include "db/schema.h"
#include "tests/db/hooked_disk.h"
#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

namespace fs = std::filesystem;
using patina::testing::TempFolder;

class CatalogueExchange : public ::testing::Test {
 protected:
  CatalogueExchange() {
    {
      Archive archive(optionsFor(path_));
      beginRun(archive);
    }
    Database fresh(fresh_, Database::Access::kCreate, realFileOps());
    createTables(fresh);
  }
  std::int64_t runs() const {
    return static_cast<std::int64_t>(ArchiveReader(path_).runs().size());
  }
  TempFolder folder_ = TempFolder::inMemory();
  fs::path path_ = folder_ / "archive", fresh_ = path_ / "tmp" / "fresh.sqlite";
};

TEST_F(CatalogueExchange, PutsTheNewOneInPlaceOfTheOld) {
  exchangeCatalogue(realFileOps(), path_, fresh_);
  EXPECT_EQ(runs(), 0);
  EXPECT_FALSE(fs::exists(fresh_));
}

TEST_F(CatalogueExchange, LeavesOneOrTheOtherWhereverItIsInterrupted) {
  for (int k = 0;; ++k) {
    const TempFolder again = TempFolder::inMemory();
    const fs::path copy = again / "archive";
    fs::copy(path_, copy, fs::copy_options::recursive);
    int calls = 0;
    HookedDisk disk([&](Call, const fs::path&) { return calls++ == k ? -EIO : 0; });
    bool through = true;
    try {
      exchangeCatalogue(disk, copy, copy / "tmp" / "fresh.sqlite");
    } catch (const ArchiveError&) {
      through = false;
    }
    if (through && calls <= k) break;
    if (fs::exists(copy / "catalog.sqlite")) {
      EXPECT_LE(ArchiveReader(copy).runs().size(), 1u) << "after call " << k;
    }
    const Archive recovered(optionsFor(copy));
    ASSERT_LT(k, 200);
  }
}

}  // namespace
}  // namespace patina::db::testing
