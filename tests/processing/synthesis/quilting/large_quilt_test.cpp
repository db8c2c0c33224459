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
#include "processing/ttf/volume_file.h"
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

// Every byte of the input read once, as many as the result has written and synced once.
void readAndWrite(const std::filesystem::path& in, const std::filesystem::path& out,
                  const Case& c) {
  const ttf::TtfReader input(in);
  ttf::TtfInfo info = input.info();
  info.width = info.height = c.result;
  ttf::VolumeFile file(out, info, false);
  std::vector<std::byte> layer(std::size_t{8} * c.side * c.side * 3), chunk(file.chunkBytes());
  for (int t = 0; t < c.frames; t += 8) {
    const int count = std::min(8, c.frames - t);
    input.storedBlock(t, count, {0, 0, c.side, c.side}, layer.data());
    std::copy_n(layer.begin(), std::min(layer.size(), chunk.size()), chunk.begin());
    file.extend(t + count);
    for (int y = 0; y < file.chunks().height; ++y)
      for (int x = 0; x < file.chunks().width; ++x) file.writeChunk(t, count, x, y, chunk.data());
  }
  file.publish(info);
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
  double bytes_s = 0;
  if (c.long_form) {
    bytes_s = secondsOf([&] { readAndWrite(in, folder / "plain.h5", c); });
    std::filesystem::remove(folder / "plain.h5");
  }
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
  std::printf("quilted in %.1f s; its bytes alone %.1f s: %.2f times\n", quilt_s, bytes_s,
              quilt_s / bytes_s);
  EXPECT_LE(quilt_s, 1.5 * bytes_s);
}

}  // namespace
}  // namespace patina::quilting
