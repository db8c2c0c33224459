// SPDX-License-Identifier: GPL-3.0-or-later
// Which calibrations a product was made with, and whether a newer one would serve it now: then the
// same command again makes a new product; frames are never touched.
#pragma once

#include <string>
#include <vector>

#include "db/archive.h"

namespace patina::workflow {

struct UsedCalibration {
  db::CalibrationRow row;
  db::RowId newer = 0;       // of the same kind, made later, within tolerance; 0: none
  std::string text() const;  // "dark 3", "dark 3 (dark 7 is newer: build again)"
};
// In the order they were made.
std::vector<UsedCalibration> calibrationsOf(const db::ArchiveReader& reader,
                                            const db::ProductRow& product);
std::vector<std::string> textsOf(const std::vector<UsedCalibration>& used);

}  // namespace patina::workflow
