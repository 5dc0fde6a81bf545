#include "engine/simulation/picture/picture_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/core/units.h"

namespace rmlcell::simulation {
namespace {

using motion::MachinePoint;
using motion::MachineVector;

constexpr double kPrecision_px = 0.05;   // of straight neighbours merged into one line
constexpr double kAlike_px = 0.2;        // closer strokes cannot be told apart
constexpr double kEdgeOn_px = 0.05;      // a circle this flat is a line
constexpr double kStraight_px = 0.02;    // an arc that bows less is a line
constexpr double kClipMargin_px = 20.0;  // beyond the panel: ends of strokes stay out of sight
constexpr double kArcStep_rad = 2.5;     // longest piece of arc: its ends stay well apart
constexpr double kCoarser = 1.6;
constexpr std::size_t kSegmentsPerPath = 1000;  // browsers draw long paths slowly
constexpr double kFinest_px = 0.35;
constexpr double kBoldest_px = 2.0;

// Pieces of one style.
enum class Layer { kTravel, kSkim, kLost, kCut };

// A circle as a panel sees it: an ellipse.
struct SeenCircle {
  PathData::Ellipse ellipse;
  MachineVector spoke;  // from the centre to the start of the arc, mm
  MachineVector side;   // the same, a quarter turn on
  MachinePoint centre;
  double sweep = 0.0;

  MachinePoint At(double angle) const {
    return centre + spoke * std::cos(angle) + side * std::sin(angle);
  }
};

// What part of a segment lies inside a rectangle (Liang and Barsky).
struct Clip {
  double begin = 0.0;
  double end = 1.0;
};
std::optional<Clip> ClipTo(const ScreenRect& rect, const ScreenPoint& a, const ScreenPoint& b) {
  Clip clip;
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const std::array p = {-dx, dx, -dy, dy};
  const std::array q = {a.x - rect.x, rect.x + rect.width - a.x, a.y - rect.y,
                        rect.y + rect.height - a.y};
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (p[i] < 0.0) {
      clip.begin = std::max(clip.begin, q[i] / p[i]);
    } else if (p[i] > 0.0) {
      clip.end = std::min(clip.end, q[i] / p[i]);
    } else if (q[i] < 0.0) {
      return std::nullopt;
    }
  }
  if (!(clip.begin <= clip.end)) return std::nullopt;
  return clip;
}

ScreenPoint Flat(const MachinePoint& p) { return {p.x(), p.y()}; }

class PathDrawing {
 public:
  PathDrawing(const PathStrokes& strokes, const Panel& panel, const DepthRange& depth)
      : strokes_(strokes), panel_(panel), depth_(depth) {
    clip_ = {panel.rect.x - kClipMargin_px, panel.rect.y - kClipMargin_px,
             panel.rect.width + 2 * kClipMargin_px, panel.rect.height + 2 * kClipMargin_px};
    // All at once: a list that grows is there twice while it does.
    elements_.reserve(strokes.elements.size() + strokes.lost.size());
    for (const SketchElement& element : strokes.elements) Project(element);
    for (const SketchElement& element : strokes.lost) Project(element);
  }

  void Thin(std::size_t elements_max) {
    double precision = kPrecision_px;
    double cell = kAlike_px;
    MergeStraight(elements_, precision);
    DropAlike(elements_, cell);
    // Ends: with cells as large as the panel everything is alike.
    while (elements_.size() > elements_max) {
      precision *= kCoarser;
      cell *= kCoarser;
      MergeStraight(elements_, precision);
      DropAlike(elements_, cell);
    }
  }

  void Write(std::string& out) const {
    WriteLayer(Layer::kTravel, out);
    if (strokes_.skims) WriteLayer(Layer::kSkim, out);
    if (!strokes_.lost.empty()) WriteLayer(Layer::kLost, out);
    WriteLayer(Layer::kCut, out);
  }

  std::size_t size() const { return elements_.size(); }

 private:
  MachineVector OnPage(const MachinePoint& point) const {
    const ScreenPoint p = panel_.Project(point);
    return {p.x, p.y, 0.0};
  }

