#include "engine/rml1/board/png_bitmap.h"

#include <png.h>

#include <algorithm>
#include <string>

#include "engine/core/units.h"

namespace rmlcell::rml1 {
namespace {

Error BadPicture(Detail detail) { return {ErrorCode::kRml1BadPicture, std::move(detail), {}}; }

std::uint32_t BigEndian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (const char c : bytes.substr(0, 4)) value = value << 8U | static_cast<unsigned char>(c);
  return value;
}

// The edge of a pixel by the chunk pHYs, which stands before the image data. The simple interface
// of libpng, which needs no jumps out of its errors, does not give it.
Result<std::optional<double>> PixelSize(std::string_view bytes) {
  constexpr std::size_t kSignature = 8;
  constexpr std::size_t kFrame = 12;  // length, type and checksum
  constexpr std::size_t kPhysBytes = 9;
  std::string_view rest = bytes.substr(std::min(bytes.size(), kSignature));
  while (rest.size() >= kFrame) {
    const std::size_t length = BigEndian(rest);
    const std::string_view type = rest.substr(4, 4);
    if (type == "IDAT" || length > rest.size() - kFrame) break;
    if (type == "pHYs" && length == kPhysBytes) {
      const std::uint32_t x = BigEndian(rest.substr(8));
      const std::uint32_t y = BigEndian(rest.substr(12));
      const bool in_metres = rest[16] == 1;
      if (x != y) return BadPicture("its pixels are not square");
      if (!in_metres || x == 0) break;
      constexpr double kMetre_mm = 1000.0;
      return std::optional<double>(kMetre_mm / x);
    }
    rest.remove_prefix(kFrame + length);
  }
  return std::optional<double>();
}

// Frees what libpng holds.
struct PngImage {
  png_image image{.version = PNG_IMAGE_VERSION};
  PngImage() = default;
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
  ~PngImage() { png_image_free(&image); }
};

}  // namespace

Result<PngBitmap> ReadPng(std::string_view bytes, bool invert, std::size_t pixels_max) {
  PngImage png;
  png_image& image = png.image;
  if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) == 0)
    return BadPicture(image.message);
  const std::size_t pixels = std::size_t{image.width} * image.height;
  if (pixels > pixels_max) {
    return Error{ErrorCode::kRml1PictureTooLarge,
                 Told("width", image.width) + " by " + Told("height", image.height) +
                     " pixels; at most " + Told("most", pixels_max) + " are taken",
                 {}};
  }
  const Result<std::optional<double>> pixel_mm = PixelSize(bytes);
  if (!pixel_mm) return pixel_mm.error();
  image.format = PNG_FORMAT_GRAY;
  const png_color black{};
  PngBitmap made{.bitmap = {.width = image.width, .height = image.height}, .pixel_mm = *pixel_mm};
  made.bitmap.copper.resize(pixels);
  // A negative stride turns the rows round: the last one of the file comes first.
  const auto stride = -static_cast<png_int_32>(image.width);
  if (png_image_finish_read(&image, &black, made.bitmap.copper.data(), stride, nullptr) == 0)
    return BadPicture(image.message);
  constexpr std::uint8_t kLight = 128;
  for (std::uint8_t& pixel : made.bitmap.copper) pixel = (pixel >= kLight) != invert ? 1 : 0;
  return made;
}

Result<double> PixelSizeOf(const PngBitmap& picture, double dpi) {
  if (dpi != 0.0) return kMmPerInch / dpi;
  if (picture.pixel_mm) return *picture.pixel_mm;
  return Error{ErrorCode::kRml1PictureSize, "it has no resolution", {}};
}

}  // namespace rmlcell::rml1
