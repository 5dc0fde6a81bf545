#include "engine/simulation/material/height_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

namespace rmlcell::simulation {
namespace {

constexpr double kHighest = 65535.0;

template <class Number>
void Put(Number number, std::string& bytes) {
  for (std::size_t byte = 0; byte < sizeof number; ++byte)
    bytes += static_cast<char>(number >> (8 * byte) & 0xFF);
}

}  // namespace

std::uint16_t HeightNumber(const Stock& stock, float height) {
  const double step = (stock.top - stock.bottom) / kHighest;
  const double above = static_cast<double>(height) - stock.bottom;
  return static_cast<std::uint16_t>(std::lround(std::clamp(above / step, 0.0, kHighest)));
}

bool WriteHeightGrid(const HeightField& field, const std::function<bool(std::string_view)>& sink) {
  const Stock& stock = field.stock();
  std::string bytes = "RMLCELLH";
  for (const std::size_t number : {std::size_t{1}, field.columns(), field.rows(), std::size_t{0}})
    Put(static_cast<std::uint32_t>(number), bytes);
  for (const double number : {stock.x_min, stock.y_min, stock.cell, stock.bottom, stock.top})
    Put(std::bit_cast<std::uint64_t>(number), bytes);
  for (std::size_t row = 0; row < field.rows(); ++row) {
    for (std::size_t column = 0; column < field.columns(); ++column)
      Put(HeightNumber(stock, field.height(column, row)), bytes);
    if (!sink(bytes)) return false;
    bytes.clear();
  }
  return true;
}

}  // namespace rmlcell::simulation