  void Project(const SketchElement& element) {
    SketchElement flat = element;
    flat.from = OnPage(element.from);
    flat.to = OnPage(element.to);
    flat.arc = -1;
    flat.skims = element.skims && strokes_.skims;
    if (element.cuts && !flat.skims && depth_.shaded) {
      const double z = std::min(element.from.z(), element.to.z());
      flat.shade = static_cast<std::uint8_t>(depth_.ShadeOf(z));
    }
    if (!element.cuts) flat.use = machine::MotionUse::kTravel;  // one look for all that does not
    if (element.arc >= 0) {
      ProjectArc(element, flat);
    } else {
      PushLine(flat);
    }
  }

  void PushLine(const SketchElement& line) {
    // A drilled hole is a dot from above; a rapid move towards the eye is nothing.
    if (!line.cuts && (line.from - line.to).norm() < kPrecision_px) return;
    const std::optional<Clip> clip = ClipTo(clip_, Flat(line.from), Flat(line.to));
    if (!clip) return;
    SketchElement inside = line;
    const MachineVector way = line.to - line.from;
    inside.from = line.from + way * clip->begin;
    inside.to = line.to - way * (1.0 - clip->end);
    elements_.push_back(inside);
  }

  void ProjectArc(const SketchElement& element, SketchElement flat) {
    const SketchCircle& circle = CircleOf(element);
    const MachinePoint centre = OnPage(circle.centre);
    const double radius = circle.radius_mm * panel_.scale;
    const bool near =
        centre.x() + radius >= clip_.x && centre.x() - radius <= clip_.x + clip_.width &&
        centre.y() + radius >= clip_.y && centre.y() - radius <= clip_.y + clip_.height;
    if (!near) return;
    flat.middle = OnPage(element.middle);
    const MachineVector chord_middle = (flat.from + flat.to) * 0.5;
    if (circle.sweep_rad < kPi && (flat.middle - chord_middle).norm() < kStraight_px) {
      PushLine(flat);
      return;
    }
    const double lean = circle.normal.dot(panel_.frame.towards_eye);
    if (radius * std::abs(lean) < kEdgeOn_px) {
      PushEdgeOn(element, flat);
      return;
    }
    SeenCircle seen;
    // The long axis lies across the way that the normal leans to.
    const double right = circle.normal.dot(panel_.frame.right);
    const double up = circle.normal.dot(panel_.frame.up);
    const bool tilted = std::hypot(right, up) > 1e-9;
    seen.ellipse = {.rx = radius,
                    .ry = tilted ? radius * std::abs(lean) : radius,
                    .rotation_deg = tilted ? std::atan2(right, up) / kRadPerDegree : 0.0,
                    .large = false,
                    .clockwise = lean < 0.0};
    seen.centre = circle.centre;
    seen.spoke = element.from - circle.centre;
    seen.side = circle.normal.cross(seen.spoke);
    seen.sweep = circle.sweep_rad;
    flat.arc = static_cast<std::int32_t>(circles_.size());
    circles_.push_back(seen);
    elements_.push_back(flat);
  }

  // To and fro on a line: as far as the circle reaches.
  void PushEdgeOn(const SketchElement& element, SketchElement flat) {
    const SketchCircle& circle = CircleOf(element);
    const MachineVector spoke = element.from - circle.centre;
    const MachineVector side = circle.normal.cross(spoke);
    const MachineVector axis = circle.normal.cross(panel_.frame.towards_eye);
    // The ends of the line: where the derivative of the place along `axis` is zero.
    double angle = std::atan2(side.dot(axis), spoke.dot(axis));
    angle -= kPi * std::floor(angle / kPi);
    for (; angle < circle.sweep_rad; angle += kPi) {
      SketchElement part = flat;
      part.to = OnPage(circle.centre + spoke * std::cos(angle) + side * std::sin(angle));
      PushLine(part);
      flat.from = part.to;
    }
    PushLine(flat);
  }

  static Layer LayerOf(const SketchElement& element) {
    if (element.lost) return Layer::kLost;
    if (element.skims) return Layer::kSkim;
    return element.cuts ? Layer::kCut : Layer::kTravel;
  }

