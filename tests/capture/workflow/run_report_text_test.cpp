// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "capture/workflow/run_report.h"

namespace patina::workflow {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(RunReportText, EscapesWhatComesFromOutside) {
  RunReport report;
  report.run.id = "<script>alert(1)</script>";
  report.events.push_back({0, report.run.id, {}, "alarm", "<b>bold</b>"});
  const std::string html = reportHtml(report, {});
  EXPECT_THAT(html, Not(HasSubstr("<script>")));
  EXPECT_THAT(html, Not(HasSubstr("<b>bold</b>")));
}

TEST(RunReportText, ShowsPicturesAndPlaysFilms) {
  const std::vector<ReportPicture> pictures = {{"banana", "banana.mp4"}, {"light", "light.png"}};
  const std::string html = reportHtml({}, pictures);
  EXPECT_THAT(html, HasSubstr("<video"));
  EXPECT_THAT(html, HasSubstr("light.png"));
  EXPECT_THAT(reportMarkdown({}, pictures), HasSubstr("light.png"));
}

}  // namespace
}  // namespace patina::workflow
