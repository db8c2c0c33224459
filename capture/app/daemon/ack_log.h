// SPDX-License-Identifier: GPL-3.0-or-later
// One line a frame that was acknowledged, written before the next shot: what an outside process may
// hold the archive to.
#pragma once

#include <string>

#include "db/rows.h"

namespace patina::daemon {

class AckLog {
 public:
  // A file to append to, the number of an open one, or nothing. Failure(kCannotCreate).
  explicit AckLog(const std::string& where);
  ~AckLog();
  AckLog(const AckLog&) = delete;
  AckLog& operator=(const AckLog&) = delete;

  // "ack RUN SHOT FILE_INDEX SHA256 BYTES", one write each: lines of several threads stay whole.
  void take(const std::string& run_id, const db::FrameRow& frame) const;

 private:
  int fd_ = -1;
  bool owned_ = false;
};

}  // namespace patina::daemon