  // Thin strokes where many run side by side, so that they do not run together.
  double StrokeWidth() const {
    double length = 0.0;
    for (const SketchElement& element : elements_) {
      if (element.cuts) length += (element.from - element.to).norm();
    }
    const double area = panel_.rect.width * panel_.rect.height;
    return std::clamp(length > 0.0 ? 0.5 * area / length : kBoldest_px, kFinest_px, kBoldest_px);
  }

  void WriteLayer(Layer layer, std::string& out) const {
    if (layer == Layer::kTravel) {
      out += "<g fill=\"none\" stroke=\"";
      out += strokes_.travel;
      out += "\" stroke-width=\"0.9\" stroke-dasharray=\"5 3.5\" stroke-opacity=\"0.8\">\n";
      WriteShade(layer, 0, out);
    } else if (layer == Layer::kLost || layer == Layer::kSkim) {
      out += layer == Layer::kLost ? "<g class=\"lost" : "<g class=\"skim";
      out += "\" fill=\"none\" ";
      out += layer == Layer::kLost ? kLostStyle : kSkimStyle;
      out += ">\n";
      WriteShade(layer, 0, out);
    } else {
      out += "<g fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\" stroke-width=\"";
      out += Pixels(StrokeWidth());
      out += "\" stroke=\"";
      out += strokes_.cut;
      if (!strokes_.cut_dashes.empty()) {
        out += "\" stroke-dasharray=\"";
        out += strokes_.cut_dashes;
      }
      out += "\">\n";
      for (int shade = 0; shade < (depth_.shaded ? kShades : 1); ++shade) {
        WriteShade(layer, shade, out);
      }
    }
    out += "</g>\n";
  }

  void WriteShade(Layer layer, int shade, std::string& out) const {
    PathData data;
    const auto flush = [&] {
      if (data.segments() == 0) return;
      out += "<path";
      if (layer == Layer::kCut && depth_.shaded) {
        out += " stroke=\"";
        out += kShadeColours[shade];
        out += '"';
      }
      out += " d=\"" + data.text() + "\"/>\n";
      data.Clear();
    };
    for (const SketchElement& element : elements_) {
      if (LayerOf(element) != layer || element.shade != shade) continue;
      if (!data.StandsAt(Flat(element.from))) data.MoveTo(Flat(element.from));
      if (element.arc >= 0) {
        WriteArc(element, data);
      } else {
        data.LineTo(Flat(element.to));
      }
      if (data.segments() >= kSegmentsPerPath) flush();
    }
    flush();
  }

  void WriteArc(const SketchElement& element, PathData& data) const {
    const SeenCircle& seen = circles_[static_cast<std::size_t>(element.arc)];
    const int pieces = static_cast<int>(std::ceil(seen.sweep / kArcStep_rad));
    for (int k = 1; k < pieces; ++k) {
      data.ArcTo(seen.ellipse, panel_.Project(seen.At(seen.sweep * k / pieces)));
    }
    data.ArcTo(seen.ellipse, Flat(element.to));
  }

  const SketchCircle& CircleOf(const SketchElement& element) const {
    return strokes_.circles[static_cast<std::size_t>(element.arc)];
  }

  const PathStrokes& strokes_;
  const Panel& panel_;
  const DepthRange& depth_;
  ScreenRect clip_;
  std::vector<SketchElement> elements_;
  std::vector<SeenCircle> circles_;
};

}  // namespace

int DepthRange::ShadeOf(double z_mm) const {
  const double share = (high_mm - z_mm) / (high_mm - low_mm);
  return static_cast<int>(std::clamp(share * kShades, 0.0, kShades - 1.0));
}

std::size_t DrawPath(const PathSketch& sketch, const Panel& panel, const DepthRange& depth,
                     std::size_t elements_max, std::string& out) {
  return DrawPath({.elements = sketch.elements(),
                   .circles = sketch.circles(),
                   .lost = sketch.lost(),
                   .skims = sketch.skims_beside_cuts()},
                  panel, depth, elements_max, out);
}

std::size_t DrawPath(const PathStrokes& strokes, const Panel& panel, const DepthRange& depth,
                     std::size_t elements_max, std::string& out) {
  PathDrawing drawing(strokes, panel, depth);
  drawing.Thin(elements_max);
  drawing.Write(out);
  return drawing.size();
}

}  // namespace rmlcell::simulation
