// SPDX-License-Identifier: GPL-3.0-or-later
// What docs/openapi.json promises.
#pragma once

#include <string>
#include <vector>

#include "capture/app/http/messages.h"

namespace patina::http {

struct Operation {
  std::string method, pattern, operation_id;
  Role role = Role::kPublic;
};
std::vector<Operation> documentedOperations();

// A path of the pattern: hashes where it takes them, "latest" elsewhere.
std::string exampleOf(const std::string& pattern);

// A stub for every documented operation that the server does not bring itself.
std::vector<Route> stubRoutes();

}  // namespace patina::http
