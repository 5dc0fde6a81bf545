#pragma once

#include <string>
#include <vector>

#include "engine/simulation/picture/path_sketch.h"
#include "engine/simulation/picture/picture.h"
#include "engine/simulation/picture/svg_text.h"

// How space becomes a picture: the eye of a view, and where its panel stands on the page.
namespace rmlcell::simulation {

// Directions of a view in the machine frame, unit vectors.
struct ViewFrame {
  motion::MachineVector right;
  motion::MachineVector up;
  motion::MachineVector towards_eye;
  std::string across;  // name of the axis to the right; empty for an oblique view
  std::string upward;
  std::string title;
};
ViewFrame FrameOf(PictureView view, const motion::MachineVector& direction);

// The views that are wanted, up to four, or those that suit the machine.
std::vector<ViewFrame> FramesOf(const PictureOptions& options, const machine::MachineShape& shape);

// What a view sees of a box: extent along right and up.
struct Extent {
  double left = 0.0;
  double right = 0.0;
  double bottom = 0.0;
  double top = 0.0;
  double width() const { return right - left; }
  double height() const { return top - bottom; }
};
Extent ExtentOf(const machine::Box& box, const ViewFrame& frame);

struct ScreenRect {
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;
};

// A view in its place. A millimetre is `scale` pixels.
struct Panel {
  ViewFrame frame;
  ScreenRect rect;
  double scale = 1.0;
  double middle_right = 0.0;  // what stands in the middle of the panel, along right and up
  double middle_up = 0.0;
  motion::MachinePoint zero{0.0, 0.0, 0.0};  // what the rulers count from

  ScreenPoint Project(const motion::MachinePoint& point) const;
  Extent visible() const;
};

// Where panels go: from its upper left corner on, as far down as they need.
struct ScreenStrip {
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
};

// Panels for up to four views in `strip`, all axial ones at the same scale and in line with each
// other, so that a height in one is at the same height in the next. Returns the height that they
// take. `box` must not be empty.
struct PanelLayout {
  std::vector<Panel> panels;
  double height = 0.0;
};
PanelLayout LayOut(const std::vector<ViewFrame>& frames, const machine::Box& box,
                   const ScreenStrip& strip, const motion::MachinePoint& zero = {0.0, 0.0, 0.0});

// What rulers and heights of a picture count from: the work origin, where there is one; and what
// the page says of that.
motion::MachinePoint ZeroOf(const PictureOptions& options, const machine::MachineShape& shape);
std::string_view ZeroText(const PictureOptions& options, const machine::MachineShape& shape);

// What the panels show: the cut with a margin; all of the path when that is not much more, or when
// nothing was cut; the travel of the machine when nothing moved. Never without extent.
machine::Box BoxToShow(const PathSketch& sketch, const machine::Box& travel);
// The same of a path that lies in `all` and cuts in `cut`.
machine::Box BoxToShow(const machine::Box& all, const machine::Box& cut,
                       const machine::Box& travel);

// 1, 2 or 5 times a power of ten, at least `least`.
double NiceStep(double least);

// "0.5", "20": as many decimals as a tick of this step needs.
std::string TickText(double value, double step);

}  // namespace rmlcell::simulation
