// SPDX-License-Identifier: GPL-3.0-or-later
// JPEG by libjpeg. Its errors leave by longjmp, so no object with a destructor may live in a frame
// that is jumped over: the functions that call setjmp hold plain data only.

// jpeglib.h needs the first two before it.
// clang-format off
#include <cstddef>
#include <cstdio>
#include <jpeglib.h>
#include <jerror.h>
// clang-format on

#include <csetjmp>
#include <cstdlib>

#include "processing/image/codecs.h"

namespace patina {
namespace {

struct Errors {
  jpeg_error_mgr base;  // first: libjpeg hands back a pointer to it
  std::jmp_buf jump;
  char message[JMSG_LENGTH_MAX];
};

[[noreturn]] void leave(j_common_ptr info) {
  auto* errors = reinterpret_cast<Errors*>(info->err);
  (*info->err->format_message)(info, errors->message);
  std::longjmp(errors->jump, 1);
}

// libjpeg goes on after damage and leaves gray blocks: for an archive that is an error.
void warn(j_common_ptr info, int level) {
  if (level >= 0) return;
  switch (info->err->msg_code) {
    case JWRN_EXTRANEOUS_DATA:
    case JWRN_ADOBE_XFORM:
    case JWRN_JFIF_MAJOR:
      return;
    default:
      leave(info);
  }
}

void installErrors(jpeg_error_mgr** slot, Errors& errors) {
  *slot = jpeg_std_error(&errors.base);
  errors.base.error_exit = leave;
  errors.base.emit_message = warn;
  errors.message[0] = 0;
}

bool runDecode(jpeg_decompress_struct& info, Errors& errors, const unsigned char* data,
               std::size_t bytes, ImageView<std::uint8_t> out) {
  if (setjmp(errors.jump)) return false;
  jpeg_create_decompress(&info);
  jpeg_mem_src(&info, data, bytes);
  jpeg_read_header(&info, TRUE);
  info.out_color_space = out.channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
  info.dct_method = JDCT_ISLOW;
  jpeg_start_decompress(&info);
  if (info.output_width != static_cast<JDIMENSION>(out.width) ||
      info.output_height != static_cast<JDIMENSION>(out.height))
    return false;
  while (info.output_scanline < info.output_height) {
    JSAMPROW row = out.row(static_cast<int>(info.output_scanline));
    jpeg_read_scanlines(&info, &row, 1);
  }
  jpeg_finish_decompress(&info);
  return true;
}

bool runEncode(jpeg_compress_struct& info, Errors& errors, ImageView<const std::uint8_t> in,
               int quality, unsigned char** data, unsigned long* bytes) {
  if (setjmp(errors.jump)) return false;
  jpeg_create_compress(&info);
  jpeg_mem_dest(&info, data, bytes);
  info.image_width = static_cast<JDIMENSION>(in.width);
  info.image_height = static_cast<JDIMENSION>(in.height);
  info.input_components = in.channels;
  info.in_color_space = in.channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, quality, TRUE);
  info.dct_method = JDCT_ISLOW;
  // Half-resolution colour would smear every texel over its neighbours: only for small files.
  if (quality >= 90 && in.channels == 3)
    info.comp_info[0].h_samp_factor = info.comp_info[0].v_samp_factor = 1;
  jpeg_start_compress(&info, TRUE);
  while (info.next_scanline < info.image_height) {
    JSAMPROW row = const_cast<JSAMPROW>(in.row(static_cast<int>(info.next_scanline)));
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  return true;
}

}  // namespace

namespace codecs {

Samples decodeJpeg(std::span<const std::byte> file, const PictureHeader& header) {
  if (header.bits != 8) refuse("a JPEG of " + std::to_string(header.bits) + " bits: only 8");
  Image<std::uint8_t> out(header.size.width, header.size.height, header.channels);
  jpeg_decompress_struct info{};
  Errors errors;
  installErrors(&info.err, errors);
  const bool good = runDecode(info, errors, reinterpret_cast<const unsigned char*>(file.data()),
                              file.size(), out.view());
  jpeg_destroy_decompress(&info);
  if (!good)
    refuse(std::string("the JPEG is damaged or of an unknown kind (") + errors.message +
           "); copy it again or save it as plain RGB");
  return out;
}

}  // namespace codecs

Bytes encodeJpeg(ImageView<const std::uint8_t> srgb, int quality) {
  if (srgb.empty() || (srgb.channels != 1 && srgb.channels != 3) || srgb.width > 65500 ||
      srgb.height > 65500 || quality < 1 || quality > 100)
    throw ProcessingError(Exit::kUsage,
                          "a JPEG has 1 or 3 channels, 1 to 65500 pixels a side and quality 1-100");
  jpeg_compress_struct info{};
  Errors errors;
  installErrors(&info.err, errors);
  unsigned char* data = nullptr;
  unsigned long bytes = 0;
  const bool good = runEncode(info, errors, srgb, quality, &data, &bytes);
  jpeg_destroy_compress(&info);
  Bytes out;
  if (good) {
    const auto* begin = reinterpret_cast<const std::byte*>(data);
    out.assign(begin, begin + bytes);
  }
  std::free(data);
  if (!good)
    throw ProcessingError(Exit::kCannotCreate, std::string("JPEG encoder: ") + errors.message);
  return out;
}

}  // namespace patina
