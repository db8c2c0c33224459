// SPDX-License-Identifier: GPL-3.0-or-later
// What lies on the card and in the camera's memory: objects with handles and names that never come
// again, whatever is deleted and however often the power goes.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "devices/twin/dslr/ptp_codes.h"
#include "processing/image/picture_file.h"

namespace patina::devices::twin::dslr {

struct CardObject {
  std::uint32_t handle = 0, store = kCardStore, parent = 0;
  ObjectFormat format = ObjectFormat::kFolder;
  std::string name;                    // "PATN0001.JPG"
  std::shared_ptr<const Bytes> bytes;  // null of a folder
  UtcTime taken;                       // by the camera's clock
  SizePx size;

  std::size_t length() const { return bytes ? bytes->size() : 0; }
};

// Thread-bound: its camera's lock guards it.
class Card {
 public:
  Card(std::int64_t card_bytes, std::int64_t memory_bytes, std::uint32_t first_number);

  const CardObject* find(std::uint32_t handle) const;
  // Of a store or kAllStores; `parent` 0: all, kRootOnly: of the root, else a folder's handle.
  std::vector<std::uint32_t> handles(std::uint32_t store, ObjectFormat format,
                                     std::uint32_t parent) const;
  bool isStore(std::uint32_t store) const { return store == kCardStore || store == kMemoryStore; }
  std::int64_t capacity(std::uint32_t store) const;
  std::int64_t free(std::uint32_t store) const;

  // Files of one picture: one number of the camera's count (PATN0042), one or two formats. Folders
  // that must be there for them are made. Their handles, in the order of `files`.
  std::vector<std::uint32_t> add(std::uint32_t store, std::vector<CardObject> files);
  bool remove(std::uint32_t handle);  // false: not there, or a folder
  std::vector<std::uint32_t> removeAll(
      std::uint32_t store);  // every file; the answer: their handles

 private:
  std::uint32_t folderFor(std::uint32_t number);
  std::map<std::uint32_t, CardObject> objects_;
  std::int64_t card_bytes_, memory_bytes_;
  std::uint32_t next_handle_ = 1, next_number_;
  std::uint32_t dcim_ = 0;
  std::map<std::uint32_t, std::uint32_t> folders_;  // by their hundreds: 100 -> its handle
};

}  // namespace patina::devices::twin::dslr
