#include "engine/simulation/material/png.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>

#include "engine/simulation/material/height_field.h"

// libpng leaves what it cannot do by longjmp. So everything that must be released is made before
// the setjmp, and functions between the two have nothing to release.
namespace rmlcell::simulation {
namespace {

constexpr std::size_t kTextsMax = 64;           // of a file; ours have eight
constexpr std::size_t kTextBytesMax = 1 << 16;  // of one of them

// What libpng says of a file, and where its bytes come from or go to.
struct Stream {
  const std::function<bool(std::string_view)>* sink = nullptr;
  std::string_view bytes{};  // not read yet
  std::array<char, 120> said{};
};

[[noreturn]] void OnPngError(png_structp png, png_const_charp text) {
  auto& stream = *static_cast<Stream*>(png_get_error_ptr(png));
  std::strncpy(stream.said.data(), text, stream.said.size() - 1);
  png_longjmp(png, 1);
}

void OnPngWarning(png_structp, png_const_charp) {}  // what it can do without

void PutPngBytes(png_structp png, png_bytep bytes, std::size_t count) {
  const auto& stream = *static_cast<Stream*>(png_get_io_ptr(png));
  if (!(*stream.sink)({reinterpret_cast<const char*>(bytes), count}))
    png_error(png, "nobody wants more");
}

void TakePngBytes(png_structp png, png_bytep bytes, std::size_t count) {
  auto& stream = *static_cast<Stream*>(png_get_io_ptr(png));
  if (stream.bytes.size() < count) png_error(png, "it ends too early");
  std::memcpy(bytes, stream.bytes.data(), count);
  stream.bytes.remove_prefix(count);
}

struct Writing {
  Writing()
      : png(png_create_write_struct(PNG_LIBPNG_VER_STRING, &stream, OnPngError, OnPngWarning)) {
    RMLCELL_CHECK(png != nullptr);
    info = png_create_info_struct(png);
    RMLCELL_CHECK(info != nullptr);
  }
  Writing(const Writing&) = delete;
  Writing& operator=(const Writing&) = delete;
  ~Writing() { png_destroy_write_struct(&png, &info); }

  Stream stream;
  png_structp png;
  png_infop info = nullptr;
};

struct Reading {
  Reading()
      : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, &stream, OnPngError, OnPngWarning)) {
    RMLCELL_CHECK(png != nullptr);
    info = png_create_info_struct(png);
    RMLCELL_CHECK(info != nullptr);
  }
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;
  ~Reading() { png_destroy_read_struct(&png, &info, nullptr); }

  Stream stream;
  png_structp png;
  png_infop info = nullptr;
};

// 0 when no whole number of the format can say it: of an edge of 0 there are infinitely many.
png_uint_32 PixelsPerMetre(double pixel_mm) {
  const double pixels = std::round(1000.0 / pixel_mm);
  return pixels >= 1.0 && pixels <= PNG_UINT_31_MAX ? static_cast<png_uint_32>(pixels) : 0;
}

