// SPDX-License-Identifier: GPL-3.0-or-later
extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

#include "processing/image/film_file.h"
#include "processing/image/libav.h"
#include "processing/image/picture_file.h"

namespace patina {
namespace {

struct CloseInput {
  void operator()(AVFormatContext* f) const { avformat_close_input(&f); }
};

// The formats with a J are the old way of saying full range.
AVPixelFormat withoutJ(AVPixelFormat format) {
  switch (format) {
    case AV_PIX_FMT_YUVJ420P:
      return AV_PIX_FMT_YUV420P;
    case AV_PIX_FMT_YUVJ422P:
      return AV_PIX_FMT_YUV422P;
    case AV_PIX_FMT_YUVJ444P:
      return AV_PIX_FMT_YUV444P;
    case AV_PIX_FMT_YUVJ440P:
      return AV_PIX_FMT_YUV440P;
    default:
      return format;
  }
}

// Untagged films: standard definition is BT.601, larger ones BT.709.
int matrixOf(const AVFrame& frame) {
  if (frame.colorspace != AVCOL_SPC_UNSPECIFIED && frame.colorspace != AVCOL_SPC_RGB)
    return frame.colorspace;
  return frame.height < 720 ? SWS_CS_ITU601 : SWS_CS_ITU709;
}

}  // namespace

struct FilmReader::State {
  std::string name;
  std::unique_ptr<AVFormatContext, CloseInput> format;
  LibavPtr<AVCodecContext> codec;
  LibavPtr<AVPacket> packet{av_packet_alloc()};
  LibavPtr<AVFrame> frame{av_frame_alloc()};
  LibavPtr<SwsContext> converter;
  SizePx converter_size;
  AVPixelFormat converter_format = AV_PIX_FMT_NONE;
  int stream = -1;
  bool draining = false;
  std::int64_t first_pts = AV_NOPTS_VALUE;
  std::optional<Nanoseconds> time;

  [[noreturn]] void refuse(const std::string& why) const {
    throw ProcessingError(Exit::kBadData, name + ": " + why);
  }
  void open();
  void feed();
  Image<std::uint8_t> convert();
  void takeTime();
};

void FilmReader::State::open() {
  AVFormatContext* raw = nullptr;
  int error = avformat_open_input(&raw, name.c_str(), nullptr, nullptr);
  if (error < 0) refuse("not a film, or damaged (" + libavText(error) + ")");
  format.reset(raw);
  error = avformat_find_stream_info(raw, nullptr);
  if (error < 0) refuse("the film is damaged (" + libavText(error) + ")");
  const AVCodec* decoder = nullptr;
  stream = av_find_best_stream(raw, AVMEDIA_TYPE_VIDEO, -1, -1, &decoder, 0);
  if (stream < 0 || !decoder) refuse("the file holds no film that can be decoded");
  codec.reset(avcodec_alloc_context3(decoder));
  avcodec_parameters_to_context(codec.get(), raw->streams[stream]->codecpar);
  codec->max_pixels = PictureLimits{}.pixels_max;
  codec->pkt_timebase = raw->streams[stream]->time_base;
  error = avcodec_open2(codec.get(), decoder, nullptr);
  if (error < 0) refuse("the film cannot be decoded (" + libavText(error) + ")");
  if (codec->width <= 0 || codec->height <= 0) refuse("the film has no size: it is damaged");
}

// One packet of our stream, or the end, into the decoder.
void FilmReader::State::feed() {
  for (;;) {
    const int error = av_read_frame(format.get(), packet.get());
    if (error == AVERROR_EOF) {
      draining = true;
      avcodec_send_packet(codec.get(), nullptr);
      return;
    }
    if (error < 0) refuse("the film is damaged or truncated (" + libavText(error) + ")");
    const bool ours = packet->stream_index == stream;
    const bool corrupt = (packet->flags & AV_PKT_FLAG_CORRUPT) != 0;
    const int sent = ours && !corrupt ? avcodec_send_packet(codec.get(), packet.get()) : 0;
    av_packet_unref(packet.get());
    if (!ours) continue;
    if (corrupt) refuse("the film is damaged or truncated within a frame");
    if (sent < 0) refuse("the film is damaged (" + libavText(sent) + ")");
    return;
  }
}

Image<std::uint8_t> FilmReader::State::convert() {
  const auto format_now = static_cast<AVPixelFormat>(frame->format);
  if (!converter || converter_size != SizePx{frame->width, frame->height} ||
      converter_format != format_now) {
    converter.reset(sws_getContext(
        frame->width, frame->height, withoutJ(format_now), frame->width, frame->height,
        AV_PIX_FMT_RGB24,
        SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT | SWS_FULL_CHR_H_INP | SWS_BITEXACT,
        nullptr, nullptr, nullptr));
    if (!converter) refuse("the film's kind of pixels cannot be converted");
    const bool full = frame->color_range == AVCOL_RANGE_JPEG || withoutJ(format_now) != format_now;
    sws_setColorspaceDetails(converter.get(), sws_getCoefficients(matrixOf(*frame)), full,
                             sws_getCoefficients(SWS_CS_ITU709), 1, 0, 1 << 16, 1 << 16);
    converter_size = {frame->width, frame->height};
    converter_format = format_now;
  }
  Image<std::uint8_t> out(frame->width, frame->height, 3);
  std::uint8_t* planes[4] = {out.texels().data(), nullptr, nullptr, nullptr};
  const int strides[4] = {frame->width * 3, 0, 0, 0};
  sws_scale(converter.get(), frame->data, frame->linesize, 0, frame->height, planes, strides);
  return out;
}

void FilmReader::State::takeTime() {
  time.reset();
  const std::int64_t pts = frame->best_effort_timestamp;
  if (pts == AV_NOPTS_VALUE) return;
  if (first_pts == AV_NOPTS_VALUE) first_pts = pts;
  const AVRational base = format->streams[stream]->time_base;
  time = Nanoseconds{av_rescale_q(pts - first_pts, base, AVRational{1, 1'000'000'000})};
}

FilmReader::FilmReader(const std::filesystem::path& path) : state_(std::make_unique<State>()) {
  silenceLibav();
  // A bare name with a colon would be taken for a protocol.
  state_->name = std::filesystem::absolute(path).string();
  if (!std::filesystem::exists(path)) state_->refuse("there is no such file");
  state_->open();
}

FilmReader::~FilmReader() = default;

std::optional<Image<std::uint8_t>> FilmReader::next() {
  State& s = *state_;
  for (;;) {
    const int error = avcodec_receive_frame(s.codec.get(), s.frame.get());
    if (error == AVERROR_EOF) return std::nullopt;
    if (error == AVERROR(EAGAIN)) {
      s.feed();
      continue;
    }
    if (error < 0) s.refuse("the film is damaged (" + libavText(error) + ")");
    s.takeTime();
    Image<std::uint8_t> out = s.convert();
    av_frame_unref(s.frame.get());
    return out;
  }
}

std::optional<Nanoseconds> FilmReader::lastFrameTime() const { return state_->time; }

}  // namespace patina
