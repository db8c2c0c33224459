// SPDX-License-Identifier: GPL-3.0-or-later
// The tables: which rows they hold beyond those that callers see, their names and keys. Internal to
// db/.
#pragma once

#include <cstdint>
#include <string>

#include "db/rows.h"

namespace patina::db {

// What the tables hold beyond the row that callers see.
struct RigRecord {
  RowId id = 0;
  std::string name, sha256, toml;
};
struct RunRecord {
  RunRow row;
  RowId specimen_id = 0, rig_id = 0;
};
struct FrameRecord {
  FrameRow row;
  std::string run_id;
};
struct ProductInputRecord {
  std::string product_id;
  std::int64_t position = 0;
  std::string sha256;
};

// Its table, and how many of its first columns are the key.
template <class Row>
struct Table;
#define PATINA_TABLE(Row, table, keys)          \
  template <>                                   \
  struct Table<Row> {                           \
    static constexpr const char* kName = table; \
    static constexpr int kKeys = keys;          \
  }
PATINA_TABLE(DeviceRow, "device", 1);
PATINA_TABLE(SpecimenRow, "specimen", 1);
PATINA_TABLE(RigRecord, "rig", 1);
PATINA_TABLE(RunRecord, "run", 1);
PATINA_TABLE(StepRow, "step", 1);
PATINA_TABLE(ShotRow, "shot", 1);
PATINA_TABLE(FrameRecord, "frame", 1);
PATINA_TABLE(ReadingRow, "reading", 1);
PATINA_TABLE(LightCheckRow, "light_check", 1);
PATINA_TABLE(CalibrationRow, "calibration", 1);
PATINA_TABLE(FrameCalibrationRow, "frame_calibration", 2);
PATINA_TABLE(ProductRow, "product", 1);
PATINA_TABLE(ProductInputRecord, "product_input", 2);
PATINA_TABLE(EventRow, "event", 1);
#undef PATINA_TABLE

}  // namespace patina::db
