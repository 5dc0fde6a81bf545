#include "engine/simulation/picture/text_width.h"

#include <array>

namespace rmlcell::simulation {
namespace {

// Advance widths of Helvetica, and of Arial and Liberation Sans, which have the same: thousandths
// of the size of the font, of the characters from blank to tilde.
constexpr std::array<int, 95> kAdvance = {
    278,  278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278,  //  !"#.../
    556,  556, 556, 556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556,  // 0-9:;<=>?
    1015, 667, 667, 722, 722, 667, 611, 778, 722, 278, 500, 667, 556, 833, 722, 778,  // @A-O
    667,  778, 722, 667, 611, 722, 667, 944, 667, 667, 611, 278, 278, 278, 469, 556,  // P-Z[\]^_
    333,  556, 556, 500, 556, 556, 278, 556, 556, 222, 222, 500, 222, 833, 556, 556,  // `a-o
    556,  556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334, 260, 334, 584};      // p-z{|}~
constexpr double kThousandth = 0.001;
constexpr double kWidestFont = 1.12;  // Inter, which comes first in the list of a picture
constexpr double kBold = 1.1;
constexpr std::string_view kEllipsis = "…";

bool Continues(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

// In sizes of the font. 0: it goes on with the character before.
double AdvanceOf(char c) {
  if (Continues(c)) return 0.0;
  if (c < ' ' || c > '~') return 1.0;
  return kThousandth * kAdvance[static_cast<std::size_t>(c - ' ')];
}

double FontScale(const TextStyle& style) {
  return style.size * kWidestFont * (style.bold ? kBold : 1.0);
}

}  // namespace

double TextWidth(std::string_view text, const TextStyle& style) {
  double width = 0.0;
  for (const char c : text) width += AdvanceOf(c);
  return width * FontScale(style);
}

std::string Fitted(std::string_view text, double width_px, const TextStyle& style) {
  if (TextWidth(text, style) <= width_px) return std::string(text);
  const double room = width_px - TextWidth(kEllipsis, style);
  double width = 0.0;
  std::size_t end = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (!Continues(text[at])) end = at;
    width += AdvanceOf(text[at]) * FontScale(style);
    if (width > room) break;
  }
  return std::string(text.substr(0, end)) + std::string(kEllipsis);
}

}  // namespace rmlcell::simulation
