#include "engine/simulation/material/surface_patches.h"

#include <array>
#include <cmath>

namespace rmlcell::simulation {
namespace {

constexpr std::size_t kLooksMax = 1 << 22;         // about 20 ms
constexpr std::size_t kSectionVertices = 1 << 14;  // more than that is divided before all others
constexpr std::size_t kSectionsAtOnce = 64;

// How far a patch is from the plane that its corners suggest.
struct Roughness {
  double height = 0.0;   // between two planes parallel to that one, with all vertices between them
  double along_x = 0.0;  // greatest step between two neighbours
  double along_y = 0.0;
};

// The plane that the corners of a patch suggest, from its corner of least X and Y on.
class CornerPlane {
 public:
  CornerPlane(const VertexGrid& grid, const Patch& patch)
      : grid_(grid), x_(grid.x(patch.left)), y_(grid.y(patch.front)) {
    const auto rise = [&](std::size_t column, std::size_t row) { return grid.z(column, row); };
    slope_x_ = (rise(patch.right, patch.front) + rise(patch.right, patch.back) -
                rise(patch.left, patch.front) - rise(patch.left, patch.back)) /
               (2.0 * (grid.x(patch.right) - grid.x(patch.left)));
    slope_y_ = (rise(patch.left, patch.back) + rise(patch.right, patch.back) -
                rise(patch.left, patch.front) - rise(patch.right, patch.front)) /
               (2.0 * (grid.y(patch.back) - grid.y(patch.front)));
  }

  double slope_x() const { return slope_x_; }
  double slope_y() const { return slope_y_; }
  bool is_level() const {
    return !(slope_x_ < 0.0 || slope_x_ > 0.0) && !(slope_y_ < 0.0 || slope_y_ > 0.0);
  }
  double AlongX(std::size_t column) const { return slope_x_ * (grid_.x(column) - x_); }
  double AlongY(std::size_t row) const { return slope_y_ * (grid_.y(row) - y_); }
  // How far a vertex is above it. All ways to a decision reckon in this order: they end alike.
  double Above(std::size_t column, std::size_t row) const {
    return grid_.z(column, row) - AlongX(column) - AlongY(row);
  }

 private:
  const VertexGrid& grid_;
  double x_;
  double y_;
  double slope_x_;
  double slope_y_;
};

// Some columns of a patch, and of each what was found on the way along it, above a plane through
// the left one of the patch. Compilers compare several columns at a time, but not several vertices
// for one result.
class PatchColumns {
 public:
  static constexpr std::size_t kMost = 64;

  PatchColumns(const VertexGrid& grid, const Patch& patch, std::size_t first,
               const CornerPlane& plane)
      : grid_(grid), before_first_(std::max(first, patch.left + 1) - 1), first_(first) {
    count_ = std::min(kMost, patch.right + 1 - first);
    plane_[0] = plane.AlongX(before_first_);
    for (std::size_t k = 0; k < count_; ++k) {
      plane_[k + 1] = plane.AlongX(first + k);
      low_[k] = HUGE_VAL;
      high_[k] = -HUGE_VAL;
      along_x_[k] = along_y_[k] = 0.0;
    }
  }

  // The first row, and then some more at a time: what was found is less often put back.
  void Begin(std::size_t row) { Add<1, true>(row, {0.0}); }
  template <std::size_t kRows>
  void Add(std::size_t row, const std::array<double, kRows>& plane_y) {
    Add<kRows, false>(row, plane_y);
  }

  void TellTo(Roughness& found, double& low, double& high) const {
    for (std::size_t k = 0; k < count_; ++k) {
      low = std::min(low, low_[k]);
      high = std::max(high, high_[k]);
      found.along_x = std::max(found.along_x, along_x_[k]);
      found.along_y = std::max(found.along_y, along_y_[k]);
    }
  }

 private:
  template <std::size_t kRows, bool kFirst>
  void Add(std::size_t row, const std::array<double, kRows>& plane_y) {
    std::array<std::array<float, kMost + 1>, kRows> heights;
    for (std::size_t r = 0; r < kRows; ++r) {
      grid_.Heights(first_, count_, row + r, &heights[r][1]);
      heights[r][0] = before_first_ < first_ ? grid_.Height(before_first_, row + r) : heights[r][1];
    }
    const double bottom = grid_.bottom();
    const auto above = [&](std::size_t r, std::size_t k) {
      return std::max(static_cast<double>(heights[r][k]), bottom) - plane_[k] - plane_y[r];
    };
    for (std::size_t k = 0; k < count_; ++k) {
      double before = kFirst ? above(0, k + 1) : before_[k];
      for (std::size_t r = 0; r < kRows; ++r) {
        const double here = above(r, k + 1);
        along_x_[k] = std::max(along_x_[k], std::abs(here - above(r, k)));
        along_y_[k] = std::max(along_y_[k], std::abs(here - before));
        low_[k] = std::min(low_[k], here);
        high_[k] = std::max(high_[k], here);
        before = here;
      }
      before_[k] = before;
    }
  }

