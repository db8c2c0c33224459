// SPDX-License-Identifier: GPL-3.0-or-later
#include <utility>

#include "db/archive_state.h"
#include "db/errors.h"
#include "db/schema.h"

namespace patina::db {
namespace {

using How = Change::How;

// A short visit beside whoever owns the archive: no lock but SQLite's own.
void visit(const std::filesystem::path& archive,
           const std::function<void(Change&, CatalogueWriter&)>& fill) {
  const auto folder = std::filesystem::absolute(archive).lexically_normal();
  const auto file = folder / "catalog.sqlite";
  std::error_code error;
  if (!std::filesystem::exists(file, error))
    throw ArchiveError(Exit::kBadData,
                       archive.string() + " is no archive: it has no catalog.sqlite");
  Database database(file, Database::Access::kWrite, realFileOps());
  checkVersion(database);
  configureWriter(database, Durability::kFull);
  CatalogueWriter writer(database);
  Journal shared(realFileOps(), folder, kSharedJournal);
  commitShared(database, writer, shared, realFileOps(), folder, fill);
}

}  // namespace

std::filesystem::path ProductWriter::folderFor(const std::filesystem::path& archive,
                                               const std::string& id) {
  if (id.empty() || id.front() == '.' || id.find('/') != std::string::npos)
    throw ArchiveError(Exit::kUsage, "'" + id + "' is no id of a product: it names a folder");
  const auto folder = std::filesystem::absolute(archive).lexically_normal() / "products" / id;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throwDiskError(error.value(), "making", folder);
  return folder;
}

void ProductWriter::add(const std::filesystem::path& archive, const ProductRow& product) {
  visit(archive, [&](Change& change, CatalogueWriter&) {
    change.add(How::kUpsert, product);  // its earlier inputs go with it
    for (std::size_t i = 0; i < product.input_sha256s.size(); ++i)
      change.add(How::kUpsert, ProductInputRecord{product.id, static_cast<std::int64_t>(i),
                                                  product.input_sha256s[i]});
  });
}

RowId ProductWriter::addCalibration(const std::filesystem::path& archive,
                                    const CalibrationRow& calibration) {
  CalibrationRow row = calibration;
  visit(archive, [&](Change& change, CatalogueWriter& writer) {
    row.id = writer.nextId("calibration");
    change.add(How::kInsert, row);
  });
  return row.id;
}

void ProductWriter::addEvents(const std::filesystem::path& archive,
                              std::span<const EventRow> events) {
  if (events.empty()) return;
  visit(archive, [&](Change& change, CatalogueWriter& writer) {
    RowId id = writer.lowestId("event");
    for (EventRow row : events) {
      PATINA_CHECK(row.run_id.empty());
      row.id = --id;
      change.add(How::kInsert, row);
    }
  });
}

void ProductWriter::bind(const std::filesystem::path& archive,
                         std::span<const FrameCalibrationRow> rows) {
  if (rows.empty()) return;
  visit(archive, [&](Change& change, CatalogueWriter&) {
    for (const FrameCalibrationRow& row : rows) change.add(How::kUpsert, row);
  });
}

}  // namespace patina::db
