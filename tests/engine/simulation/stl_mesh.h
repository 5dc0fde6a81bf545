#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/motion/geometry/frames.h"
#include "engine/simulation/material/stl.h"

// A binary STL as it is read back, for tests.
namespace rmlcell::simulation {

using Triangle = std::array<motion::MachineVector, 3>;

struct StlMesh {
  std::uint32_t stated = 0;  // triangles, by its heading
  std::vector<Triangle> triangles;
  std::vector<motion::MachineVector> normals;
};

inline std::string StlOf(const HeightField& field, double tolerance_mm) {
  std::string bytes;
  WriteStl(field, tolerance_mm, [&](std::string_view part) {
    bytes += part;
    return true;
  });
  return bytes;
}

inline StlMesh ReadBack(const std::string& bytes) {
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t k = 4; k-- > 0;)
      value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
    return value;
  };
  const auto vector = [&](std::size_t at) {
    const auto value = [&](std::size_t k) {
      return double{std::bit_cast<float>(number(at + 4 * k))};
    };
    return motion::MachineVector{value(0), value(1), value(2)};
  };
  StlMesh mesh;
  mesh.stated = number(80);
  for (std::size_t at = 84; at + 50 <= bytes.size(); at += 50) {
    mesh.normals.push_back(vector(at));
    mesh.triangles.push_back({vector(at + 12), vector(at + 24), vector(at + 36)});
  }
  return mesh;
}

// By the divergence theorem; above 0 when the triangles are seen counter-clockwise from outside.
inline double VolumeOf(const StlMesh& mesh) {
  double six_fold = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) six_fold += a.dot(b.cross(c));
  return six_fold / 6.0;
}

// How often each edge is there in each direction.
using Corner = std::tuple<double, double, double>;
inline std::map<std::pair<Corner, Corner>, int> EdgesOf(const StlMesh& mesh) {
  const auto key = [](const motion::MachineVector& v) { return Corner{v.x(), v.y(), v.z()}; };
  std::map<std::pair<Corner, Corner>, int> edges;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++edges[{key(t[k]), key(t[(k + 1) % 3])}];
  }
  return edges;
}

}  // namespace rmlcell::simulation
