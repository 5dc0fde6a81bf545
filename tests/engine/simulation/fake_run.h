#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/machine/family.h"
#include "engine/machine/observer.h"
#include "engine/machine/run.h"
#include "engine/motion/planner/planner.h"
#include "tests/engine/motion/standard_machine.h"

// A run that does what a test scripts, through the same observer that real machines use.
namespace rmlcell::simulation {

inline constexpr motion::PathLimits kSlowLimits{
    .speed = 50.0, .acceleration = 2000.0, .jerk = 40000.0};

// A motion planned from rest to rest.
inline motion::PlannedMotion Planned(const motion::PathPiece& path,
                                     const motion::PathLimits& limits = kSlowLimits,
                                     double settling_s = 0.0, motion::Head head = {}) {
  motion::PlannedMotion planned;
  planned.path = path;
  planned.head = head;
  planned.limits = limits;
  planned.speed = motion::SpeedProfile::Span(path.length(), 0.0, 0.0, limits);
  planned.settling_s = settling_s;
  return planned;
}

inline motion::PathPiece LineFrom(const motion::MachinePoint& from,
                                  const motion::MachinePoint& to) {
  return motion::PathPiece::Line({from}, {to});
}

// Two lines with a /FLY corner between them, planned with look-ahead at SPEED 10 of the machine of
// motion.md section 1: what is left of the lines, and two halves of a curve.
inline std::vector<motion::PlannedMotion> PlannedCorner(const motion::TipPose& from,
                                                        const motion::TipPose& corner,
                                                        const motion::TipPose& to) {
  motion::Planner planner(motion::StandardMachine());
  motion::MoveCommand move;
  move.speed_fraction = 0.1;
  move.path = motion::PathPiece::Line(from, corner);
  move.fly = true;
  move.tag = 1;
  EXPECT_TRUE(planner.Append(move));
  move.path = motion::PathPiece::Line(corner, to);
  move.fly = false;
  move.tag = 2;
  EXPECT_TRUE(planner.Append(move));
  planner.Stop();
  std::vector<motion::PlannedMotion> motions;
  while (const auto item = planner.Next()) {
    motions.push_back(std::get<motion::PlannedMotion>(*item));
  }
  return motions;
}

// How a scripted motion is used.
struct MotionOptions {
  machine::MotionUse use = machine::MotionUse::kTravel;
  bool beam_on = false;
  machine::PowerBySpeed power{};
  double programmed_mm_s = 0.0;
};

// What a fake run does, in order. Times follow from the durations.
class Script {
 public:
  // Everything that follows happens at this step.
  Script& Step(int program, int step, int line = 0) {
    place_ = {.program = program, .step = step, .line = line};
    return Instant(
        [place = place_](machine::RunObserver& to, SimTime at) { to.OnStep(at, place, "STEP"); },
        true);
  }

  Script& Motion(motion::PlannedMotion planned, const MotionOptions& options = {}) {
    const SimTime length = FromSeconds(planned.duration_s());
    const auto shared = std::make_shared<motion::PlannedMotion>(std::move(planned));
    items_.push_back({.length = length,
                      .place = place_,
                      .tell = [shared, options, place = place_](machine::RunObserver& to,
                                                                SimTime start, SimTime end) {
                        to.OnMotion({.start = start,
                                     .end = end,
                                     .place = place,
                                     .use = options.use,
                                     .motion = shared.get(),
                                     .from = 0.0,
                                     .travelled = shared->path.length(),
                                     .profile_start_s = 0.0,
                                     .programmed_mm_s = options.programmed_mm_s,
                                     .beam_on = options.beam_on,
                                     .power = options.power});
                      }});
    items_.back().pose = motion::TipOn(shared->path, shared->head, shared->path.to());
    return *this;
  }

