#pragma once

#include <string>
#include <string_view>

#include "engine/simulation/picture/picture_view.h"
#include "engine/simulation/picture/svg_text.h"

// The few SVG elements that pictures are made of; each appends one line. `style` is further
// attributes, as they stand.
namespace rmlcell::simulation {

inline constexpr std::string_view kInk = "#1c2733";    // text
inline constexpr std::string_view kFaint = "#66747f";  // secondary text
inline constexpr std::string_view kRule = "#d3dae1";   // frames
inline constexpr std::string_view kGrid = "#edf1f4";

inline constexpr double kPageMargin = 36.0;  // px
inline constexpr int kPageWidthMax = 8192;   // px

void AppendLine(std::string& out, ScreenPoint from, ScreenPoint to, std::string_view style);
void AppendRect(std::string& out, const ScreenRect& rect, std::string_view style);
void AppendCircle(std::string& out, ScreenPoint middle, double radius, std::string_view style);

struct TextStyle {
  double size = 12.0;
  std::string_view colour = kInk;
  std::string_view anchor = "start";  // middle, end
  bool bold = false;
};
// `text` is plain; it is escaped here.
void AppendText(std::string& out, ScreenPoint at, std::string_view text, const TextStyle& style);

}  // namespace rmlcell::simulation
