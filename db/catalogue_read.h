// SPDX-License-Identifier: GPL-3.0-or-later
// The questions of ArchiveReader as SQL, so that a test can ask for the plan of each. Internal.
#pragma once

#include <array>
#include <memory>
#include <mutex>
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
  kDevices,
  kStepsByHand,
  kStepsPage,
  kFramesPage,
  kLightChecksPage,
  kEventsPage,
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
  kArmedShots,
  kShotOfKey
};
constexpr int kQueryCount = 31;
std::string sqlOf(Query query);

struct ArchiveReader::State {
  std::filesystem::path folder;
  std::shared_ptr<Database> database;
  std::recursive_mutex* owner = nullptr;  // the Archive's, when it shares its connection
  std::array<Statement, kQueryCount> statements;

  Statement& statement(Query query);  // prepared at first use
  std::unique_lock<std::recursive_mutex> guard() const {
    return owner ? std::unique_lock(*owner) : std::unique_lock<std::recursive_mutex>();
  }
};

}  // namespace patina::db
