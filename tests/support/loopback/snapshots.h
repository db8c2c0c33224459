// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures and answers that tests of this folder share.
#pragma once

#include <cstdint>
#include <string>

#include "processing/image/picture_file.h"
#include "processing/image/random.h"
#include "tests/support/loopback/loopback_server.h"

namespace patina::testing {

// Another one for every number.
inline std::string jpeg(std::uint64_t number) {
  Image<std::uint8_t> grey(32, 24, 1);
  for (std::size_t i = 0; i < grey.texels().size(); ++i)
    grey.texels()[i] = static_cast<std::uint8_t>(uniformBelow(hashSeed(number, i), 200));
  const Bytes file = encodeJpeg(std::as_const(grey).view());
  return {reinterpret_cast<const char*>(file.data()), file.size()};
}

inline std::string ok(const std::string& body, const std::string& more_headers = {},
                      const std::string& type = "image/jpeg") {
  return "HTTP/1.1 200 OK\r\nContent-Type: " + type +
         "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n" + more_headers +
         "Connection: close\r\n\r\n" + body;
}

inline std::string status(int code, const std::string& more_headers = {}) {
  return "HTTP/1.1 " + std::to_string(code) + " x\r\nContent-Length: 0\r\n" + more_headers +
         "Connection: close\r\n\r\n";
}

}  // namespace patina::testing
