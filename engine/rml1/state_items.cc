#include "engine/rml1/state_items.h"

#include <cmath>
#include <string>
#include <string_view>

#include "engine/core/number_text.h"

namespace rmlcell::rml1 {
namespace {

std::string UnitsText(double value) { return ShortestText(std::round(value * 1e6) / 1e6 + 0.0); }

std::string SettingText(CommandSetting setting) {
  switch (setting) {
    case CommandSetting::kAuto:
      return "auto";
    case CommandSetting::kMode1:
      return "mode 1";
    case CommandSetting::kMode2:
      return "mode 2";
  }
  return {};
}

}  // namespace

std::vector<machine::StateItem> ItemsOf(const Device& device, const Profile& profile,
                                        const ToolNow& tool, std::string_view fitted) {
  using enum machine::StartAction;
  std::vector<machine::StateItem> items = {
      {"pose",
       "X " + UnitsText(tool.at.x) + " Y " + UnitsText(tool.at.y) + " Z " + UnitsText(tool.at.z) +
           " A " + UnitsText(tool.at.a),
       kMove},
      {"spindle", tool.spindle_turns ? "on" : "off", kSwitch},
      {"origin", UnitsText(profile.origin_x) + ", " + UnitsText(profile.origin_y), kAsk},
      {"command set", SettingText(profile.commands.setting), kSet},
      {"pending", std::to_string(device.waiting()) + " bytes", kSet},
      {"tool", std::string(fitted), kAsk},
      {"clamps", std::string(fitted), kAsk}};
  for (const std::string_view name : {"VS", "VZ", "DW", "MC", "RPM", "Z0", "Z1", "Z2", "MODE",
                                      "TOOL", "ERR", "COM", "ESC.M", "ESC.T"}) {
    items.push_back({std::string(name), ReadRegister(device, profile, tool, name)->text,
                     name == "Z0" ? kAsk : kSet});
  }
  // Where the program is, which may be beyond the travel: from the machine's zero, so that another
  // Z0 is one difference and not two.
  const Point& logical = device.carriage().logical();
  items.push_back({"logical",
                   "X " + UnitsText(logical.x) + " Y " + UnitsText(logical.y) + " Z " +
                       UnitsText(logical.z) + " A " + UnitsText(logical.a),
                   kSet});
  return items;
}

}  // namespace rmlcell::rml1
