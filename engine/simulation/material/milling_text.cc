#include "engine/simulation/material/milling_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/number_text.h"
#include "engine/core/units.h"

namespace rmlcell::simulation {
namespace {

std::optional<std::vector<double>> NumbersBetween(std::string_view text, char separator) {
  std::vector<double> numbers;
  for (;;) {
    const std::size_t end = text.find(separator);
    const std::optional<double> number = ParseDouble(text.substr(0, end));
    if (!number) return std::nullopt;
    numbers.push_back(*number);
    if (end == std::string_view::npos) return numbers;
    text.remove_prefix(end + 1);
  }
}

struct ShapeName {
  std::string_view name;
  MillTool::Shape shape;
};
constexpr ShapeName kShapes[] = {
    {"flat", MillTool::Shape::kFlat}, {"end", MillTool::Shape::kFlat},
    {"ball", MillTool::Shape::kBall}, {"vee", MillTool::Shape::kVee},
    {"cone", MillTool::Shape::kVee},  {"engrave", MillTool::Shape::kVee}};
constexpr std::array<std::string_view, 4> kParts = {"flutes", "flute", "shank", "holder"};

// One letter too many, missing, another, or two changed about; of two letters that is no likeness.
bool AreAlike(std::string_view a, std::string_view b) {
  if (a.size() > b.size()) std::swap(a, b);
  if (a.size() < 2 || b.size() - a.size() > 1 || a == b) return false;
  const auto differ = static_cast<std::size_t>(std::ranges::mismatch(a, b).in1 - a.begin());
  const std::string_view rest_a = a.substr(differ);
  const std::string_view rest_b = b.substr(differ);
  if (a.size() < b.size()) return rest_a == rest_b.substr(1);
  if (rest_a.substr(1) == rest_b.substr(1)) return true;
  return rest_a[0] == rest_b[1] && rest_a[1] == rest_b[0] && rest_a.substr(2) == rest_b.substr(2);
}

// "; did you mean flat?"
template <class Names>
Detail Nearest(std::string_view name, const Names& names) {
  for (const auto& one : names) {
    if (AreAlike(name, one)) return "; did you mean " + Told("near", one) + "?";
  }
  return {};
}

// What people call parts, and their names here.
struct OtherName {
  std::string_view said;
  std::string_view part;
};
constexpr OtherName kOtherNames[] = {{"length", "flute=LENGTH"},  {"cut", "flute=LENGTH"},
                                     {"edges", "flutes=NUMBER"},  {"teeth", "flutes=NUMBER"},
                                     {"shaft", "shank=DIAMETER"}, {"collet", "holder=WIDTH@FROM"}};

Detail NearestPart(std::string_view name) {
  for (const OtherName& other : kOtherNames) {
    if (name == other.said || AreAlike(name, other.said))
      return "; did you mean " + Told("near", other.part) + "?";
  }
  return Nearest(name, kParts);
}

// "flutes=2", "flute=12", "shank=6", "holder=20@25": what is wrong with the value; nothing:
// nothing.
std::string_view TakeValue(std::string_view name, std::string_view value, MillTool& tool) {
  if (name == "holder") {
    const auto numbers = NumbersBetween(value, '@');
    if (!numbers || numbers->size() != 2 || !(numbers->front() > 0.0))
      return "write its width and where it begins, holder=20@25";
    tool.holder_radius_mm = 0.5 * numbers->front();
    tool.holder_from_mm = numbers->back();
    return {};
  }
  const std::optional<double> number = ParseDouble(value);
  if (!number || !(*number > 0.0)) return "write a number above 0";
  if (name == "flutes") {
    constexpr double kFlutesMax = 100.0;
    if (*number != std::floor(*number) || *number > kFlutesMax)
      return "write a whole number from 1 to 100";
    tool.flutes = static_cast<int>(*number);
  } else if (name == "flute") {
    tool.flute_mm = *number;
  } else {
    tool.shank_radius_mm = 0.5 * *number;
  }
  return {};
}

// One part behind the measures, and that it comes once. What is wrong; nothing: nothing.
Detail TakePart(std::string_view part, std::vector<std::string_view>& taken, MillTool& tool) {
  const std::size_t equals = part.find('=');
  const std::string_view name = part.substr(0, equals);
  if (std::ranges::find(kParts, name) == kParts.end())
    return "'" + Told("part", part) + "' is no part of a tool" + NearestPart(name);
  if (std::ranges::find(taken, name) != taken.end())
    return "'" + Told("part", part) + "' gives " + Told("name", name) + " again";
  taken.push_back(name);
  if (equals == std::string_view::npos) return "'" + Told("part", part) + "' has no value";
  const std::string_view wrong = TakeValue(name, part.substr(equals + 1), tool);
  return wrong.empty() ? Detail() : "'" + Told("part", part) + "': " + wrong;
}

// Diameter, and of a vee its angle and perhaps the diameter of its tip.
bool TakeMeasures(const std::vector<double>& numbers, MillTool& tool) {
  const bool vee = tool.shape == MillTool::Shape::kVee;
  if (numbers.size() < (vee ? 2U : 1U) || numbers.size() > (vee ? 3U : 1U)) return false;
  tool.radius_mm = 0.5 * numbers[0];
  if (vee) tool.half_angle_rad = 0.5 * numbers[1] * kRadPerDegree;
  if (numbers.size() == 3) tool.tip_radius_mm = 0.5 * numbers[2];
  return true;
}

}  // namespace

Result<Stock> ParseStock(std::string_view text) {
  const Error wrong = InvalidArgument("'" + Told("word", text) +
                                      "' is no block: write 100x80x10, or 100x80x10@-5,-5,2");
  const std::size_t at = text.find('@');
  const auto sizes = NumbersBetween(text.substr(0, at), 'x');
  if (!sizes || sizes->size() != 3) return wrong;
  std::vector<double> corner{0.0, 0.0, 0.0};
  if (at != std::string_view::npos) {
    const auto given = NumbersBetween(text.substr(at + 1), ',');
    if (!given || given->size() < 2 || given->size() > 3) return wrong;
    std::copy(given->begin(), given->end(), corner.begin());
  }
  return Stock{.x_min = corner[0],
               .x_max = corner[0] + (*sizes)[0],
               .y_min = corner[1],
               .y_max = corner[1] + (*sizes)[1],
               .bottom = corner[2] - (*sizes)[2],
               .top = corner[2]};
}

// tool := shape ":" diameter [ ":" angle [ ":" tip ] ] { ":" name "=" value }
Result<MillTool> ParseTool(std::string_view text) {
  // `at`: of what is wrong, so that it is found in a long text.
  const auto wrong = [text](const Detail& what, std::size_t at) {
    return InvalidArgument(
        "'" + Told("word", text) + "' is no tool" +
        (what.empty() ? Detail() : ": at " + Told("column", at + 1) + ", " + what) +
        ": write flat:3, ball:3, vee:6:60 or vee:6:60:0.2, and what is above it "
        "as in flat:3:flutes=2:flute=12:shank=6:holder=20@25");
  };
  const std::size_t colon = text.find(':');
  const std::string_view shape = text.substr(0, colon);
  const auto known = std::ranges::find(kShapes, shape, &ShapeName::name);
  if (known == std::end(kShapes)) {
    std::vector<std::string_view> names;
    for (const ShapeName& one : kShapes) names.push_back(one.name);
    const Detail near = Nearest(shape, names);
    return wrong(near.empty() ? Detail() : "'" + Told("shape", shape) + "' is no shape" + near, 0);
  }
  const std::size_t named = text.find('=');
  const std::size_t end = named == std::string_view::npos ? text.size() : text.rfind(':', named);
  if (end == std::string_view::npos || colon >= end) return wrong({}, 0);
  MillTool tool;
  tool.shape = known->shape;
  const auto numbers = NumbersBetween(text.substr(colon + 1, end - colon - 1), ':');
  if (!numbers || !TakeMeasures(*numbers, tool)) return wrong({}, 0);
  std::vector<std::string_view> taken;
  for (std::size_t at = end; at < text.size();) {
    ++at;
    const std::string_view part = text.substr(at, text.find(':', at) - at);
    if (const Detail what = TakePart(part, taken, tool); !what.empty()) return wrong(what, at);
    at += part.size();
  }
  if (const Status sound = CheckTool(tool); !sound) return sound.error();
  return tool;
}

}  // namespace rmlcell::simulation
