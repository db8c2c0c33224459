// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/golden.h"

#include <cstdlib>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "tests/support/matchers.h"
#include "tests/support/places.h"
#include "tests/support/temp_folder.h"

namespace fs = std::filesystem;
using ::testing::AssertionFailure;
using ::testing::AssertionResult;
using ::testing::AssertionSuccess;

namespace patina::testing {

namespace {

fs::path goldenFile(const std::string& name) { return sourceFolder() / "tests/golden" / name; }

bool updating() {
  const char* asked = std::getenv("PATINA_UPDATE_GOLDEN");
  return asked != nullptr && std::string(asked) == "1";
}

AssertionResult missing(const fs::path& file) {
  return AssertionFailure() << file << " is not there; PATINA_UPDATE_GOLDEN=1 writes it";
}

// PFM: rows from the bottom up, little endian for a negative scale.
std::string toPfm(ImageView<const float> image) {
  std::ostringstream out;
  out << (image.channels == 3 ? "PF\n" : "Pf\n") << image.width << ' ' << image.height << "\n-1\n";
  for (int y = image.height - 1; y >= 0; --y)
    out.write(reinterpret_cast<const char*>(image.row(y)),
              static_cast<std::streamsize>(sizeof(float)) * image.width * image.channels);
  return out.str();
}

Image<float> fromPfm(const std::string& bytes) {
  std::istringstream in(bytes);
  std::string kind;
  int width = 0, height = 0;
  double scale = 0;
  in >> kind >> width >> height >> scale;
  in.get();
  const int channels = kind == "PF" ? 3 : 1;
  if (!in || scale != -1) throw std::runtime_error("not a PFM of ours");
  Image<float> image(width, height, channels);
  for (int y = height - 1; y >= 0; --y)
    in.read(reinterpret_cast<char*>(image.view().row(y)),
            static_cast<std::streamsize>(sizeof(float)) * width * channels);
  if (!in) throw std::runtime_error("a PFM cut short");
  return image;
}

}  // namespace

AssertionResult matchesGolden(const std::string& name, const std::string& text) {
  const fs::path file = goldenFile(name);
  if (updating()) {
    writeFile(file, text);
    return AssertionSuccess() << "wrote " << file;
  }
  if (!fs::exists(file)) return missing(file);
  const std::string golden = readFile(file);
  if (golden == text) return AssertionSuccess() << "equals " << file;
  std::istringstream want(golden), got(text);
  std::string want_line, got_line;
  for (int line = 1;; ++line) {
    const bool want_more = static_cast<bool>(std::getline(want, want_line));
    const bool got_more = static_cast<bool>(std::getline(got, got_line));
    if (!want_more) want_line = "(end)";
    if (!got_more) got_line = "(end)";
    if (want_line != got_line || !want_more)
      return AssertionFailure() << name << ":" << line << ": want: " << want_line
                                << "\n  got:  " << got_line;
  }
}

AssertionResult matchesGolden(const std::string& name, ImageView<const float> image,
                              double tolerance) {
  if (image.channels != 1 && image.channels != 3)
    return AssertionFailure() << name << ": a golden image has 1 or 3 channels";
  const fs::path file = goldenFile(name);
  if (updating()) {
    writeFile(file, toPfm(image));
    return AssertionSuccess() << "wrote " << file;
  }
  if (!fs::exists(file)) return missing(file);
  ::testing::StringMatchResultListener why;
  const ::testing::Matcher<ImageView<const float>> near =
      ImageNear(fromPfm(readFile(file)), tolerance);
  if (near.MatchAndExplain(image, &why)) return AssertionSuccess() << "near " << file;
  return AssertionFailure() << name << ": " << why.str();
}

}  // namespace patina::testing
