#include "engine/optimo/control/process_watch.h"

#include <array>
#include <string>

namespace rmlcell::optimo {
namespace {

using machine::FigureInfo;
using machine::Verdict;
using machine::VerdictRule;

struct Row {
  FigureInfo info;
  Misdeed ProcessWatchState::*value;
};

constexpr std::array kRows = {
    Row{{"shutter_closed_length", "mm",
         "way along contours with WORK 0 or 1 ON and the shutter closed"},
        &ProcessWatchState::shutter_closed},
    Row{{"beam_off_length", "mm",
         "way along contours with WORK 0 or 1 ON, the shutter open and the beam off"},
        &ProcessWatchState::beam_off},
    Row{{"other_gas_length", "mm",
         "way along contours with the beam on while the assist gas that was asked for is refused"},
        &ProcessWatchState::gas_refused},
    Row{{"no_power_length", "mm", "way along contours with the beam on and no power"},
        &ProcessWatchState::no_power},
    Row{{"ends_with_process", "", "ends of programs with WORK 0 or 1 ON"},
        &ProcessWatchState::left_on},
};

constexpr std::array kInfos = [] {
  std::array<FigureInfo, kRows.size()> infos{};
  for (std::size_t i = 0; i < infos.size(); ++i) infos[i] = kRows[i].info;
  return infos;
}();

// What the rounding of a passage makes of nothing.
constexpr double kRounding_mm = 0.01;

constexpr std::array kRules = {
    VerdictRule{ErrorCode::kCutWithoutShutter, "shutter_closed_length", kRounding_mm, Verdict::kBad,
                "# mm of a process that is ON with the shutter closed"},
    VerdictRule{ErrorCode::kCutWithoutBeam, "beam_off_length", kRounding_mm, Verdict::kBad,
                "# mm of a process that is ON with the beam off"},
    VerdictRule{ErrorCode::kGasConflict, "other_gas_length", kRounding_mm, Verdict::kBad,
                "# mm are cut with another assist gas than the program asks for"},
    VerdictRule{ErrorCode::kCutWithoutPower, "no_power_length", kRounding_mm, Verdict::kDoubtful,
                "# mm with the beam on and no power"},
    VerdictRule{ErrorCode::kWorkActiveAtEnd, "ends_with_process", 0.0, Verdict::kDoubtful,
                "programs that end with the beam's process ON: #"},
};

}  // namespace

void ProcessWatch::OnMotion(const machine::MotionDone& done) {
  if (!(done.programmed_mm_s > 0.0) || done.motion->path.by_sigma()) return;
  const double mm = done.travelled - done.from;
  if (!(mm > 0.0)) return;
  const Beam& beam = actuators_.beam;
  if (done.beam_on) {
    if (actuators_.gas_refused != 0) s_.gas_refused.Add(mm, done.place);
    if (!(done.power.PercentAt(done.programmed_mm_s) > 0.0)) s_.no_power.Add(mm, done.place);
  } else if (beam.asked()) {
    (beam.shutter_open() ? s_.beam_off : s_.shutter_closed).Add(mm, done.place);
  }
}

std::vector<machine::Figure> ProcessWatch::figures() const {
  std::vector<machine::Figure> figures;
  for (const Row& row : kRows) {
    const Misdeed& misdeed = s_.*row.value;
    figures.push_back({.name = std::string(row.info.name),
                       .unit = std::string(row.info.unit),
                       .value = misdeed.amount,
                       .first = misdeed.first});
  }
  return figures;
}

std::span<const FigureInfo> ProcessWatch::FigureTable() { return kInfos; }
std::span<const VerdictRule> ProcessWatch::VerdictRules() { return kRules; }

}  // namespace rmlcell::optimo
