#include "engine/simulation/picture/picture_panel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include "engine/simulation/picture/svg_shapes.h"

namespace rmlcell::simulation {
namespace {

using motion::MachineVector;

constexpr double kTick_px = 78.0;      // least distance of ruler marks
constexpr double kScaleBar_px = 90.0;  // least length of the scale bar
constexpr double kDotCell_px = 2.0;    // dots nearer than this are one
constexpr std::size_t kManyDots = 300;
constexpr std::size_t kToolsShown = 120;
constexpr double kToolLength_px = 26.0;

bool Inside(const ScreenRect& rect, ScreenPoint p) {
  return p.x >= rect.x && p.x <= rect.x + rect.width && p.y >= rect.y &&
         p.y <= rect.y + rect.height;
}

std::string Stroke(std::string_view colour, double width, std::string_view more = {}) {
  std::string style =
      "stroke=\"" + std::string(colour) + "\" stroke-width=\"" + Pixels(width) + '"';
  if (!more.empty()) style += ' ' + std::string(more);
  return style;
}

void DrawRulers(const Panel& panel, std::string& out) {
  const ScreenRect& rect = panel.rect;
  const Extent seen = panel.visible();
  const double step = NiceStep(kTick_px / panel.scale);
  const std::string grid = Stroke(kGrid, 1.0);
  const TextStyle label{.size = 11.0, .colour = kFaint, .anchor = "middle"};
  const double left = seen.left - panel.zero.dot(panel.frame.right);
  for (double u = std::ceil(left / step) * step; u <= left + seen.width(); u += step) {
    const double x = rect.x + (u - left) * panel.scale;
    AppendLine(out, {x, rect.y}, {x, rect.y + rect.height}, grid);
    AppendText(out, {x, rect.y + rect.height + 15.0}, TickText(u, step), label);
  }
  const TextStyle side{.size = 11.0, .colour = kFaint, .anchor = "end"};
  const double bottom = seen.bottom - panel.zero.dot(panel.frame.up);
  for (double v = std::ceil(bottom / step) * step; v <= bottom + seen.height(); v += step) {
    const double y = rect.y + rect.height - (v - bottom) * panel.scale;
    AppendLine(out, {rect.x, y}, {rect.x + rect.width, y}, grid);
    AppendText(out, {rect.x - 6.0, y + 4.0}, TickText(v, step), side);
  }
  AppendText(out, {rect.x + rect.width, rect.y + rect.height + 30.0}, panel.frame.across + " mm",
             {.size = 12.0, .colour = kInk, .anchor = "end", .bold = true});
  AppendText(out, {rect.x - 6.0, rect.y - 8.0}, panel.frame.upward + " mm",
             {.size = 12.0, .colour = kInk, .anchor = "end", .bold = true});
}

// The twelve edges of a box.
void DrawBox(const machine::Box& box, const Panel& panel, std::string_view style,
             std::string& out) {
  const auto corner = [&](unsigned bits) {
    return panel.Project({(bits & 1) != 0 ? box.max.x() : box.min.x(),
                          (bits & 2) != 0 ? box.max.y() : box.min.y(),
                          (bits & 4) != 0 ? box.max.z() : box.min.z()});
  };
  std::set<std::tuple<double, double, double, double>>
      drawn;  // an axial view sees edges behind each other
  for (unsigned from = 0; from < 8; ++from) {
    for (const unsigned bit : {1u, 2u, 4u}) {
      if ((from & bit) != 0) continue;
      const ScreenPoint a = corner(from);
      const ScreenPoint b = corner(from | bit);
      if (std::hypot(b.x - a.x, b.y - a.y) < 0.5) continue;
      if (drawn.insert({a.x, a.y, b.x, b.y}).second) AppendLine(out, a, b, style);
    }
  }
}

void DrawWorkOrigin(const PanelContent& content, const Panel& panel, std::string& out) {
  if (!content.shape.has_work_origin) return;
  const ScreenPoint p = panel.Project(content.shape.work_origin);
  if (!Inside(panel.rect, p)) return;
  const std::string style = Stroke("#b4540a", 1.2);
  AppendLine(out, {p.x - 9, p.y}, {p.x + 9, p.y}, style);
  AppendLine(out, {p.x, p.y - 9}, {p.x, p.y + 9}, style);
  AppendCircle(out, p, 4.5, "fill=\"none\" " + style);
}

// Where the tool pointed while it cut, seen in space.
void DrawTools(const PanelContent& content, const Panel& panel, std::string& out) {
  const std::vector<SketchTool>& tools = content.sketch.tools();
  if (!panel.frame.across.empty() || tools.empty()) return;
  out += "<g " + Stroke("#0f8a5f", 0.9, "stroke-opacity=\"0.55\" stroke-linecap=\"round\"") + ">\n";
  const std::size_t stride = (tools.size() + kToolsShown - 1) / kToolsShown;
  for (std::size_t i = 0; i < tools.size(); i += stride) {
    const ScreenPoint tip = panel.Project(tools[i].tip);
    if (!Inside(panel.rect, tip)) continue;
    AppendLine(out, tip,
               panel.Project(tools[i].tip + tools[i].towards_head * (kToolLength_px / panel.scale)),
               {});
  }
  out += "</g>\n";
}

void DrawDots(const PanelContent& content, const Panel& panel, std::string& out) {
  const std::vector<SketchDot>& dots = content.sketch.dots();
  std::set<std::pair<long long, long long>> taken;
  std::vector<std::pair<ScreenPoint, bool>> shown;
  for (const SketchDot& dot : dots) {
    const ScreenPoint p = panel.Project(dot.at);
    if (!Inside(panel.rect, p)) continue;
    const std::pair cell{std::llround(p.x / kDotCell_px), std::llround(p.y / kDotCell_px)};
    if (taken.insert(cell).second) shown.push_back({p, dot.pierce});
  }
  if (shown.empty()) return;
  const bool many = shown.size() > kManyDots;
  for (const auto& [p, pierce] : shown) {
    if (pierce) {
      AppendCircle(out, p, many ? 2.2 : 4.2,
                   "fill=\"#e8590c\" stroke=\"#ffffff\" stroke-width=\"1\"");
    } else {
      AppendCircle(
          out, p, many ? 1.1 : 2.4,
          "fill=\"#ffffff\" stroke=\"#e8590c\" stroke-width=\"" + Pixels(many ? 0.6 : 1.2) + '"');
    }
  }
}

void DrawStartAndEnd(const PanelContent& content, const Panel& panel, std::string& out) {
  if (!content.sketch.moved()) return;
  const ScreenPoint start = panel.Project(content.sketch.start());
  const ScreenPoint end = panel.Project(content.sketch.end());
  if (Inside(panel.rect, start)) {
    AppendCircle(out, start, 6.5, "fill=\"none\" stroke=\"#2b8a3e\" stroke-width=\"2\"");
  }
  if (!Inside(panel.rect, end)) return;
  if (content.completed) {
    AppendRect(out, {end.x - 3.5, end.y - 3.5, 7.0, 7.0},
               "fill=\"#1c2733\" stroke=\"#ffffff\" stroke-width=\"1\"");
  } else {
    const std::string style = Stroke("#c92a2a", 2.4, "stroke-linecap=\"round\"");
    AppendLine(out, {end.x - 6, end.y - 6}, {end.x + 6, end.y + 6}, style);
    AppendLine(out, {end.x - 6, end.y + 6}, {end.x + 6, end.y - 6}, style);
  }
}

// Below the panel: nothing of the path lies under it.
void DrawScaleBar(const Panel& panel, std::string& out) {
  // Its figure stands clear of the name of the axis.
  constexpr double kFigure_px = 60.0, kAxisName_px = 44.0;
  double length_mm = NiceStep(kScaleBar_px / panel.scale);
  if (length_mm * panel.scale + kFigure_px + kAxisName_px > panel.rect.width)
    length_mm = NiceStep(0.25 * kScaleBar_px / panel.scale);
  const double length = length_mm * panel.scale;
  const double x = panel.rect.x;
  const double y = panel.rect.y + panel.rect.height + 27.0;
  const std::string style = Stroke(kInk, 1.6);
  AppendLine(out, {x, y}, {x + length, y}, style);
  AppendLine(out, {x, y - 4.0}, {x, y + 4.0}, style);
  AppendLine(out, {x + length, y - 4.0}, {x + length, y + 4.0}, style);
  AppendText(out, {x + length + 9.0, y + 4.0}, TickText(length_mm, length_mm) + " mm",
             {.size = 11.5});
}

// The three axes in a corner of an oblique view.
void DrawTriad(const Panel& panel, std::string& out) {
  constexpr double kArm_px = 34.0;
  const ScreenPoint middle{panel.rect.x + 56.0, panel.rect.y + panel.rect.height - 56.0};
  constexpr std::array kNames{"X", "Y", "Z"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const double right = panel.frame.right[i];
    const double up = panel.frame.up[i];
    const ScreenPoint tip{middle.x + kArm_px * right, middle.y - kArm_px * up};
    AppendLine(out, middle, tip, Stroke(kFaint, 1.6, "stroke-linecap=\"round\""));
    AppendText(out, {middle.x + (kArm_px + 11.0) * right, middle.y - (kArm_px + 11.0) * up + 4.0},
               kNames[i], {.size = 11.5, .colour = kInk, .anchor = "middle", .bold = true});
  }
}

}  // namespace

void BeginPanel(const machine::MachineShape& shape, const Panel& panel, int id, std::string& out) {
  const std::string name = "panel" + std::to_string(id);
  out += "<g id=\"" + name + "\">\n";
  AppendRect(out, panel.rect, "fill=\"#ffffff\"");
  if (!panel.frame.across.empty()) DrawRulers(panel, out);
  out += "<clipPath id=\"" + name + "-clip\">";
  AppendRect(out, panel.rect, {});
  out += "</clipPath>\n<g clip-path=\"url(#" + name + "-clip)\">\n";
  // In space its edges would only confuse.
  if (!shape.travel.empty() && !panel.frame.across.empty()) {
    DrawBox(shape.travel, panel, Stroke("#b0894a", 1.3, "stroke-dasharray=\"14 4 2 4\""), out);
  }
}

void EndPanel(const Panel& panel, bool nothing, std::string& out) {
  out += "</g>\n";
  if (nothing) {
    AppendText(out, {panel.rect.x + 0.5 * panel.rect.width, panel.rect.y + 0.5 * panel.rect.height},
               "nothing moved", {.size = 20.0, .colour = kFaint, .anchor = "middle"});
  }
  AppendRect(out, panel.rect, "fill=\"none\" " + Stroke("#9aa7b2", 1.0));
  AppendText(out, {panel.rect.x + 2.0, panel.rect.y - 8.0}, panel.frame.title,
             {.size = 13.0, .colour = kFaint});
  if (panel.frame.across.empty()) {
    DrawTriad(panel, out);
  } else {
    DrawScaleBar(panel, out);
  }
  out += "</g>\n";
}

std::size_t DrawPanel(const PanelContent& content, const Panel& panel, int id, std::string& out) {
  BeginPanel(content.shape, panel, id, out);
  DrawTools(content, panel, out);
  const std::size_t elements =
      DrawPath(content.sketch, panel, content.depth, content.elements_max, out);
  DrawDots(content, panel, out);
  DrawWorkOrigin(content, panel, out);
  DrawStartAndEnd(content, panel, out);
  EndPanel(panel, !content.sketch.moved(), out);
  return elements;
}

}  // namespace rmlcell::simulation
