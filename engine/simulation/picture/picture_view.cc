#include "engine/simulation/picture/picture_view.h"

#include <algorithm>
#include <cmath>

#include "engine/core/number_text.h"

namespace rmlcell::simulation {
namespace {

using motion::MachinePoint;
using motion::MachineVector;

constexpr double kMargin = 0.06;  // around what is shown, of the larger extent: a line gets room
constexpr double kWholeIfWithin = 1.8;  // the path is shown whole when at most this much larger
constexpr double kThinnest = 0.04;      // of the largest extent: a panel counts as this at least
constexpr double kSmallest_mm = 0.05;
constexpr double kGap_px = 64.0;  // between panels: the rulers of the next one
constexpr double kPanelMin_px = 230.0;
constexpr double kPanelHeightMax_px = 900.0;  // of all rows

MachineVector Unit(const MachineVector& v) {
  const double length = v.norm();
  return length > 0.0 ? v * (1.0 / length) : MachineVector{};
}

// Shares the room among two rows or columns by what they need, but leaves each its least.
std::pair<double, double> Share(double room, double first, double second) {
  const double least = std::min(kPanelMin_px, 0.5 * room);
  const double wanted = room * first / (first + second);
  const double given = std::clamp(wanted, least, room - least);
  return {given, room - given};
}

// What was lost belongs to the part. One that leads far away must not make the rest a dot: it is
// followed to as far beyond the travel as that is large. Where nothing was cut, there is nothing to
// make a dot of.
machine::Box WithLost(const PathSketch& sketch, const machine::Box& travel) {
  const machine::Box& lost = sketch.lost_box();
  machine::Box part = sketch.cut_box();
  if (part.empty() || travel.empty()) {
    part.Add(sketch.box());
    part.Add(lost);
    return part;
  }
  const MachineVector reach = travel.max - travel.min;
  const MachinePoint low = travel.min - reach;
  const MachinePoint high = travel.max + reach;
  for (const MachinePoint& corner : {lost.min, lost.max}) {
    part.Add({std::clamp(corner.x(), low.x(), high.x()), std::clamp(corner.y(), low.y(), high.y()),
              std::clamp(corner.z(), low.z(), high.z())});
  }
  return part;
}

}  // namespace

ViewFrame FrameOf(PictureView view, const MachineVector& direction) {
  switch (view) {
    case PictureView::kXY:
      return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, "X", "Y", "XY from above"};
    case PictureView::kXZ:
      return {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}, "X", "Z", "XZ from the front"};
    case PictureView::kYZ:
      return {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}, "Y", "Z", "YZ from the right"};
    case PictureView::kDirection:
      break;
  }
  ViewFrame frame;
  frame.towards_eye = Unit(direction);
  if (frame.towards_eye == MachineVector{}) frame.towards_eye = {0, 0, 1};
  frame.right = Unit(MachineVector::UnitZ().cross(frame.towards_eye));
  if (frame.right == MachineVector{}) frame.right = {1, 0, 0};  // straight from above or below
  frame.up = frame.towards_eye.cross(frame.right);
  frame.title = "in space";
  return frame;
}

std::vector<ViewFrame> FramesOf(const PictureOptions& options, const machine::MachineShape& shape) {
  constexpr std::size_t kViewsMax = 4;
  std::vector<PictureView> views = options.views;
  if (views.size() > kViewsMax) views.resize(kViewsMax);
  if (views.empty() && !shape.five_axis) views = {PictureView::kXY};
  if (views.empty()) {
    views = {PictureView::kXY, PictureView::kDirection, PictureView::kXZ, PictureView::kYZ};
  }
  std::vector<ViewFrame> frames;
  for (const PictureView view : views) frames.push_back(FrameOf(view, options.direction));
  return frames;
}

Extent ExtentOf(const machine::Box& box, const ViewFrame& frame) {
  Extent extent{HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL};
  for (const double x : {box.min.x(), box.max.x()}) {
    for (const double y : {box.min.y(), box.max.y()}) {
      for (const double z : {box.min.z(), box.max.z()}) {
        const MachinePoint corner{x, y, z};
        const double u = corner.dot(frame.right);
        const double v = corner.dot(frame.up);
        extent.left = std::min(extent.left, u);
        extent.right = std::max(extent.right, u);
        extent.bottom = std::min(extent.bottom, v);
        extent.top = std::max(extent.top, v);
      }
    }
  }
  return extent;
}

ScreenPoint Panel::Project(const MachinePoint& point) const {
  return {rect.x + 0.5 * rect.width + (point.dot(frame.right) - middle_right) * scale,
          rect.y + 0.5 * rect.height - (point.dot(frame.up) - middle_up) * scale};
}

Extent Panel::visible() const {
  const double half_width = 0.5 * rect.width / scale;
  const double half_height = 0.5 * rect.height / scale;
  return {middle_right - half_width, middle_right + half_width, middle_up - half_height,
          middle_up + half_height};
}

