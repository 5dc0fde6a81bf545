#include "engine/rml1/verdict_rules.h"

#include <array>
#include <chrono>

#include "engine/machine/run_setup.h"

namespace rmlcell::rml1 {
namespace {

using machine::Verdict;
using machine::VerdictRule;

// What the rounding of a post processor makes of nothing.
constexpr double kRounding_mm = 0.01;

constexpr double kBudget_s = 30.0 * 24.0 * 3600.0;
static_assert(machine::RunBudget().virtual_time == std::chrono::hours(24 * 30));

constexpr std::array kRules = {
    VerdictRule{ErrorCode::kRml1NoProgram, "foreign_share", kForeignShareMax_percent, Verdict::kBad,
                "# % of the bytes belong to no command"},
    VerdictRule{ErrorCode::kRml1PositionRefused, "positions_refused", 0.0, Verdict::kBad,
                "coordinates or heights that were refused: #"},
    VerdictRule{
        ErrorCode::kRml1Clipped, "oversize_x", kRounding_mm, Verdict::kBad,
        "the work is # mm longer in X than the travel: wherever its origin is, it does not fit"},
    VerdictRule{
        ErrorCode::kRml1Clipped, "oversize_y", kRounding_mm, Verdict::kBad,
        "the work is # mm longer in Y than the travel: wherever its origin is, it does not fit"},
    VerdictRule{
        ErrorCode::kRml1Clipped, "oversize_z", kRounding_mm, Verdict::kBad,
        "the work is # mm deeper than the travel of Z: wherever its origin is, it does not fit"},
    VerdictRule{ErrorCode::kRml1Clipped, "clipped_cut_length", kRounding_mm, Verdict::kBad,
                "# mm of the work lie beyond the travel and are not cut"},
    VerdictRule{ErrorCode::kRml1Clipped, "clipped_x_low", kRounding_mm, Verdict::kBad,
                "the work leads # mm beyond the least X: move the origin to greater X"},
    VerdictRule{ErrorCode::kRml1Clipped, "clipped_x_high", kRounding_mm, Verdict::kBad,
                "the work leads # mm beyond the greatest X: move the origin to less X"},
    VerdictRule{ErrorCode::kRml1Clipped, "clipped_y_low", kRounding_mm, Verdict::kBad,
                "the work leads # mm beyond the least Y: move the origin to greater Y"},
    VerdictRule{ErrorCode::kRml1Clipped, "clipped_y_high", kRounding_mm, Verdict::kBad,
                "the work leads # mm beyond the greatest Y: move the origin to less Y"},
    VerdictRule{ErrorCode::kRml1Clipped, "move_x_less", kRounding_mm, Verdict::kBad,
                "no work origin in the travel fits: move the program by # mm to less X"},
    VerdictRule{ErrorCode::kRml1Clipped, "move_x_more", kRounding_mm, Verdict::kBad,
                "no work origin in the travel fits: move the program by # mm to greater X"},
    VerdictRule{ErrorCode::kRml1Clipped, "move_y_less", kRounding_mm, Verdict::kBad,
                "no work origin in the travel fits: move the program by # mm to less Y"},
    VerdictRule{ErrorCode::kRml1Clipped, "move_y_more", kRounding_mm, Verdict::kBad,
                "no work origin in the travel fits: move the program by # mm to greater Y"},
    VerdictRule{ErrorCode::kRml1Clipped, "clipped_z_low", kRounding_mm, Verdict::kBad,
                "the work leads # mm below the travel: raise Z0"},
    VerdictRule{ErrorCode::kRml1SpindleStands, "spindle_stands_length", kRounding_mm, Verdict::kBad,
                "# mm in the work while the spindle stands"},
    VerdictRule{ErrorCode::kCellTimeBudget, "least_time", kBudget_s, Verdict::kBad,
                "a run takes #{least_days} days at least, and ends at its budget of 30 days"},
    machine::kWaitsForKey,
    VerdictRule{ErrorCode::kRml1NoClearance, "no_clearance_length", kRounding_mm,
                Verdict::kDoubtful,
                "# mm across at travel speed, not above the surface of the work"},
    VerdictRule{ErrorCode::kRml1Z0Moved, "z0_raised", kRounding_mm, Verdict::kDoubtful,
                "!ZO raises Z0 by # mm: so much less deep is what follows"},
    VerdictRule{ErrorCode::kRml1Z0Moved, "z0_lowered", kRounding_mm, Verdict::kDoubtful,
                "!ZO lowers Z0 by # mm: so much deeper is what follows"},
    VerdictRule{ErrorCode::kRml1StepGuess, "step_fits_at", 0.0, Verdict::kDoubtful,
                "it may be written for # units per mm: the work would be #{step_fits_x} x "
                "#{step_fits_y} x #{step_fits_z} mm there, and would fit"},
    VerdictRule{ErrorCode::kRml1StepGuess, "step_lift", 0.0, Verdict::kDoubtful,
                "it may be written for 40 units per mm: the tool rises # mm above the work, which "
                "would be #{step_lift_at_40} mm there"},
    VerdictRule{ErrorCode::kRml1FastPlunge, "fast_plunge_length", kRounding_mm, Verdict::kDoubtful,
                "# mm down to where the tool cuts, nearly as fast as Z travels"},
    VerdictRule{ErrorCode::kRml1FastAcross, "fast_across_length", kRounding_mm, Verdict::kDoubtful,
                "# mm across in the work, nearly as fast as Z travels, where other cuts take "
                "half of that or less"},
    VerdictRule{ErrorCode::kRml1BelowClamps, "below_clamps_length", kRounding_mm,
                Verdict::kDoubtful,
                "# mm across to the work or from it, lower than the clamps stand"},
    VerdictRule{ErrorCode::kRml1SpeedClamped, "feed_limited_length", kRounding_mm,
                Verdict::kDoubtful,
                "# mm in the work with feed rates that the machine does not have: "
                "#{feed_limited_used} mm/s in place of #{feed_limited_asked}"},
    VerdictRule{ErrorCode::kRml1SpeedClamped, "rpm_limited_length", kRounding_mm,
                Verdict::kDoubtful,
                "# mm in the work with spindle speeds that the machine does not have: "
                "#{rpm_limited_used} rpm in place of #{rpm_limited_asked}"},
    VerdictRule{ErrorCode::kRml1IncompleteCommand, "incomplete_at_end", 0.0, Verdict::kDoubtful,
                "the data ends inside a command: the last one is not carried out"},
    VerdictRule{ErrorCode::kRml1EndsInWork, "depth_at_end", kRounding_mm, Verdict::kDoubtful,
                "the tool stays # mm deep in the work at the end"},
    VerdictRule{ErrorCode::kRml1SpindleLeftOn, "spindle_on_at_end", 0.0, Verdict::kDoubtful,
                "the spindle turns on at the end"},
    VerdictRule{ErrorCode::kRml1FeedNotGiven, "feed_not_given_length", kRounding_mm,
                Verdict::kDoubtful, "# mm in the work at a speed that the program did not set"},
    VerdictRule{ErrorCode::kRml1PlaceAssumed, "place_not_given_length", kRounding_mm,
                Verdict::kDoubtful,
                "# mm in the work at a place that hangs on where the tool stood before"},
    VerdictRule{ErrorCode::kRml1NotUnderstood, "errors", 0.0, Verdict::kDoubtful,
                "places that are no command, or have wrong parameters: #"},
    VerdictRule{ErrorCode::kRml1NotUnderstood, "communication_errors", 0.0, Verdict::kDoubtful,
                "communication errors: #"},
    VerdictRule{ErrorCode::kRml1NothingCut, "nothing_cut", 0.0, Verdict::kDoubtful,
                "nothing is cut: the tool never goes below the surface"},
    VerdictRule{ErrorCode::kRml1NothingCut, "skimmed_length", kRounding_mm, Verdict::kDoubtful,
                "# mm with the tool down and the spindle on, but along the surface: nothing is cut "
                "there"},
};

}  // namespace

std::span<const VerdictRule> VerdictRules() { return kRules; }

}  // namespace rmlcell::rml1
