#include "engine/simulation/material/milling_text.h"

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

Result<MillTool> ParseTool(std::string_view text) {
  const Error wrong = InvalidArgument(
      "'" + std::string(text) + "' is no tool: write flat:3, ball:3, vee:6:60 or vee:6:60:0.2");
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return wrong;
  const std::string_view shape = text.substr(0, colon);
  const auto numbers = NumbersBetween(text.substr(colon + 1), ':');
  if (!numbers) return wrong;
  MillTool tool{.radius_mm = 0.5 * numbers->front()};
  if ((shape == "flat" || shape == "ball") && numbers->size() == 1) {
    tool.shape = shape == "flat" ? MillTool::Shape::kFlat : MillTool::Shape::kBall;
  } else if (shape == "vee" && (numbers->size() == 2 || numbers->size() == 3)) {
    tool.shape = MillTool::Shape::kVee;
    tool.half_angle_rad = 0.5 * (*numbers)[1] * kRadPerDegree;
    if (numbers->size() == 3) tool.tip_radius_mm = 0.5 * (*numbers)[2];
  } else {
    return wrong;
  }
  if (Status sound = CheckTool(tool); !sound) return sound.error();
  return tool;
}

}  // namespace rmlcell::simulation
