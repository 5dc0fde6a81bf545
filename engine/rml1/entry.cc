#include "engine/rml1/entry.h"

#include <algorithm>
#include <cstdint>

#include "engine/core/number_text.h"
#include "engine/motion/geometry/path.h"
#include "engine/rml1/carriage.h"

namespace rmlcell::rml1 {
namespace {

// Which command begins at a byte.
class CommandFinder final : public DeviceListener {
 public:
  explicit CommandFinder(std::int64_t byte_offset) : byte_offset_(byte_offset) {}

  void OnReading(const Reading& reading, const CommandReader& reader,
                 std::int64_t /*offset*/) override {
    if (reading.kind == Reading::Kind::kCall) called_ = true;
    if (reading.kind != Reading::Kind::kCommand) return;
    const bool called = called_;
    called_ = false;
    ++number_;
    passed_ = reader.command_offset() > byte_offset_;
    if (reader.command_offset() <= byte_offset_) before_ = number_;
    if (reader.command_offset() == byte_offset_ && !called) found_ = number_;
  }

  int found() const { return found_; }
  int before() const { return before_; }
  bool passed() const { return passed_ || found_ > 0; }

 private:
  const std::int64_t byte_offset_;
  int number_ = 0;
  int before_ = 0;  // the last one that does not begin behind it
  int found_ = 0;
  bool called_ = false;
  bool passed_ = false;
};

}  // namespace

std::string_view NameOfApproach(const Action& motion) { return motion.rapid ? "PU" : "PD"; }

std::vector<Action> PlanEntry(const Profile& profile, const Registers& there, bool spindle_turns,
                              const Point& from, const Point& to) {
  std::vector<Action> actions;
  Point at = from;
  const auto go = [&](const Point& next, bool rapid) {
    if (SamePoint(at, next, motion::kTipLengthZero_mm * profile.units_per_mm)) return;
    Action& made = actions.emplace_back();
    made.to = next;
    made.rapid = rapid;
    made.speed_mm_s = LimitedSpeed(profile, at, next, rapid ? profile.travel_speed : there.z_speed);
    at = next;
  };
  go({from.x, from.y, profile.z.high, from.a}, true);
  go({to.x, to.y, profile.z.high, to.a}, true);
  if (spindle_turns && there.rotation) {
    Action& start = actions.emplace_back();
    start.kind = Action::Kind::kSpindleStart;
    start.rpm = there.rpm;
  }
  go(to, false);
  return actions;
}

std::vector<machine::OutOfTravel> OutsideOf(const Profile& profile, const Point& at) {
  std::vector<machine::OutOfTravel> outside;
  const auto look = [&](int axis, double value, const Travel& travel) {
    const double excess = std::max(travel.low - value, value - travel.high) / profile.units_per_mm;
    if (excess > motion::kTipLengthZero_mm)
      outside.push_back({.axis = axis, .excess = excess, .at_target = true});
  };
  look(0, at.x, profile.x);
  look(1, at.y, profile.y);
  look(2, at.z, profile.z);
  return outside;
}

Result<int> CommandAt(std::string_view stream, std::int64_t byte_offset, Device device) {
  CommandFinder finder(byte_offset);
  for (std::size_t at = 0; at < stream.size() && !finder.passed(); ++at) {
    device.Receive(static_cast<unsigned char>(stream[at]), static_cast<std::int64_t>(at), finder);
    for (;;) {  // whatever it does, nothing of it is carried out here
      while (!device.actions().empty()) device.actions().Pop();
      if (!device.Step(finder)) break;
    }
  }
  if (finder.found() > 0) return finder.found();
  return Error{ErrorCode::kCellStepUnreachable,
               "byte " + Told("byte", byte_offset) + " lies inside of command " +
                   Told("step", finder.before()) +
                   " or of a call or ESC sequence: a run begins with a whole command",
               {}};
}

}  // namespace rmlcell::rml1
