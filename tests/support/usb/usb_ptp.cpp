// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/usb/usb_ptp.h"

#include <algorithm>
#include <utility>

#include "devices/twin/dslr/ptp_data.h"

namespace patina::testing {

using namespace devices::twin::dslr;

namespace {

constexpr std::size_t kHeaderBytes = 12, kParametersMax = 5;
enum class Container : std::uint16_t { kCommand = 1, kData = 2, kResponse = 3, kEvent = 4 };
// Requests of the still image class.
constexpr unsigned kCancel = 0x64, kReset = 0x66, kStatus = 0x67;
constexpr unsigned kClassIn = 0xA1, kClassOut = 0x21;

Bytes container(Container type, std::uint16_t code, std::uint32_t transaction,
                std::span<const std::byte> payload) {
  PtpWriter out;
  out.u32(static_cast<std::uint32_t>(kHeaderBytes + payload.size()));
  out.u16(static_cast<std::uint16_t>(type));
  out.u16(code);
  out.u32(transaction);
  out.raw(payload);
  return out.take();
}

Bytes parameters(const std::vector<std::uint32_t>& values) {
  PtpWriter out;
  for (const std::uint32_t v : values) out.u32(v);
  return out.take();
}

std::optional<PtpCommand> commandIn(std::span<const std::byte> bytes) {
  PtpReader from(bytes);
  const std::uint32_t length = from.u32();
  const auto type = static_cast<Container>(from.u16());
  PtpCommand command;
  command.operation = static_cast<Operation>(from.u16());
  command.transaction = from.u32();
  if (from.bad() || length != bytes.size() || type != Container::kCommand || from.left() % 4 != 0 ||
      from.left() / 4 > kParametersMax)
    return std::nullopt;
  while (from.left() > 0) command.parameters.push_back(from.u32());
  return command;
}

}  // namespace

bool UsbPtp::isStalled() {
  if (stalled_until_ && *stalled_until_ <= camera_.clock().mono()) stalled_until_.reset();
  return stalled_until_.has_value();
}

std::optional<UsbTransfer> UsbPtp::bulkOut(std::span<const std::byte> bytes) {
  if (isStalled()) return std::nullopt;
  if (waiting_) {
    data_.insert(data_.end(), bytes.begin(), bytes.end());
    if (data_.size() < kHeaderBytes || PtpReader(data_).u32() > data_.size()) return UsbTransfer{};
    waiting_->data.assign(data_.begin() + kHeaderBytes, data_.end());
    perform(*std::exchange(waiting_, std::nullopt));
    return UsbTransfer{};
  }
  if (bytes.empty()) return UsbTransfer{};  // the end of a transfer of whole packets
  auto command = commandIn(bytes);
  if (!command) return UsbTransfer{UsbTransfer::kStalledPipe, {}};
  if (command->operation == Operation::kSetDevicePropValue) {
    data_.clear();
    waiting_ = std::move(command);
  } else {
    perform(*command);
  }
  return UsbTransfer{};
}

void UsbPtp::perform(const PtpCommand& command) {
  const PtpReply reply = camera_.perform(command);
  Pending answer;
  if (reply.data)
    answer.bytes =
        container(Container::kData, static_cast<std::uint16_t>(command.operation),
                  command.transaction, std::span(*reply.data).subspan(reply.first, reply.bytes));
  Pending response;
  response.bytes = container(Container::kResponse, static_cast<std::uint16_t>(reply.answer),
                             command.transaction, parameters(reply.parameters));
  Pending& first = answer.bytes.empty() ? response : answer;
  first.trouble = reply.trouble;
  if (reply.trouble)
    first.trouble_at =
        static_cast<std::size_t>(reply.trouble->share * static_cast<double>(first.bytes.size()));
  if (!answer.bytes.empty()) answers_.push_back(std::move(answer));
  answers_.push_back(std::move(response));
}

UsbTransfer UsbPtp::meetTrouble() {
  const WireTrouble trouble = *std::exchange(answers_.front().trouble, std::nullopt);
  if (trouble.kind == WireTrouble::kClose) {
    answers_.clear();
    return {UsbTransfer::kStalledPipe, {}};
  }
  wants_unplug_ = true;
  return {UsbTransfer::kGone, {}};
}

std::optional<UsbTransfer> UsbPtp::bulkIn(std::size_t most) {
  if (isStalled() || answers_.empty()) return std::nullopt;
  Pending& answer = answers_.front();
  std::size_t end = answer.bytes.size();
  if (answer.trouble) {
    if (answer.sent >= answer.trouble_at) {
      if (answer.trouble->kind != WireTrouble::kStall) return meetTrouble();
      const Nanoseconds duration = std::exchange(answer.trouble, std::nullopt)->duration;
      stalled_until_ = duration == kForEver ? MonoTime::max() : camera_.clock().mono() + duration;
      return std::nullopt;
    }
    end = answer.trouble_at;
  }
  const auto part = std::span(answer.bytes).subspan(answer.sent, std::min(most, end - answer.sent));
  UsbTransfer transfer{UsbTransfer::kDone, Bytes(part.begin(), part.end())};
  answer.sent += part.size();
  if (answer.sent == answer.bytes.size()) answers_.pop_front();
  return transfer;
}

std::optional<UsbTransfer> UsbPtp::interruptIn(std::size_t most) {
  if (isStalled() || events_.empty()) return std::nullopt;
  UsbTransfer transfer{UsbTransfer::kDone, std::move(events_.front())};
  events_.pop_front();
  transfer.bytes.resize(std::min(most, transfer.bytes.size()));
  return transfer;
}

UsbTransfer UsbPtp::control(std::span<const std::byte> setup, std::span<const std::byte>) {
  PtpReader from(setup);
  const unsigned type = from.u8(), request = from.u8();
  if (type == kClassIn && request == kStatus) {
    PtpWriter out;
    out.u16(4);
    out.u16(static_cast<std::uint16_t>(devices::twin::dslr::Answer::kOk));
    return {UsbTransfer::kDone, out.take()};
  }
  if (type == kClassOut && (request == kCancel || request == kReset)) {
    answers_.clear();
    waiting_.reset();
    stalled_until_.reset();
    if (request == kReset) camera_.hangUp();
    return {};
  }
  return {UsbTransfer::kStalledPipe, {}};
}

void UsbPtp::takeEvents() {
  if (isStalled()) return;
  for (const PtpEvent& event : camera_.takeEvents())
    events_.push_back(container(Container::kEvent, static_cast<std::uint16_t>(event.code),
                                event.transaction, parameters(event.parameters)));
}

std::optional<MonoTime> UsbPtp::nextDue() const {
  if (!stalled_until_) return camera_.nextDue();
  return *stalled_until_ == MonoTime::max() ? std::nullopt : stalled_until_;
}

void UsbPtp::reset() {
  answers_.clear();
  events_.clear();
  waiting_.reset();
  stalled_until_.reset();
  wants_unplug_ = false;
  camera_.hangUp();
}

}  // namespace patina::testing
