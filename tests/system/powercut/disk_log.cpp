// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/system/powercut/disk_log.h"

#include <algorithm>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "processing/image/random.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {
namespace {

constexpr std::size_t kTorn = 4096;  // bytes that are written whole or not at all

}  // namespace

DiskReplay::DiskReplay(const std::filesystem::path& image, const std::filesystem::path& log)
    : disk_(readFile(image)), log_(readFile(log)) {
  for (std::size_t at = 0; at < log_.size();) {
    Record record{};
    if (at + sizeof record.head > log_.size()) throw std::runtime_error("the log ends in a head");
    std::memcpy(&record.head, log_.data() + at, sizeof record.head);
    record.at = at + sizeof record.head;
    at = record.at + record.head.size;
    if (at > log_.size()) throw std::runtime_error("the log ends in a record");
    records_.push_back(record);
  }
}

void DiskReplay::apply(std::string& disk, const Record& record, std::size_t from,
                       std::size_t size) const {
  std::memcpy(disk.data() + record.head.offset + from, log_.data() + record.at + from, size);
}

void DiskReplay::forwardTo(std::size_t cut) {
  for (; position_ < cut; ++position_) {
    const Record& record = records_.at(position_);
    switch (record.head.kind) {
      case RecordKind::kWrite:
        pending_.push_back(position_);
        break;
      case RecordKind::kFlush:
        for (const std::size_t write : pending_)
          apply(disk_, records_[write], 0, records_[write].head.size);
        pending_.clear();
        break;
      case RecordKind::kMark: {
        std::istringstream lines(log_.substr(record.at, record.head.size));
        for (std::string line; std::getline(lines, line);) marks_.push_back(line);
        break;
      }
    }
  }
}

std::string DiskReplay::cut(std::uint64_t seed) const {
  std::string disk = disk_;
  enum { kNothing, kAll, kFirst, kSome };
  const auto how = uniformBelow(hashSeed(seed, 0), 4);
  const std::size_t first = uniformBelow(hashSeed(seed, 1), pending_.size() + 1);
  std::size_t number = 0;
  for (const std::size_t write : pending_) {
    const Record& record = records_[write];
    const bool kept = how == kAll || (how == kFirst && number < first);
    for (std::size_t from = 0; from < record.head.size; from += kTorn)
      if (kept || (how == kSome && hashSeed(seed, 2, write, from) % 2 == 0))
        apply(disk, record, from, std::min(kTorn, record.head.size - from));
    ++number;
  }
  return disk;
}

}  // namespace patina::testing
