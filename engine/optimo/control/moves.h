#pragma once

#include <array>
#include <string>

#include "engine/optimo/control/data_access.h"
#include "engine/optimo/control/halts.h"
#include "engine/optimo/control/move_watch.h"
#include "engine/optimo/control/passage_effects.h"
#include "engine/optimo/control/program_counter.h"
#include "engine/optimo/control/waits.h"
#include "engine/optimo/machine/telling.h"
#include "engine/optimo/ride/ride.h"
#include "engine/optimo/ride/travel.h"

namespace rmlcell::optimo {

struct MoveState {
  WorkOffsetState work_offset{};  // SYSDEF
  // The axes know where they are, or will when what was planned is done: ZERO. OPT-B.02
  bool zeroed = true;
  bool speed_limited_told = false;
};

// MOVE, and the instructions that decide how it moves: COORD, PATH, SPEED, ACCEL, OVERSH, SYSDEF,
// TCP; ZERO.
class Moves {
 public:
  Moves(MoveState& state, Situation& situation, const OptimoParameters& parameters,
        const Telling& telling, ProgramCounter& counter, DataAccess& data, Travel& travel,
        Ride& ride, PassageEffects& effects, Waits& waits, MoveWatch& watch, const Halts& halts)
      : s_(state),
        situation_(situation),
        parameters_(parameters),
        telling_(telling),
        counter_(counter),
        data_(data),
        travel_(travel),
        ride_(ride),
        effects_(effects),
        waits_(waits),
        watch_(watch),
        halts_(halts) {}

  // Precondition: the instruction is one of those above. A MOVE may begin a wait for its /START.
  // Errors: of expressions and the planner, ValueRange, PathNeedsAbsol, NotZeroed, NoMotion,
  // TargetOutOfTravel, HoleRadiusZero, HoleStartOnAxis, those of arcs.
  Status Execute(const Instruction& i);

  // MOVE and TCP: whether a motion must be over before. OPT-2.48
  bool NeedsStandstill(const Instruction& i);

 private:
  using Coordinates = std::array<double, 5>;  // as programmed: X Y Z A B

  // A MOVE while it is carried out.
  struct Programmed {
    const Instruction& i;
    Coordinates target{};
    MoveNote note{};
    std::uint64_t first_tag = 0;
    bool ran_ahead = false;
  };

  Status Move(const Instruction& i);
  // False: it waits for its /START.
  Result<bool> MayBegin(const Instruction& i);
  MoveNote NoteOf(const Instruction& i, const Coordinates& target);
  Result<bool> AppendPath(Programmed& move);
  Result<bool> AppendHole(Programmed& move, const motion::TipPose& from);
  Result<motion::PathPiece> CirclePath(const motion::TipPose& from, const motion::TipPose& target,
                                       const std::optional<motion::MachinePoint>& via);
  // Writes down in the note what it knows of the motion. False: nothing is on its way. It ends
  // where it begins, or the MOVE stands until its /TIME.
  Result<bool> Append(const Instruction& i, const motion::PathPiece& path, MoveNote& note,
                      bool settles = true);
  Result<bool> NeverEnds(const Instruction& i, Detail why);
  void TellStanding(const MoveNote& note);
  double SpeedFraction();
  void GoOn(const Programmed& move);

  Result<Coordinates> TargetOf(const Instruction& i);
  Result<motion::TipPose> ViaOf(const Instruction& i);
  motion::TipPose TipAt(const Coordinates& v) const;
  static motion::AxisPose AxesAt(const Coordinates& v);
  bool GoesNowhere(const Instruction& i);
  bool NeverMoves() const;

  Status SetPath(const Instruction& i);
  Status SetPercent(const Instruction& i);
  Status SetWorkOffset(const Instruction& i);
  Status SetTool(const Instruction& i);
  Result<std::array<double, 6>> SixValues(const Instruction& i);
  Status ZeroAxes();
  Status ZeroGroup(int group, const motion::AxisPose& to);

  MoveState& s_;
  Situation& situation_;
  const OptimoParameters& parameters_;
  const Telling& telling_;
  ProgramCounter& counter_;
  DataAccess& data_;
  Travel& travel_;
  Ride& ride_;
  PassageEffects& effects_;
  Waits& waits_;
  MoveWatch& watch_;
  const Halts& halts_;
};

}  // namespace rmlcell::optimo
