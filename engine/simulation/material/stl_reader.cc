#include "engine/simulation/material/stl_reader.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <string>

#include "engine/core/number_text.h"

namespace rmlcell::simulation {
namespace {

constexpr std::size_t kStlHeading = 84;   // 80 bytes of anything, and how many triangles follow
constexpr std::size_t kStlTriangle = 50;  // normal, three corners, two bytes of anything

Error NoStl(const Detail& why) { return {ErrorCode::kCellBadText, "no STL: " + why, {}}; }

Error TooManyTriangles() {
  return {ErrorCode::kCellTooLarge,
          "the STL has more than " + Told("most", kStlTrianglesMax) + " triangles",
          {}};
}

std::uint32_t LittleEndian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (std::size_t k = 4; k-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[k]);
  return value;
}

bool IsBinaryStl(std::string_view bytes) {
  return bytes.size() >= kStlHeading &&
         kStlHeading + kStlTriangle * std::size_t{LittleEndian(bytes.substr(80))} == bytes.size();
}

Result<std::vector<StlTriangle>> ReadBinary(std::string_view bytes) {
  const std::size_t count = LittleEndian(bytes.substr(80));
  if (count > kStlTrianglesMax) return TooManyTriangles();
  std::vector<StlTriangle> triangles(count);
  for (std::size_t t = 0; t < count; ++t) {
    std::string_view at = bytes.substr(kStlHeading + t * kStlTriangle + 12);
    for (auto& corner : triangles[t].corners) {
      for (float& coordinate : corner) {
        coordinate = std::bit_cast<float>(LittleEndian(at));
        at.remove_prefix(4);
        if (!std::isfinite(coordinate))
          return NoStl("triangle " + Told("triangle", t + 1) + " has a corner nowhere");
      }
    }
  }
  return triangles;
}

// The words of a text, with the line that the last one stands on.
class StlWords {
 public:
  explicit StlWords(std::string_view text) : rest_(text) {}

  // Empty at the end.
  std::string_view Next() {
    while (!rest_.empty() && IsBlank(rest_.front())) Skip();
    std::size_t length = 0;
    while (length < rest_.size() && !IsBlank(rest_[length])) ++length;
    const std::string_view word = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return word;
  }
  void SkipLine() {
    while (!rest_.empty() && rest_.front() != '\n') rest_.remove_prefix(1);
  }
  // Of a message: "line 7: 'vertx'".
  Error Wrong(std::string_view word) const {
    return NoStl("line " + Told("line", line_) + ": '" + Told("word", word.substr(0, 40)) + "'");
  }

 private:
  static bool IsBlank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
  void Skip() {
    if (rest_.front() == '\n') ++line_;
    rest_.remove_prefix(1);
  }

  std::string_view rest_;
  int line_ = 1;
};

// facet := "facet" "normal" x y z "outer" "loop" 3 * ( "vertex" x y z ) "endloop" "endfacet"
Result<std::vector<StlTriangle>> ReadText(std::string_view bytes) {
  StlWords words(bytes);
  std::vector<StlTriangle> triangles;
  StlTriangle open;
  std::size_t corners = 0;
  for (std::string_view word = words.Next(); !word.empty(); word = words.Next()) {
    if (word == "solid" || word == "endsolid") {
      words.SkipLine();  // a name
    } else if (word == "facet") {
      if (const std::string_view next = words.Next(); next != "normal") return words.Wrong(next);
      for (int k = 0; k < 3; ++k) words.Next();
    } else if (word == "vertex") {
      if (corners == 3) return words.Wrong("a fourth vertex");
      for (float& coordinate : open.corners[corners]) {
        const std::string_view text = words.Next();
        const std::optional<double> number = ParseDouble(text);
        if (!number || !std::isfinite(static_cast<float>(*number))) return words.Wrong(text);
        coordinate = static_cast<float>(*number);
      }
      ++corners;
    } else if (word == "endfacet") {
      if (corners != 3) return words.Wrong("fewer than three vertices");
      if (triangles.size() == kStlTrianglesMax) return TooManyTriangles();
      triangles.push_back(open);
      corners = 0;
    } else if (word != "outer" && word != "loop" && word != "endloop") {
      return words.Wrong(word);
    }
  }
  if (corners > 0) return NoStl("it ends inside a triangle");
  return triangles;
}

}  // namespace

Status CheckStlBeginning(std::string_view bytes) {
  if (IsBinaryStl(bytes) || bytes.substr(0, 5) == "solid") return {};
  return NoStl("it neither begins with 'solid' nor is as long as its number of triangles says");
}

Result<std::vector<StlTriangle>> ReadStl(std::string_view bytes) {
  if (const Status begins = CheckStlBeginning(bytes); !begins) return begins.error();
  Result<std::vector<StlTriangle>> triangles =
      IsBinaryStl(bytes) ? ReadBinary(bytes) : ReadText(bytes);
  if (triangles && triangles->empty()) return NoStl("it has no triangle");
  return triangles;
}

}  // namespace rmlcell::simulation