  // A part of a motion, as told when something happens on the way.
  Script& Part(const motion::PlannedMotion& planned, machine::MotionDone done, SimTime length) {
    const auto shared = std::make_shared<motion::PlannedMotion>(planned);
    done.place = place_;
    items_.push_back({.length = length,
                      .place = place_,
                      .tell = [shared, done](machine::RunObserver& to, SimTime start, SimTime end) {
                        machine::MotionDone told = done;
                        told.motion = shared.get();
                        told.start = start;
                        told.end = end;
                        to.OnMotion(told);
                      }});
    return *this;
  }

  Script& Line(const motion::MachinePoint& from, const motion::MachinePoint& to,
               const MotionOptions& options = {}) {
    return Motion(Planned(LineFrom(from, to)), options);
  }

  Script& Move(const motion::MachinePoint& tip, double feed_mm_s, std::string path,
               bool programmed = true) {
    return Instant([=, place = place_](machine::RunObserver& to, SimTime at) {
      to.OnMove({.at = at,
                 .place = place,
                 .tip = {tip},
                 .axes = {tip},
                 .program_point = motion::ProgramPoint::AsMachine(tip),
                 .rotary_a = 0.0,
                 .feed_mm_s = feed_mm_s,
                 .path = path,
                 .programmed = programmed});
    });
  }

  Script& Lost(const motion::MachinePoint& from, const motion::MachinePoint& to) {
    return Instant([=, place = place_](machine::RunObserver& watcher, SimTime at) {
      watcher.OnLost({.at = at, .place = place, .from = from, .to = to});
    });
  }

  Script& Wait(machine::WaitKind kind, double seconds, bool beam_on = false, double power = 0.0) {
    items_.push_back(
        {.length = FromSeconds(seconds),
         .place = place_,
         .tell = [=, place = place_](machine::RunObserver& to, SimTime start, SimTime end) {
           to.OnWait({.start = start,
                      .end = end,
                      .place = place,
                      .kind = kind,
                      .beam_on = beam_on,
                      .power_percent = power});
         }});
    return *this;
  }

  // Time that nobody tells about.
  Script& Nothing(double seconds) {
    items_.push_back({.length = FromSeconds(seconds), .place = place_, .tell = {}});
    return *this;
  }

  Script& Signal(machine::Signal signal, double value, double detail = 0.0, int index = 0) {
    return Instant([=, place = place_](machine::RunObserver& to, SimTime at) {
      to.OnSignal({.at = at,
                   .place = place,
                   .signal = signal,
                   .index = index,
                   .value = value,
                   .detail = detail});
    });
  }

  Script& Find(ErrorCode code, std::string detail) {
    return Instant([=, place = place_](machine::RunObserver& to, SimTime at) {
      to.OnDiagnostic(at, {.code = code,
                           .severity = Lookup(code).severity,
                           .detail = detail,
                           .rule = {},
                           .file = {},
                           .where = {.line = place.line},
                           .program = place.program,
                           .step = place.step,
                           .fixes = {}});
    });
  }

  Script& Message(std::string text) {
    return Instant([=, place = place_](machine::RunObserver& to, SimTime at) {
      to.OnMessage(at, place, text);
    });
  }

  Script& Program(std::string what, int program) {
    return Instant([=, place = place_](machine::RunObserver& to, SimTime at) {
      to.OnProgram(at, place, what, program);
    });
  }

  // Stands until a START comes.
  Script& Halt(std::string why) {
    items_.push_back({.length = {}, .place = place_, .tell = {}, .halt = std::move(why)});
    return *this;
  }

  Script& Ends(machine::OutcomeKind kind, std::optional<ErrorCode> code, std::string detail) {
    outcome_ = {.kind = kind, .code = code, .detail = std::move(detail), .place = place_};
    return *this;
  }

  struct Item {
    SimTime length{0};
    machine::Place place{};
    std::function<void(machine::RunObserver&, SimTime, SimTime)> tell;
    std::optional<motion::TipPose> pose{};
    bool counts = false;
    std::string halt{};
  };
  const std::vector<Item>& items() const { return items_; }
  const machine::Outcome& outcome() const { return outcome_; }
  std::vector<machine::Figure> figures;

