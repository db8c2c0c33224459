// SPDX-License-Identifier: GPL-3.0-or-later
// Every file of the corpora through its target, with the compiler of every day: what a fuzzer once
// found stays mended.
#include <gtest/gtest.h>

#include <filesystem>

#include "processing/image/random.h"
#include "tests/fuzz/targets.h"
#include "tests/support/places.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {
namespace {

class FuzzCorpus : public ::testing::TestWithParam<FuzzTarget> {
 protected:
  static std::vector<std::string> files() {
    std::vector<std::string> texts;
    const auto folder = sourceFolder() / "tests/fuzz/corpus" / GetParam().name;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      texts.push_back(readFile(entry.path()));
    return texts;
  }
  static void run(const std::string& text) { GetParam().run(std::as_bytes(std::span(text))); }
};

TEST_P(FuzzCorpus, IsReadOrRefused) {
  const auto texts = files();
  EXPECT_GE(texts.size(), 2u);
  for (const std::string& text : texts) run(text);
}

TEST_P(FuzzCorpus, IsReadOrRefusedWhenItIsCutShortOrChanged) {
  for (const std::string& text : files())
    for (std::uint64_t i = 0; i < 200 && !text.empty(); ++i) {
      const std::uint64_t own = hashSeed(text.size(), i);
      run(text.substr(0, uniformBelow(own, text.size())));
      std::string changed = text;
      for (std::uint64_t n = 0; n < 1 + own % 4; ++n)
        changed[uniformBelow(hashSeed(own, n), text.size())] =
            static_cast<char>(hashSeed(own, n, 1) & 0xff);
      run(changed);
    }
}

INSTANTIATE_TEST_SUITE_P(Of, FuzzCorpus, ::testing::ValuesIn(fuzzTargets()),
                         [](const auto& target) { return target.param.name; });

}  // namespace
}  // namespace patina::testing
