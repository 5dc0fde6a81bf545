#include "engine/simulation/material/stl.h"

#include <bit>
#include <cstdint>
#include <span>
#include <string>

#include "engine/simulation/material/surface_patches.h"

namespace rmlcell::simulation {
namespace {

using motion::MachineVector;

struct Vertex {
  std::size_t column;
  std::size_t row;
};

// A rectangle with all vertices on its sides, both ends included: front and back from left to
// right, left and right from front to back.
struct Outline {
  std::vector<Vertex> front;
  std::vector<Vertex> back;
  std::vector<Vertex> left;
  std::vector<Vertex> right;
};

// The corners of patches on the sides of a rectangle: its neighbours end there.
void FindOutline(const SurfacePatches& patches, const Patch& patch, Outline& outline) {
  const auto along_x = [&](std::size_t row, std::vector<Vertex>& side) {
    side.clear();
    for (std::size_t column = patch.left; column <= patch.right; ++column) {
      if (patches.corner(column, row)) side.push_back({column, row});
    }
  };
  const auto along_y = [&](std::size_t column, std::vector<Vertex>& side) {
    side.clear();
    for (std::size_t row = patch.front; row <= patch.back; ++row) {
      if (patches.corner(column, row)) side.push_back({column, row});
    }
  };
  along_x(patch.front, outline.front);
  along_x(patch.back, outline.back);
  along_y(patch.left, outline.left);
  along_y(patch.right, outline.right);
}

// Triangles of a rectangle between the vertices of its sides, none without area: a fan to the left
// side, one to the right side, and what is between the fans from front to back.
template <class Visit>
void FillOutline(const Outline& outline, Visit visit) {
  const auto& [front, back, left, right] = outline;
  const Vertex left_hub = front[1];
  const Vertex right_hub = back[back.size() - 2];
  for (std::size_t k = 0; k + 1 < left.size(); ++k) visit(left[k], left_hub, left[k + 1]);
  for (std::size_t k = 0; k + 1 < right.size(); ++k) visit(right_hub, right[k], right[k + 1]);
  std::size_t f = 1;
  std::size_t b = 0;
  while (f + 1 < front.size() || b + 2 < back.size()) {
    const bool front_next =
        b + 2 >= back.size() || (f + 1 < front.size() && front[f + 1].column <= back[b + 1].column);
    if (front_next) {
      visit(front[f], front[f + 1], back[b]);
      ++f;
    } else {
      visit(front[f], back[b + 1], back[b]);
      ++b;
    }
  }
}

// From one vertex of the outer edge to the next, in the sense that has the body on the left.
template <class Visit>
void ForEachWall(const VertexGrid& grid, std::span<const Vertex> edge, bool backwards,
                 Visit visit) {
  for (std::size_t k = 0; k + 1 < edge.size(); ++k) {
    const Vertex a = edge[backwards ? k + 1 : k];
    const Vertex b = edge[backwards ? k : k + 1];
    const auto at = [&](Vertex v, bool top) {
      return MachineVector{grid.x(v.column), grid.y(v.row),
                           top ? grid.z(v.column, v.row) : grid.bottom()};
    };
    // Where the block is cut through there is no wall.
    if (at(b, true).z() > grid.bottom()) visit(at(a, false), at(b, false), at(b, true));
    if (at(a, true).z() > grid.bottom()) visit(at(a, false), at(b, true), at(a, true));
  }
}

// The surface of the body, triangle by triangle; no further than the patch where `wanted` becomes
// false.
template <class Visit>
void ForEachTriangle(const VertexGrid& grid, const SurfacePatches& patches, const bool& wanted,
                     Visit visit) {
  Outline outline;
  patches.ForEach([&](const Patch& patch) {
    FindOutline(patches, patch, outline);
    const auto at = [&](Vertex v) {
      return MachineVector{grid.x(v.column), grid.y(v.row), grid.z(v.column, v.row)};
    };
    FillOutline(outline, [&](Vertex a, Vertex b, Vertex c) { visit(at(a), at(b), at(c)); });
    return wanted;
  });
  if (!wanted) return;
  FindOutline(patches, {0, grid.columns() - 1, 0, grid.rows() - 1}, outline);
  ForEachWall(grid, outline.front, false, visit);
  ForEachWall(grid, outline.right, false, visit);
  ForEachWall(grid, outline.back, true, visit);
  ForEachWall(grid, outline.left, true, visit);
  const auto below = [&](Vertex v) {
    return MachineVector{grid.x(v.column), grid.y(v.row), grid.bottom()};
  };
  FillOutline(outline, [&](Vertex a, Vertex b, Vertex c) { visit(below(a), below(c), below(b)); });
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

bool WriteStl(const HeightField& field, double tolerance_mm,
              const std::function<bool(std::string_view)>& sink) {
  constexpr std::size_t kPortion = 1 << 20;
  const VertexGrid grid(field);
  const SurfacePatches patches(grid, tolerance_mm, [&] { return sink({}); });
  if (!patches.complete()) return false;
  bool wanted = true;
  std::uint32_t triangles = 0;
  ForEachTriangle(grid, patches, wanted,
                  [&](const MachineVector&, const MachineVector&, const MachineVector&) {
                    if (++triangles % kPortion == 0) wanted = wanted && sink({});
                  });
  if (!wanted) return false;
  std::string bytes = "what is left of the block, mm";  // must not begin with "solid"
  bytes.resize(80, ' ');
  PutLittle(bytes, triangles);
  ForEachTriangle(grid, patches, wanted,
                  [&](const MachineVector& a, const MachineVector& b, const MachineVector& c) {
                    if (!wanted) return;
                    PutVector(bytes, (b - a).cross(c - a).normalized());
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