motion::MachinePoint ZeroOf(const PictureOptions& options, const machine::MachineShape& shape) {
  const bool from_work = shape.has_work_origin && !options.machine_frame;
  return from_work ? shape.work_origin : motion::MachinePoint(0.0, 0.0, 0.0);
}

std::string_view ZeroText(const PictureOptions& options, const machine::MachineShape& shape) {
  const bool from_work = shape.has_work_origin && !options.machine_frame;
  return from_work ? "from the work origin, mm" : "machine frame, mm";
}

PanelLayout LayOut(const std::vector<ViewFrame>& frames, const machine::Box& box,
                   const ScreenStrip& strip, const motion::MachinePoint& zero) {
  PanelLayout layout;
  std::vector<Extent> extents;
  for (const ViewFrame& frame : frames) extents.push_back(ExtentOf(box, frame));

  if (frames.size() == 1) {
    const double wanted = strip.width * extents[0].height() / extents[0].width();
    const double height = std::clamp(wanted, 2.0 * kPanelMin_px, kPanelHeightMax_px);
    layout.panels.push_back({.frame = frames[0], .rect = {strip.x, strip.y, strip.width, height}});
    layout.height = height;
  } else {
    // Two columns; each row and column as large as its largest axial view needs.
    double columns[2] = {0.0, 0.0};
    double rows[2] = {0.0, 0.0};
    for (std::size_t k = 0; k < frames.size(); ++k) {
      if (frames[k].across.empty()) continue;  // views in space need nothing in particular
      columns[k % 2] = std::max(columns[k % 2], extents[k].width());
      rows[k / 2] = std::max(rows[k / 2], extents[k].height());
    }
    const double largest = std::max({columns[0], columns[1], rows[0], rows[1], kSmallest_mm});
    for (double& side : columns) side = std::max(side, kThinnest * largest);
    const auto [first, second] = Share(strip.width - kGap_px, columns[0], columns[1]);
    const double scale = std::min(first / columns[0], second / columns[1]);
    const auto height_of = [&](double row) {
      return std::clamp(std::max(row, kThinnest * largest) * scale, kPanelMin_px,
                        0.72 * kPanelHeightMax_px);
    };
    const double heights[2] = {height_of(rows[0]), height_of(rows[1])};
    const bool two_rows = frames.size() > 2;
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const bool right = k % 2 == 1;
      const bool below = k / 2 == 1;
      layout.panels.push_back({.frame = frames[k],
                               .rect = {strip.x + (right ? first + kGap_px : 0.0),
                                        strip.y + (below ? heights[0] + kGap_px : 0.0),
                                        right ? second : first, heights[below ? 1 : 0]}});
    }
    layout.height = heights[0] + (two_rows ? kGap_px + heights[1] : 0.0);
  }

  double common = HUGE_VAL;
  for (std::size_t k = 0; k < layout.panels.size(); ++k) {
    Panel& panel = layout.panels[k];
    panel.zero = zero;
    panel.middle_right = 0.5 * (extents[k].left + extents[k].right);
    panel.middle_up = 0.5 * (extents[k].bottom + extents[k].top);
    panel.scale =
        std::min(panel.rect.width / extents[k].width(), panel.rect.height / extents[k].height());
    if (!panel.frame.across.empty()) common = std::min(common, panel.scale);
  }
  for (Panel& panel : layout.panels) {
    if (!panel.frame.across.empty()) panel.scale = common;
  }
  return layout;
}

machine::Box BoxToShow(const PathSketch& sketch, const machine::Box& travel) {
  if (sketch.lost_box().empty()) return BoxToShow(sketch.box(), sketch.cut_box(), travel);
  machine::Box part = WithLost(sketch, travel);
  machine::Box all = sketch.box();
  all.Add(part);
  return BoxToShow(all, part, travel);
}

machine::Box BoxToShow(const machine::Box& all, const machine::Box& cut,
                       const machine::Box& travel) {
  const bool whole = cut.empty() || all.diagonal_mm() <= kWholeIfWithin * cut.diagonal_mm();
  machine::Box box = whole ? all : cut;
  if (box.empty()) box = travel;
  if (box.empty()) box.Add(MachineVector{});
  const MachineVector size = box.max - box.min;
  const double largest = std::max({size.x(), size.y(), size.z(), kSmallest_mm});
  const double margin = kMargin * largest;
  box.Add(box.min - MachineVector{margin, margin, margin});
  box.Add(box.max + MachineVector{margin, margin, margin});
  return box;
}

double NiceStep(double least) {
  if (!(least > 0.0) || !std::isfinite(least)) return 1.0;
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double times : {1.0, 2.0, 5.0}) {
    if (times * power >= least * (1.0 - 1e-9)) return times * power;
  }
  return 10.0 * power;
}

std::string TickText(double value, double step) {
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
  return FixedText(value, decimals);
}

}  // namespace rmlcell::simulation
