#pragma once

#include <optional>
#include <string_view>

#include "engine/core/result.h"
#include "engine/rml1/board/bitmap.h"

namespace rmlcell::rml1 {

struct PngBitmap {
  Bitmap bitmap;
  std::optional<double> pixel_mm;  // edge of a pixel, where the file says it (pHYs)
};

// Reads the bytes of a PNG of any kind. Light pixels are copper, dark ones and transparent ones are
// not; `invert` turns that round. Errors: Rml1BadPicture (8121) for what is no PNG, is damaged, or
// has pixels that are not square; Rml1PictureTooLarge (8122) above `pixels_max`, before anything is
// decoded.
Result<PngBitmap> ReadPng(std::string_view bytes, bool invert, std::size_t pixels_max = kPixelsMax);

// Edge of a pixel in mm: by the dots an inch that were asked for, where they are not 0, else as the
// file has it. Error: Rml1PictureSize (8123) where neither says it.
Result<double> PixelSizeOf(const PngBitmap& picture, double dpi);

}  // namespace rmlcell::rml1
