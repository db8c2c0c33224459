// SPDX-License-Identifier: GPL-3.0-or-later
// The choices a camera offers, as typed values. Makers spell them differently ("1/125", "0.0080s",
// "f/8", "5.6", "NEF+Fine"); what a plan asks for is matched by value, never by spelling.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "devices/result.h"
#include "processing/image/units.h"

namespace patina::devices::gphoto2 {

using Choices = std::vector<std::string>;

// Nothing for what is no value: "Bulb", "Time", "Auto", "Hi 1", "implicit auto".
std::optional<Nanoseconds> exposureOf(const std::string& choice);  // "1/125" "0.0080s" "1 3/10"
std::optional<Iso> isoOf(const std::string& choice);               // "100" "ISO 100"
std::optional<FNumber> fNumberOf(const std::string& choice);       // "f/8" "5.6"

// The choice nearest to what was asked, if it is within 1 %: kUnsupported with the camera's list
// otherwise. `camera` names it in the message.
Result<std::string> matchExposure(Nanoseconds asked, const Choices& choices,
                                  const std::string& camera);
Result<std::string> matchIso(Iso asked, const Choices& choices, const std::string& camera);
Result<std::string> matchFNumber(FNumber asked, const Choices& choices, const std::string& camera);

// The same word in any letter case; `setting` names it in the message.
Result<std::string> matchWord(const std::string& asked, const Choices& choices,
                              const std::string& setting, const std::string& camera);

// Which files a format setting gives.
struct FileKinds {
  bool raw = false, jpeg = false;
  bool operator==(const FileKinds&) const = default;
};
std::optional<FileKinds> fileKindsOf(const std::string& choice);  // nothing: no way to tell
// Of several choices that give these files: a full-size raw, the least compressed JPEG.
Result<std::string> matchFormat(FileKinds asked, const Choices& choices, const std::string& camera);

// "Auto", "Automatic", "AF-S", "P", "AI Servo": the camera decides, not the plan.
bool soundsAutomatic(const std::string& choice);

std::string lowerCase(std::string text);
std::string listed(const Choices& choices);  // for messages: "1/60, 1/125, ..."

}  // namespace patina::devices::gphoto2
