// SPDX-License-Identifier: BSD-3-Clause
// JPEG through TurboJPEG, which hands out the stored luma. Any warning of the decoder (such as
// a premature end) is an error.
#include <turbojpeg.h>

#include <memory>
#include <type_traits>

#include "lsv/ingest/decoders.h"

namespace lsv {
namespace {

struct Destroy {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using Handle = std::unique_ptr<std::remove_pointer_t<tjhandle>, Destroy>;

Error jpeg_error(const EncodedImage& in, tjhandle handle) {
  return bad_image(in.name, std::string("damaged JPEG: ") + tjGetErrorStr2(handle));
}

}  // namespace

Result<ImageNotes> decode_jpeg(const EncodedImage& in, Frame& out) {
  const Handle handle(tjInitDecompress());
  if (!handle) return bad_image(in.name, "the JPEG decoder could not be started");
  int width_px = 0;
  int height_px = 0;
  int subsampling = 0;
  int colour_space = 0;
  const auto size_bytes = static_cast<unsigned long>(in.bytes.size());
  if (tjDecompressHeader3(handle.get(), in.bytes.data(), size_bytes, &width_px, &height_px,
                          &subsampling, &colour_space) != 0)
    return jpeg_error(in, handle.get());
  const auto size = check_image_size(in.name, width_px, height_px, in.options.max_pixels);
  if (!size) return size.error();
  if (colour_space == TJCS_CMYK || colour_space == TJCS_YCCK)
    return unsupported_image(in.name, "is a CMYK JPEG; lsv reads grey and RGB ones");

  out.reset({.width_px = width_px, .height_px = height_px});
  if (tjDecompress2(handle.get(), in.bytes.data(), size_bytes, out.row8(0), width_px,
                    static_cast<int>(out.view().stride_bytes), height_px, TJPF_GRAY,
                    TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS | TJFLAG_ACCURATEDCT) != 0)
    return jpeg_error(in, handle.get());
  return ImageNotes{.colour = colour_space != TJCS_GRAY};
}

}  // namespace lsv
