#include "engine/optimo/control/modal_values.h"

#include <array>
#include <span>
#include <string>
#include <utility>

#include "engine/optimo/language/operands.h"
#include "engine/optimo/language/printer.h"

namespace rmlcell::optimo {
namespace {

std::string RealText(double value) {
  std::string text;
  PrintReal(static_cast<float>(value), text);
  return text;
}

std::string ListText(std::span<const double> values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + RealText(value);
  return "(" + text + ")";
}

// "IL, OA"; of none OFF.
std::string GroupsText(std::uint8_t groups) {
  constexpr std::array kGroups = {std::pair{kGroupIl, "IL"}, std::pair{kGroupOl, "OL"},
                                  std::pair{kGroupIa, "IA"}, std::pair{kGroupOa, "OA"}};
  std::string text;
  for (const auto& [bit, name] : kGroups) {
    if ((groups & bit) != 0) text += (text.empty() ? "" : ", ") + std::string(name);
  }
  return text.empty() ? "OFF" : text;
}

template <class Choice>
std::string WordText(std::span<const Word> words, Choice choice) {
  return std::string(Describe(words[static_cast<std::size_t>(choice)]).text);
}

}  // namespace

std::vector<machine::ModalValue> ModalValuesOf(const Modal& modal) {
  std::string path = WordText(operands::kPathWords, modal.path);
  if (modal.path == PathType::kHole) path += " (" + RealText(modal.hole_radius_mm) + ")";
  return {{"COORD", WordText(operands::kCoordWords, modal.coord)},
          {"PATH", std::move(path)},
          {"SPEED", RealText(modal.speed_percent)},
          {"ACCEL", RealText(modal.accel_percent)},
          {"OVERSH", RealText(modal.oversh_percent)},
          {"UPDATE", GroupsText(modal.updated)},
          {"IMAGE", GroupsText(modal.imaged)}};
}

std::vector<machine::ModalValue> ModalValuesOf(const ToolState& tool,
                                               const WorkOffsetState& offset) {
  const std::array<double, 6> points = {tool.offset.x_mm,  tool.offset.y_mm,  tool.offset.z_mm,
                                        tool.reference[0], tool.reference[1], tool.reference[2]};
  return {{"TCP", ListText(points)}, {"SYSDEF", offset.active ? ListText(offset.values) : "OFF"}};
}

}  // namespace rmlcell::optimo
