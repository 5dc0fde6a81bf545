#include "engine/rml1/figures.h"

#include <algorithm>
#include <array>
#include <optional>

#include "engine/rml1/step_guess.h"

namespace rmlcell::rml1 {
namespace {

struct Source {
  const Device& device;
  const Physical::Totals& tool;
  const CutWatch& watch;
  double mm;     // of one device unit
  Point origin;  // of the work, device units
  WorkFit fit;
  StepGuess step;
  bool rotary;
  std::optional<std::uint64_t> starved;
  bool ended;
};

using Value = std::optional<double>;

double Count(std::uint64_t count) { return static_cast<double>(count); }

// Nothing where nothing was added: an extent of 0 would be a claim.
Value Low(const Extent& extent, double factor = 1.0) {
  return extent.known ? Value(extent.low * factor) : std::nullopt;
}
Value High(const Extent& extent, double factor = 1.0) {
  return extent.known ? Value(extent.high * factor) : std::nullopt;
}
Value Moved(Value value, double by) { return value ? Value(*value + by) : std::nullopt; }
// A check carries a stream out without time: a 0 would be a claim.
Value IfTimed(const Source& s, double seconds) { return s.starved ? Value(seconds) : std::nullopt; }
Value IfAny(std::uint64_t count) { return count > 0 ? Value(Count(count)) : std::nullopt; }

template <int kNumber>
Value Errors(const Source& s) {
  return IfAny(s.device.command_errors().count(kNumber));
}
template <int kNumber>
Value LinkErrors(const Source& s) {
  return IfAny(s.device.link_errors().count(kNumber));
}
template <Op kOp>
Value Commands(const Source& s) {
  return IfAny(s.device.programmed().count(kOp));
}

// How far below the surface the tool stands.
double DepthNow(const Source& s) {
  const double below = s.device.registers().surface_z - s.device.carriage().physical().z;
  return std::max(0.0, below) * s.mm;
}

Value IfFits(const WorkFit::Axis& axis, double value) {
  return axis.fits() ? Value(value) : std::nullopt;
}

// Where it fits from no origin, another figure tells what to do.
Value IfPlaced(const WorkFit::Axis& axis, double value) {
  return axis.over == 0.0 && axis.move == 0.0 ? Value(value) : std::nullopt;
}

// Where !ZO says where Z0 is, it helps little that somebody sets it.
bool Z0Stays(const Source& s) { return s.device.raised().by + s.device.lowered().by == 0.0; }

Value IfAbove0(double value) { return value > 0.0 ? Value(value) : std::nullopt; }

// Where nothing is lost the origin as it is will do, wherever that is.
Value IfLost(const Source& s, double value) {
  return s.device.carriage().lost().length > 0.0 ? IfAbove0(value) : std::nullopt;
}

// Of the work as it would be with the other step.
Value Otherwise(const Source& s, const WorkFit::Axis& axis) {
  return s.step.fits_at > 0.0 ? Value(axis.length) : std::nullopt;
}

// A speed of the machine in place of the one asked for, where that was cut with.
Value IfLimited(const CutWatch::LimitedWay& way, double speed) {
  return way.mm > 0.0 ? Value(speed) : std::nullopt;
}

struct Row {
  machine::FigureInfo info;
  Value (*value)(const Source&);
  CommandPlace (*first)(const Source&) = nullptr;  // the command that was the first to do it
};

// clang-format off
constexpr std::array kRows = {
    Row{{"commands", "", "commands carried out to their end", "commands", "#", true, machine::FigureInfo::Where::kCheck}, [](const Source& s) -> Value { return Count(s.device.commands_done()); }},
    Row{{"motions", "", "motions of the tool", "motions", "#", true, machine::FigureInfo::Where::kCheck}, [](const Source& s) -> Value { return Count(s.tool.motions); }},
    Row{{"cut_length", "mm", "way of the tool in the work: motions that lead below its surface, lifts left out", "path", "cut # mm", true, machine::FigureInfo::Where::kCheck}, [](const Source& s) -> Value { return s.tool.cut_mm; }},
    Row{{"travel_length", "mm", "the rest of its way", "path", "travel # mm", true, machine::FigureInfo::Where::kCheck}, [](const Source& s) -> Value { return s.tool.travel_mm; }},
    Row{{"plunges", "", "times that the tool went down below the surface; steps of one way down are one", "plunges", "#", true, machine::FigureInfo::Where::kCheck}, [](const Source& s) -> Value { return Count(s.tool.plunges); }},
    Row{{"motion_time", "s", "moving"}, [](const Source& s) -> Value { return IfTimed(s, s.tool.motion_s); }},
    Row{{"tool_up_time", "s", "the rest of the time of motions and waits", "tool", "up # s", true}, [](const Source& s) -> Value { return IfTimed(s, s.tool.up_s); }},
    Row{{"tool_down_time", "s", "moving or waiting in the work, or in tool state down", "tool", "down # s", true}, [](const Source& s) -> Value { return IfTimed(s, s.tool.down_s); }},
    Row{{"dwell_time", "s", "waits of W and !DW"}, [](const Source& s) -> Value { return IfTimed(s, s.tool.dwell_s); }},
    Row{{"spindle_time", "s", "waits for the spindle to turn steadily or to stand"}, [](const Source& s) -> Value { return IfTimed(s, s.tool.spindle_s); }},
    Row{{"halted_time", "s", "waits for a key"}, [](const Source& s) -> Value { return IfTimed(s, s.tool.halted_s); }},
    Row{{"lookahead_starved", "", "times that the planner had to decide before it could see enough"}, [](const Source& s) -> Value { return s.starved ? Value(Count(*s.starved)) : std::nullopt; }},
    Row{{"box.xmin", "units", "least X of the tool, work coordinates"}, [](const Source& s) -> Value { return Low(s.tool.x); }},
    Row{{"box.xmax", "units", "greatest X of the tool, work coordinates"}, [](const Source& s) -> Value { return High(s.tool.x); }},
    Row{{"box.ymin", "units", "least Y of the tool, work coordinates"}, [](const Source& s) -> Value { return Low(s.tool.y); }},
    Row{{"box.ymax", "units", "greatest Y of the tool, work coordinates"}, [](const Source& s) -> Value { return High(s.tool.y); }},
    Row{{"box.zmin", "units", "least Z of the tool, work coordinates"}, [](const Source& s) -> Value { return Low(s.tool.z); }},
    Row{{"box.zmax", "units", "greatest Z of the tool, work coordinates"}, [](const Source& s) -> Value { return High(s.tool.z); }},
    Row{{"box_mm.xmin", "mm", "least X of the tool, work coordinates", "X", "from # mm", true, machine::FigureInfo::Where::kCheck}, [](const Source& s) -> Value { return Low(s.tool.x, s.mm); }},
    Row{{"box_mm.xmax", "mm", "greatest X of the tool, work coordinates", "X", "to # mm", true, machine::FigureInfo::Where::kCheck}, [](const Source& s) -> Value { return High(s.tool.x, s.mm); }},
    Row{{"box_mm.ymin", "mm", "least Y of the tool, work coordinates", "Y", "from # mm", true, machine::FigureInfo::Where::kCheck}, [](const Source& s) -> Value { return Low(s.tool.y, s.mm); }},
    Row{{"box_mm.ymax", "mm", "greatest Y of the tool, work coordinates", "Y", "to # mm", true, machine::FigureInfo::Where::kCheck}, [](const Source& s) -> Value { return High(s.tool.y, s.mm); }},
    Row{{"box_mm.zmin", "mm", "least Z of the tool, work coordinates", "Z", "from # mm", true, machine::FigureInfo::Where::kCheck}, [](const Source& s) -> Value { return Low(s.tool.z, s.mm); }},
    Row{{"box_mm.zmax", "mm", "greatest Z of the tool, work coordinates", "Z", "to # mm", true, machine::FigureInfo::Where::kCheck}, [](const Source& s) -> Value { return High(s.tool.z, s.mm); }},
    Row{{"machine_mm.xmin", "mm", "the same, machine coordinates", "machine X", "from # mm", true, machine::FigureInfo::Where::kCheckMachine}, [](const Source& s) -> Value { return Moved(Low(s.tool.x, s.mm), s.origin.x * s.mm); }},
    Row{{"machine_mm.xmax", "mm", "the same, machine coordinates", "machine X", "to # mm", true, machine::FigureInfo::Where::kCheckMachine}, [](const Source& s) -> Value { return Moved(High(s.tool.x, s.mm), s.origin.x * s.mm); }},
    Row{{"machine_mm.ymin", "mm", "the same, machine coordinates", "machine Y", "from # mm", true, machine::FigureInfo::Where::kCheckMachine}, [](const Source& s) -> Value { return Moved(Low(s.tool.y, s.mm), s.origin.y * s.mm); }},
    Row{{"machine_mm.ymax", "mm", "the same, machine coordinates", "machine Y", "to # mm", true, machine::FigureInfo::Where::kCheckMachine}, [](const Source& s) -> Value { return Moved(High(s.tool.y, s.mm), s.origin.y * s.mm); }},
    Row{{"machine_mm.zmin", "mm", "the same, machine coordinates", "machine Z", "from # mm", true, machine::FigureInfo::Where::kCheckMachine}, [](const Source& s) -> Value { return Moved(Low(s.tool.z, s.mm), s.origin.z * s.mm); }},
    Row{{"machine_mm.zmax", "mm", "the same, machine coordinates", "machine Z", "to # mm", true, machine::FigureInfo::Where::kCheckMachine}, [](const Source& s) -> Value { return Moved(High(s.tool.z, s.mm), s.origin.z * s.mm); }},
    Row{{"origin.xmin", "mm", "least X of the work origin on the machine so that the work fits its travel", "origin X", "may be from # mm", true, machine::FigureInfo::Where::kBoth}, [](const Source& s) -> Value { return IfFits(s.fit.x, s.fit.x.low); }},
    Row{{"origin.xmax", "mm", "greatest such X", "origin X", "to # mm", true, machine::FigureInfo::Where::kBoth}, [](const Source& s) -> Value { return IfFits(s.fit.x, s.fit.x.high); }},
    Row{{"origin.ymin", "mm", "least Y of the work origin on the machine so that the work fits its travel", "origin Y", "may be from # mm", true, machine::FigureInfo::Where::kBoth}, [](const Source& s) -> Value { return IfFits(s.fit.y, s.fit.y.low); }},
    Row{{"origin.ymax", "mm", "greatest such Y", "origin Y", "to # mm", true, machine::FigureInfo::Where::kBoth}, [](const Source& s) -> Value { return IfFits(s.fit.y, s.fit.y.high); }},
    Row{{"origin.zmin", "mm", "least Z of the work origin on the machine (Z0) so that the work fits its travel, and the lowest lift too", "origin Z", "may be from # mm", true, machine::FigureInfo::Where::kBoth}, [](const Source& s) -> Value { return Z0Stays(s) ? IfFits(s.fit.z, s.fit.z.low) : std::nullopt; }},
    Row{{"origin.zmax", "mm", "greatest such Z", "origin Z", "to # mm", true, machine::FigureInfo::Where::kBoth}, [](const Source& s) -> Value { return Z0Stays(s) ? IfFits(s.fit.z, s.fit.z.high) : std::nullopt; }},
    Row{{"move_x_less", "mm", "where no work origin in the travel makes it fit: how far the program has to move to less X", "origin X", "none fits; the program has to move # mm to less X", false, machine::FigureInfo::Where::kBoth}, [](const Source& s) -> Value { return IfLost(s, -s.fit.x.move); }},
    Row{{"move_x_more", "mm", "how far to greater X", "origin X", "none fits; the program has to move # mm to greater X", false, machine::FigureInfo::Where::kBoth}, [](const Source& s) -> Value { return IfLost(s, s.fit.x.move); }},
    Row{{"move_y_less", "mm", "how far to less Y", "origin Y", "none fits; the program has to move # mm to less Y", false, machine::FigureInfo::Where::kBoth}, [](const Source& s) -> Value { return IfLost(s, -s.fit.y.move); }},
    Row{{"move_y_more", "mm", "how far to greater Y", "origin Y", "none fits; the program has to move # mm to greater Y", false, machine::FigureInfo::Where::kBoth}, [](const Source& s) -> Value { return IfLost(s, s.fit.y.move); }},
    Row{{"oversize_x", "mm", "by how much the work is larger than the travel of X"}, [](const Source& s) -> Value { return s.fit.x.over; }},
    Row{{"oversize_y", "mm", "by how much it is larger than the travel of Y"}, [](const Source& s) -> Value { return s.fit.y.over; }},
    Row{{"oversize_z", "mm", "by how much it is deeper than the travel of Z"}, [](const Source& s) -> Value { return s.fit.z.over; }},
    Row{{"step_fits_at", "", "units in a millimetre at which work fits that is too large for the travel as it is: the program may be written for such a machine"}, [](const Source& s) -> Value { return s.step.fits_at; }},
    Row{{"step_fits_x", "mm", "length in X that the work would have there"}, [](const Source& s) -> Value { return Otherwise(s, s.step.work.x); }},
    Row{{"step_fits_y", "mm", "length in Y that it would have there"}, [](const Source& s) -> Value { return Otherwise(s, s.step.work.y); }},
    Row{{"step_fits_z", "mm", "depth that it would have there"}, [](const Source& s) -> Value { return Otherwise(s, s.step.work.z); }},
    Row{{"step_lift", "mm", "with 100 units in a millimetre: how high the tool rises at most above the surface, where that is 0.2 to 0.4 mm, or less than 1 mm with heights that are round with 40"}, [](const Source& s) -> Value { return IfAbove0(s.step.lift_mm); }},
    Row{{"step_lift_at_40", "mm", "how high that would be with 40 units in a millimetre"}, [](const Source& s) -> Value { return IfAbove0(s.step.lift_there_mm); }},
    Row{{"box.amin", "deg", "least angle of the rotary axis"}, [](const Source& s) -> Value { return s.rotary ? Low(s.tool.a) : std::nullopt; }},
    Row{{"box.amax", "deg", "greatest angle of the rotary axis"}, [](const Source& s) -> Value { return s.rotary ? High(s.tool.a) : std::nullopt; }},
    Row{{"clipped_length", "mm", "programmed way beyond the cutting range", "clipped", "# mm beyond the cutting range", false, machine::FigureInfo::Where::kBoth}, [](const Source& s) -> Value { return s.device.carriage().clipped_length() * s.mm; }},
    Row{{"clipped_sets", "", "coordinate sets that led beyond it"}, [](const Source& s) -> Value { return Count(s.device.carriage().clipped_sets()); }},
    Row{{"clipped_cut_length", "mm", "the part of that which would have been in the work"}, [](const Source& s) -> Value { return s.device.carriage().lost().length * s.mm; }, [](const Source& s) { return s.device.first_lost(); }},
    Row{{"clipped_x_low", "mm", "how far the work leads beyond the least X of the travel; of work that fits from another origin, as the next four"}, [](const Source& s) -> Value { return IfPlaced(s.fit.x, s.device.carriage().lost().x_low * s.mm); }},
    Row{{"clipped_x_high", "mm", "how far it leads beyond the greatest X"}, [](const Source& s) -> Value { return IfPlaced(s.fit.x, s.device.carriage().lost().x_high * s.mm); }},
    Row{{"clipped_y_low", "mm", "how far it leads beyond the least Y"}, [](const Source& s) -> Value { return IfPlaced(s.fit.y, s.device.carriage().lost().y_low * s.mm); }},
    Row{{"clipped_y_high", "mm", "how far it leads beyond the greatest Y"}, [](const Source& s) -> Value { return IfPlaced(s.fit.y, s.device.carriage().lost().y_high * s.mm); }},
    Row{{"clipped_z_low", "mm", "how far it leads below the travel"}, [](const Source& s) -> Value { return s.fit.z.over > 0.0 ? std::nullopt : Value(s.device.carriage().lost().z_low * s.mm); }},
    Row{{"positions_refused", "", "coordinates and tool heights that were refused: the tool does not go where the program says"}, [](const Source& s) -> Value { return Count(s.device.positions_refused()); }, [](const Source& s) { return s.device.first_refused(); }},
    Row{{"foreign_share", "%", "bytes that belong to no command; of 256 at least where no more than a word or a quarter is foreign"}, [](const Source& s) -> Value { return s.device.foreign_percent(); }},
    Row{{"spindle_stands_length", "mm", "way in the work while the spindle stands"}, [](const Source& s) -> Value { return s.watch.spindle_stands().mm; }, [](const Source& s) { return s.watch.spindle_stands().first; }},
    Row{{"no_clearance_length", "mm", "way across at travel speed, not above the surface of the work; and along it with a V of 80 % of the speed at which Z travels or more, where the cuts before and behind have half of that or less"}, [](const Source& s) -> Value { return s.watch.no_clearance().mm; }, [](const Source& s) { return s.watch.no_clearance().first; }},
    Row{{"feed_not_given_length", "mm", "way in the work at a speed that the program did not set"}, [](const Source& s) -> Value { return s.watch.feed_not_given().mm; }, [](const Source& s) { return s.watch.feed_not_given().first; }},
    Row{{"place_not_given_length", "mm", "way in the work from a place that no command gave: it hangs on where the tool stood before"}, [](const Source& s) -> Value { return s.watch.place_not_given().mm; }, [](const Source& s) { return s.watch.place_not_given().first; }},
    Row{{"assumed_absolute", "", "first command with coordinates, before one says whether they are absolute; 0: none", "assumed", "coordinates are absolute (command #)", false, machine::FigureInfo::Where::kBoth}, [](const Source& s) -> Value { return Count(s.device.assumed().mode.number); }},
    Row{{"assumed_heights", "", "first command that goes to Z1 or Z2 before one sets them; 0: none", "assumed", "Z1 and Z2 of the machine (command #)", false, machine::FigureInfo::Where::kBoth}, [](const Source& s) -> Value { return Count(s.device.assumed().heights.number); }},
    Row{{"assumed_rotation", "", "first command in the work before one says whether the spindle may turn; 0: none", "assumed", "the spindle may turn (command #)", false, machine::FigureInfo::Where::kBoth}, [](const Source& s) -> Value { return Count(s.watch.rotation_not_given().first.number); }},
    Row{{"assumed_cleared", "", "first command that goes down below the surface, and deeper than the program has cut before, nearly as fast as Z travels and slows down before it cuts; 0: none", "assumed", "an earlier cut has cleared the way down (command #)", false, machine::FigureInfo::Where::kBoth}, [](const Source& s) -> Value { return Count(s.watch.taken_for_cleared().first.number); }},
    Row{{"z0_raised", "mm", "how far !ZO takes Z0 above where it was before the program: there is the surface of the work", "Z0", "raised by # mm by !ZO", false, machine::FigureInfo::Where::kBoth}, [](const Source& s) -> Value { return s.device.raised().by * s.mm; }, [](const Source& s) { return s.device.raised().at; }},
    Row{{"z0_lowered", "mm", "how far !ZO takes it below that", "Z0", "lowered by # mm by !ZO", false, machine::FigureInfo::Where::kBoth}, [](const Source& s) -> Value { return s.device.lowered().by * s.mm; }, [](const Source& s) { return s.device.lowered().at; }},
    Row{{"fast_plunge_length", "mm", "way straight or steeply down below the surface, at 80 % of the speed at which Z travels or more, to where the tool cuts or turns back"}, [](const Source& s) -> Value { return s.watch.fast_plunge().mm; }, [](const Source& s) { return s.watch.fast_plunge().first; }},
    Row{{"fast_across_length", "mm", "way across below the surface with a V of 80 % of the speed at which Z travels or more, where other cuts of the same visit to the work, or of the program where the tool goes in as fast, have half of that or less"}, [](const Source& s) -> Value { return s.watch.fast_across().mm; }, [](const Source& s) { return s.watch.fast_across().first; }},
    Row{{"below_clamps_length", "mm", "way across, lower than the clamps, to the first cut and from the last one"}, [](const Source& s) -> Value { return s.watch.below_clamps().mm; }, [](const Source& s) { return s.watch.below_clamps().first; }},
    Row{{"feed_limited_length", "mm", "way in the work at a speed of the machine in place of one that it does not have"}, [](const Source& s) -> Value { return s.watch.feed_limited().mm; }, [](const Source& s) { return s.watch.feed_limited().first; }},
    Row{{"feed_limited_asked", "mm/s", "of these the speed asked for that is furthest from what it became"}, [](const Source& s) -> Value { return IfLimited(s.watch.feed_limited(), s.watch.feed_limited().worst.asked); }},
    Row{{"feed_limited_used", "mm/s", "what that one became"}, [](const Source& s) -> Value { return IfLimited(s.watch.feed_limited(), s.watch.feed_limited().worst.used); }},
    Row{{"rpm_limited_length", "mm", "way in the work with a spindle speed of the machine in place of one that it does not have"}, [](const Source& s) -> Value { return s.watch.rpm_limited().mm; }, [](const Source& s) { return s.watch.rpm_limited().first; }},
    Row{{"rpm_limited_asked", "rpm", "of these the spindle speed asked for that is furthest from what it became"}, [](const Source& s) -> Value { return IfLimited(s.watch.rpm_limited(), s.watch.rpm_limited().worst.asked); }},
    Row{{"rpm_limited_used", "rpm", "what that one became"}, [](const Source& s) -> Value { return IfLimited(s.watch.rpm_limited(), s.watch.rpm_limited().worst.used); }},
    Row{{"depth_at_end", "mm", "how far below the surface the tool stands at the end"}, [](const Source& s) -> Value { return s.ended ? Value(DepthNow(s)) : std::nullopt; }},
    Row{{"spindle_on_at_end", "", "1 when the spindle turns at the end"}, [](const Source& s) -> Value { return s.ended ? Value(s.device.spindle_turns() ? 1.0 : 0.0) : std::nullopt; }},
    Row{{"incomplete_at_end", "", "1 when the data ends inside a command, which is not carried out"}, [](const Source& s) -> Value { return s.ended ? Value(s.device.pending() ? 1.0 : 0.0) : std::nullopt; }},
    Row{{"skimmed_length", "mm", "way with the tool down and the spindle on along the surface, where nothing is cut, of a program that cuts elsewhere"}, [](const Source& s) -> Value { return s.tool.cut_mm > 0.0 ? s.watch.skims().mm : 0.0; }, [](const Source& s) { return s.watch.skims().first; }},
    Row{{"nothing_cut", "", "1 when the tool never was below the surface; with the spindle off and strokes along the surface it is a pen, and this 0"}, [](const Source& s) -> Value { return s.ended ? Value(s.tool.cut_mm + s.tool.drawn_mm > 0.0 ? 0.0 : 1.0) : std::nullopt; }},
    Row{{"speed_clamps", "", "speed words beyond the machine", "speeds", "# limited to those of the machine", false, machine::FigureInfo::Where::kBoth}, [](const Source& s) -> Value { return Count(s.device.speeds_limited()); }},
    Row{{"error_register", "", "command error register"}, [](const Source& s) -> Value { return static_cast<double>(s.device.command_errors().value()); }},
    Row{{"communication_register", "", "communication error register"}, [](const Source& s) -> Value { return static_cast<double>(s.device.link_errors().value()); }},
    Row{{"errors", "", "command errors"}, [](const Source& s) -> Value { return Count(s.device.command_errors().total()); }},
    Row{{"errors.1", "", "command errors 1"}, Errors<1>},
    Row{{"errors.2", "", "command errors 2"}, Errors<2>},
    Row{{"errors.3", "", "command errors 3"}, Errors<3>},
    Row{{"errors.cut", "", "1 when the error log was full and later ones were only counted"}, [](const Source& s) -> Value { return s.device.command_errors().cut() ? 1.0 : 0.0; }},
    Row{{"communication_errors", "", "communication errors"}, [](const Source& s) -> Value { return Count(s.device.link_errors().total()); }},
    Row{{"communication_errors.11", "", "communication errors 11"}, LinkErrors<11>},
    Row{{"communication_errors.12", "", "communication errors 12"}, LinkErrors<12>},
    Row{{"communication_errors.13", "", "communication errors 13"}, LinkErrors<13>},
    Row{{"communication_errors.14", "", "communication errors 14"}, LinkErrors<14>},
    Row{{"communication_errors.15", "", "communication errors 15"}, LinkErrors<15>},
    Row{{"communication_errors.16", "", "communication errors 16"}, LinkErrors<16>},
    Row{{"communication_errors.cut", "", "1 when their log was full"}, [](const Source& s) -> Value { return s.device.link_errors().cut() ? 1.0 : 0.0; }},
    Row{{"programmed.commands", "", "commands of the program, without ^"}, [](const Source& s) -> Value { return Count(s.device.programmed().commands()); }},
    Row{{"programmed.count.D", "", "commands D"}, Commands<Op::kD>},
    Row{{"programmed.count.F", "", "commands F"}, Commands<Op::kF>},
    Row{{"programmed.count.H", "", "commands H"}, Commands<Op::kH>},
    Row{{"programmed.count.I", "", "commands I"}, Commands<Op::kI>},
    Row{{"programmed.count.M", "", "commands M"}, Commands<Op::kM>},
    Row{{"programmed.count.R", "", "commands R"}, Commands<Op::kR>},
    Row{{"programmed.count.V", "", "commands V"}, Commands<Op::kV>},
    Row{{"programmed.count.W", "", "commands W"}, Commands<Op::kW>},
    Row{{"programmed.count.Z", "", "commands Z"}, Commands<Op::kZ>},
    Row{{"programmed.count.@", "", "commands @"}, Commands<Op::kAt>},
    Row{{"programmed.count.^", "", "calls ^"}, Commands<Op::kCall>},
    Row{{"programmed.count.DF", "", "commands DF"}, Commands<Op::kDF>},
    Row{{"programmed.count.IN", "", "commands IN"}, Commands<Op::kIN>},
    Row{{"programmed.count.PA", "", "commands PA"}, Commands<Op::kPA>},
    Row{{"programmed.count.PD", "", "commands PD"}, Commands<Op::kPD>},
    Row{{"programmed.count.PR", "", "commands PR"}, Commands<Op::kPR>},
    Row{{"programmed.count.PU", "", "commands PU"}, Commands<Op::kPU>},
    Row{{"programmed.count.VS", "", "commands VS"}, Commands<Op::kVS>},
    Row{{"programmed.count.!DW", "", "commands !DW"}, Commands<Op::kDW>},
    Row{{"programmed.count.!MC", "", "commands !MC"}, Commands<Op::kMC>},
    Row{{"programmed.count.!NR", "", "commands !NR"}, Commands<Op::kNR>},
    Row{{"programmed.count.!PZ", "", "commands !PZ"}, Commands<Op::kPZ>},
    Row{{"programmed.count.!RC", "", "commands !RC"}, Commands<Op::kRC>},
    Row{{"programmed.count.!VZ", "", "commands !VZ"}, Commands<Op::kVZ>},
    Row{{"programmed.count.!ZM", "", "commands !ZM"}, Commands<Op::kZM>},
    Row{{"programmed.count.!ZO", "", "commands !ZO"}, Commands<Op::kZO>},
    Row{{"programmed.count.!ZZ", "", "commands !ZZ"}, Commands<Op::kZZ>},
    Row{{"programmed.count.!ZE", "", "commands !ZE"}, Commands<Op::kZE>},
    Row{{"programmed.count.J", "", "commands J"}, Commands<Op::kToolChange>},
    Row{{"programmed.count.!CO", "", "commands !CO"}, Commands<Op::kVendorCO>},
    Row{{"programmed.count.!SL", "", "commands !SL"}, Commands<Op::kVendorSL>},
    Row{{"programmed.count.!SP", "", "commands !SP"}, Commands<Op::kVendorSP>},
    Row{{"programmed.count.!RD", "", "commands !RD"}, Commands<Op::kVendorRD>},
    Row{{"programmed.count.!1", "", "commands !1"}, Commands<Op::kVendorOne>},
    Row{{"programmed.count.!0", "", "commands !0"}, Commands<Op::kVendorZero>},
    Row{{"programmed.other", "", "statements that are no command"}, [](const Source& s) -> Value { return Count(s.device.programmed().other()); }},
    Row{{"programmed.xmin", "units", "least X that the program asks for"}, [](const Source& s) -> Value { return Low(s.device.programmed().x()); }},
    Row{{"programmed.xmax", "units", "greatest X that the program asks for"}, [](const Source& s) -> Value { return High(s.device.programmed().x()); }},
    Row{{"programmed.ymin", "units", "least Y that the program asks for"}, [](const Source& s) -> Value { return Low(s.device.programmed().y()); }},
    Row{{"programmed.ymax", "units", "greatest Y that the program asks for"}, [](const Source& s) -> Value { return High(s.device.programmed().y()); }},
    Row{{"programmed.zmin", "units", "least Z that the program asks for"}, [](const Source& s) -> Value { return Low(s.device.programmed().z()); }},
    Row{{"programmed.zmax", "units", "greatest Z that the program asks for"}, [](const Source& s) -> Value { return High(s.device.programmed().z()); }},
    Row{{"programmed.cut_length", "units", "way asked for with an end below Z 0, or in X and Y with the tool down"}, [](const Source& s) -> Value { return s.device.programmed().cut_length(); }},
    Row{{"programmed.travel_length", "units", "the rest of the way asked for"}, [](const Source& s) -> Value { return s.device.programmed().travel_length(); }},
};
// clang-format on

}  // namespace

std::span<const machine::FigureInfo> FigureTable() {
  static const auto infos = [] {
    std::array<machine::FigureInfo, kRows.size()> made;
    for (std::size_t i = 0; i < kRows.size(); ++i) made[i] = kRows[i].info;
    return made;
  }();
  return infos;
}

std::vector<machine::Figure> FiguresOf(const Device& device, const Physical& physical, bool ended,
                                       std::optional<std::uint64_t> starved) {
  const Profile& profile = physical.profile();
  const Point origin{profile.origin_x, profile.origin_y, device.registers().surface_z, 0.0};
  const CuttingRange& travel = device.carriage().range();
  const WorkFit fit = FitOf(physical.totals().work, device.carriage().lost(), origin, travel,
                            device.programmed().lowest_lift(), profile.units_per_mm);
  const Source source{
      .device = device,
      .tool = physical.totals(),
      .watch = physical.watch(),
      .mm = 1.0 / profile.units_per_mm,
      .origin = origin,
      .fit = fit,
      .step = GuessStep(fit, travel, {device.programmed().z(), device.programmed().z_grain()},
                        profile.units_per_mm),
      .rotary = profile.has_rotary,
      .starved = starved,
      .ended = ended};
  std::vector<machine::Figure> figures;
  for (const Row& row : kRows) {
    const Value value = row.value(source);
    if (!value) continue;
    machine::Figure figure{std::string(row.info.name), std::string(row.info.unit), *value};
    if (row.first != nullptr && *value > 0.0) {
      const CommandPlace first = row.first(source);
      figure.first.step = static_cast<int>(first.number);
      figure.first.byte_offset = first.offset;
    }
    figures.push_back(std::move(figure));
  }
  return figures;
}

void PlaceFigures(std::string_view stream, const machine::BytesKeeper* keeper, int program,
                  std::vector<machine::Figure>& figures) {
  std::vector<machine::Figure*> placed;
  for (machine::Figure& figure : figures) {
    if (figure.first.step != 0) placed.push_back(&figure);
  }
  std::ranges::sort(placed, {}, [](const machine::Figure* one) { return one->first.byte_offset; });
  LineCounter lines;
  std::int64_t read = 0;
  for (machine::Figure* figure : placed) {
    constexpr auto kPart = static_cast<std::int64_t>(machine::kReleaseEvery);
    for (; figure->first.byte_offset - read > kPart; read += kPart) {
      lines.At(stream, read + kPart, 0);
      if (keeper != nullptr) keeper->Release();
    }
    figure->first.program = program;
    figure->first.line = lines.At(stream, figure->first.byte_offset, 0).line;
  }
}

}  // namespace rmlcell::rml1
