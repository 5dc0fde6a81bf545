#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// Pieces of SVG text. Lengths on the picture are pixels, written in hundredths.
namespace rmlcell::simulation {

// Text for XML content and attribute values: what could be markup is escaped, what XML cannot hold
// (control characters, bytes that are no UTF-8) becomes U+FFFD.
std::string XmlText(std::string_view text);

// The first `bytes` of a text that is longer, ended by an ellipsis; no character is cut in two.
std::string Shortened(std::string_view text, std::size_t bytes);

// A text in lines of at most so many bytes, cut at blanks; a word that is longer is shortened. At
// most three lines: the last one ends with an ellipsis where there would be more.
std::vector<std::string> Wrapped(std::string_view text, std::size_t bytes);

// "12.5", "-0.07", "3".
void AppendPixels(std::string& out, std::int64_t hundredths);
std::string Pixels(double px);

struct ScreenPoint {
  double x = 0.0;
  double y = 0.0;
};

// The data of a path element. Points are rounded to hundredths of a pixel first and written
// relative to each other, so that rounding does not add up.
class PathData {
 public:
  void MoveTo(ScreenPoint to);
  void LineTo(ScreenPoint to);

  // An elliptical arc; radii in pixels, rotation in degrees.
  struct Ellipse {
    double rx = 0.0;
    double ry = 0.0;
    double rotation_deg = 0.0;
    bool large = false;
    bool clockwise = false;  // as seen on the screen
  };
  void ArcTo(const Ellipse& ellipse, ScreenPoint to);

  bool StandsAt(ScreenPoint at) const;
  std::size_t segments() const { return segments_; }
  const std::string& text() const { return text_; }
  void Clear();

 private:
  void AppendStep(ScreenPoint to);

  std::string text_;
  std::int64_t x_ = 0;  // hundredths
  std::int64_t y_ = 0;
  bool started_ = false;
  char last_command_ = 0;
  std::size_t segments_ = 0;
};

}  // namespace rmlcell::simulation
