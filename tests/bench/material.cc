// What files of a milled block cost, by the least that anybody could do for them in the same run,
// rounds interleaved; medians and their ratios. Of a block of 200 x 200 mm in cells of 0.1 mm with
// pockets, slopes and scallops.
//
// Claims: the STL within 0.01 mm has less than a fiftieth of the bytes that two triangles a cell
// have, and takes at most fifteen times as long as only storing those; a relief takes at most four
// times as long as libpng needs for the same number of pixels of one colour.
//   build/release/bin/material_bench
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "engine/simulation/material/cell_picture.h"
#include "engine/simulation/material/relief.h"
#include "engine/simulation/material/stl.h"

namespace {

using namespace rmlcell::simulation;  // NOLINT: one program, one subject

HeightField Milled() {
  HeightField field =
      HeightField::Of({.x_max = 200.0, .y_max = 200.0, .bottom = -20.0, .top = 0.0, .cell = 0.1})
          .value();
  for (double y = 20.0; y <= 80.0; y += 2.0)
    field.Cut({.radius_mm = 1.5}, {20, y, -5}, {90, y, -5});
  for (int k = 0; k < 360; ++k) {  // a round pocket
    const double a = k * 3.14159265358979 / 180.0, b = (k + 1) * 3.14159265358979 / 180.0;
    for (double r = 0.0; r <= 30.0; r += 2.0) {
      field.Cut({.radius_mm = 1.5}, {145 + r * std::cos(a), 50 + r * std::sin(a), -8},
                {145 + r * std::cos(b), 50 + r * std::sin(b), -8});
    }
  }
  const MillTool ball{.shape = MillTool::Shape::kBall, .radius_mm = 1.5};
  for (double y = 110.0; y <= 190.0; y += 0.5)  // scallops on a slope
    field.Cut(ball, {20, y, -1}, {180, y, -9});
  return field;
}

template <class Work>
double Seconds(Work work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double Median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

// 50 bytes for each of two triangles a cell, out of the heights.
std::size_t EveryCell(const HeightField& field, std::vector<char>& bytes) {
  bytes.resize(field.heights().size() * 100);
  char* to = bytes.data();
  for (const float height : field.heights()) {
    float numbers[12] = {height, height, height, height, height, height,
                         height, height, height, height, height, height};
    for (int k = 0; k < 2; ++k, to += 50) std::memcpy(to, numbers, sizeof numbers);
  }
  return bytes.size();
}

}  // namespace

int main() {
  const HeightField field = Milled();
  std::vector<double> stl, every, relief, plain;
  std::size_t stl_bytes = 0, every_bytes = 0;
  std::vector<char> memory;
  const auto count = [](std::size_t& sum) {
    return [&sum](std::string_view part) {
      sum += part.size();
      return true;
    };
  };
  for (int round = 0; round < 5; ++round) {
    stl_bytes = 0;
    stl.push_back(Seconds([&] { (void)WriteStl(field, kStlTolerance_mm, count(stl_bytes)); }));
    every.push_back(Seconds([&] { every_bytes = EveryCell(field, memory); }));
    std::size_t pixels = 0;
    relief.push_back(Seconds([&] { (void)WriteRelief(field, count(pixels)); }));
    plain.push_back(Seconds([&] {
      (void)WriteCellPicture(
          field,
          [](std::size_t, std::size_t) {
            return Colour{1, 2, 3};
          },
          count(pixels));
    }));
  }
  std::printf("cells                    %zu\n", field.heights().size());
  std::printf("STL                      %.3f s, %zu bytes\n", Median(stl), stl_bytes);
  std::printf("two triangles a cell     %.3f s, %zu bytes\n", Median(every), every_bytes);
  std::printf("  time by theirs         %.2f\n", Median(stl) / Median(every));
  std::printf("  bytes by theirs        %.4f\n",
              static_cast<double>(stl_bytes) / static_cast<double>(every_bytes));
  std::printf("relief                   %.3f s\n", Median(relief));
  std::printf("picture of one colour    %.3f s\n", Median(plain));
  std::printf("  time by its            %.2f\n", Median(relief) / Median(plain));
  return 0;
}
