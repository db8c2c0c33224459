// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/routes.h"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>

#include "processing/image/random.h"
#include "tests/capture/app/http/open_api.h"

namespace patina::http {
namespace {

const std::string kHash(64, 'a');

TEST(MatchPattern, GivesTheParametersOfAPath) {
  const auto found = matchPattern("/api/v1/runs/{run}/pause", "/api/v1/runs/latest/pause");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->at("run"), "latest");
}

TEST(MatchPattern, TakesNothingButAHashForAHash) {
  const std::string pattern = "/api/v1/objects/{sha256}";
  EXPECT_TRUE(matchPattern(pattern, "/api/v1/objects/" + kHash));
  for (const std::string& wrong :
       {kHash.substr(1), kHash + "a", std::string(64, 'A'), std::string(64, 'g'),
        kHash.substr(1) + "/", "../" + kHash, kHash.substr(4) + ".jpg"})
    EXPECT_FALSE(matchPattern(pattern, "/api/v1/objects/" + wrong)) << wrong;
}

TEST(MatchPattern, WantsAsManySegmentsAsThePatternHas) {
  EXPECT_FALSE(matchPattern("/runs/{run}", "/runs"));
  EXPECT_FALSE(matchPattern("/runs/{run}", "/runs/a/b"));
  EXPECT_FALSE(matchPattern("/runs", "/"));
  EXPECT_FALSE(matchPattern("/", "/runs"));
  EXPECT_TRUE(matchPattern("/", "/"));
}

TEST(IsPlainPath, RefusesWhateverAFileSystemOrADecoderCouldReadInAnotherWay) {
  for (const std::string& path :
       {std::string(""), std::string("x"), std::string("//"), std::string("/a/"),
        std::string("/../a"), std::string("/a/.."), std::string("/./a"), std::string("/.hidden"),
        std::string("/%2e%2e/a"), std::string("/a%2fb"), std::string("/a\\b"),
        std::string("/a\0b", 4), std::string("/a b"), std::string("/a\xc0\xaf"),
        std::string("http://evil/"), "/" + std::string(1024, 'a')})
    EXPECT_FALSE(isPlainPath(path)) << path;
  EXPECT_TRUE(isPlainPath("/api/v1/runs/20240501T120000Z-banana"));
}

TEST(RouteTable, NamesTheMethodsOfAPathThatHasOthers) {
  const RouteTable table(stubRoutes());
  const auto found = table.find("DELETE", "/api/v1/runs");
  EXPECT_EQ(found.route, nullptr);
  EXPECT_NE(found.allowed.find("POST"), std::string::npos);
  EXPECT_TRUE(table.find("GET", "/api/v1/nothing").allowed.empty());
}

TEST(RouteTable, AnswersHeadWithTheRouteOfGet) {
  const RouteTable table(
      {{"GET", "/a", Role::kViewer, "a", {}}, {"GET", "/events", Role::kViewer, "e", {}}});
  EXPECT_EQ(table.find("HEAD", "/a").route->operation_id, "a");
  EXPECT_EQ(table.find("HEAD", "/events").route, nullptr);
}

TEST(RouteTableDeathTest, RefusesTwoRoutesThatOneRequestCouldMean) {
  EXPECT_DEATH(RouteTable({{"GET", "/a/{x}", Role::kViewer, "a", {}},
                           {"GET", "/a/b", Role::kViewer, "b", {}}}),
               "overlap");
}

// A path out of pieces that attacks are made of, and of what our own paths are made of.
std::string fuzzedPath(std::uint64_t seed) {
  static const std::array<std::string, 26> pieces = {"/",
                                                     "/",
                                                     "/",
                                                     "..",
                                                     ".",
                                                     "%2e%2e",
                                                     "%2f",
                                                     "\\",
                                                     "api",
                                                     "v1",
                                                     "objects",
                                                     "runs",
                                                     "latest",
                                                     std::string(64, 'a'),
                                                     std::string(63, '0'),
                                                     std::string("\0", 1),
                                                     "%00",
                                                     "~",
                                                     "etc/passwd",
                                                     "preview",
                                                     "\xc0\xae",
                                                     "?",
                                                     ";",
                                                     "//",
                                                     "/api/v1/objects/",
                                                     "/api/v1/runs/"};
  std::string path = uniformBelow(hashSeed(seed, 0), 4) == 0 ? "" : "/api/v1/objects/";
  const auto count = uniformBelow(hashSeed(seed, 1), 8);
  for (std::uint64_t i = 0; i < count; ++i) {
    if (uniformBelow(hashSeed(seed, 2, i), 8) == 0)
      path += static_cast<char>(uniformBelow(hashSeed(seed, 3, i), 256));
    else
      path += pieces[uniformBelow(hashSeed(seed, 4, i), pieces.size())];
  }
  return path;
}

TEST(RouteTable, LetsNoneOfAMillionFuzzedPathsLeaveTheArchive) {
  const RouteTable table(stubRoutes());
  const std::filesystem::path root = "/archive/frames";
  int objects = 0, escaped = 0;
  for (std::uint64_t seed = 0; seed < 1'000'000; ++seed) {
    const auto found = table.find("GET", fuzzedPath(seed));
    if (!found.route) continue;
    for (const auto& [name, value] : found.parameters) {
      const auto file = (root / value).lexically_normal();
      escaped += file.parent_path() != root || value.find('\0') != std::string::npos;
      if (name == "sha256") escaped += !isSha256Text(value);
      objects += name == "sha256";
    }
  }
  EXPECT_EQ(escaped, 0);
  EXPECT_GT(objects, 1000);  // the fuzz does reach the route
}

}  // namespace
}  // namespace patina::http
