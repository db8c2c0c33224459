// SPDX-License-Identifier: GPL-3.0-or-later
// A texture that would not fit is quilted in little memory, about as fast as its bytes can be read
// once and written once. The long form (PATINA_LARGE_QUILT) takes 2,500 frames of 512x512 to
// 1024x1024: 2 GB in, 7.9 GB out, beside the test program.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>

#include "devices/clock.h"
#include "processing/ttf/remap.h"
#include "tests/processing/synthesis/quilting/textures.h"
#include "tests/support/child.h"
#include "tests/support/places.h"

namespace patina::quilting {
namespace {

using patina::testing::TempFolder;

struct Case {
  int frames, side, result;
  std::int64_t memory_bytes;
  bool long_form;
};
Case chosenCase() {
  if (std::getenv("PATINA_LARGE_QUILT")) return {2500, 512, 1024, std::int64_t{1} << 30, true};
  return {600, 256, 512, std::int64_t{400} << 20, false};  // 118 MB in, 472 MB out
}

// Two patterns that fade into one another.
void writeInput(const std::filesystem::path& path, const Case& c) {
  const Image<float> waves = waveTexture({c.side, c.side}, 2);
  ttf::TtfInfo info;
  info.width = info.height = c.side;
  info.type = ttf::SampleType::kU8;
  ttf::TtfWriter writer(path, info);
  Image<std::uint16_t> frame(c.side, c.side, 3);
  for (int t = 0; t < c.frames; ++t) {
    const float s = static_cast<float>(t) / static_cast<float>(c.frames);
    for (std::size_t i = 0; i < frame.texels().size() / 3; ++i) {
      const float v =
          20000 + 4000 * ((1 - s) * waves.texels()[2 * i] + s * waves.texels()[2 * i + 1]);
      for (std::size_t channel = 0; channel < 3; ++channel)
        frame.texels()[3 * i + channel] =
            static_cast<std::uint16_t>(v + 2000 * static_cast<float>(channel) * s);
    }
    writer.add(std::as_const(frame).view(), t, Sha256{});
  }
  writer.close();
}

void forget(const std::filesystem::path& path) {  // so that it is read from the disk
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_EQ(::fdatasync(fd), 0);
  ASSERT_EQ(::posix_fadvise(fd, 0, 0, POSIX_FADV_DONTNEED), 0);
  ::close(fd);
}

// As any program would: every byte of `in` read once, as many as `out` has written and synced.
void readAndWrite(const std::filesystem::path& in, const std::filesystem::path& out,
                  std::int64_t out_bytes) {
  std::vector<char> piece(std::size_t{1} << 20);
  const int from = ::open(in.c_str(), O_RDONLY | O_CLOEXEC);
  while (::read(from, piece.data(), piece.size()) > 0) continue;
  ::close(from);
  const int to = ::open(out.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  const auto most = static_cast<std::int64_t>(piece.size());
  for (std::int64_t left = out_bytes; left > 0; left -= most) {
    const auto bytes = static_cast<std::size_t>(std::min(left, most));
    ASSERT_EQ(::write(to, piece.data(), bytes), static_cast<ssize_t>(bytes));
  }
  ASSERT_EQ(::fsync(to), 0);
  ::close(to);
}

// The same through this project's files, which are on their way to the disk while they are written.
void remap(const std::filesystem::path& in, const std::filesystem::path& out, const Case& c) {
  const ttf::TtfReader input(in);
  Image<std::int32_t> tiled(c.result, c.result, 2);
  for (int y = 0; y < c.result; ++y)
    for (int x = 0; x < c.result; ++x) {
      tiled.at(x, y, 0) = x % c.side;
      tiled.at(x, y, 1) = y % c.side;
    }
  Progress silent;
  ttf::remapTtf(input, std::as_const(tiled).view(), out, noProvenance, silent);
}

TEST(LargeQuilt, TakesLittleMemoryAndAboutTheTimeOfItsBytes) {
  const Case c = chosenCase();
  const TempFolder folder;
  const std::string in = folder / "in.h5", out = folder / "out.h5";
  writeInput(in, c);
  const devices::RealClock clock;
  const auto secondsOf = [&](const auto& work) {
    forget(in);
    const MonoTime began = clock.mono();
    work();
    return toSeconds(clock.mono() - began);
  };
  const std::string side = std::to_string(c.result);
  const double quilt_s = secondsOf([&] {
    const auto done = patina::testing::runPatina({"synth", "quilt", in, "--size", side + "x" + side,
                                                  "--block", "96x96", "--out", out, "--quiet"});
    ASSERT_EQ(done.exit, 0) << done.err;
  });
  rusage taken{};
  getrusage(RUSAGE_CHILDREN, &taken);
  std::printf("%d frames of %dx%d to %dx%d: peak %.0f MB, user %.1f s, system %.1f s\n", c.frames,
              c.side, c.side, c.result, c.result, static_cast<double>(taken.ru_maxrss) / 1024,
              static_cast<double>(taken.ru_utime.tv_sec) + 1e-6 * taken.ru_utime.tv_usec,
              static_cast<double>(taken.ru_stime.tv_sec) + 1e-6 * taken.ru_stime.tv_usec);
  EXPECT_LE(std::int64_t{1024} * taken.ru_maxrss, c.memory_bytes);
  EXPECT_EQ(ttf::TtfReader(out).info().frames, c.frames);
  if (!c.long_form) return;
  const auto out_bytes = static_cast<std::int64_t>(std::filesystem::file_size(out));
  std::filesystem::remove(out);
  const double remap_s = secondsOf([&] { remap(in, out, c); });
  std::filesystem::remove(out);
  const double bytes_s = secondsOf([&] { readAndWrite(in, folder / "plain", out_bytes); });
  std::printf("quilted in %.1f s; its bytes alone %.1f s: %.2f times; copied alone %.1f s\n",
              quilt_s, bytes_s, quilt_s / bytes_s, remap_s);
  EXPECT_LE(quilt_s, 1.5 * bytes_s);
}

}  // namespace
}  // namespace patina::quilting
