#include "engine/simulation/picture/svg_shapes.h"

namespace rmlcell::simulation {
namespace {

void Attribute(std::string& out, std::string_view name, double px) {
  out += ' ';
  out += name;
  out += "=\"";
  out += Pixels(px);
  out += '"';
}

void Close(std::string& out, std::string_view style) {
  if (!style.empty()) {
    out += ' ';
    out += style;
  }
  out += "/>\n";
}

}  // namespace

void AppendLine(std::string& out, ScreenPoint from, ScreenPoint to, std::string_view style) {
  out += "<line";
  Attribute(out, "x1", from.x);
  Attribute(out, "y1", from.y);
  Attribute(out, "x2", to.x);
  Attribute(out, "y2", to.y);
  Close(out, style);
}

void AppendRect(std::string& out, const ScreenRect& rect, std::string_view style) {
  out += "<rect";
  Attribute(out, "x", rect.x);
  Attribute(out, "y", rect.y);
  Attribute(out, "width", rect.width);
  Attribute(out, "height", rect.height);
  Close(out, style);
}

void AppendCircle(std::string& out, ScreenPoint middle, double radius, std::string_view style) {
  out += "<circle";
  Attribute(out, "cx", middle.x);
  Attribute(out, "cy", middle.y);
  Attribute(out, "r", radius);
  Close(out, style);
}

void AppendText(std::string& out, ScreenPoint at, std::string_view text, const TextStyle& style) {
  out += "<text";
  Attribute(out, "x", at.x);
  Attribute(out, "y", at.y);
  Attribute(out, "font-size", style.size);
  out += " fill=\"";
  out += style.colour;
  out += '"';
  if (style.anchor != "start") {
    out += " text-anchor=\"";
    out += style.anchor;
    out += '"';
  }
  if (style.bold) out += " font-weight=\"600\"";
  out += '>';
  out += XmlText(text);
  out += "</text>\n";
}

}  // namespace rmlcell::simulation
