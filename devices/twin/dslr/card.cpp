// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/card.h"

#include <cstdio>
#include <utility>

namespace patina::devices::twin::dslr {
namespace {

constexpr std::uint32_t kFilesAFolder = 9999, kFirstFolder = 100;

const char* extension(ObjectFormat format) { return format == ObjectFormat::kDng ? "DNG" : "JPG"; }

}  // namespace

Card::Card(std::int64_t card_bytes, std::int64_t memory_bytes, std::uint32_t first_number)
    : card_bytes_(card_bytes), memory_bytes_(memory_bytes), next_number_(first_number) {
  dcim_ = next_handle_++;
  CardObject dcim;
  dcim.handle = dcim_;
  dcim.name = "DCIM";
  objects_.emplace(dcim_, dcim);
  folderFor(next_number_);
}

const CardObject* Card::find(std::uint32_t handle) const {
  const auto found = objects_.find(handle);
  return found == objects_.end() ? nullptr : &found->second;
}

std::vector<std::uint32_t> Card::handles(std::uint32_t store, ObjectFormat format,
                                         std::uint32_t parent) const {
  std::vector<std::uint32_t> handles;
  for (const auto& [handle, object] : objects_) {
    if (store != kAllStores && object.store != store) continue;
    if (format != ObjectFormat::kAny && object.format != format) continue;
    if (parent != 0 && object.parent != (parent == kRootOnly ? 0 : parent)) continue;
    handles.push_back(handle);
  }
  return handles;
}

std::int64_t Card::capacity(std::uint32_t store) const {
  return store == kMemoryStore ? memory_bytes_ : card_bytes_;
}

std::int64_t Card::free(std::uint32_t store) const {
  std::int64_t left = capacity(store);
  for (const auto& [handle, object] : objects_)
    if (object.store == store) left -= static_cast<std::int64_t>(object.length());
  return left;
}

std::vector<std::uint32_t> Card::add(std::uint32_t store, std::vector<CardObject> files) {
  const std::uint32_t number = next_number_++;
  const std::uint32_t folder = store == kCardStore ? folderFor(number) : 0;
  std::vector<std::uint32_t> handles;
  for (CardObject& file : files) {
    char base[16];
    std::snprintf(base, sizeof base, "PATN%04u", (number - 1) % kFilesAFolder + 1);
    file.name = std::string(base) + "." + extension(file.format);
    file.handle = next_handle_++;
    file.store = store;
    file.parent = folder;
    handles.push_back(file.handle);
    objects_.emplace(file.handle, std::move(file));
  }
  return handles;
}

bool Card::remove(std::uint32_t handle) {
  const auto found = objects_.find(handle);
  if (found == objects_.end() || found->second.format == ObjectFormat::kFolder) return false;
  objects_.erase(found);
  return true;
}

std::vector<std::uint32_t> Card::removeAll(std::uint32_t store) {
  std::vector<std::uint32_t> removed;
  for (const std::uint32_t handle : handles(store, ObjectFormat::kAny, 0))
    if (remove(handle)) removed.push_back(handle);
  return removed;
}

std::uint32_t Card::folderFor(std::uint32_t number) {
  const std::uint32_t hundreds = kFirstFolder + (number - 1) / kFilesAFolder;
  const auto known = folders_.find(hundreds);
  if (known != folders_.end()) return known->second;
  CardObject folder;
  folder.handle = next_handle_++;
  folder.parent = dcim_;
  folder.name = std::to_string(hundreds) + "PATNA";
  objects_.emplace(folder.handle, folder);
  folders_.emplace(hundreds, folder.handle);
  return folder.handle;
}

}  // namespace patina::devices::twin::dslr
