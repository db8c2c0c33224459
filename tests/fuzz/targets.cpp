// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/fuzz/targets.h"

namespace patina::testing {

const std::vector<FuzzTarget>& fuzzTargets() {
  static const std::vector<FuzzTarget> kTargets = {
      {"plan", fuzzPlan},
      {"rig", fuzzRig},
      {"faults", fuzzFaults},
      {"daemon_config", fuzzDaemonConfig},
      {"journal", fuzzJournal},
      {"picture_header", fuzzPictureHeader},
      {"picture_samples", fuzzPictureSamples},
      {"lights", fuzzLights},
      {"picture_names", fuzzPictureNames},
      {"product_facts", fuzzProductFacts},
      {"ttf", fuzzTtf},
      {"mesh_obj", fuzzMeshObj},
      {"mesh_gltf", fuzzMeshGltf},
      {"brdf_manifest", fuzzBrdfManifest},
      {"http_request", fuzzHttpRequest},
      {"http_fields", fuzzHttpFields},
      {"http_events", fuzzHttpEvents},
      {"kept_tokens", fuzzKeptTokens},
      {"daemon_json", fuzzDaemonJson},
      {"ptpip", fuzzPtpIp},
      {"op_dmx", fuzzOpDmx},
      {"host_messages", fuzzHostMessages},
  };
  return kTargets;
}

std::string textOf(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace patina::testing
