// SPDX-License-Identifier: GPL-3.0-or-later
// SHA-256 (libcrypto): the name of every frame, plan and product input.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace patina {

struct Sha256 {
  std::array<unsigned char, 32> bytes{};
  auto operator<=>(const Sha256&) const = default;
  std::string hex() const;                         // 64 lower-case digits
  static Sha256 fromHex(std::string_view digits);  // throws ProcessingError(kBadData)
};

Sha256 sha256(std::span<const std::byte> data);
Sha256 sha256(std::string_view text);
Sha256 sha256OfFile(const std::filesystem::path& path);  // streamed; throws ProcessingError(kIo)

class Sha256Stream {
 public:
  Sha256Stream();
  ~Sha256Stream();
  void add(std::span<const std::byte> data);
  Sha256 finish();  // once

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace patina
