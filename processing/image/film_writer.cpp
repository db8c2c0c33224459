// SPDX-License-Identifier: GPL-3.0-or-later
extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include <cmath>
#include <cstring>

#include "processing/image/atomic_file.h"
#include "processing/image/film_file.h"
#include "processing/image/libav.h"

namespace patina {
namespace {

struct FreeOutput {
  void operator()(AVFormatContext* f) const {
    if (f->pb) avio_closep(&f->pb);
    avformat_free_context(f);
  }
};

// x264 gives other frames for other numbers of threads: fixed, whatever machine this is.
constexpr int kEncoderThreads = 2;

}  // namespace

void FilmOptions::check() const {
  if (!(frames_per_second > 0 && frames_per_second <= 240))
    throw ProcessingError(Exit::kUsage, "frames_per_second " + std::to_string(frames_per_second) +
                                            ": allowed is above 0 up to 240");
  if (quality_crf < 0 || quality_crf > 51)
    throw ProcessingError(Exit::kUsage, "quality_crf " + std::to_string(quality_crf) +
                                            ": allowed is 0 (lossless) to 51");
}

struct FilmWriter::State {
  std::filesystem::path path, temporary;
  SizePx size, padded;
  std::unique_ptr<AVFormatContext, FreeOutput> format;
  LibavPtr<AVCodecContext> codec;
  LibavPtr<AVFrame> frame{av_frame_alloc()};
  LibavPtr<AVPacket> packet{av_packet_alloc()};
  LibavPtr<SwsContext> converter;
  std::vector<std::uint8_t> rgb;  // of the padded size, only for odd sizes
  std::int64_t frames = 0;
  bool closed = false;

