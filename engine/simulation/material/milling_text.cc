#include "engine/simulation/material/milling_text.h"

#include <cmath>
#include <optional>
#include <string>
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

// "flutes=2", "flute=12", "shank=6", "holder=20@25"; false: it is none of them.
bool TakeShankPart(std::string_view part, MillTool& tool) {
  const std::size_t equals = part.find('=');
  const std::string_view name = part.substr(0, equals);
  const std::string_view value = part.substr(equals + 1);
  if (name == "holder") {
    const auto numbers = NumbersBetween(value, '@');
    if (!numbers || numbers->size() != 2 || !(numbers->front() > 0.0)) return false;
    tool.holder_radius_mm = 0.5 * numbers->front();
    tool.holder_from_mm = numbers->back();
    return true;
  }
  const std::optional<double> number = ParseDouble(value);
  if (!number || !(*number > 0.0)) return false;
  if (name == "flutes") {
    constexpr double kFlutesMax = 100.0;
    if (*number != std::floor(*number) || *number > kFlutesMax) return false;
    tool.flutes = static_cast<int>(*number);
  } else if (name == "flute") {
    tool.flute_mm = *number;
  } else if (name == "shank") {
    tool.shank_radius_mm = 0.5 * *number;
  } else {
    return false;
  }
  return true;
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
  const Error wrong = InvalidArgument("'" + std::string(text) +
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
  const Error wrong = InvalidArgument(
      "'" + std::string(text) +
      "' is no tool: write flat:3, ball:3, vee:6:60 or vee:6:60:0.2, and what is above it as in "
      "flat:3:flutes=2:flute=12:shank=6:holder=20@25");
  const std::size_t named = text.find('=');
  const std::size_t end = named == std::string_view::npos ? text.size() : text.rfind(':', named);
  const std::size_t colon = text.find(':');
  if (end == std::string_view::npos || colon >= end) return wrong;
  MillTool tool;
  bool known = false;
  for (const ShapeName& one : kShapes) {
    if (one.name != text.substr(0, colon)) continue;
    tool.shape = one.shape;
    known = true;
  }
  const auto numbers = NumbersBetween(text.substr(colon + 1, end - colon - 1), ':');
  if (!known || !numbers || !TakeMeasures(*numbers, tool)) return wrong;
  for (std::string_view rest = text.substr(end); !rest.empty();) {
    rest.remove_prefix(1);
    const std::string_view part = rest.substr(0, rest.find(':'));
    if (!TakeShankPart(part, tool)) return wrong;
    rest.remove_prefix(part.size());
  }
  if (const Status sound = CheckTool(tool); !sound) return sound.error();
  return tool;
}

}  // namespace rmlcell::simulation
