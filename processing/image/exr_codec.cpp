// SPDX-License-Identifier: GPL-3.0-or-later
// OpenEXR in memory: flat pictures with R, G, B or one channel, and A; half and float, read as
// float.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>

#include <cstring>

#include "processing/image/alpha.h"
#include "processing/image/codecs.h"

namespace patina::codecs {
namespace {

class MemoryInput final : public Imf::IStream {
 public:
  explicit MemoryInput(std::span<const std::byte> file) : Imf::IStream("memory"), file_(file) {}
  bool read(char* to, int n) override {
    if (n < 0 || at_ > file_.size() || static_cast<std::uint64_t>(n) > file_.size() - at_)
      throw std::runtime_error("it ends early");
    std::memcpy(to, file_.data() + at_, static_cast<std::size_t>(n));
    at_ += static_cast<std::uint64_t>(n);
    return at_ < file_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t at) override { at_ = at; }

 private:
  std::span<const std::byte> file_;
  std::uint64_t at_ = 0;
};

class MemoryOutput final : public Imf::OStream {
 public:
  MemoryOutput() : Imf::OStream("memory") {}
  void write(const char* from, int n) override {
    const auto count = static_cast<std::size_t>(n);
    if (at_ + count > bytes.size()) bytes.resize(at_ + count);
    std::memcpy(bytes.data() + at_, from, count);
    at_ += count;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t at) override { at_ = at; }

  Bytes bytes;

 private:
  std::uint64_t at_ = 0;
};

// OpenEXR makes room for an attribute as long as it says it is, whatever the file's length: so
// every attribute of every part (magic, version, then name, type and length each, an empty name at
// the end) has to lie within the file.
void refuseAttributesBeyond(std::span<const std::byte> file) {
  constexpr std::uint32_t kMultipart = 0x1000;
  std::size_t at = 4;
  const auto number = [&] {
    if (file.size() - at < 4) throw std::runtime_error("its header ends early");
    std::uint32_t value = 0;
    std::memcpy(&value, file.data() + at, 4);
    at += 4;
    return value;
  };
  const auto skipText = [&] {
    const std::size_t begin = at;
    while (at < file.size() && file[at] != std::byte{0}) ++at;
    if (at == file.size()) throw std::runtime_error("its header ends early");
    return at++ - begin;
  };
  const bool several = (number() & kMultipart) != 0;
  for (bool any = true; any;) {
    any = false;
    while (skipText() > 0) {
      any = several;
      skipText();
      const std::uint32_t length = number();
      if (length > file.size() - at)
        throw std::runtime_error("an attribute is longer than the file");
      at += length;
    }
  }
}

// R, G, B, or the single channel whatever its name.
std::vector<std::string> channelNames(const Imf::Header& header) {
  const Imf::ChannelList& channels = header.channels();
  std::vector<std::string> names;
  for (auto it = channels.begin(); it != channels.end(); ++it) {
    if (it.channel().xSampling != 1 || it.channel().ySampling != 1)
      refuse("the EXR holds channels of a lower resolution: save it as plain R, G, B");
    names.emplace_back(it.name());
  }
  if (channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B"))
    return {"R", "G", "B"};
  if (channels.findChannel("Y")) return {"Y"};
  if (names.size() == 1) return names;
  refuse("the EXR has neither R, G, B nor a single channel");
}

PictureHeader headerOf(const Imf::InputFile& in) {
  const Imath::Box2i window = in.header().dataWindow();
  const auto side = [](int low, int high) {
    return static_cast<int>(std::min<std::int64_t>(std::int64_t{high} - low + 1, 0x7fffffff));
  };
  const auto names = channelNames(in.header());
  const auto type = in.header().channels().findChannel(names[0])->type;
  return {.format = PictureFormat::kExr,
          .size = {side(window.min.x, window.max.x), side(window.min.y, window.max.y)},
          .channels = static_cast<int>(names.size()),
          .bits = type == Imf::HALF ? 16 : 32};
}

template <class Body>
auto guarded(const Body& body) {
  try {
    return body();
  } catch (const ProcessingError&) {
    throw;
  } catch (const std::exception& e) {
    refuse(std::string("the EXR is damaged or truncated (") + e.what() + "); copy it again");
  }
}

Image<float> read(Imf::InputFile& in, const std::vector<std::string>& names, SizePx size) {
  const Imath::Box2i window = in.header().dataWindow();
  Image<float> out(size.width, size.height, static_cast<int>(names.size()));
  const std::size_t step = sizeof(float) * names.size();
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < names.size(); ++c)
    buffer.insert(names[c], Imf::Slice::Make(Imf::FLOAT, out.texels().data() + c, window, step,
                                             step * static_cast<std::size_t>(size.width)));
  in.setFrameBuffer(buffer);
  in.readPixels(window.min.y, window.max.y);
  return out;
}

// Y, or R, G, B, or R, G, B, A.
Bytes encode(ImageView<const float> linear) {
  try {
    Imf::Header header(linear.width, linear.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer buffer;
    static constexpr const char* kNames[] = {"R", "G", "B", "A"};
    for (int c = 0; c < linear.channels; ++c) {
      const char* name = linear.channels == 1 ? "Y" : kNames[c];
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      buffer.insert(
          name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(const_cast<float*>(linear.data + c)),
                           sizeof(float) * static_cast<std::size_t>(linear.channels),
                           sizeof(float) * static_cast<std::size_t>(linear.row_stride)));
    }
    MemoryOutput stream;
    {
      Imf::OutputFile out(stream, header);  // writes its table of lines when it closes
      out.setFrameBuffer(buffer);
      out.writePixels(linear.height);
    }
    return std::move(stream.bytes);
  } catch (const std::exception& e) {
    throw ProcessingError(Exit::kCannotCreate, std::string("EXR encoder: ") + e.what());
  }
}

}  // namespace

PictureHeader readExrHeader(std::span<const std::byte> file, const PictureLimits& limits) {
  return guarded([&] {
    refuseAttributesBeyond(file);
    MemoryInput stream(file);
    const Imf::InputFile in(stream);
    const PictureHeader header = headerOf(in);
    checkClaim(header, limits);
    if (!in.isComplete()) refuse("the EXR is truncated: lines are missing; copy it again");
    return header;
  });
}

Samples decodeExr(std::span<const std::byte> file, const PictureHeader& header) {
  return guarded([&]() -> Samples {
    MemoryInput stream(file);
    Imf::InputFile in(stream);
    return read(in, channelNames(in.header()), header.size);
  });
}

Image<float> decodeExrAlpha(std::span<const std::byte> file, const PictureLimits& limits) {
  const PictureHeader header = readExrHeader(file, limits);
  return guarded([&]() -> Image<float> {
    MemoryInput stream(file);
    Imf::InputFile in(stream);
    if (in.header().channels().findChannel("A") == nullptr) return {};
    return read(in, {"A"}, header.size);
  });
}

Bytes encodeExr(ImageView<const float> linear) {
  if (linear.empty() || (linear.channels != 1 && linear.channels != 3))
    throw ProcessingError(Exit::kUsage, "an EXR has 1 or 3 channels and at least one pixel");
  return encode(linear);
}

}  // namespace patina::codecs

namespace patina {

Bytes encodeAlphaExr(ImageView<const float> linear_alpha) {
  PATINA_CHECK(!linear_alpha.empty() && linear_alpha.channels == 4);
  return codecs::encode(linear_alpha);
}

}  // namespace patina