  void require(int error, const char* what) const {
    if (error >= 0) return;
    const Exit exit = error == AVERROR(ENOSPC)                              ? Exit::kCannotCreate
                      : error == AVERROR(EACCES) || error == AVERROR(EROFS) ? Exit::kPermission
                                                                            : Exit::kIo;
    throw ProcessingError(exit, path.string() + ": " + what + ": " + libavText(error));
  }
  void openCodec(const FilmOptions& options);
  void openFile();
  void openConverter();
  void send(const AVFrame* next);
  void pad(ImageView<const std::uint8_t> srgb);
};

void FilmWriter::State::openCodec(const FilmOptions& options) {
  const AVCodec* encoder = avcodec_find_encoder_by_name("libx264");
  if (!encoder)
    throw ProcessingError(Exit::kUnavailable, "films need libavcodec with libx264; run make again");
  codec.reset(avcodec_alloc_context3(encoder));
  AVCodecContext& c = *codec;
  c.width = padded.width;
  c.height = padded.height;
  c.pix_fmt = AV_PIX_FMT_YUV420P;
  const AVRational rate = av_d2q(options.frames_per_second, 100'000);
  c.framerate = rate;
  c.time_base = av_inv_q(rate);
  c.gop_size = std::max(1, static_cast<int>(std::lround(options.frames_per_second * 4)));
  c.thread_count = kEncoderThreads;
  c.color_range = AVCOL_RANGE_MPEG;
  c.colorspace = AVCOL_SPC_BT709;
  c.color_primaries = AVCOL_PRI_BT709;
  c.color_trc = AVCOL_TRC_BT709;
  c.chroma_sample_location = AVCHROMA_LOC_LEFT;
  if (format->oformat->flags & AVFMT_GLOBALHEADER) c.flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  av_opt_set(c.priv_data, "preset", "veryfast", 0);
  av_opt_set_double(c.priv_data, "crf", options.quality_crf, 0);
  av_opt_set(c.priv_data, "x264-params", "lookahead-threads=1", 0);
  require(avcodec_open2(&c, encoder, nullptr), "the H.264 encoder refuses");
}

void FilmWriter::State::openFile() {
  AVStream* stream = avformat_new_stream(format.get(), nullptr);
  PATINA_CHECK(stream != nullptr);
  require(avcodec_parameters_from_context(stream->codecpar, codec.get()), "parameters");
  stream->time_base = codec->time_base;
  stream->avg_frame_rate = codec->framerate;
  require(avio_open(&format->pb, temporary.c_str(), AVIO_FLAG_WRITE), "cannot be created");
  AVDictionary* options = nullptr;
  av_dict_set(&options, "movflags", "+faststart", 0);
  const int error = avformat_write_header(format.get(), &options);
  av_dict_free(&options);
  require(error, "cannot be written");
}

void FilmWriter::State::openConverter() {
  converter.reset(sws_getContext(padded.width, padded.height, AV_PIX_FMT_RGB24, padded.width,
                                 padded.height, AV_PIX_FMT_YUV420P,
                                 SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INP | SWS_BITEXACT,
                                 nullptr, nullptr, nullptr));
  PATINA_CHECK(converter != nullptr);
  const int* matrix = sws_getCoefficients(SWS_CS_ITU709);
  sws_setColorspaceDetails(converter.get(), matrix, 1, matrix, 0, 0, 1 << 16, 1 << 16);
}

void FilmWriter::State::send(const AVFrame* next) {
  require(avcodec_send_frame(codec.get(), next), "the H.264 encoder failed");
  for (;;) {
    const int error = avcodec_receive_packet(codec.get(), packet.get());
    if (error == AVERROR(EAGAIN) || error == AVERROR_EOF) return;
    require(error, "the H.264 encoder failed");
    packet->duration = 1;
    av_packet_rescale_ts(packet.get(), codec->time_base, format->streams[0]->time_base);
    packet->stream_index = 0;
    require(av_interleaved_write_frame(format.get(), packet.get()), "cannot be written");
  }
}

// Repeats the last column and row.
void FilmWriter::State::pad(ImageView<const std::uint8_t> srgb) {
  const std::size_t stride = static_cast<std::size_t>(padded.width) * 3;
  rgb.resize(stride * padded.height);
  for (int y = 0; y < padded.height; ++y) {
    std::uint8_t* row = rgb.data() + y * stride;
    std::memcpy(row, srgb.row(std::min(y, size.height - 1)),
                static_cast<std::size_t>(size.width) * 3);
    if (padded.width > size.width) std::memcpy(row + stride - 3, row + stride - 6, 3);
  }
}

FilmWriter::FilmWriter(const std::filesystem::path& mp4, SizePx size, const FilmOptions& options)
    : state_(std::make_unique<State>()) {
  silenceLibav();
  options.check();
  if (size.width < 1 || size.height < 1 || size.width > 16384 || size.height > 16384)
    throw ProcessingError(Exit::kUsage, "a film has 1 to 16384 pixels a side");
  State& s = *state_;
  s.path = std::filesystem::absolute(mp4);
  s.temporary = temporaryBeside(s.path);
  s.size = size;
  s.padded = {(size.width + 1) & ~1, (size.height + 1) & ~1};
  AVFormatContext* raw = nullptr;
  s.require(avformat_alloc_output_context2(&raw, nullptr, "mp4", s.temporary.c_str()), "mp4");
  s.format.reset(raw);
  s.openCodec(options);
  s.openFile();
  s.openConverter();
  s.frame->format = AV_PIX_FMT_YUV420P;
  s.frame->width = s.padded.width;
  s.frame->height = s.padded.height;
  s.frame->color_range = AVCOL_RANGE_MPEG;
  s.frame->colorspace = AVCOL_SPC_BT709;
  s.require(av_frame_get_buffer(s.frame.get(), 0), "memory");
}

FilmWriter::~FilmWriter() {
  if (state_->closed) return;
  state_->format.reset();
  std::error_code ignored;
  std::filesystem::remove(state_->temporary, ignored);
}

void FilmWriter::add(ImageView<const std::uint8_t> srgb) {
  State& s = *state_;
  PATINA_CHECK(!s.closed && srgb.size() == s.size && srgb.channels == 3);
  const std::uint8_t* planes[4] = {srgb.data, nullptr, nullptr, nullptr};
  int strides[4] = {static_cast<int>(srgb.row_stride), 0, 0, 0};
  if (s.padded != s.size) {
    s.pad(srgb);
    planes[0] = s.rgb.data();
    strides[0] = s.padded.width * 3;
  }
  s.require(av_frame_make_writable(s.frame.get()), "memory");
  sws_scale(s.converter.get(), planes, strides, 0, s.padded.height, s.frame->data,
            s.frame->linesize);
  s.frame->pts = s.frames++;
  s.send(s.frame.get());
}

void FilmWriter::close() {
  State& s = *state_;
  PATINA_CHECK(!s.closed);
  if (s.frames == 0) throw ProcessingError(Exit::kUsage, s.path.string() + ": a film of no frames");
  s.send(nullptr);
  s.require(av_write_trailer(s.format.get()), "cannot be written");
  s.require(avio_closep(&s.format->pb), "cannot be written");
  s.format.reset();
  publishAtomically(s.temporary, s.path);
  s.closed = true;
}

}  // namespace patina
