// SPDX-License-Identifier: GPL-3.0-or-later
// The questions of ArchiveReader as SQL, so that a test can ask for the plan of each. Internal.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "db/archive.h"
#include "db/database.h"

namespace patina::db {

enum class Query {
  kRuns,
  kRunsByPrefix,
  kSteps,
  kStepsDecided,
  kStep,
  kLastNumber,
  kUnfinished,
  kRunOfStep,
  kShotsOfStep,
  kFramesOfStep,
  kNewestFrame,
  kFramesBetween,
  kFrameBySha256,
  kEachFrame,
  kLightChecks,
  kLightChecksOfShot,
  kReadings,
  kEvents,
  kCalibrations,
  kCalibrationsOfKind,
  kProducts,
  kProductsOfKind,
  kProductInputs,
  kArmedShots
};
constexpr int kQueryCount = 24;
std::string sqlOf(Query query);

struct ArchiveReader::State {
  std::filesystem::path folder;
  std::shared_ptr<Database> database;
  std::array<Statement, kQueryCount> statements;

  Statement& statement(Query query);  // prepared at first use
};

}  // namespace patina::db
