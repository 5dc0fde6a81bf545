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

template <class Number>
Number Take(std::string_view bytes, std::size_t at) {
  Number number = 0;
  for (std::size_t byte = sizeof number; byte-- > 0;)
    number = static_cast<Number>(number << 8 | static_cast<unsigned char>(bytes[at + byte]));
  return number;
}

}  // namespace

void AddHeight(std::uint16_t number, std::string& bytes) { Put(number, bytes); }

std::uint16_t HeightAt(std::string_view bytes, std::size_t index) {
  return Take<std::uint16_t>(bytes, sizeof(std::uint16_t) * index);
}

std::uint16_t HeightNumber(const Stock& stock, float height) {
  const double step = (stock.top - stock.bottom) / kHighest;
  const double above = static_cast<double>(height) - stock.bottom;
  return static_cast<std::uint16_t>(std::lround(std::clamp(above / step, 0.0, kHighest)));
}

HeightGridHead HeadOf(const HeightField& field) {
  const Stock& stock = field.stock();
  return {.size = {field.columns(), field.rows()},
          .left = stock.x_min,
          .front = stock.y_min,
          .cell = stock.cell,
          .bottom = stock.bottom,
          .top = stock.top};
}

Result<HeightGridHead> ReadHeightGridHead(std::string_view bytes) {
  const Error bad{ErrorCode::kCellBadText, "this is no height grid", {}};
  if (bytes.size() < kHeightGridHeadBytes || !bytes.starts_with("RMLCELLH") ||
      Take<std::uint32_t>(bytes, 8) != 1)
    return bad;
  const auto real = [&](std::size_t at) {
    return std::bit_cast<double>(Take<std::uint64_t>(bytes, at));
  };
  const HeightGridHead head{
      .size = {Take<std::uint32_t>(bytes, 12), Take<std::uint32_t>(bytes, 16)},
      .left = real(24),
      .front = real(32),
      .cell = real(40),
      .bottom = real(48),
      .top = real(56)};
  const auto& [columns, rows] = head.size;
  if (columns == 0 || rows == 0 || rows > HeightField::kCellsMax / columns || !(head.cell > 0.0))
    return bad;
  return head;
}

bool WriteHeightGrid(const HeightField& field, const std::function<bool(std::string_view)>& sink) {
  const HeightGridHead head = HeadOf(field);
  std::string bytes = "RMLCELLH";
  for (const std::size_t number :
       {std::size_t{1}, head.size.columns, head.size.rows, std::size_t{0}})
    Put(static_cast<std::uint32_t>(number), bytes);
  for (const double number : {head.left, head.front, head.cell, head.bottom, head.top})
    Put(std::bit_cast<std::uint64_t>(number), bytes);
  for (std::size_t row = 0; row < field.rows(); ++row) {
    for (std::size_t column = 0; column < field.columns(); ++column)
      AddHeight(HeightNumber(field.stock(), field.height(column, row)), bytes);
    if (!sink(bytes)) return false;
    bytes.clear();
  }
  return true;
}

}  // namespace rmlcell::simulation
