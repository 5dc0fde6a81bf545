#pragma once

#include "engine/machine/run.h"
#include "engine/optimo/language/ast.h"
#include "engine/optimo/machine/situation.h"
#include "engine/optimo/machine/system_cycle.h"
#include "engine/optimo/machine/telling.h"
#include "engine/optimo/ride/ride.h"

namespace rmlcell::optimo {

// What the control waits for before it goes on with the program.
//
//   kind         begun by                                ended by
//   kStandstill  StandFirst, an error ahead of motion    nothing is under way (Control)
//   kTime        DELAY, a pierce, CALL, polling          its time (Control)
//   kCondition   WAIT, /START of MOVE and WORK           the expression is true (Control), or
//                                                        /TIME (watch)
//   kTakeOver    a MOVE beside a motion of /NEXT         the next tick: then kStandstill
//   kNoMotion    a MOVE that never moves                 its /END or /TIME (watch)
//
// An error ends whatever it is.
struct Pending {
  enum class Kind {
    kNone,
    kStandstill,  // motions to be over, then the program goes on at the same instruction
    kTime,        // until `until`
    kCondition,   // until the expression of the instruction is true, then it is carried out
    kTakeOver,    // the next tick, when the /NEXT motion is brought to rest
    kNoMotion,    // the end of a MOVE that never moves (move_watch.h)
  };
  Kind kind = Kind::kNone;
  SimTime since{0};
  SimTime until{0};
  SimTime told{0};  // reported up to here
  machine::WaitKind wait = machine::WaitKind::kDwell;
  machine::Place place{};         // of the instruction that waits
  ExprRange expression{};         // kCondition: of the module of the innermost frame
  bool of_move = false;           // kCondition: /START of a MOVE, whose /TIME counts the wait
  machine::PowerBySpeed after{};  // kTime, WaitKind::kPierce: the power of the beam then
};

// A loop that reads an input again and again, and lets no time pass by itself.
struct Polling {
  int program = 0;
  std::uint32_t instruction = 0;
  SimTime at{-1};  // when it was read last
  int count = 0;   // how often at that instant
  int others = 0;  // how often others were read at that instant, since it was read last
  int others_max = 0;
  bool slow = false;  // each further time takes a CYCLE
};

struct WaitState {
  Pending pending{};
  Polling polling{};
  // The instruction in execution has waited for its condition: from the end of kCondition until it
  // is over, or an error ends it. Meanwhile it may wait for kStandstill.
  bool condition_met = false;
  bool input_changed = false;    // conditions are to be tested again, before the next tick
  SimTime instruction_since{0};  // when the instruction in execution began
};

// The waits of the program, which are told in parts: up to what changes meanwhile. While a motion
// goes on beside the program (/NEXT) there is nothing to tell: that time is the motion's.
class Waits {
 public:
  Waits(WaitState& state, const Situation& situation, const Beam& beam, SystemCycle cycle,
        const Telling& telling, const Ride& ride)
      : s_(state),
        situation_(situation),
        beam_(beam),
        cycle_(cycle),
        telling_(telling),
        ride_(ride) {}

  const Pending& pending() const { return s_.pending; }
  bool waits() const { return s_.pending.kind != Pending::Kind::kNone; }
  bool condition_met() const { return s_.condition_met; }
  bool input_changed() const { return s_.input_changed; }
  SimTime instruction_since() const { return s_.instruction_since; }

  // From now on, for the instruction in execution.
  void Begin(const Pending& pending);
  void BeginTime(double seconds, machine::WaitKind kind);
  void BeginCondition(ExprRange expression, bool of_move = false);
  void BeginStandstill() { Begin({.kind = Pending::Kind::kStandstill}); }
  void BeginNoMotion() { Begin({.kind = Pending::Kind::kNoMotion}); }
  // Tells what of the wait was not yet told: up to now.
  void Tell();
  // From here on it is told: what was before is the motion's.
  void ToldByMotion() { s_.pending.told = situation_.now; }
  // It is over, and told.
  void End();
  // The condition that the instruction waited for is true: it is carried out.
  void EndMet();
  // The machine stood halted so long, and with it the time of this wait.
  void Shift(SimTime stood);

  void BeginInstruction() { s_.instruction_since = situation_.now; }
  void EndInstruction() { s_.condition_met = false; }
  void InputChanged() { s_.input_changed = true; }
  void InputSeen() { s_.input_changed = false; }

  // An instruction that reads an input over and over in one instant waits for something to change
  // outside: from its thousandth time on each further one takes a CYCLE, in which the control
  // samples its inputs. True: it waits, and is fetched again then. Of a loop with several of them
  // the first is counted; where that was read before the loop and is not of it, another one takes
  // its place behind a thousand others.
  bool PollingTakesTime(int slot, std::uint32_t instruction);

 private:
  WaitState& s_;
  const Situation& situation_;
  const Beam& beam_;
  const SystemCycle cycle_;
  const Telling& telling_;
  const Ride& ride_;
};

}  // namespace rmlcell::optimo