bool EncodePng(const Writing& to, const PngHeading& heading, std::span<const png_text> texts,
               const std::function<void(std::size_t, std::span<std::uint8_t>)>& row,
               std::span<std::uint8_t> row_bytes) {
  if (setjmp(png_jmpbuf(to.png)) != 0) return false;
  png_set_user_limits(to.png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
  png_set_compression_level(to.png, 6);
  const bool grey = heading.form == PngHeading::Form::kGrey16;
  png_set_IHDR(to.png, to.info, static_cast<png_uint_32>(heading.width),
               static_cast<png_uint_32>(heading.height), grey ? 16 : 8,
               grey ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_BASE, PNG_FILTER_TYPE_BASE);
  if (const png_uint_32 pixels = PixelsPerMetre(heading.pixel_mm); pixels > 0)
    png_set_pHYs(to.png, to.info, pixels, pixels, PNG_RESOLUTION_METER);
  png_set_text(to.png, to.info, texts.data(), static_cast<int>(texts.size()));
  png_write_info(to.png, to.info);
  for (std::size_t k = 0; k < heading.height; ++k) {
    if (!(*to.stream.sink)({})) return false;
    row(k, row_bytes);
    png_write_row(to.png, row_bytes.data());
  }
  png_write_end(to.png, nullptr);
  return true;
}

// Nothing, or what is wrong with the picture.
const char* DecodeHeading(Reading& from, GreyPicture& picture) {
  if (setjmp(png_jmpbuf(from.png)) != 0) return from.stream.said.data();
  png_set_user_limits(from.png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
  // Whatever is damaged, or too long to be one of our texts, is an error and no warning.
  png_set_benign_errors(from.png, 0);
  png_set_crc_action(from.png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
  png_set_chunk_cache_max(from.png, kTextsMax);
  png_set_chunk_malloc_max(from.png, kTextBytesMax);
  png_read_info(from.png, from.info);
  picture.width = png_get_image_width(from.png, from.info);
  picture.height = png_get_image_height(from.png, from.info);
  if (png_get_bit_depth(from.png, from.info) != 16 ||
      png_get_color_type(from.png, from.info) != PNG_COLOR_TYPE_GRAY)
    return "it is not grey of 16 bits";
  if (picture.width > HeightField::kCellsMax / picture.height) return "it has too many pixels";
  if (png_get_interlace_type(from.png, from.info) != PNG_INTERLACE_NONE) return "it is interlaced";
  return nullptr;
}

const char* DecodeRows(Reading& from, GreyPicture& picture, std::span<std::uint8_t> row_bytes) {
  if (setjmp(png_jmpbuf(from.png)) != 0) return from.stream.said.data();
  std::uint16_t* grey = picture.grey.data();
  for (std::size_t row = 0; row < picture.height; ++row) {
    png_read_row(from.png, row_bytes.data(), nullptr);
    for (std::size_t k = 0; k < picture.width; ++k)
      *grey++ = static_cast<std::uint16_t>(row_bytes[2 * k] << 8 | row_bytes[2 * k + 1]);
  }
  png_read_end(from.png, from.info);
  return nullptr;
}

Error NoPicture(const char* why) {
  return {ErrorCode::kCellBadText, "no height map: " + std::string(why), {}};
}

}  // namespace

bool WritePng(const PngHeading& heading,
              const std::function<void(std::size_t, std::span<std::uint8_t>)>& row,
              const std::function<bool(std::string_view)>& sink) {
  std::vector<png_text> texts;
  std::vector<std::pair<std::string, std::string>> kept = heading.texts;  // libpng wants to write
  for (auto& [key, value] : kept) {
    png_text text{};
    text.compression = PNG_TEXT_COMPRESSION_NONE;
    text.key = key.data();
    text.text = value.data();
    text.text_length = value.size();
    texts.push_back(text);
  }
  const std::size_t pixel_bytes = heading.form == PngHeading::Form::kGrey16 ? 2 : 3;
  std::vector<std::uint8_t> row_bytes(heading.width * pixel_bytes);
  Writing to;
  to.stream.sink = &sink;
  png_set_write_fn(to.png, &to.stream, PutPngBytes, nullptr);
  return EncodePng(to, heading, texts, row, row_bytes);
}

Result<GreyPicture> ReadGreyPng(std::string_view bytes) {
  Reading from;
  from.stream.bytes = bytes;
  png_set_read_fn(from.png, &from.stream, TakePngBytes);
  GreyPicture picture;
  if (const char* wrong = DecodeHeading(from, picture)) return NoPicture(wrong);
  // A picture of nothing but zeros packs a thousand to one: what cannot be is not given memory.
  constexpr std::size_t kPackedMost = 1100;
  if (picture.width * picture.height / kPackedMost > bytes.size())
    return NoPicture("it ends too early");
  picture.grey.resize(picture.width * picture.height);
  std::vector<std::uint8_t> row_bytes(2 * picture.width);
  if (const char* wrong = DecodeRows(from, picture, row_bytes)) return NoPicture(wrong);
  png_textp texts = nullptr;
  const int count = png_get_text(from.png, from.info, &texts, nullptr);
  for (int k = 0; k < count; ++k)
    picture.texts.emplace_back(texts[k].key, std::string(texts[k].text, texts[k].text_length));
  return picture;
}

}  // namespace rmlcell::simulation