  using Values = std::array<double, kMost>;
  const VertexGrid& grid_;
  std::size_t before_first_;  // for the step from there; the same where there is none
  std::size_t first_;
  std::size_t count_;
  std::array<double, kMost + 1> plane_;  // from the one before the first on
  Values before_;                        // those of the row before
  Values low_;
  Values high_;
  Values along_x_;
  Values along_y_;
};

Roughness RoughnessOf(const VertexGrid& grid, const Patch& patch, const CornerPlane& plane) {
  Roughness found;
  double low = HUGE_VAL;
  double high = -HUGE_VAL;
  for (std::size_t first = patch.left; first <= patch.right; first += PatchColumns::kMost) {
    PatchColumns columns(grid, patch, first, plane);
    columns.Begin(patch.front);
    std::size_t row = patch.front + 1;
    for (; row + 4 <= patch.back + 1; row += 4)
      columns.Add<4>(row, {plane.AlongY(row), plane.AlongY(row + 1), plane.AlongY(row + 2),
                           plane.AlongY(row + 3)});
    for (; row <= patch.back; ++row) columns.Add<1>(row, {plane.AlongY(row)});
    columns.TellTo(found, low, high);
  }
  found.height = high - low;
  return found;
}

// When there is no need to look on: above that height a patch is halved, and across the way of
// which the steps are greater than any of the other one.
struct Enough {
  double height = 0.0;
  double along_x = 0.0;  // beyond any step along Y
  double along_y = 0.0;  // beyond any step along X
};

// The same of a patch of few columns, or few rows: those are looked at together, place by place of
// the other way. Without steps the height alone counts.
template <std::size_t kLanes, bool kLanesAreRows, bool kSteps>
Roughness RoughnessOfNarrow(const VertexGrid& grid, const Patch& patch, const CornerPlane& plane,
                            const Enough& enough) {
  const std::size_t first = kLanesAreRows ? patch.front : patch.left;
  const std::size_t last = kLanesAreRows ? patch.back : patch.right;
  const std::size_t begin = kLanesAreRows ? patch.left : patch.front;
  const std::size_t end = (kLanesAreRows ? patch.right : patch.back) + 1;
  std::array<const float*, kLanes> from;
  std::array<double, kLanes> plane_of_lane;
  std::array<double, kLanes> low, high, across, along, before;
  for (std::size_t k = 0; k < kLanes; ++k) {
    const std::size_t lane = std::min(first + k, last);  // the last one more than once
    from[k] = kLanesAreRows ? grid.Line(0, lane) : grid.Line(lane, 0);
    plane_of_lane[k] = kLanesAreRows ? plane.AlongY(lane) : plane.AlongX(lane);
    low[k] = HUGE_VAL;
    high[k] = -HUGE_VAL;
    across[k] = along[k] = 0.0;
  }
  const double bottom = grid.bottom();
  const auto found = [&] {
    const auto most = [](const auto& of) { return *std::max_element(of.begin(), of.end()); };
    Roughness rough{.height = most(high) - *std::min_element(low.begin(), low.end()),
                    .along_x = most(kLanesAreRows ? along : across),
                    .along_y = most(kLanesAreRows ? across : along)};
    return rough;
  };
  for (std::size_t at = begin; at < end; ++at) {
    const std::size_t cell = kLanesAreRows ? grid.ToColumn(at) : grid.ToRow(at);
    const double plane_here = kLanesAreRows ? plane.AlongX(at) : plane.AlongY(at);
    std::array<double, kLanes> here;
    for (std::size_t k = 0; k < kLanes; ++k) here[k] = static_cast<double>(from[k][cell]);
    for (std::size_t k = 0; k < kLanes; ++k) {
      const double height = std::max(here[k], bottom);
      here[k] = kLanesAreRows ? height - plane_here - plane_of_lane[k]
                              : height - plane_of_lane[k] - plane_here;
      low[k] = std::min(low[k], here[k]);
      high[k] = std::max(high[k], here[k]);
    }
    if constexpr (kSteps) {
      if (at == begin) before = here;
      for (std::size_t k = 0; k < kLanes; ++k)
        along[k] = std::max(along[k], std::abs(here[k] - before[k]));
      for (std::size_t k = 1; k < kLanes; ++k)
        across[k] = std::max(across[k], std::abs(here[k] - here[k - 1]));
      before = here;
    }
    if ((at - begin) % 8 != 7) continue;
    const Roughness rough = found();
    if (rough.height > enough.height &&
        (!kSteps || rough.along_x > enough.along_x || rough.along_y > enough.along_y))
      return rough;
  }
  return found();
}

// With steps: what is asked of a patch that can be halved both ways.
template <bool kSteps>
Roughness RoughnessOfAny(const VertexGrid& grid, const Patch& patch, const CornerPlane& plane,
                         const Enough& enough) {
  const std::size_t width = patch.right - patch.left;
  const std::size_t depth = patch.back - patch.front;
  if (width == 1) return RoughnessOfNarrow<2, false, kSteps>(grid, patch, plane, enough);
  if (depth == 1) return RoughnessOfNarrow<2, true, kSteps>(grid, patch, plane, enough);
  if (width < 4) return RoughnessOfNarrow<4, false, kSteps>(grid, patch, plane, enough);
  if (depth < 4) return RoughnessOfNarrow<4, true, kSteps>(grid, patch, plane, enough);
  if (width < 8) return RoughnessOfNarrow<8, false, kSteps>(grid, patch, plane, enough);
  if (depth < 8) return RoughnessOfNarrow<8, true, kSteps>(grid, patch, plane, enough);
  return RoughnessOf(grid, patch, plane);
}

// Whether some of the vertices are further apart than the tolerance already.
bool SomeAreRough(const Patch& patch, const CornerPlane& plane, double tolerance) {
  constexpr std::size_t kPlacesAcross = 4;
  double low = HUGE_VAL;
  double high = -HUGE_VAL;
  for (std::size_t y = 0; y <= kPlacesAcross; ++y) {
    const std::size_t row = patch.front + (patch.back - patch.front) * y / kPlacesAcross;
    for (std::size_t x = 0; x <= kPlacesAcross; ++x) {
      const double above =
          plane.Above(patch.left + (patch.right - patch.left) * x / kPlacesAcross, row);
      low = std::min(low, above);
      high = std::max(high, above);
    }
    if (high - low > tolerance) return true;
  }
  return false;
}

// What the range of a patch says about its roughness, up to rounding.
struct Estimate {
  Roughness rough;     // height: of a level plane alone; else 0
  double error = 0.0;  // of the steps along X and Y; 0 of a level plane
};

Estimate EstimateOf(const VertexGrid& grid, const Patch& patch, const PatchRange& range,
                    const CornerPlane& plane) {
  const double cell = grid.cell();
  // Steps of the ring are half as long.
  const auto along = [&](double least, double most, double slope, bool has_ring) {
    const double rise = slope * cell;
    const double of_ring = has_ring ? std::abs(0.5 * rise) : 0.0;
    if (most < least) return of_ring;  // of one cell
    return std::max({of_ring, std::abs(most - rise), std::abs(least - rise)});
  };
  Estimate estimate;
  estimate.rough.along_x = along(range.least_x, range.most_x, plane.slope_x(),
                                 patch.left == 0 || patch.right + 1 == grid.columns());
  estimate.rough.along_y = along(range.least_y, range.most_y, plane.slope_y(),
                                 patch.front == 0 || patch.back + 1 == grid.rows());
  const double low = std::max(static_cast<double>(range.lowest), grid.bottom());
  const double high = std::max(static_cast<double>(range.highest), grid.bottom());
  if (plane.is_level()) {
    estimate.rough.height = high - low;
    return estimate;
  }
  // A thousand times as much as the numbers of such sums are rounded by.
  constexpr double kRounding = 1e-12;
  const auto reach = [](double a, double b) { return std::max(std::abs(a), std::abs(b)); };
  estimate.error =
      kRounding *
      (reach(low, high) + std::abs(plane.slope_x()) * reach(grid.x(0), grid.x(grid.columns() - 1)) +
       std::abs(plane.slope_y()) * reach(grid.y(0), grid.y(grid.rows() - 1)));
  return estimate;
}

}  // namespace

SurfacePatches::SurfacePatches(const VertexGrid& grid, double tolerance_mm,
                               const std::function<bool()>& wanted, ParallelFor& parallel)
    : grid_(grid),
      tolerance_(tolerance_mm),
      table_(grid, kLooksMax, wanted, parallel),
      corners_(grid.columns(), grid.rows()),
      complete_(table_.complete()) {
  if (complete_) FindSections(wanted);
  if (complete_) DivideSections(wanted, parallel);
  for (std::size_t section = 0; complete_ && section < sections_.size(); ++section) {
    ForEach(section, [&](const Patch& patch) {
      for (const std::size_t row : {patch.front, patch.back}) {
        for (const std::size_t column : {patch.left, patch.right}) corners_.Add(column, row);
      }
    });
  }
}

std::pair<SurfacePatches::Open, SurfacePatches::Open> SurfacePatches::HalvesOf(const Open& open,
                                                                               bool across_x) {
  const auto [first, second] = Halves(open.patch, across_x);
  PatchPlace place = open.place;
  std::size_t& at = across_x ? place.x : place.y;
  ++(across_x ? place.across_x : place.across_y);
  at *= 2;
  const Open before{first, place};
  ++at;
  return {before, {second, place}};
}

bool SurfacePatches::StillWanted(std::size_t looked_at, const std::function<bool()>& wanted) {
  looked_at_ += looked_at;
  if (looked_at_ <= kLooksMax) return true;
  looked_at_ = 0;
  complete_ = wanted();
  return complete_;
}

void SurfacePatches::FindSections(const std::function<bool()>& wanted) {
  std::vector<Open> opens{{Whole()}};
  while (!opens.empty()) {
    const Open open = opens.back();
    opens.pop_back();
    const Patch& patch = open.patch;
    if ((patch.right - patch.left + 1) * (patch.back - patch.front + 1) > kSectionVertices) {
      const Decision decision = Decide(open);
      if (!StillWanted(decision.looked_at, wanted)) return;
      if (decision.halved) {
        const auto [first, second] = HalvesOf(open, decision.across_x);
        opens.push_back(second);
        opens.push_back(first);
        continue;
      }
      sections_.push_back({patch, open.place, {false, false}});
      continue;
    }
    sections_.push_back({patch, open.place});
  }
}

void SurfacePatches::DivideSections(const std::function<bool()>& wanted, ParallelFor& parallel) {
  for (std::size_t first = 0; first < sections_.size(); first += kSectionsAtOnce) {
    const std::size_t count = std::min(kSectionsAtOnce, sections_.size() - first);
    parallel.Run(count, [&](std::size_t k) { Divide(sections_[first + k]); });
    std::size_t looked_at = 0;
    for (std::size_t k = first; k < first + count; ++k) {
      const Patch& patch = sections_[k].patch;
      if (sections_[k].decisions.size() > 2)
        looked_at += (patch.right - patch.left + 1) * (patch.back - patch.front + 1);
    }
    if (!StillWanted(looked_at, wanted)) return;
  }
}

void SurfacePatches::Divide(Section& section) const {
  if (!section.decisions.empty()) return;  // looked at before
  std::vector<Open> opens{{section.patch, section.place}};
  while (!opens.empty()) {
    const Open open = opens.back();
    opens.pop_back();
    const Decision decision = Decide(open);
    section.decisions.push_back(decision.halved);
    section.decisions.push_back(decision.across_x);
    if (!decision.halved) continue;
    const auto [first, second] = HalvesOf(open, decision.across_x);
    opens.push_back(second);
    opens.push_back(first);
  }
}

SurfacePatches::Decision SurfacePatches::Decide(const Open& open) const {
  const Patch& patch = open.patch;
  const std::size_t width = patch.right - patch.left;
  const std::size_t depth = patch.back - patch.front;
  if (width == 1 && depth == 1) return {};
  const auto across = [&](double along_x, double along_y) {
    const bool equal = along_x == along_y;
    return depth == 1 || (width > 1 && (along_x > along_y || (equal && width >= depth)));
  };
  const CornerPlane plane(grid_, patch);
  const bool one_way = width == 1 || depth == 1;
  bool halved = false;
  if (const PatchRange* const range = table_.Find(open.place)) {
    const auto [rough, error] = EstimateOf(grid_, patch, *range, plane);
    if (plane.is_level())
      return {.halved = rough.height > tolerance_,
              .across_x = across(rough.along_x, rough.along_y)};
    halved = std::max(rough.along_x, rough.along_y) > tolerance_ + error;
    halved = halved || SomeAreRough(patch, plane, tolerance_);
    if (halved && (one_way || std::abs(rough.along_x - rough.along_y) > 2.0 * error))
      return {.halved = true, .across_x = across(rough.along_x, rough.along_y)};
  }
  const auto [around, error] = EstimateOf(grid_, patch, table_.FindAround(open.place), plane);
  const Enough enough{tolerance_, around.along_y + error, around.along_x + error};
  const Roughness rough = one_way ? RoughnessOfAny<false>(grid_, patch, plane, enough)
                                  : RoughnessOfAny<true>(grid_, patch, plane, enough);
  return {.halved = rough.height > tolerance_,
          .across_x = across(rough.along_x, rough.along_y),
          .looked_at = (width + 1) * (depth + 1)};
}

}  // namespace rmlcell::simulation
