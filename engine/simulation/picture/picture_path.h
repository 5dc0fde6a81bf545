#pragma once

#include <span>
#include <string>
#include <string_view>

#include "engine/simulation/picture/path_sketch.h"
#include "engine/simulation/picture/picture_view.h"

namespace rmlcell::simulation {

// Depths of a mill in the XY view, from the highest to the deepest.
inline constexpr int kShades = 8;
inline constexpr const char* kShadeColours[kShades] = {"#6cc6bd", "#43a9b8", "#2f8bb5", "#2a6fae",
                                                       "#2a559f", "#2b3d8c", "#292872", "#1f1653"};
inline constexpr const char* kCutColour = "#0b4fa8";
inline constexpr const char* kTravelColour = "#7d8b99";
inline constexpr const char* kLostColour = "#c2255c";
inline constexpr const char* kSkimStyle =
    "stroke=\"#868e96\" stroke-width=\"1.4\" stroke-dasharray=\"1.5 3\"";
inline constexpr const char* kLostStyle =
    "stroke=\"#c2255c\" stroke-width=\"1.6\" stroke-dasharray=\"2.5 3\"";

struct DepthRange {
  double low_mm = 0.0;
  double high_mm = 0.0;
  bool shaded = false;  // false: one colour
  int ShadeOf(double z_mm) const;
};

// Lines and arcs to draw, and how; both must outlive the drawing.
struct PathStrokes {
  std::span<const SketchElement> elements;
  std::span<const SketchCircle> circles;
  std::string_view cut = kCutColour;
  std::string_view cut_dashes{};  // of stroke-dasharray; empty: a solid line
  std::string_view travel = kTravelColour;
  std::span<const SketchElement> lost{};  // lines that the machine left out
  bool skims = false;                     // strokes along the surface have a look of their own
};

// Appends the path as `panel` shows it: travel thin and dashed below, then strokes along the
// surface in a group of class "skim" and what was lost in one of class "lost", the cut on top. Arcs
// are elliptical arcs of the picture, exactly; only where the view sees a circle from its edge they
// are lines. Nothing that differs by less than a tenth of a pixel is drawn twice. At most
// `elements_max` elements: longer paths get coarser. Returns the number of elements drawn.
std::size_t DrawPath(const PathStrokes& strokes, const Panel& panel, const DepthRange& depth,
                     std::size_t elements_max, std::string& out);
std::size_t DrawPath(const PathSketch& sketch, const Panel& panel, const DepthRange& depth,
                     std::size_t elements_max, std::string& out);

}  // namespace rmlcell::simulation
