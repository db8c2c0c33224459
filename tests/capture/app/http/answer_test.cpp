// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/answer.h"

#include <gtest/gtest.h>
#include <microhttpd.h>
#include <unistd.h>

#include "tests/support/temp_folder.h"

namespace patina::http {
namespace {

class AnswerTest : public ::testing::Test {
 protected:
  AnswerTest() {
    std::filesystem::create_directories(folder / "archive/frames/ab");
    testing::writeFile(folder / "archive/frames/ab/cd.nef", "0123456789");
    testing::writeFile(folder / "secret", "secret");
  }
  ~AnswerTest() override {
    if (answer.response) MHD_destroy_response(answer.response);
  }
  int statusOf(Response response) {
    if (answer.response) MHD_destroy_response(answer.response);
    answer = AnswerMaker(folder / "archive", budget).make(admission, std::move(response));
    return answer.status;
  }
  int statusOfFile(const std::filesystem::path& file) {
    Response response;
    response.file = file;
    return statusOf(response);
  }
  std::string header(const char* name) const {
    const char* value = MHD_get_response_header(answer.response, name);
    return value == nullptr ? "" : value;
  }

  testing::TempFolder folder = testing::TempFolder::inMemory();
  ByteBudget budget{1000};
  Admission admission;
  Answer answer;
};

TEST_F(AnswerTest, SendsAFileOfTheArchiveAsAnAttachment) {
  EXPECT_EQ(statusOfFile("frames/ab/cd.nef"), 200);
  EXPECT_EQ(answer.bytes, 10u);
  EXPECT_EQ(header("Content-Disposition"), "attachment");
  EXPECT_EQ(statusOfFile(folder / "archive/frames/ab/cd.nef"), 200);
}

TEST_F(AnswerTest, OpensNothingOutsideTheArchiveWhateverAHandlerSays) {
  ASSERT_EQ(symlink("../../secret", (folder / "archive/frames/link").c_str()), 0);
  ASSERT_EQ(symlink("..", (folder / "archive/up").c_str()), 0);
  for (const std::filesystem::path& file :
       {std::filesystem::path("../secret"), std::filesystem::path("frames/../../secret"),
        folder / "secret", folder / "archive/../secret", std::filesystem::path("frames/link"),
        std::filesystem::path("up/secret"), std::filesystem::path("/etc/passwd"),
        std::filesystem::path("/proc/self/environ"), std::filesystem::path("frames"),
        std::filesystem::path(".")}) {
    EXPECT_GE(statusOfFile(file), 404) << file;
    EXPECT_EQ(header("Content-Disposition"), "") << file;
  }
}

TEST_F(AnswerTest, SaysThatAFileIsNotThere) { EXPECT_EQ(statusOfFile("frames/ab/none"), 404); }

TEST_F(AnswerTest, SendsOneRangeAndRefusesSeveral) {
  admission.range = "bytes=2-4";
  EXPECT_EQ(statusOfFile("frames/ab/cd.nef"), 206);
  EXPECT_EQ(answer.bytes, 3u);
  EXPECT_EQ(header("Content-Range"), "bytes 2-4/10");
  admission.range = "bytes=0-1,3-4";
  EXPECT_EQ(statusOfFile("frames/ab/cd.nef"), 416);
  EXPECT_EQ(header("Content-Range"), "bytes */10");
}

TEST_F(AnswerTest, SendsNothingAgainThatIsFresh) {
  Response response;
  response.body = "x";
  response.headers["ETag"] = "\"1\"";
  EXPECT_EQ(statusOf(response), 200);
  admission.if_none_match = "\"1\"";
  EXPECT_EQ(statusOf(response), 304);
  EXPECT_EQ(answer.bytes, 0u);
}

TEST_F(AnswerTest, CarriesTheProtectiveHeadersOnGoodAndBadAnswersAlike) {
  for (const Response& response : {Response{}, errorResponse(404, Exit::kUsage, "x")}) {
    statusOf(response);
    EXPECT_EQ(header("Content-Security-Policy"),
              "default-src 'self'; img-src 'self' blob:; object-src 'none'; form-action 'none'; "
              "frame-ancestors 'none'; "
              "base-uri 'none'");
    EXPECT_EQ(header("X-Content-Type-Options"), "nosniff");
    EXPECT_EQ(header("Referrer-Policy"), "no-referrer");
    EXPECT_EQ(header("Cross-Origin-Opener-Policy"), "same-origin");
    EXPECT_EQ(header("Cross-Origin-Resource-Policy"), "same-origin");
    EXPECT_EQ(header("Cache-Control"), "no-store");
    EXPECT_EQ(header("Access-Control-Allow-Origin"), "");
  }
}

TEST_F(AnswerTest, HoldsNoMoreThanItsBudgetAndGivesItBack) {
  Response large;
  large.body = std::string(900, 'x');
  EXPECT_EQ(statusOf(large), 200);
  Answer first = answer;
  answer = {};
  EXPECT_EQ(statusOf(large), 503);
  MHD_destroy_response(first.response);
  EXPECT_EQ(statusOf(large), 200);
}

}  // namespace
}  // namespace patina::http
