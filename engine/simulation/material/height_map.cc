#include "engine/simulation/material/height_map.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/number_text.h"
#include "engine/simulation/material/height_grid.h"
#include "engine/simulation/material/png.h"

namespace rmlcell::simulation {
namespace {

constexpr double kWhite = 65535.0;

double StepOf(const Stock& stock) { return (stock.top - stock.bottom) / kWhite; }

struct ScaleText {
  const char* key;
  double Stock::*value;
};
constexpr ScaleText kScale[] = {{"Left mm", &Stock::x_min},
                                {"Front mm", &Stock::y_min},
                                {"Cell mm", &Stock::cell},
                                {"Bottom mm", &Stock::bottom},
                                {"Top mm", &Stock::top}};

std::optional<double> NumberOf(const GreyPicture& picture, std::string_view key) {
  for (const auto& [name, value] : picture.texts) {
    if (name == key) return ParseDouble(value);
  }
  return std::nullopt;
}

}  // namespace

bool WriteHeightMap(const HeightField& field, const std::function<bool(std::string_view)>& sink) {
  const Stock& stock = field.stock();
  PngHeading heading{.width = field.columns(),
                     .height = field.rows(),
                     .form = PngHeading::Form::kGrey16,
                     .pixel_mm = stock.cell,
                     .texts = {{"Software", "rmlcell"}}};
  for (const ScaleText& text : kScale)
    heading.texts.emplace_back(text.key, ShortestText(stock.*text.value));
  heading.texts.emplace_back("Step mm", TrimmedText(StepOf(stock), 9));
  return WritePng(
      heading,
      [&](std::size_t from_above, std::span<std::uint8_t> bytes) {
        const std::size_t row = field.rows() - 1 - from_above;
        for (std::size_t column = 0; column < field.columns(); ++column) {
          const std::uint16_t grey = HeightNumber(stock, field.height(column, row));
          bytes[2 * column] = static_cast<std::uint8_t>(grey >> 8);
          bytes[2 * column + 1] = static_cast<std::uint8_t>(grey & 0xFF);
        }
      },
      sink);
}

Result<HeightMap> ReadHeightMap(std::string_view bytes) {
  const Result<GreyPicture> picture = ReadGreyPng(bytes);
  if (!picture) return picture.error();
  HeightMap map{.columns = picture->width, .rows = picture->height};
  for (const ScaleText& text : kScale) {
    const std::optional<double> value = NumberOf(*picture, text.key);
    if (!value) {
      return Error{ErrorCode::kCellBadText,
                   "the picture does not say '" + Told("key", text.key) +
                       "': --height-map writes one that does",
                   {}};
    }
    map.stock.*text.value = *value;
  }
  map.stock.x_max = map.stock.x_min + static_cast<double>(map.columns) * map.stock.cell;
  map.stock.y_max = map.stock.y_min + static_cast<double>(map.rows) * map.stock.cell;
  if (const Status sound = CheckStock(map.stock); !sound)
    return Error{ErrorCode::kCellBadText, "no height map: " + sound.error().detail, {}};
  for (const double end : {map.stock.bottom, map.stock.top}) {
    if (!std::isfinite(static_cast<float>(end)))
      return Error{ErrorCode::kCellBadText, "no height map: its heights are out of reach", {}};
  }
  const double step = StepOf(map.stock);
  map.heights.reserve(map.columns * map.rows);
  for (std::size_t row = map.rows; row-- > 0;) {
    for (std::size_t column = 0; column < map.columns; ++column) {
      const double grey = picture->grey[row * map.columns + column];
      map.heights.push_back(static_cast<float>(map.stock.bottom + grey * step));
    }
  }
  return map;
}

}  // namespace rmlcell::simulation
