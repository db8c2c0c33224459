// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/daemon/routes_bench.h"
#include "tests/support/places.h"

namespace patina::daemon {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class HandlersRead : public ::testing::Test {
 protected:
  HandlersRead() {
    id_ = bench_.start().id;
    bench_.watcher.waitForEnd(id_);
  }
  RoutesBench bench_;
  std::string id_;
};

TEST_F(HandlersRead, EveryRouteIsAViewersButWhatChangesSomething) {
  for (const http::Route& route : bench_.routes) {
    const bool reads = route.method == "GET";
    EXPECT_EQ(route.role == http::Role::kViewer, reads) << route.pattern;
    EXPECT_NE(route.role, http::Role::kPublic) << route.pattern;
  }
}

TEST_F(HandlersRead, EveryRouteStandsInTheOpenApiDocument) {
  const std::string document = testing::readFile(testing::sourceFolder() / "docs/openapi.json");
  for (const http::Route& route : bench_.routes) {
    EXPECT_THAT(document, HasSubstr("\"" + route.pattern + "\""));
    EXPECT_THAT(document, HasSubstr("\"" + route.operation_id + "\""));
  }
}

TEST_F(HandlersRead, ListsRunsAndOneOfThem) {
  EXPECT_THAT(bench_.get("/api/v1/runs").body, HasSubstr("\"id\":\"" + id_ + "\""));
  // No session is left to tell how far it has come: the rows do.
  EXPECT_THAT(bench_.get("/api/v1/runs").body, HasSubstr("\"captured\":12"));
  const std::string one = bench_.get("/api/v1/runs/{run}", {{"run", "latest"}}).body;
  EXPECT_THAT(one, HasSubstr("\"state\":\"finished\""));
  EXPECT_EQ(bench_.get("/api/v1/runs/{run}", {{"run", "nobody"}}).status, 404);
  EXPECT_EQ(bench_.get("/api/v1/runs/{run}/steps", {{"run", "nobody"}}).status, 404);
}

TEST_F(HandlersRead, ListsComeInPages) {
  const auto steps = [&](const std::string& after) {
    return bench_
        .get("/api/v1/runs/{run}/steps", {{"run", id_}}, {{"limit", "5"}, {"after", after}})
        .body;
  };
  EXPECT_THAT(steps("-1"), HasSubstr("\"next\":4"));
  EXPECT_THAT(steps("4"), HasSubstr("\"number\":5"));
  EXPECT_THAT(steps("9"), Not(HasSubstr("\"next\"")));
  for (const char* list : {"light", "events", "frames"})
    EXPECT_THAT(bench_.get(std::string("/api/v1/runs/{run}/") + list, {{"run", id_}}).body,
                HasSubstr("\"id\":"))
        << list;
}

TEST_F(HandlersRead, APageIsANumberOrARefusal) {
  for (const char* limit : {"0", "1001", "-5", "x", "", "1e3", "99999999999999999999"})
    EXPECT_THROW(bench_.get("/api/v1/runs/{run}/steps", {{"run", id_}}, {{"limit", limit}}),
                 capture::CaptureError)
        << limit;
}

TEST_F(HandlersRead, AnOriginalIsAnAttachmentAndAPreviewIsMadeByUs) {
  const db::FrameRow frame = *bench_.archive->reader().newestFrame(id_);
  const std::string hex = frame.sha256.hex();
  const auto original = bench_.get("/api/v1/objects/{sha256}", {{"sha256", hex}});
  EXPECT_EQ(original.file, bench_.archive->reader().pathOf(frame));
  EXPECT_EQ(original.content_type, "application/octet-stream");
  EXPECT_THAT(original.headers.at("Content-Disposition"), HasSubstr("attachment"));
  const auto preview =
      bench_.get("/api/v1/objects/{sha256}/preview", {{"sha256", hex}}, {{"width", "32"}});
  EXPECT_EQ(preview.content_type, "image/jpeg");
  EXPECT_TRUE(preview.file.empty());
  EXPECT_THAT(preview.body, ::testing::StartsWith("\xff\xd8"));
}

TEST_F(HandlersRead, AHashThatIsNotThereIsNotFound) {
  const std::string hex(64, 'a');
  EXPECT_EQ(bench_.get("/api/v1/objects/{sha256}", {{"sha256", hex}}).status, 404);
  EXPECT_EQ(bench_.get("/api/v1/objects/{sha256}/preview", {{"sha256", hex}}).status, 404);
}

TEST_F(HandlersRead, DevicesAlertsAndStatusAnswer) {
  EXPECT_THAT(bench_.get("/api/v1/devices").body, HasSubstr("\"id\":\"cam0\""));
  EXPECT_THAT(bench_.get("/api/v1/alerts").body, HasSubstr("patina.alerts/1"));
  EXPECT_THAT(bench_.get("/api/v1/status").body, HasSubstr("\"version\":\"test\""));
}

}  // namespace
}  // namespace patina::daemon
