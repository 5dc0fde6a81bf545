#include "engine/simulation/material/stl.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>

namespace rmlcell::simulation {
namespace {

using motion::MachineVector;

// The surface of the body, triangle by triangle, seen counter-clockwise from outside.
template <class Visit>
void ForEachTriangle(const HeightField& field, Visit visit) {
  const Stock& stock = field.stock();
  const std::size_t nx = field.columns();
  const std::size_t ny = field.rows();
  const auto at = [&](std::size_t column, std::size_t row, bool top) {
    const double height = std::max(static_cast<double>(field.height(column, row)), stock.bottom);
    return MachineVector{stock.x_min + (static_cast<double>(column) + 0.5) * stock.cell,
                         stock.y_min + (static_cast<double>(row) + 0.5) * stock.cell,
                         top ? height : stock.bottom};
  };
  const auto quad = [&](const MachineVector& a, const MachineVector& b, const MachineVector& c,
                        const MachineVector& d) {
    visit(a, b, c);
    visit(a, c, d);
  };
  for (std::size_t y = 0; y + 1 < ny; ++y) {
    for (std::size_t x = 0; x + 1 < nx; ++x)
      quad(at(x, y, true), at(x + 1, y, true), at(x + 1, y + 1, true), at(x, y + 1, true));
  }
  for (std::size_t x = 0; x + 1 < nx; ++x) {
    quad(at(x, 0, false), at(x + 1, 0, false), at(x + 1, 0, true), at(x, 0, true));
    quad(at(x + 1, ny - 1, false), at(x, ny - 1, false), at(x, ny - 1, true),
         at(x + 1, ny - 1, true));
  }
  for (std::size_t y = 0; y + 1 < ny; ++y) {
    quad(at(0, y + 1, false), at(0, y, false), at(0, y, true), at(0, y + 1, true));
    quad(at(nx - 1, y, false), at(nx - 1, y + 1, false), at(nx - 1, y + 1, true),
         at(nx - 1, y, true));
  }
  quad(at(0, 0, false), at(0, ny - 1, false), at(nx - 1, ny - 1, false), at(nx - 1, 0, false));
}

std::uint32_t TriangleCount(const HeightField& field) {
  const std::size_t nx = field.columns() - 1;
  const std::size_t ny = field.rows() - 1;
  return static_cast<std::uint32_t>(2 * nx * ny + 4 * (nx + ny) + 2);
}

void PutLittle(std::string& bytes, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8)
    bytes += static_cast<char>(static_cast<unsigned char>(value >> shift & 0xFF));
}

void PutVector(std::string& bytes, const MachineVector& v) {
  for (const double c : {v.x(), v.y(), v.z()})
    PutLittle(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(c)));
}

}  // namespace

bool WriteStl(const HeightField& field, const std::function<bool(std::string_view)>& sink) {
  constexpr std::size_t kPortion = 1 << 20;
  std::string bytes = "what is left of the block, mm";  // must not begin with "solid"
  bytes.resize(80, ' ');
  PutLittle(bytes, TriangleCount(field));
  bool wanted = true;
  ForEachTriangle(field,
                  [&](const MachineVector& a, const MachineVector& b, const MachineVector& c) {
                    if (!wanted) return;
                    const MachineVector across = (b - a).cross(c - a);
                    const double length = across.norm();
                    PutVector(bytes, length > 0.0 ? across * (1.0 / length) : MachineVector{});
                    PutVector(bytes, a);
                    PutVector(bytes, b);
                    PutVector(bytes, c);
                    bytes.append(2, '\0');
                    if (bytes.size() < kPortion) return;
                    wanted = sink(bytes);
                    bytes.clear();
                  });
  return wanted && sink(bytes);
}

}  // namespace rmlcell::simulation
