// SPDX-License-Identifier: GPL-3.0-or-later
// A virtual DSLR on the wire: one PTP/IP client at a time, and the next one once that one is gone.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "devices/twin/dslr/dslr.h"

namespace patina::devices::twin::dslr {

// Serves from a thread of its own until it is destroyed, which takes milliseconds whatever clients
// do. What strangers send costs them their connection and nothing else.
class PtpIpServer {
 public:
  // The camera outlives it; its clock must be thread-safe. Port 0: any free one. Failure(kUsage,
  // kUnavailable) when it cannot listen there.
  explicit PtpIpServer(Dslr& camera, const std::string& address = "127.0.0.1", int port = 0);
  ~PtpIpServer();
  PtpIpServer(const PtpIpServer&) = delete;
  PtpIpServer& operator=(const PtpIpServer&) = delete;

  int port() const;
  // What a client of libgphoto2 calls it: "ptpip:127.0.0.1:PORT:PORT".
  std::string gphotoPort() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace patina::devices::twin::dslr
