// SPDX-License-Identifier: GPL-3.0-or-later
// RTSP by FFmpeg, over TCP. Each shot connects anew: a connection that is kept for days must be
// read for days, or what it gives is old.
extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libswscale/swscale.h>
}

#include <cctype>

#include "devices/network/picture_source.h"

namespace patina::devices::network {
namespace {

using namespace std::chrono_literals;

struct FreeAv {
  void operator()(AVFormatContext* f) const { avformat_close_input(&f); }
  void operator()(AVCodecContext* c) const { avcodec_free_context(&c); }
  void operator()(AVPacket* p) const { av_packet_free(&p); }
  void operator()(AVFrame* f) const { av_frame_free(&f); }
  void operator()(SwsContext* s) const { sws_freeContext(s); }
};
template <class T>
using Av = std::unique_ptr<T, FreeAv>;

std::string errorText(int error) {
  char text[AV_ERROR_MAX_STRING_SIZE] = "";
  av_strerror(error, text, sizeof text);
  return text;
}

std::string percentEncoded(const std::string& text) {
  constexpr char kHex[] = "0123456789ABCDEF";
  std::string out;
  for (const char c : text) {
    const auto u = static_cast<unsigned char>(c);
    if (std::isalnum(u) || c == '-' || c == '_' || c == '.')
      out += c;
    else
      out += {'%', kHex[u >> 4], kHex[u & 15]};
  }
  return out;
}

// The library takes them in the address only; no message shows this one.
std::string addressOf(const CameraSettings& settings) {
  const std::string& secret = settings.credentials;
  if (secret.empty()) return settings.url;
  const std::size_t colon = secret.find(':');
  const std::size_t host = settings.url.find("://") + 3;
  return settings.url.substr(0, host) + percentEncoded(secret.substr(0, colon)) + ":" +
         percentEncoded(secret.substr(colon + 1)) + "@" + settings.url.substr(host);
}

// Formats with a J are the old way of saying full range.
bool isFullRange(const AVFrame& frame) {
  return frame.color_range == AVCOL_RANGE_JPEG || frame.format == AV_PIX_FMT_YUVJ420P ||
         frame.format == AV_PIX_FMT_YUVJ422P || frame.format == AV_PIX_FMT_YUVJ444P;
}

AVPixelFormat plainFormat(const AVFrame& frame) {
  switch (frame.format) {
    case AV_PIX_FMT_YUVJ420P:
      return AV_PIX_FMT_YUV420P;
    case AV_PIX_FMT_YUVJ422P:
      return AV_PIX_FMT_YUV422P;
    case AV_PIX_FMT_YUVJ444P:
      return AV_PIX_FMT_YUV444P;
    default:
      return static_cast<AVPixelFormat>(frame.format);
  }
}

// One connection, for one picture.
class Connection {
 public:
  Connection(const CameraSettings& settings, Clock& clock, MonoTime deadline)
      : settings_(settings), clock_(clock), deadline_(deadline) {}

  Result<void> open();
  // The first whole key frame that arrives at `not_before` or later, less those to be skipped.
  Result<Fetched> keyFrame(MonoTime not_before);

 private:
  static int interrupted(void* self) {
    const auto& me = *static_cast<Connection*>(self);
    return me.clock_.mono() >= me.deadline_ ? 1 : 0;
  }
  tl::unexpected<Error> failed(const std::string& what, int error) const;
  Result<Fetched> decode(const AVPacket& packet, MonoTime arrived);
  Result<Bytes> pngOf(const AVFrame& frame) const;

