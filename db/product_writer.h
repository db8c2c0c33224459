// SPDX-License-Identifier: GPL-3.0-or-later
// What is made of an archive's frames, and its rows.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "db/rows.h"

namespace patina::db {

// Products are added by any process in short transactions beside a capturing one.
struct ProductWriter {
  static std::filesystem::path folderFor(const std::filesystem::path& archive,
                                         const std::string& id);
  static void add(const std::filesystem::path& archive, const ProductRow& product);
  static RowId addCalibration(const std::filesystem::path& archive, const CalibrationRow& row);
  // Of no run: a run's rows are its owner's. The owner counts ids up in memory, so these count down
  // from -1.
  static void addEvents(const std::filesystem::path& archive, std::span<const EventRow> events);
  static void bind(const std::filesystem::path& archive, std::span<const FrameCalibrationRow> rows);
};

}  // namespace patina::db
