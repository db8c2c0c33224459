// SPDX-License-Identifier: GPL-3.0-or-later
// PNG by libpng. As with JPEG, frames that call setjmp hold plain data only.
#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstring>
#include <limits>

#include "processing/image/alpha.h"
#include "processing/image/codecs.h"
#include "processing/image/linear_png.h"

namespace patina {
namespace {

constexpr png_fixed_point kGammaOne = 100'000;

struct Errors {
  char message[120] = "";
};

[[noreturn]] void leave(png_structp png, png_const_charp message) {
  auto* errors = static_cast<Errors*>(png_get_error_ptr(png));
  std::strncpy(errors->message, message, sizeof errors->message - 1);
  png_longjmp(png, 1);
}
void ignore(png_structp, png_const_charp) {}

struct Source {
  std::span<const std::byte> rest;
};

void readSome(png_structp png, png_bytep to, std::size_t n) {
  auto* source = static_cast<Source*>(png_get_io_ptr(png));
  if (n > source->rest.size()) png_error(png, "truncated");
  std::memcpy(to, source->rest.data(), n);
  source->rest = source->rest.subspan(n);
}

void writeSome(png_structp png, png_bytep from, std::size_t n) {
  auto* out = static_cast<Bytes*>(png_get_io_ptr(png));
  const auto* begin = reinterpret_cast<const std::byte*>(from);
  out->insert(out->end(), begin, begin + n);
}
void flushNothing(png_structp) {}

enum class Alpha { kDropped, kKept };

// Gray or RGB of 8 or 16 bits, whatever the file holds.
void normalise(png_structp png, png_infop info, int bits, Alpha alpha) {
  if (bits == 16 && std::endian::native == std::endian::little) png_set_swap(png);
  png_set_expand(png);
  if (alpha == Alpha::kDropped) png_set_strip_alpha(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
}

bool runDecode(png_structp png, png_infop info, Source& source, int bits, Alpha alpha,
               std::size_t row_bytes, png_bytep first_row, int height) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_read_fn(png, &source, readSome);
  png_set_user_limits(png, 0x7fffffff, 0x7fffffff);
  png_set_chunk_malloc_max(png, 16 << 20);
  png_read_info(png, info);
  normalise(png, info, bits, alpha);
  if (png_get_rowbytes(png, info) != row_bytes) png_error(png, "unknown layout of samples");
  const int passes = png_get_interlace_type(png, info) == PNG_INTERLACE_NONE ? 1 : 7;
  for (int pass = 0; pass < passes; ++pass)
    for (int y = 0; y < height; ++y)
      png_read_row(png, first_row + static_cast<std::size_t>(y) * row_bytes, nullptr);
  png_read_end(png, nullptr);  // checks the sums that are left
  return true;
}

template <class T>
Image<T> decodeAs(std::span<const std::byte> file, const PictureHeader& header,
                  Alpha alpha = Alpha::kDropped) {
  Image<T> out(header.size.width, header.size.height,
               header.channels + (alpha == Alpha::kKept ? 1 : 0));
  Errors errors;
  Source source{file};
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &errors, leave, ignore);
  PATINA_CHECK(png != nullptr);
  png_infop info = png_create_info_struct(png);
  const bool good =
      info && runDecode(png, info, source, header.bits, alpha,
                        static_cast<std::size_t>(out.width()) * out.channels() * sizeof(T),
                        reinterpret_cast<png_bytep>(out.texels().data()), out.height());
  png_destroy_read_struct(&png, &info, nullptr);
  if (!good)
    codecs::refuse(std::string("the PNG is damaged (") + errors.message + "); copy it again");
  return out;
}

bool runEncode(png_structp png, png_infop info, Bytes& out, SizePx size, int channels, int bits,
               Encoding encoding, png_const_bytep first_row, std::ptrdiff_t stride_bytes) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_write_fn(png, &out, writeSome, flushNothing);
  // A third of the time of the default level for a few per cent of size.
  png_set_compression_level(png, 3);
  png_set_IHDR(png, info, static_cast<png_uint_32>(size.width),
               static_cast<png_uint_32>(size.height), bits,
               channels == 1   ? PNG_COLOR_TYPE_GRAY
               : channels == 3 ? PNG_COLOR_TYPE_RGB
                               : PNG_COLOR_TYPE_RGB_ALPHA,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (encoding == Encoding::kLinear) png_set_gAMA_fixed(png, info, kGammaOne);
  png_write_info(png, info);
  if (bits == 16 && std::endian::native == std::endian::little) png_set_swap(png);
  for (int y = 0; y < size.height; ++y) png_write_row(png, first_row + y * stride_bytes);
  png_write_end(png, info);
  return true;
}

template <class T>
Bytes encodeAs(ImageView<const T> in, Encoding encoding) {
  Bytes out;
  Errors errors;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &errors, leave, ignore);
  PATINA_CHECK(png != nullptr);
  png_infop info = png_create_info_struct(png);
  const bool good = info && runEncode(png, info, out, in.size(), in.channels, sizeof(T) * 8,
                                      encoding, reinterpret_cast<png_const_bytep>(in.data),
                                      in.row_stride * static_cast<std::ptrdiff_t>(sizeof(T)));
  png_destroy_write_struct(&png, &info);
  if (!good)
    throw ProcessingError(Exit::kCannotCreate, std::string("PNG encoder: ") + errors.message);
  return out;
}