  const CameraSettings& settings_;
  Clock& clock_;
  MonoTime deadline_;
  Av<AVFormatContext> format_;
  Av<AVCodecContext> codec_;
  int stream_ = -1;
};

tl::unexpected<Error> Connection::failed(const std::string& what, int error) const {
  const std::string message = settings_.who + ": " + settings_.url + ": " + what;
  if (clock_.mono() >= deadline_) return fail(Errc::kTimeout, message + ": not by the deadline");
  if (error == AVERROR_HTTP_UNAUTHORIZED || error == AVERROR_HTTP_FORBIDDEN)
    return fail(Errc::kRefused,
                message + ": the camera wants other credentials: settings.credentials");
  if (error == AVERROR_HTTP_NOT_FOUND)
    return fail(Errc::kRefused, message + ": no such stream: is the address right?");
  return fail(Errc::kLost, message + ": " + errorText(error));
}

Result<void> Connection::open() {
  AVFormatContext* raw = avformat_alloc_context();
  if (!raw) return fail(Errc::kBusy, settings_.who + ": out of memory");
  raw->interrupt_callback = {interrupted, this};
  AVDictionary* options = nullptr;
  av_dict_set(&options, "rtsp_transport", "tcp", 0);
  av_dict_set(&options, "protocol_whitelist", "rtsp,rtp,tcp", 0);
  av_dict_set(&options, "timeout", std::to_string(settings_.connect_timeout.count() / 1000).c_str(),
              0);
  const int opened = avformat_open_input(&raw, addressOf(settings_).c_str(), nullptr, &options);
  av_dict_free(&options);
  if (opened < 0) return failed("connect", opened);  // which has freed it
  format_.reset(raw);
  stream_ = av_find_best_stream(raw, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
  if (stream_ < 0)
    return fail(Errc::kRefused, settings_.who + ": " + settings_.url + " holds no pictures");
  const AVCodecParameters& parameters = *raw->streams[stream_]->codecpar;
  const AVCodec* decoder = avcodec_find_decoder(parameters.codec_id);
  if (!decoder) return fail(Errc::kUnsupported, settings_.who + ": the stream cannot be decoded");
  codec_.reset(avcodec_alloc_context3(decoder));
  avcodec_parameters_to_context(codec_.get(), &parameters);
  codec_->max_pixels = PictureLimits{}.pixels_max;
  codec_->thread_count = 1;
  if (const int error = avcodec_open2(codec_.get(), decoder, nullptr); error < 0)
    return failed("open the decoder", error);
  return {};
}

Result<Fetched> Connection::keyFrame(MonoTime not_before) {
  const Av<AVPacket> packet(av_packet_alloc());
  int skip = settings_.skip_key_frames;
  for (std::uint64_t bytes = 0;;) {
    const int error = av_read_frame(format_.get(), packet.get());
    const MonoTime arrived = clock_.mono();
    if (arrived >= deadline_ || error < 0) return failed("read", error);
    bytes += static_cast<std::uint64_t>(packet->size);
    const bool whole = (packet->flags & AV_PKT_FLAG_CORRUPT) == 0;
    const bool key = packet->stream_index == stream_ && (packet->flags & AV_PKT_FLAG_KEY) != 0;
    const bool kept_one = key && whole && skip-- > 0;
    if (key && whole && !kept_one && arrived >= not_before) return decode(*packet, arrived);
    av_packet_unref(packet.get());
    if (bytes > settings_.bytes_max)
      return fail(Errc::kCorrupt, settings_.who + ": no key frame within settings.bytes_max, " +
                                      formatBytes(settings_.bytes_max));
  }
}

// A key frame needs no other: the end after it makes the decoder give it out at once.
Result<Fetched> Connection::decode(const AVPacket& packet, MonoTime arrived) {
  const Av<AVFrame> frame(av_frame_alloc());
  int error = avcodec_send_packet(codec_.get(), &packet);
  if (error >= 0) error = avcodec_send_packet(codec_.get(), nullptr);
  if (error >= 0) error = avcodec_receive_frame(codec_.get(), frame.get());
  const bool damaged =
      error < 0 || frame->decode_error_flags != 0 || (frame->flags & AV_FRAME_FLAG_CORRUPT) != 0;
  if (damaged)
    return fail(Errc::kCorrupt, settings_.who + ": the key frame is damaged" +
                                    (error < 0 ? " (" + errorText(error) + ")" : ""));
  auto png = pngOf(*frame);
  if (!png) return tl::make_unexpected(png.error());
  return Fetched{std::move(*png), arrived - settings_.latency / 2};
}

Result<Bytes> Connection::pngOf(const AVFrame& frame) const {
  const Av<SwsContext> converter(sws_getContext(
      frame.width, frame.height, plainFormat(frame), frame.width, frame.height, AV_PIX_FMT_RGB24,
      SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT | SWS_FULL_CHR_H_INP | SWS_BITEXACT,
      nullptr, nullptr, nullptr));
  if (!converter)
    return fail(Errc::kUnsupported, settings_.who + ": the stream's kind of pixels is not known");
  // Untagged: standard definition is BT.601, larger ones BT.709.
  int matrix = frame.height < 720 ? SWS_CS_ITU601 : SWS_CS_ITU709;
  if (frame.colorspace != AVCOL_SPC_UNSPECIFIED && frame.colorspace != AVCOL_SPC_RGB)
    matrix = frame.colorspace;
  sws_setColorspaceDetails(converter.get(), sws_getCoefficients(matrix), isFullRange(frame),
                           sws_getCoefficients(SWS_CS_ITU709), 1, 0, 1 << 16, 1 << 16);
  Image<std::uint8_t> rgb(frame.width, frame.height, 3);
  std::uint8_t* planes[4] = {rgb.texels().data(), nullptr, nullptr, nullptr};
  const int strides[4] = {frame.width * 3, 0, 0, 0};
  sws_scale(converter.get(), frame.data, frame.linesize, 0, frame.height, planes, strides);
  return encodePng(std::as_const(rgb).view());
}

class RtspSource final : public PictureSource {
 public:
  RtspSource(const CameraSettings& settings, Clock& clock) : settings_(settings), clock_(clock) {
    av_log_set_level(AV_LOG_QUIET);  // what goes wrong reaches the caller by value
  }

  Result<void> open(MonoTime deadline) override {
    Connection connection(settings_, clock_, deadline);
    return connection.open();
  }

  Result<Fetched> fetch(MonoTime trigger, MonoTime deadline) override {
    Connection connection(settings_, clock_, deadline);
    if (auto opened = connection.open(); !opened) return tl::make_unexpected(opened.error());
    auto fetched = connection.keyFrame(trigger + settings_.latency);
    if (fetched && fetched->file == last_)
      return fail(Errc::kCorrupt, settings_.who + ": the previous picture came again");
    if (fetched) last_ = fetched->file;
    return fetched;
  }

 private:
  const CameraSettings& settings_;
  Clock& clock_;
  Bytes last_;
};

}  // namespace

std::unique_ptr<PictureSource> makeRtspSource(const CameraSettings& settings, Clock& clock) {
  return std::make_unique<RtspSource>(settings, clock);
}

}  // namespace patina::devices::network
