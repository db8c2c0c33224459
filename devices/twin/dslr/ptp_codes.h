// SPDX-License-Identifier: GPL-3.0-or-later
// The numbers of PTP (ISO 15740) that the camera knows.
#pragma once

#include <cstdint>
#include <vector>

namespace patina::devices::twin::dslr {

enum class Operation : std::uint16_t {
  kGetDeviceInfo = 0x1001,
  kOpenSession = 0x1002,
  kCloseSession = 0x1003,
  kGetStorageIds = 0x1004,
  kGetStorageInfo = 0x1005,
  kGetNumObjects = 0x1006,
  kGetObjectHandles = 0x1007,
  kGetObjectInfo = 0x1008,
  kGetObject = 0x1009,
  kGetThumb = 0x100A,
  kDeleteObject = 0x100B,
  kInitiateCapture = 0x100E,
  kFormatStore = 0x100F,
  kResetDevice = 0x1010,
  kGetDevicePropDesc = 0x1014,
  kGetDevicePropValue = 0x1015,
  kSetDevicePropValue = 0x1016,
  kResetDevicePropValue = 0x1017,
  kGetPartialObject = 0x101B
};
// "GetObject"; "unknown" for one that is not in the list.
const char* name(Operation operation);
std::vector<Operation> allOperations();

enum class Answer : std::uint16_t {
  kOk = 0x2001,
  kGeneralError = 0x2002,
  kSessionNotOpen = 0x2003,
  kOperationNotSupported = 0x2005,
  kParameterNotSupported = 0x2006,
  kInvalidStorageId = 0x2008,
  kInvalidObjectHandle = 0x2009,
  kDevicePropNotSupported = 0x200A,
  kStoreFull = 0x200C,
  kAccessDenied = 0x200F,
  kNoThumbnail = 0x2010,
  kSpecificationByFormatUnsupported = 0x2014,
  kInvalidParentObject = 0x201A,
  kInvalidDevicePropFormat = 0x201B,
  kInvalidDevicePropValue = 0x201C,
  kInvalidParameter = 0x201D,
  kSessionAlreadyOpen = 0x201E,
  kDeviceBusy = 0x2019
};

enum class EventCode : std::uint16_t {
  kObjectAdded = 0x4002,
  kObjectRemoved = 0x4003,
  kDevicePropChanged = 0x4006,
  kStoreFull = 0x400A,
  kCaptureComplete = 0x400D
};

enum class Property : std::uint16_t {
  kBatteryLevel = 0x5001,
  kImageSize = 0x5003,
  kCompression = 0x5004,
  kWhiteBalance = 0x5005,
  kFNumber = 0x5007,
  kFocusMode = 0x500A,
  kExposureTime = 0x500D,
  kExposureProgram = 0x500E,
  kExposureIndex = 0x500F,
  kDateTime = 0x5011,
  kCaptureMode = 0x5013,
  // Our own, from the vendors' range.
  kSaveTo = 0xDFF1,
  kShutterCount = 0xDFF2
};

enum class ObjectFormat : std::uint16_t {
  kAny = 0,
  kFolder = 0x3001,
  kJpeg = 0x3801,
  kDng = 0x3811
};

// Values of properties.
constexpr int kJpegOnly = 2, kRawOnly = 4, kRawAndJpeg = 7;            // kCompression
constexpr int kManual = 1, kProgram = 2, kAperture = 3, kShutter = 4;  // kExposureProgram
constexpr int kManualFocus = 1, kAutofocus = 2;
constexpr int kManualWhite = 1, kAutomaticWhite = 2;
constexpr int kToCard = 1, kToMemory = 2;  // kSaveTo
constexpr int kAutoIso = 0xFFFF;           // kExposureIndex

constexpr std::uint32_t kCardStore = 0x00010001, kMemoryStore = 0x00020001;
constexpr std::uint32_t kAllStores = 0xFFFFFFFF, kRootOnly = 0xFFFFFFFF;

}  // namespace patina::devices::twin::dslr
