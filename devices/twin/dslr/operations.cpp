// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/operations.h"

#include <algorithm>

namespace patina::devices::twin::dslr {
namespace {

// Clients know the words of CompressionSetting ("JPEG Fine", "NEF (Raw)", "NEF+Fine") from this
// vendor alone; nothing else of it is claimed.
constexpr std::uint32_t kVendorWithWords = 10;
constexpr std::uint32_t kFree32Max = 0xFFFFFFFE;

PtpReply answer(Answer code, std::vector<std::uint32_t> parameters = {}) {
  return {code, std::move(parameters), nullptr, 0, 0, std::nullopt};
}

PtpReply withData(Bytes data) {
  const std::size_t bytes = data.size();
  return {Answer::kOk, {}, std::make_shared<const Bytes>(std::move(data)), 0, bytes, std::nullopt};
}

std::string ptpDate(UtcTime t) {
  std::string text = formatUtc(t).substr(0, 19);
  std::erase_if(text, [](char c) { return c == '-' || c == ':'; });
  return text;
}

std::uint32_t clamped(std::size_t bytes) {
  return static_cast<std::uint32_t>(std::min<std::size_t>(bytes, UINT32_MAX));
}

PtpReply deviceInfo(const Body& body) {
  PtpWriter out;
  out.u16(100);  // the standard's version, times 100
  out.u32(kVendorWithWords);
  out.u16(100);
  out.text("");
  out.u16(0);  // functional mode
  std::vector<std::uint16_t> operations;
  for (const Operation known : allOperations())
    operations.push_back(static_cast<std::uint16_t>(known));
  out.u16s(operations);
  out.u16s({static_cast<std::uint16_t>(EventCode::kObjectAdded),
            static_cast<std::uint16_t>(EventCode::kObjectRemoved),
            static_cast<std::uint16_t>(EventCode::kDevicePropChanged),
            static_cast<std::uint16_t>(EventCode::kStoreFull),
            static_cast<std::uint16_t>(EventCode::kCaptureComplete)});
  out.u16s(body.settings.codes());
  const std::vector<std::uint16_t> formats = {static_cast<std::uint16_t>(ObjectFormat::kJpeg),
                                              static_cast<std::uint16_t>(ObjectFormat::kDng)};
  out.u16s(formats);
  out.u16s(formats);
  out.text("Patina");
  out.text(body.options().model);
  out.text("1.0");
  out.text(body.options().serial);
  return withData(out.take());
}

PtpReply storageInfo(const Body& body, std::uint32_t store) {
  if (!body.card.isStore(store)) return answer(Answer::kInvalidStorageId);
  const bool card = store == kCardStore;
  const auto left = static_cast<std::uint64_t>(std::max<std::int64_t>(0, body.card.free(store)));
  PtpWriter out;
  out.u16(card ? 4 : 3);  // removable or fixed RAM
  out.u16(card ? 3 : 1);  // DCF or flat
  out.u16(0);             // reads and writes
  out.u64(static_cast<std::uint64_t>(body.card.capacity(store)));
  out.u64(left);
  const std::uint64_t picture =
      std::uint64_t(body.pictureSize().width) * std::uint64_t(body.pictureSize().height) * 3;
  out.u32(static_cast<std::uint32_t>(std::min<std::uint64_t>(left / picture, kFree32Max)));
  out.text(card ? "Card" : "Memory");
  out.text("");
  return withData(out.take());
}

// kOk when the three parameters of GetObjectHandles name a place.
Answer checkPlace(const Body& body, const PtpCommand& command) {
  const std::uint32_t store = command.parameter(0), parent = command.parameter(2);
  if (store != kAllStores && !body.card.isStore(store)) return Answer::kInvalidStorageId;
  if (parent == 0 || parent == kRootOnly) return Answer::kOk;
  const CardObject* const folder = body.card.find(parent);
  if (folder == nullptr) return Answer::kInvalidObjectHandle;
  return folder->format == ObjectFormat::kFolder ? Answer::kOk : Answer::kInvalidParentObject;
}

std::vector<std::uint32_t> handlesAt(const Body& body, const PtpCommand& command) {
  return body.card.handles(command.parameter(0), static_cast<ObjectFormat>(command.parameter(1)),
                           command.parameter(2));
}

PtpReply objectHandles(const Body& body, const PtpCommand& command) {
  if (const Answer place = checkPlace(body, command); place != Answer::kOk) return answer(place);
  PtpWriter out;
  out.u32s(handlesAt(body, command));
  return withData(out.take());
}

PtpReply numObjects(const Body& body, const PtpCommand& command) {
  if (const Answer place = checkPlace(body, command); place != Answer::kOk) return answer(place);
  return answer(Answer::kOk, {clamped(handlesAt(body, command).size())});
}

PtpReply objectInfo(const Body& body, std::uint32_t handle) {
  const CardObject* const object = body.card.find(handle);
  if (object == nullptr) return answer(Answer::kInvalidObjectHandle);
  const bool folder = object->format == ObjectFormat::kFolder;
  PtpWriter out;
  out.u32(object->store);
  out.u16(static_cast<std::uint16_t>(object->format));
  out.u16(0);  // not protected
  out.u32(clamped(object->length()));
  out.u16(0);  // no thumbnail
  for (int i = 0; i < 3; ++i) out.u32(0);
  out.u32(static_cast<std::uint32_t>(object->size.width));
  out.u32(static_cast<std::uint32_t>(object->size.height));
  out.u32(folder ? 0 : object->format == ObjectFormat::kDng ? 16 : 24);
  out.u32(object->parent);
  out.u16(folder ? 1 : 0);  // a generic folder
  out.u32(0);
  out.u32(0);
  out.text(object->name);
  out.text(folder ? "" : ptpDate(object->taken));
  out.text(folder ? "" : ptpDate(object->taken));
  out.text("");
  return withData(out.take());
}

PtpReply object(const Body& body, const PtpCommand& command) {
  const CardObject* const found = body.card.find(command.parameter(0));
  if (found == nullptr) return answer(Answer::kInvalidObjectHandle);
  if (!found->bytes) return answer(Answer::kAccessDenied);  // a folder has no bytes
  PtpReply reply;
  reply.data = found->bytes;
  reply.bytes = found->bytes->size();
  if (command.operation == Operation::kGetObject) return reply;
  if (command.parameter(1) > reply.bytes) return answer(Answer::kInvalidParameter);
  reply.first = command.parameter(1);
  reply.bytes = std::min<std::size_t>(reply.bytes - reply.first, command.parameter(2));
  reply.parameters = {clamped(reply.bytes)};
  return reply;
}

PtpReply deleteObject(Body& body, std::uint32_t handle) {
  if (handle == kAllStores) {
    for (const std::uint32_t one : body.card.handles(kAllStores, ObjectFormat::kAny, 0))
      if (body.card.find(one)->bytes) body.remove(one);
    return answer(Answer::kOk);
  }
  const CardObject* const found = body.card.find(handle);
  if (found == nullptr) return answer(Answer::kInvalidObjectHandle);
  if (!found->bytes) return answer(Answer::kAccessDenied);
  body.remove(handle);
  return answer(Answer::kOk);
}

PtpReply formatStore(Body& body, std::uint32_t store) {
  if (!body.card.isStore(store)) return answer(Answer::kInvalidStorageId);
  for (const std::uint32_t one : body.card.handles(store, ObjectFormat::kAny, 0))
    if (body.card.find(one)->bytes) body.remove(one);
  return answer(Answer::kOk);
}

PtpReply capture(Body& body, const PtpCommand& command, const CaptureTrouble& trouble) {
  const std::uint32_t store = command.parameter(0);
  if (store != 0 && !body.card.isStore(store)) return answer(Answer::kInvalidStorageId);
  return answer(body.capture(command.transaction, trouble));
}

PtpReply property(Body& body, const PtpCommand& command) {
  const auto asked = static_cast<Property>(command.parameter(0));
  body.refreshTime();
  const auto data = command.operation == Operation::kGetDevicePropDesc
                        ? body.settings.describe(asked)
                        : body.settings.read(asked);
  return data ? withData(*data) : answer(Answer::kDevicePropNotSupported);
}

PtpReply setProperty(Body& body, const PtpCommand& command) {
  const auto asked = static_cast<Property>(command.parameter(0));
  if (asked == Property::kDateTime) {
    PtpReader from(command.data);
    return answer(body.setTime(from.text()) ? Answer::kOk : Answer::kInvalidDevicePropValue);
  }
  return answer(body.settings.write(asked, command.data));
}

PtpReply resetProperty(Body& body, const PtpCommand& command) {
  const Setting* const setting = body.settings.find(static_cast<Property>(command.parameter(0)));
  if (setting == nullptr) return answer(Answer::kDevicePropNotSupported);
  if (!setting->writable || setting->type == DataType::kText) return answer(Answer::kAccessDenied);
  body.settings.reset(setting->property);
  return answer(Answer::kOk);
}

PtpReply openSession(Body& body, std::uint32_t session) {
  if (session == 0) return answer(Answer::kInvalidParameter);
  if (body.session_open) return answer(Answer::kSessionAlreadyOpen, {1});
  body.session_open = true;
  ++body.truth.sessions;
  return answer(Answer::kOk);
}

PtpReply inSession(Body& body, const PtpCommand& command, const CaptureTrouble& trouble) {
  switch (command.operation) {
    case Operation::kCloseSession:
    case Operation::kResetDevice:
      body.session_open = false;
      return answer(Answer::kOk);
    case Operation::kGetStorageIds: {
      PtpWriter out;
      out.u32s({kCardStore, kMemoryStore});
      return withData(out.take());
    }
    case Operation::kGetStorageInfo:
      return storageInfo(body, command.parameter(0));
    case Operation::kGetNumObjects:
      return numObjects(body, command);
    case Operation::kGetObjectHandles:
      return objectHandles(body, command);
    case Operation::kGetObjectInfo:
      return objectInfo(body, command.parameter(0));
    case Operation::kGetObject:
    case Operation::kGetPartialObject:
      return object(body, command);
    case Operation::kGetThumb:
      return answer(Answer::kNoThumbnail);
    case Operation::kDeleteObject:
      return deleteObject(body, command.parameter(0));
    case Operation::kFormatStore:
      return formatStore(body, command.parameter(0));
    case Operation::kInitiateCapture:
      return capture(body, command, trouble);
    case Operation::kGetDevicePropDesc:
    case Operation::kGetDevicePropValue:
      return property(body, command);
    case Operation::kSetDevicePropValue:
      return setProperty(body, command);
    case Operation::kResetDevicePropValue:
      return resetProperty(body, command);
    default:
      return answer(Answer::kOperationNotSupported);
  }
}

}  // namespace

PtpReply execute(Body& body, const PtpCommand& command, const CaptureTrouble& trouble) {
  if (command.operation == Operation::kGetDeviceInfo) return deviceInfo(body);
  if (command.operation == Operation::kOpenSession) return openSession(body, command.parameter(0));
  if (!body.session_open) return answer(Answer::kSessionNotOpen);
  return inSession(body, command, trouble);
}

}  // namespace patina::devices::twin::dslr
