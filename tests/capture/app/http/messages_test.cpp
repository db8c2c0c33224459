// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/messages.h"

#include <gtest/gtest.h>

namespace patina::http {
namespace {

TEST(RoleFromName, KnowsTheThreeRolesAndTrustsNoOtherWord) {
  for (const Role role : {Role::kViewer, Role::kOperator, Role::kAdmin})
    EXPECT_EQ(roleFromName(roleName(role)), role);
  for (const char* word : {"", "Admin", "root", "public", "admin "})
    EXPECT_EQ(roleFromName(word), Role::kPublic) << word;
}

TEST(ErrorResponse, TellsAClientWhatTheExitCodeTellsAShell) {
  const auto status = [](Exit exit) { return errorResponse(HttpError(exit, "x")).status; };
  EXPECT_EQ(status(Exit::kUsage), 400);
  EXPECT_EQ(status(Exit::kConfig), 422);
  EXPECT_EQ(status(Exit::kPermission), 403);
  EXPECT_EQ(status(Exit::kTemporary), 503);
  EXPECT_EQ(status(Exit::kIo), 500);
}

TEST(ErrorResponse, IsTheObjectTheCommandLinePrints) {
  EXPECT_EQ(errorResponse(404, Exit::kUsage, "no \"x\"").body,
            "{\"error\":{\"exit\":64,\"message\":\"no \\\"x\\\"\"}}\n");
}

}  // namespace
}  // namespace patina::http
