#include "engine/optimo/language/flow_field.h"

namespace rmlcell::optimo {

unsigned Modes::PathsSeen() const {
  std::uint64_t paths = 0;
  for (std::uint64_t pairs = pairs_; pairs != 0; pairs >>= kPaths) paths |= pairs & kAllPaths;
  return static_cast<unsigned>(paths);
}

void Modes::SetCoord(CoordType coord) {
  pairs_ = std::uint64_t{PathsSeen()} << (Of(coord) * kPaths);
}

void Modes::SetPath(PathType path) {
  std::uint64_t pairs = 0;
  for (unsigned c = 0; pairs_ >> (c * kPaths) != 0; ++c) {
    if ((pairs_ >> (c * kPaths) & kAllPaths) != 0) pairs |= Bit(c, Of(path));
  }
  pairs_ = pairs;
}

void Modes::Then(const Modes& next) {
  if (next == Kept()) return;
  std::uint64_t pairs = 0;
  for (std::uint64_t n = next.pairs_; n != 0; n &= n - 1) {
    const auto last = static_cast<unsigned>(std::countr_zero(n));
    for (std::uint64_t f = pairs_; f != 0; f &= f - 1) {
      const auto first = static_cast<unsigned>(std::countr_zero(f));
      const unsigned coord = last / kPaths, path = last % kPaths;
      pairs |= Bit(coord == kKept ? first / kPaths : coord, path == kKept ? first % kPaths : path);
    }
  }
  pairs_ = pairs;
}

std::optional<CoordType> Modes::coord() const {
  for (const CoordType coord : {CoordType::kAbsol, CoordType::kRobot}) {
    if (pairs_ != 0 && (pairs_ & ~(kAllPaths << (Of(coord) * kPaths))) == 0) return coord;
  }
  return std::nullopt;
}

std::optional<PathType> Modes::path() const {
  const unsigned paths = PathsSeen();
  if (!std::has_single_bit(paths) || paths < 1U << kFirst) return std::nullopt;
  return static_cast<PathType>(static_cast<unsigned>(std::countr_zero(paths)) - kFirst);
}

bool Modes::MayBe(PathType path) const { return (PathsSeen() & 1U << Of(path)) != 0; }
bool Modes::IsDefaultPath() const { return PathsSeen() == 1U << kDefault; }

bool Modes::IsDefaultCoord() const {
  return pairs_ != 0 && (pairs_ & ~(kAllPaths << (kDefault * kPaths))) == 0;
}

bool Modes::IsContour() const {
  const unsigned contours =
      1U << Of(PathType::kLin) | 1U << Of(PathType::kCir) | 1U << Of(PathType::kHole);
  return pairs_ != 0 && (PathsSeen() & ~contours) == 0;
}

}  // namespace rmlcell::optimo
