// SPDX-License-Identifier: GPL-3.0-or-later
// What is fuzzed: every reader of bytes that others wrote. A target returns whatever the bytes are;
// it may refuse them with the typed exception of its room, and do nothing else wrong.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace patina::testing {

struct FuzzTarget {
  std::string name;  // of its folder in corpus/
  void (*run)(std::span<const std::byte> bytes);
};
const std::vector<FuzzTarget>& fuzzTargets();

void fuzzPlan(std::span<const std::byte> bytes);
void fuzzRig(std::span<const std::byte> bytes);
void fuzzFaults(std::span<const std::byte> bytes);
void fuzzDaemonConfig(std::span<const std::byte> bytes);
void fuzzJournal(std::span<const std::byte> bytes);
void fuzzPictureHeader(std::span<const std::byte> bytes);
void fuzzPictureSamples(std::span<const std::byte> bytes);
void fuzzLights(std::span<const std::byte> bytes);
void fuzzPictureNames(std::span<const std::byte> bytes);
void fuzzProductFacts(std::span<const std::byte> bytes);
void fuzzTtf(std::span<const std::byte> bytes);
void fuzzMeshObj(std::span<const std::byte> bytes);
void fuzzMeshGltf(std::span<const std::byte> bytes);
void fuzzBrdfManifest(std::span<const std::byte> bytes);
void fuzzHttpRequest(std::span<const std::byte> bytes);
void fuzzHttpFields(std::span<const std::byte> bytes);
void fuzzHttpEvents(std::span<const std::byte> bytes);
void fuzzKeptTokens(std::span<const std::byte> bytes);
void fuzzDaemonJson(std::span<const std::byte> bytes);
void fuzzPtpIp(std::span<const std::byte> bytes);
void fuzzOpDmx(std::span<const std::byte> bytes);
void fuzzHostMessages(std::span<const std::byte> bytes);

std::string textOf(std::span<const std::byte> bytes);

}  // namespace patina::testing
