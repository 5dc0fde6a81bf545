#include "engine/simulation/material/stl.h"

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

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
void FindOutline(const CornerSet& corners, const Patch& patch, Outline& outline) {
  const auto along_x = [&](std::size_t row, std::vector<Vertex>& side) {
    side.clear();
    corners.ForEachInRow(row, patch.left, patch.right, [&](std::size_t column) {
      side.push_back({column, row});
    });
  };
  const auto along_y = [&](std::size_t column, std::vector<Vertex>& side) {
    side.clear();
    corners.ForEachInColumn(column, patch.front, patch.back, [&](std::size_t row) {
      side.push_back({column, row});
    });
  };
  along_x(patch.front, outline.front);
  along_x(patch.back, outline.back);
  along_y(patch.left, outline.left);
  along_y(patch.right, outline.right);
}

// As many triangles as FillOutline draws: two less than there are vertices on the sides, of which
// those of the corners are counted twice.
std::size_t TrianglesOf(const CornerSet& corners, const Patch& patch) {
  return corners.CountInRow(patch.front, patch.left, patch.right) +
         corners.CountInRow(patch.back, patch.left, patch.right) +
         corners.CountInColumn(patch.left, patch.front, patch.back) +
         corners.CountInColumn(patch.right, patch.front, patch.back) - 6;
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

// The surface of a section of the body, triangle by triangle.
template <class Visit>
void ForEachTriangle(const VertexGrid& grid, const SurfacePatches& patches, std::size_t section,
                     Visit visit) {
  Outline outline;
  patches.ForEach(section, [&](const Patch& patch) {
    FindOutline(patches.corners(), patch, outline);
    const auto at = [&](Vertex v) {
      return MachineVector{grid.x(v.column), grid.y(v.row), grid.z(v.column, v.row)};
    };
    FillOutline(outline, [&](Vertex a, Vertex b, Vertex c) { visit(at(a), at(b), at(c)); });
  });
}

// Its walls and its base.
template <class Visit>
void ForEachTriangleBelow(const VertexGrid& grid, const SurfacePatches& patches, Visit visit) {
  Outline outline;
  FindOutline(patches.corners(), patches.Whole(), outline);
  ForEachWall(grid, outline.front, false, visit);
  ForEachWall(grid, outline.right, false, visit);
  ForEachWall(grid, outline.back, true, visit);
  ForEachWall(grid, outline.left, true, visit);
  const auto below = [&](Vertex v) {
    return MachineVector{grid.x(v.column), grid.y(v.row), grid.bottom()};
  };
  FillOutline(outline, [&](Vertex a, Vertex b, Vertex c) { visit(below(a), below(c), below(b)); });
}

void PutLittle(std::uint32_t value, char* bytes) {
  for (int k = 0; k < 4; ++k)
    bytes[k] = static_cast<char>(static_cast<unsigned char>(value >> 8 * k & 0xFF));
}

constexpr std::size_t kTriangleBytes = 50;

void PutTriangle(std::string& bytes, const MachineVector& a, const MachineVector& b,
                 const MachineVector& c) {
  std::array<char, kTriangleBytes> triangle{};
  char* at = triangle.data();
  const auto put = [&at](const MachineVector& v) {
    for (const double part : {v.x(), v.y(), v.z()}) {
      PutLittle(std::bit_cast<std::uint32_t>(static_cast<float>(part)), at);
      at += 4;
    }
  };
  put((b - a).cross(c - a).normalized());
  put(a);
  put(b);
  put(c);
  bytes.append(triangle.data(), triangle.size());
}

// Gives the bytes of a file out in portions, in the order in which they come.
class Portions {
 public:
  explicit Portions(const std::function<bool(std::string_view)>& sink) : sink_(sink) {}

  std::string& bytes() { return bytes_; }
  bool GiveOut(bool all) {
    std::size_t given = 0;
    for (; bytes_.size() - given >= kPortion; given += kPortion) {
      if (!sink_(std::string_view(bytes_).substr(given, kPortion))) return false;
    }
    if (all) return sink_(std::string_view(bytes_).substr(given));
    bytes_.erase(0, given);
    return true;
  }

 private:
  static constexpr std::size_t kPortion = 1 << 20;
  const std::function<bool(std::string_view)>& sink_;
  std::string bytes_;
};

// Nothing: it is not wanted any more.
std::optional<std::size_t> CountTriangles(const VertexGrid& grid, const SurfacePatches& patches,
                                          const std::function<bool(std::string_view)>& sink) {
  constexpr std::size_t kCounted = 1 << 20;
  std::size_t count = 0;
  std::size_t asked_at = kCounted;
  ForEachTriangleBelow(grid, patches, [&](auto&&...) { ++count; });
  for (std::size_t section = 0; section < patches.sections(); ++section) {
    patches.ForEach(section,
                    [&](const Patch& patch) { count += TrianglesOf(patches.corners(), patch); });
    if (count < asked_at) continue;
    asked_at = count + kCounted;
    if (!sink({})) return std::nullopt;
  }
  return count;
}

// Of each section by itself, several at the same time.
bool WriteSections(const VertexGrid& grid, const SurfacePatches& patches, ParallelFor& parallel,
                   Portions& portions) {
  std::vector<std::string> written(parallel.width() > 1 ? 4 * parallel.width() : 1);
  for (std::size_t first = 0; first < patches.sections(); first += written.size()) {
    const std::size_t count = std::min(written.size(), patches.sections() - first);
    const auto write = [&](std::size_t section, std::string& bytes) {
      ForEachTriangle(grid, patches, section, [&](const auto& a, const auto& b, const auto& c) {
        PutTriangle(bytes, a, b, c);
      });
    };
    if (count == 1) {
      write(first, portions.bytes());
    } else {
      parallel.Run(count, [&](std::size_t k) {
        written[k].clear();
        write(first + k, written[k]);
      });
      for (std::size_t k = 0; k < count; ++k) portions.bytes() += written[k];
    }
    if (!portions.GiveOut(false)) return false;
  }
  return true;
}

}  // namespace

bool WriteStl(const HeightField& field, double tolerance_mm,
              const std::function<bool(std::string_view)>& sink, ParallelFor* parallel) {
  SerialFor serial;
  ParallelFor& threads = parallel != nullptr ? *parallel : serial;
  const VertexGrid grid(field);
  const SurfacePatches patches(
      grid, tolerance_mm, [&] { return sink({}); }, threads);
  if (!patches.complete()) return false;
  const std::optional<std::size_t> triangles = CountTriangles(grid, patches, sink);
  if (!triangles) return false;
  Portions portions(sink);
  std::string& bytes = portions.bytes();
  bytes = "what is left of the block, mm";  // must not begin with "solid"
  bytes.resize(84, ' ');
  PutLittle(static_cast<std::uint32_t>(*triangles), bytes.data() + 80);
  if (!WriteSections(grid, patches, threads, portions)) return false;
  ForEachTriangleBelow(grid, patches, [&](const auto& a, const auto& b, const auto& c) {
    PutTriangle(bytes, a, b, c);
  });
  return portions.GiveOut(true);
}

}  // namespace rmlcell::simulation
