// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/nnf_file.h"

#include <bit>
#include <cstring>
#include <string>

#include "processing/image/picture_file.h"

namespace patina::texture_optimization {

static_assert(std::endian::native == std::endian::little, "the header below says '<i4'");

void writeNnf(const std::filesystem::path& file, const OptimizedField& field, int source_width) {
  // Version 1.0: magic, length of the header in 2 bytes, the header padded to 64 bytes.
  std::string header = "{'descr': '<i4', 'fortran_order': False, 'shape': (" +
                       std::to_string(field.size.height) + ", " + std::to_string(field.size.width) +
                       ", 2), }";
  constexpr std::size_t kPreamble = 10, kAlignment = 64;
  const std::size_t whole =
      (kPreamble + header.size() + 1 + kAlignment - 1) / kAlignment * kAlignment;
  header.resize(whole - kPreamble - 1, ' ');
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() & 0xff);
  bytes += static_cast<char>(header.size() >> 8);
  bytes += header;
  const std::size_t start = bytes.size();
  bytes.resize(start + field.centres.size() * 8);
  for (std::size_t i = 0; i < field.centres.size(); ++i) {
    const std::int32_t xy[2] = {field.centres[i] % source_width, field.centres[i] / source_width};
    std::memcpy(&bytes[start + 8 * i], xy, sizeof xy);
  }
  writeFileAtomically(file, bytes);
}

}  // namespace patina::texture_optimization