 private:
  Script& Instant(std::function<void(machine::RunObserver&, SimTime)> tell, bool counts = false) {
    items_.push_back({.length = {},
                      .place = place_,
                      .tell = [tell = std::move(tell)](machine::RunObserver& to, SimTime,
                                                       SimTime end) { tell(to, end); },
                      .counts = counts});
    return *this;
  }

  machine::Place place_;
  std::vector<Item> items_;
  machine::Outcome outcome_;
};

class FakeRun final : public machine::Run {
 public:
  FakeRun(Script script, machine::RunObserver& observer, machine::InputScript inputs = {})
      : script_(std::move(script)), observer_(observer), inputs_(std::move(inputs)) {
    outcome_ = script_.outcome();
  }

  machine::RunPhase Advance(SimTime until) override {
    while (phase_ != machine::RunPhase::kFinished) {
      if (phase_ == machine::RunPhase::kHalted && !TakeScriptedStart(until)) return phase_;
      if (next_ == script_.items().size()) return phase_ = machine::RunPhase::kFinished;
      const Script::Item& item = script_.items()[next_];
      place_ = item.place;
      if (item_start_ + item.length > until) {
        time_ = until;
        return phase_ = machine::RunPhase::kRunning;
      }
      time_ = item_start_ + item.length;
      if (item.tell) item.tell(observer_, item_start_, time_);
      if (item.pose) pose_ = *item.pose;
      if (item.counts) ++steps_;
      item_start_ = time_;
      ++next_;
      if (!item.halt.empty()) {
        observer_.OnHalt({.at = time_, .place = item.place, .why = item.halt});
        phase_ = machine::RunPhase::kHalted;
      }
    }
    return phase_;
  }

  void Apply(const machine::InputChange& input) override {
    if (input.kind != machine::InputKind::kStart || phase_ != machine::RunPhase::kHalted) return;
    if (deaf_) return;
    observer_.OnResume(time_, place_);
    phase_ = machine::RunPhase::kRunning;
  }

  void End(machine::OutcomeKind kind, ErrorCode code) override {
    outcome_ = {.kind = kind, .code = code, .detail = "ended from outside", .place = place_};
    phase_ = machine::RunPhase::kFinished;
  }

  machine::RunState state() const override {
    machine::RunState state;
    state.time = time_;
    state.phase = phase_;
    state.place = place_;
    state.tip = pose_;
    state.axes = {pose_.tip, pose_.a_rad, pose_.b_rad};
    return state;
  }
  const machine::Outcome& outcome() const override { return outcome_; }
  std::uint64_t steps_executed() const override { return steps_; }
  std::optional<machine::VariableValue> ReadVariable(std::string_view name) const override {
    if (name == "VR[5]") return {{machine::VariableKind::kReal, "7.0"}};
    return std::nullopt;
  }
  std::vector<machine::Figure> figures() const override { return script_.figures; }
  std::string SaveMachine() const override { return "state"; }
  std::map<int, std::string> made_executables() const override { return {{12, "executable"}}; }
  std::unique_ptr<machine::RunSnapshot> Save() const override { return nullptr; }
  void Restore(const machine::RunSnapshot&) override {}

  void MakeDeaf() { deaf_ = true; }  // START does nothing any more

 private:
  bool TakeScriptedStart(SimTime until) {
    for (const machine::InputChange& input : inputs_) {
      if (input.kind != machine::InputKind::kStart || input.at <= time_ || input.at > until)
        continue;
      time_ = input.at;
      item_start_ = time_;
      Apply(input);
      return true;
    }
    return false;
  }

  Script script_;
  machine::RunObserver& observer_;
  machine::InputScript inputs_;
  machine::Outcome outcome_;
  machine::RunPhase phase_ = machine::RunPhase::kRunning;
  std::size_t next_ = 0;
  SimTime time_{0};
  SimTime item_start_{0};
  machine::Place place_;
  motion::TipPose pose_;
  std::uint64_t steps_ = 0;
  bool deaf_ = false;
};

}  // namespace rmlcell::simulation
