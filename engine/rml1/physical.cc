#include "engine/rml1/physical.h"

namespace rmlcell::rml1 {
namespace {

using machine::Figure;
using machine::MotionUse;

class FigureList {
 public:
  void Add(std::string name, std::string unit, double value) {
    figures_.push_back({std::move(name), std::move(unit), value});
  }
  void Count(std::string name, std::uint64_t value) {
    Add(std::move(name), "", static_cast<double>(value));
  }
  // Nothing where nothing was added: an extent of 0 would be a claim.
  void AddExtent(const std::string& name, const char* low, const char* high, const char* unit,
                 const Extent& extent, double factor = 1.0) {
    if (!extent.known) return;
    Add(name + low, unit, extent.low * factor);
    Add(name + high, unit, extent.high * factor);
  }
  std::vector<Figure> Take() { return std::move(figures_); }

 private:
  std::vector<Figure> figures_;
};

void AddErrors(FigureList& list, const std::string& name, const ErrorLog& log) {
  for (int number = 1; number <= ErrorLog::kNumberMax; ++number) {
    if (log.count(number) > 0) list.Count(name + "." + std::to_string(number), log.count(number));
  }
  list.Count(name, log.total());
  list.Count(name + ".cut", log.cut() ? 1 : 0);
}

void AddProgrammed(FigureList& list, const Programmed& programmed) {
  list.Count("programmed.commands", programmed.commands());
  for (const CommandRow& row : CommandTable()) {
    if (programmed.count(row.op) == 0) continue;
    list.Count("programmed.count." + std::string(row.name), programmed.count(row.op));
  }
  list.Count("programmed.other", programmed.other());
  list.AddExtent("programmed.x", "min", "max", "units", programmed.x());
  list.AddExtent("programmed.y", "min", "max", "units", programmed.y());
  list.AddExtent("programmed.z", "min", "max", "units", programmed.z());
  list.Add("programmed.cut_length", "units", programmed.cut_length());
  list.Add("programmed.travel_length", "units", programmed.travel_length());
}

}  // namespace

void Physical::OnRide(const Ride& ride, const Registers& registers) {
  const bool first_ever = !x_.known;
  const auto add_point = [&](const Point& p) {
    x_.Add(p.x - profile_->origin_x);
    y_.Add(p.y - profile_->origin_y);
    z_.Add(p.z - registers.z0);
    a_.Add(p.a);
  };
  if (first_ever) add_point(ride.from);
  add_point(ride.to);
  if (ride.first) {
    ++motions_;
    if (ride.use == MotionUse::kPlunge) ++plunges_;
  }
  const bool in_work = ride.use == MotionUse::kCut || ride.use == MotionUse::kPlunge;
  (in_work ? cut_mm_ : travel_mm_) += ride.length_mm;
  motion_s_ += ride.time_s;
  AddToState(ride.time_s, registers);
}

void Physical::OnDwell(double time_s, const Registers& registers) {
  dwell_s_ += time_s;
  AddToState(time_s, registers);
}

void Physical::OnSpindleWait(double time_s, const Registers& registers) {
  spindle_s_ += time_s;
  AddToState(time_s, registers);
}

void Physical::AddToState(double time_s, const Registers& registers) {
  (registers.tool_down ? down_s_ : up_s_) += time_s;
}

std::vector<Figure> Physical::Figures(const Device& device) const {
  FigureList list;
  const double mm = 1.0 / profile_->units_per_mm;
  list.Count("commands", device.commands_done());
  list.Count("motions", motions_);
  list.Add("cut_length", "mm", cut_mm_);
  list.Add("travel_length", "mm", travel_mm_);
  list.Count("plunges", plunges_);
  list.Add("time.motion", "s", motion_s_);
  list.Add("time.tool_up", "s", up_s_);
  list.Add("time.tool_down", "s", down_s_);
  list.Add("time.dwell", "s", dwell_s_);
  list.Add("time.spindle", "s", spindle_s_);
  list.Add("time.halted", "s", halted_s_);
  list.AddExtent("box.x", "_min", "_max", "units", x_);
  list.AddExtent("box.y", "_min", "_max", "units", y_);
  list.AddExtent("box.z", "_min", "_max", "units", z_);
  list.AddExtent("box.x", "_min_mm", "_max_mm", "mm", x_, mm);
  list.AddExtent("box.y", "_min_mm", "_max_mm", "mm", y_, mm);
  list.AddExtent("box.z", "_min_mm", "_max_mm", "mm", z_, mm);
  if (profile_->has_rotary) list.AddExtent("box.a", "_min", "_max", "deg", a_);
  list.Add("clipped_length", "mm", device.carriage().clipped_length() * mm);
  list.Count("clipped_sets", device.carriage().clipped_sets());
  list.Count("speed_clamps", device.speeds_limited());
  list.Add("error_register", "", device.command_errors().value());
  list.Add("communication_register", "", device.link_errors().value());
  AddErrors(list, "errors", device.command_errors());
  AddErrors(list, "communication_errors", device.link_errors());
  AddProgrammed(list, device.programmed());
  return list.Take();
}

}  // namespace rmlcell::rml1
