// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/ptp_data.h"

#include <algorithm>
#include <array>

#include "devices/twin/dslr/ptp_codes.h"
#include "processing/image/failure.h"

namespace patina::devices::twin::dslr {
namespace {

constexpr std::size_t kTextMax = 254;  // and its zero

struct OperationName {
  Operation operation;
  const char* name;
};
constexpr std::array kOperations{
    OperationName{Operation::kGetDeviceInfo, "GetDeviceInfo"},
    OperationName{Operation::kOpenSession, "OpenSession"},
    OperationName{Operation::kCloseSession, "CloseSession"},
    OperationName{Operation::kGetStorageIds, "GetStorageIDs"},
    OperationName{Operation::kGetStorageInfo, "GetStorageInfo"},
    OperationName{Operation::kGetNumObjects, "GetNumObjects"},
    OperationName{Operation::kGetObjectHandles, "GetObjectHandles"},
    OperationName{Operation::kGetObjectInfo, "GetObjectInfo"},
    OperationName{Operation::kGetObject, "GetObject"},
    OperationName{Operation::kGetThumb, "GetThumb"},
    OperationName{Operation::kDeleteObject, "DeleteObject"},
    OperationName{Operation::kInitiateCapture, "InitiateCapture"},
    OperationName{Operation::kFormatStore, "FormatStore"},
    OperationName{Operation::kResetDevice, "ResetDevice"},
    OperationName{Operation::kGetDevicePropDesc, "GetDevicePropDesc"},
    OperationName{Operation::kGetDevicePropValue, "GetDevicePropValue"},
    OperationName{Operation::kSetDevicePropValue, "SetDevicePropValue"},
    OperationName{Operation::kResetDevicePropValue, "ResetDevicePropValue"},
    OperationName{Operation::kGetPartialObject, "GetPartialObject"}};

}  // namespace

const char* name(Operation operation) {
  const auto known = std::ranges::find(kOperations, operation, &OperationName::operation);
  return known == kOperations.end() ? "unknown" : known->name;
}

std::vector<Operation> allOperations() {
  std::vector<Operation> all;
  for (const OperationName& known : kOperations) all.push_back(known.operation);
  return all;
}

void PtpWriter::number(std::uint64_t v, int bytes) {
  for (int i = 0; i < bytes; ++i, v >>= 8) bytes_.push_back(static_cast<std::byte>(v & 0xff));
}

void PtpWriter::text(const std::string& ascii) {
  PATINA_CHECK(ascii.size() <= kTextMax);
  if (ascii.empty()) return u8(0);
  u8(static_cast<std::uint8_t>(ascii.size() + 1));
  for (const char c : ascii) u16(static_cast<unsigned char>(c));
  u16(0);
}

void PtpWriter::u16s(const std::vector<std::uint16_t>& values) {
  u32(static_cast<std::uint32_t>(values.size()));
  for (const std::uint16_t v : values) u16(v);
}

void PtpWriter::u32s(const std::vector<std::uint32_t>& values) {
  u32(static_cast<std::uint32_t>(values.size()));
  for (const std::uint32_t v : values) u32(v);
}

void PtpWriter::raw(std::span<const std::byte> bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::uint64_t PtpReader::number(int bytes) {
  const auto from = raw(static_cast<std::size_t>(bytes));
  std::uint64_t v = 0;
  for (std::size_t i = from.size(); i-- > 0;) v = v << 8 | std::to_integer<std::uint64_t>(from[i]);
  return v;
}

std::string PtpReader::text() {
  std::string ascii;
  for (int left = u8(); left > 0 && !bad_; --left) {
    const std::uint16_t c = u16();
    if (c == 0) continue;
    ascii += c >= ' ' && c < 127 ? static_cast<char>(c) : '?';
  }
  return bad_ ? std::string() : ascii;
}

std::span<const std::byte> PtpReader::raw(std::size_t bytes) {
  if (bad_ || bytes > rest_.size()) {
    bad_ = true;
    return {};
  }
  const auto taken = rest_.first(bytes);
  rest_ = rest_.subspan(bytes);
  return taken;
}

}  // namespace patina::devices::twin::dslr
