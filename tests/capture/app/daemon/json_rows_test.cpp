// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/json_rows.h"

#include <gmock/gmock.h>

#include "capture/failure.h"
#include "tests/capture/app/daemon/live_view.h"

namespace patina::daemon {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(JsonRows, KeysAreColumnsWithTheirUnits) {
  db::StepRow step;
  step.run_id = "r";
  step.number = 3;
  step.decision = db::Decision::kSkipped;
  step.reason = "late \"by\" 5";
  step.held = std::chrono::seconds(2);
  const std::string json = jsonOf(step);
  EXPECT_THAT(json, HasSubstr("\"number\":3"));
  EXPECT_THAT(json, HasSubstr("\"decision\":\"skipped\""));
  EXPECT_THAT(json, HasSubstr("\"held_ns\":2000000000"));
  EXPECT_THAT(json, HasSubstr("\"reason\":\"late \\\"by\\\" 5\""));
  step.number.reset();
  EXPECT_THAT(jsonOf(step), HasSubstr("\"number\":null"));
}

TEST(JsonRows, NoTextOfAPlanOrRigGoesOut) {
  db::RunRow row;
  row.id = "r";
  row.plan_toml = "webhook = \"https://user:secret@host\"";
  row.rig_toml = "settings = { password = \"secret\" }";
  EXPECT_THAT(jsonOf(row, nullptr, {}), Not(HasSubstr("secret")));
  EXPECT_THAT(jsonOf(row, nullptr, {}), HasSubstr("\"id\":\"r\""));
}

TEST(JsonRows, BytesThatAreNoTextDoNotStopAnAnswer) {
  db::EventRow event;
  event.detail = "driver says \xff\xfe";
  EXPECT_THAT(jsonOf(event), HasSubstr("driver says"));
}

TEST(JsonRows, AViewComesBackAsItWas) {
  const RunView view = liveView();
  const auto back = runOf(jsonOf(view));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->id, view.id);
  EXPECT_EQ(back->state, view.state);
  EXPECT_EQ(back->devices, view.devices);
  EXPECT_EQ(back->status.captured, view.status.captured);
  EXPECT_EQ(back->status.next_due_utc, view.status.next_due_utc);
  ASSERT_EQ(back->cameras.size(), 2u);
  EXPECT_FALSE(back->cameras[1].status.up);
  EXPECT_EQ(back->cameras[0].newest->utc, view.cameras[0].newest->utc);
  EXPECT_FALSE(back->cameras[1].newest);
  EXPECT_EQ(runsOf(listJson("runs", {jsonOf(view), jsonOf(view)})).size(), 2u);
}

TEST(JsonRows, AListSaysWhereItsNextPageBegins) {
  EXPECT_EQ(listJson("steps", {"{}", "{}"}, 7),
            "{\"schema\":\"patina.steps/1\",\"items\":[{},{}],\"next\":7}\n");
  EXPECT_EQ(nextOf(listJson("steps", {"{}"}, 7)), 7);
  EXPECT_FALSE(nextOf(listJson("steps", {"{}"})));
  EXPECT_EQ(listJson("steps", {}), "{\"schema\":\"patina.steps/1\",\"items\":[]}\n");
}

TEST(JsonRows, AWishIsTakenOnlyAsItIsMeant) {
  EXPECT_EQ(startWishOf("{\"plan\":\"a.toml\"}")->plan, "a.toml");
  EXPECT_TRUE(startWishOf("{\"plan\":\"a.toml\",\"new_run\":true}")->new_run);
  EXPECT_TRUE(startWishOf(jsonOf(StartWish{"a.toml", true}))->new_run);
  for (const char* wrong : {"", "[]", "{}", "{\"plan\":1}", "{\"plan\":\"a\",\"new_run\":1}",
                            "{\"plan\":\"a\",\"exec\":\"rm\"}", "{\"plan\":\"a\""})
    EXPECT_FALSE(startWishOf(wrong)) << wrong;
  EXPECT_THROW(startWishOf(std::string(100'000, '[')), capture::CaptureError);
}

TEST(JsonRows, AnErrorIsFoundInAnAnswer) {
  const auto error = errorOf("{\"error\":{\"exit\":75,\"message\":\"busy\"}}");
  ASSERT_TRUE(error);
  EXPECT_EQ(*error, std::pair(75, std::string("busy")));
  EXPECT_FALSE(errorOf("<html>"));
  EXPECT_EQ(errorOf("{\"error\":{\"exit\":99999999999}}")->first, 70);
}

TEST(JsonRows, ANumberThatIsNoCountIsNone) {
  EXPECT_EQ(runOf("{\"id\":\"r\",\"step\":1e300,\"captured\":2}")->status.step, 0);
  EXPECT_EQ(runOf("{\"id\":\"r\",\"step\":1e300,\"captured\":2}")->status.captured, 2);
}

TEST(JsonRows, AnswersThatAreNoneAreEmpty) {
  for (const char* text : {"", "<html>", "{}", "{\"items\":3}", "[1,2"}) {
    EXPECT_TRUE(runsOf(text).empty()) << text;
    EXPECT_FALSE(runOf(text)) << text;
  }
}

}  // namespace
}  // namespace patina::daemon
