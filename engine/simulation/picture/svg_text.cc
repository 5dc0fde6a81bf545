#include "engine/simulation/picture/svg_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace rmlcell::simulation {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD
constexpr double kPerPixel = 100.0;
// Far outside of every picture; keeps nonsense out of the integers.
constexpr double kFarthest_px = 1e7;

// Length of the UTF-8 sequence at the front, or 0: overlong forms, surrogates and what XML excludes
// are none.
std::size_t SequenceLength(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < length) return 0;
  unsigned point = lead & (0xFFu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0u) != 0x80u) return 0;
    point = (point << 6) | (byte(i) & 0x3Fu);
  }
  constexpr std::array<unsigned, 5> kLeast = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = point >= 0xD800 && point <= 0xDFFF;
  if (point < kLeast[length] || surrogate || point > 0x10FFFF) return 0;
  return point == 0xFFFE || point == 0xFFFF ? 0 : length;
}

std::int64_t Hundredths(double px) {
  const double clamped = std::clamp(px, -kFarthest_px, kFarthest_px);
  return clamped == clamped ? std::llround(clamped * kPerPixel) : 0;
}

}  // namespace

std::string Shortened(std::string_view text, std::size_t bytes) {
  if (text.size() <= bytes) return std::string(text);
  while (bytes > 0 && (static_cast<unsigned char>(text[bytes]) & 0xC0u) == 0x80u) --bytes;
  return std::string(text.substr(0, bytes)) + "…";
}

std::vector<std::string> Wrapped(std::string_view text, std::size_t bytes) {
  constexpr std::size_t kLinesMax = 3;
  std::vector<std::string> lines;
  while (!text.empty()) {
    if (text.size() <= bytes || lines.size() + 1 == kLinesMax) {
      lines.push_back(Shortened(text, bytes));
      break;
    }
    std::size_t end = text.rfind(' ', bytes);
    const bool word_too_long = end == std::string_view::npos || end == 0;
    if (word_too_long) end = std::min(text.find(' ', 1), text.size());
    lines.push_back(Shortened(text.substr(0, end), bytes));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::string XmlText(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = SequenceLength(text);
    const char c = text.front();
    if (length == 0) {
      out += kReplacement;
    } else if (length > 1) {
      out += text.substr(0, length);
    } else if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else if (c == '\'') {
      out += "&#39;";
    } else if (c == '\t' || c == '\n' || c == '\r') {
      out += ' ';
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
      out += kReplacement;
    } else {
      out += c;
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return out;
}

void AppendPixels(std::string& out, std::int64_t hundredths) {
  std::array<char, 24> room{};
  if (hundredths < 0) {
    out += '-';
    hundredths = -hundredths;
  }
  const std::int64_t whole = hundredths / 100;
  const std::int64_t part = hundredths % 100;
  if (whole != 0 || part == 0) {
    out.append(room.data(), std::to_chars(room.data(), room.data() + room.size(), whole).ptr);
  }
  if (part == 0) return;
  out += '.';
  out += static_cast<char>('0' + part / 10);
  if (part % 10 != 0) out += static_cast<char>('0' + part % 10);
}

std::string Pixels(double px) {
  std::string text;
  AppendPixels(text, Hundredths(px));
  return text;
}

void PathData::AppendStep(ScreenPoint to) {
  const std::int64_t x = Hundredths(to.x);
  const std::int64_t y = Hundredths(to.y);
  AppendPixels(text_, x - x_);
  if (y >= y_) text_ += ' ';  // a minus sign separates as well
  AppendPixels(text_, y - y_);
  x_ = x;
  y_ = y;
}

void PathData::MoveTo(ScreenPoint to) {
  text_ += started_ ? 'm' : 'M';  // relative to the point before
  started_ = true;
  last_command_ = 'm';
  AppendStep(to);
}

void PathData::LineTo(ScreenPoint to) {
  // After a move or a line, further pairs are lines; a minus sign needs no blank before it.
  if (last_command_ != 'l') {
    text_ += 'l';
  } else if (Hundredths(to.x) >= x_) {
    text_ += ' ';
  }
  last_command_ = 'l';
  AppendStep(to);
  ++segments_;
}

void PathData::ArcTo(const Ellipse& ellipse, ScreenPoint to) {
  text_ += 'a';
  last_command_ = 'a';
  AppendPixels(text_, Hundredths(ellipse.rx));
  text_ += ' ';
  AppendPixels(text_, Hundredths(ellipse.ry));
  text_ += ' ';
  AppendPixels(text_, Hundredths(ellipse.rotation_deg));
  text_ += ellipse.large ? " 1" : " 0";
  text_ += ellipse.clockwise ? " 1 " : " 0 ";
  AppendStep(to);
  ++segments_;
}

bool PathData::StandsAt(ScreenPoint at) const {
  return started_ && Hundredths(at.x) == x_ && Hundredths(at.y) == y_;
}

void PathData::Clear() { *this = PathData(); }

}  // namespace rmlcell::simulation
