// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/ack_log.h"

#include <fcntl.h>
#include <unistd.h>

#include <charconv>

#include "capture/failure.h"

namespace patina::daemon {

AckLog::AckLog(const std::string& where) {
  if (where.empty()) return;
  const auto [end, error] = std::from_chars(where.data(), where.data() + where.size(), fd_);
  if (error == std::errc() && end == where.data() + where.size()) return;
  fd_ = open(where.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (fd_ < 0) throw capture::CaptureError(Exit::kCannotCreate, "cannot write " + where);
  owned_ = true;
}

AckLog::~AckLog() {
  if (owned_) close(fd_);
}

void AckLog::take(const std::string& run_id, const db::FrameRow& frame) const {
  if (fd_ < 0) return;
  const std::string line = "ack " + run_id + " " + std::to_string(frame.shot_id) + " " +
                           std::to_string(frame.file_index) + " " + frame.sha256.hex() + " " +
                           std::to_string(frame.bytes) + "\n";
  if (write(fd_, line.data(), line.size()) != static_cast<ssize_t>(line.size()))
    throw capture::CaptureError(Exit::kIo, "cannot write the log of acknowledged frames");
}

}  // namespace patina::daemon
