// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/email.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <sstream>

#include "tests/capture/notify/messages.h"
#include "tests/support/temp_folder.h"

namespace patina::capture::notify {
namespace {

using namespace std::chrono_literals;
using patina::testing::readFile;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Result = Delivery::Result;

// A sendmail that keeps what it is given, then does as `script` says.
class Mail : public ::testing::Test {
 protected:
  std::filesystem::path sendmail(const std::string& script) {
    const auto file = folder_ / "sendmail";
    const std::string keep = folder_.path().string();
    patina::testing::writeFile(file, "#!/bin/sh\necho \"$@\" >" + keep + "/arguments\nenv >" +
                                         keep + "/environment\nls /proc/self/fd >" + keep +
                                         "/descriptors\ncat >" + keep + "/mail\n" + script + "\n");
    chmod(file.c_str(), 0700);
    return file;
  }
  static EmailSettings settings() {
    EmailSettings s;
    s.to = {"lab@example.org", "night@example.org"};
    s.from = "rig@example.org";
    return s;
  }
  patina::testing::TempFolder folder_;
};

TEST_F(Mail, IsTakenBySendmailWithItsRecipientsInTheHeader) {
  setenv("PATINA_TEST_SECRET", "hunter2", 1);
  Email email(settings(), sendmail("exit 0"));
  const Delivery delivery = email.send(cameraDown(), {});
  EXPECT_TRUE(delivery.delivered()) << delivery.answer;
  EXPECT_EQ(readFile(folder_ / "arguments"), "-i -t\n");
  EXPECT_EQ(readFile(folder_ / "mail"), mailOf(cameraDown(), settings()));
  EXPECT_THAT(readFile(folder_ / "environment"), Not(HasSubstr("hunter2")));
  EXPECT_THAT(readFile(folder_ / "descriptors"), StartsWith("0\n1\n2\n3\n"));  // 3: of ls
  EXPECT_EQ(std::filesystem::file_size(folder_ / "descriptors"), 8u);
}

TEST_F(Mail, HasTheHeadersOfARobotAndAnEmptyLineBeforeTheBody) {
  const std::string mail = mailOf(cameraDown(), settings());
  EXPECT_THAT(mail, StartsWith("To: lab@example.org,\n night@example.org\n"
                               "From: Patina <rig@example.org>\n"
                               "Subject: [critical] banana: camera cam0 down\n"
                               "Date: Wed, 01 May 2024 12:07:00 +0000\n"));
  EXPECT_THAT(mail, HasSubstr("Auto-Submitted: auto-generated\n"));
  EXPECT_THAT(mail, HasSubstr("\n\ncamera cam0 down\n"));
}

TEST_F(Mail, TakesNoHeaderFromWhatItTells) {
  Message m = cameraDown();
  const std::string evil = "x\r\nBcc: thief@example.org\n\n<body>\rX-Y: z\n.\n";
  m.news.subject = evil;
  m.news.detail = evil;
  m.about.rig = m.about.specimen = m.about.run_id = evil;
  const std::string mail = mailOf(m, settings());
  const std::string head = mail.substr(0, mail.find("\n\n"));
  std::istringstream lines(head);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count)
    EXPECT_THAT(line, Not(StartsWith("Bcc"))) << head;
  EXPECT_EQ(count, 10);  // To, its second line, From, Subject, Date, three of MIME, two more
  EXPECT_THAT(mail, Not(HasSubstr("\r")));
  EXPECT_THAT(mail, Not(HasSubstr("\n.\n")));
}

TEST_F(Mail, BreaksLinesThatMailCannotCarry) {
  Message m = cameraDown();
  m.news.detail.clear();
  for (int i = 0; i < 3000; ++i) m.news.detail += "\xc3\xa4";
  std::istringstream lines(mailOf(m, settings()));
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(line.size(), 998u);
    if (line.empty()) continue;
    EXPECT_NE(static_cast<unsigned char>(line[0]) & 0xC0, 0x80) << "cut a letter";
  }
}

TEST_F(Mail, IsTriedAgainWhenSendmailSaysSoAndNotWhenItKnowsBetter) {
  for (const int exit : {1, 69, 71, 75}) {
    Email email(settings(), sendmail("echo queue is full >&2; exit " + std::to_string(exit)));
    const Delivery delivery = email.send(cameraDown(), {});
    EXPECT_EQ(delivery.result, Result::kTryAgain) << exit;
    EXPECT_THAT(delivery.answer, HasSubstr(": queue is full"));
  }
  for (const int exit : {64, 67, 68, 78})
    EXPECT_EQ(
        Email(settings(), sendmail("exit " + std::to_string(exit))).send(cameraDown(), {}).result,
        Result::kRefused)
        << exit;
}

TEST_F(Mail, IsTriedAgainWhenThereIsNoSendmail) {
  const Delivery delivery = Email(settings(), folder_ / "none").send(cameraDown(), {});
  EXPECT_EQ(delivery.result, Result::kTryAgain);
  EXPECT_THAT(delivery.answer, HasSubstr("install a mail transport"));
}

TEST_F(Mail, KillsASendmailThatHangsWithItsChildren) {
  Email email(settings(),
              sendmail("sleep 1000 & echo $! >" + (folder_ / "child").string() + "; wait"), 300ms);
  const Delivery delivery = email.send(cameraDown(), {});
  EXPECT_EQ(delivery.result, Result::kTryAgain);
  EXPECT_THAT(delivery.answer, HasSubstr("within 300ms"));
  std::stop_source hurry;
  hurry.request_stop();
  EXPECT_EQ(Email(settings(), sendmail("sleep 1000")).send(cameraDown(), hurry.get_token()).result,
            Result::kTryAgain);
}

TEST_F(Mail, IsWantedForWhatIsBadEnough) {
  const Email email(settings());
  EXPECT_TRUE(email.wants(cameraDown()));
  EXPECT_TRUE(email.wants(test()));
  EXPECT_FALSE(email.wants(run("the run begins")));
  EXPECT_FALSE(email.wants(frame()));
}

}  // namespace
}  // namespace patina::capture::notify