std::uint32_t numberAt(std::span<const std::byte> file, std::size_t at) {
  std::uint32_t v = 0;
  for (std::size_t i = 0; i < 4; ++i) v = v << 8 | std::to_integer<std::uint32_t>(file[at + i]);
  return v;
}

// Where the chunk of that name begins, of those before the samples; 0: it is not there.
std::size_t findChunk(std::span<const std::byte> file, std::uint32_t wanted) {
  constexpr std::uint32_t kIdat = 0x49444154;
  for (std::size_t at = 8; at + 12 <= file.size();) {
    const std::uint32_t name = numberAt(file, at + 4);
    if (name == kIdat) return 0;
    if (name == wanted) return at;
    at += 12 + std::size_t{numberAt(file, at)};
  }
  return 0;
}

// Whether an alpha channel (colour types 4 and 6) or a transparent colour (tRNS) is there: what the
// header and the chunks before the samples say.
bool hasAlpha(std::span<const std::byte> file) {
  constexpr std::size_t kColourType = 25;
  constexpr std::uint32_t kTrns = 0x74524E53;
  if (file.size() <= kColourType) return false;
  if ((std::to_integer<int>(file[kColourType]) & PNG_COLOR_MASK_ALPHA) != 0) return true;
  return findChunk(file, kTrns) != 0;
}

template <class T>
Image<float> alphaOf(std::span<const std::byte> file, const PictureHeader& header) {
  const Image<T> samples = decodeAs<T>(file, header, Alpha::kKept);
  Image<float> out(samples.width(), samples.height(), 1);
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x)
      out.at(x, y) = static_cast<float>(samples.at(x, y, header.channels)) /
                     static_cast<float>(std::numeric_limits<T>::max());
  return out;
}

void checkPlain(SizePx size, int channels) {
  if (size.width < 1 || size.height < 1 || (channels != 1 && channels != 3))
    throw ProcessingError(Exit::kUsage, "a PNG has 1 or 3 channels and at least one pixel");
}

}  // namespace

namespace codecs {

Samples decodePng(std::span<const std::byte> file, const PictureHeader& header) {
  if (header.bits == 16) return decodeAs<std::uint16_t>(file, header);
  return decodeAs<std::uint8_t>(file, header);
}

Image<float> decodePngAlpha(std::span<const std::byte> file, const PictureLimits& limits) {
  const PictureHeader header = readPngHeader(file, limits);
  if (!hasAlpha(file)) return {};
  return header.bits == 16 ? alphaOf<std::uint16_t>(file, header)
                           : alphaOf<std::uint8_t>(file, header);
}

}  // namespace codecs

Bytes encodePng(ImageView<const std::uint8_t> srgb) {
  checkPlain(srgb.size(), srgb.channels);
  return encodeAs(srgb, Encoding::kSrgb);
}
Bytes encodePng(ImageView<const std::uint16_t> samples) {
  checkPlain(samples.size(), samples.channels);
  return encodeAs(samples, Encoding::kSrgb);
}
Bytes encodeAlphaPng(ImageView<const std::uint8_t> srgb_alpha) {
  PATINA_CHECK(!srgb_alpha.empty() && srgb_alpha.channels == 4);
  return encodeAs(srgb_alpha, Encoding::kSrgb);
}
Bytes encodeLinearPng(ImageView<const std::uint16_t> linear) {
  checkPlain(linear.size(), linear.channels);
  return encodeAs(linear, Encoding::kLinear);
}

bool isLinearPng(std::span<const std::byte> file) {
  constexpr std::uint32_t kGama = 0x67414D41;
  const std::size_t at = findChunk(file, kGama);
  return at != 0 && numberAt(file, at) == 4 && numberAt(file, at + 8) == kGammaOne;
}
}  // namespace patina
