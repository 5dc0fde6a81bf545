#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/motion/planner/planner.h"
#include "engine/motion/ride/path_ride.h"
#include "engine/optimo/machine/beam.h"
#include "engine/optimo/ride/lead_along.h"
#include "engine/optimo/ride/move_note.h"
#include "engine/optimo/ride/travel.h"

// The motions of the machine in time: planned, under way, interrupted, held back.
namespace rmlcell::optimo {

// Whether the program goes on while there are motions. A halt on the path leaves it as it is: the
// motions go on at START as they did before.
//
//   kNo       Append of a motion with /FLY     kAhead
//   kAhead    Append                           kAhead with /FLY, else kNo
//             EndChain                         kNo
//   kNo,      GoOnBeside                       kBeside; kComes, where the program has run ahead;
//   kAhead                                     kNo, where nothing is under way any more
//   kComes    its motion begins                kBeside
//   kComes,   all is over, TakeOver            kNo
//   kBeside
//
// Beside a motion of /NEXT nothing is appended: a MOVE takes over first, all else that moves waits.
enum class GoesOn : std::uint8_t {
  kNo,      // it waits for them
  kAhead,   // it runs ahead of a /FLY motion, which the planner may hold back
  kComes,   // it waits for the motion of /NEXT behind a passage: that of RideState::beside_from
  kBeside,  // it goes on beside the motion of /NEXT under way
};

struct RideState {
  explicit RideState(const motion::MachineLimits& limits) : planner(limits) {}

  motion::Planner planner;
  motion::AxisPose axes{};          // where the machine stands while nothing is under way
  motion::AxisPose planned_axes{};  // after everything that was appended
  std::uint64_t next_tag = 1;
  std::deque<std::pair<std::uint64_t, MoveNote>> notes{};  // of motions not over, by tag
  int run_ahead = 0;                                       // see Ride::RunsAhead
  // Commands outside of /FLY passages whose motions are not over; those inside are in `path`. They
  // are few: the program waits for them.
  std::vector<motion::AppendedCommand> alone{};
  std::optional<motion::AxisPose> moved_from{};  // halted there, and moved by hand since
  double override_percent = 100.0;
  bool override_owed = false;  // too little was planned to take it over

  // Commands are kept in it while /FLY passages are open.
  motion::PathRide path{motion::HoldRamp::kStays};
  MoveNote note{};  // of the motion under way
  GoesOn program = GoesOn::kNo;
  std::uint64_t beside_from = 0;   // kComes
  machine::Place halted_behind{};  // the move that HOLD made exact, or that STOP interrupted
};

// Told by a ride, at the time of its situation.
class RideListener {
 public:
  virtual ~RideListener() = default;
  virtual void OnMark(std::uint64_t tag) = 0;                      // the mark was passed
  virtual void OnMotionBegins(std::uint64_t tag) = 0;              // and is under way from now on
  virtual void OnMotionTold(const machine::MotionDone& done) = 0;  // or a part of one
  virtual void OnMoveOver(std::uint64_t tag) = 0;                  // and told
};

// What is appended becomes motions that begin as soon as the one before is over. The program runs
// ahead of /FLY passages: a motion whose passage is open may be held back until it is decided.
//
// Time is that of the situation: whoever lets it pass calls Arrive() at NextEvent(), and Start().
class Ride {
 public:
  Ride(RideState& state, const Situation& situation, const Beam& beam,
       const OptimoParameters& parameters, Travel& travel, const Telling& telling,
       RideListener& listener)
      : s_(state),
        situation_(situation),
        beam_(beam),
        parameters_(parameters),
        travel_(travel),
        telling_(telling),
        listener_(listener) {}

  // --- ride.cc: motions one after the other ---

  // Motions are under way or to come.
  bool busy() const { return s_.path.busy(); }
  // The planner may hold a /FLY motion back.
  bool passing() const { return s_.program == GoesOn::kAhead; }
  bool beside() const { return s_.program == GoesOn::kBeside; }
  const motion::MotionUnderWay* under_way() const { return s_.path.under_way(); }
  bool moves() const { return under_way() != nullptr && situation_.now < under_way()->arrival; }
  bool waits_to_start() const { return s_.path.waits_to_begin(); }
  // Whatever moves comes to rest, and nothing follows: EndHere.
  bool ends_here() const { return s_.path.ends(); }
  bool more_to_come() const { return !s_.path.to_come().empty(); }

  double override_percent() const { return s_.override_percent; }
  motion::Head head() const { return HeadOf(situation_.tool, parameters_); }
  motion::TipPose tip() const;
  motion::AxisPose axes() const;
  double tip_speed_mm_s() const;
  const motion::AxisPose& planned_axes() const { return s_.planned_axes; }
  std::uint64_t next_tag() const { return s_.next_tag; }
  std::uint64_t lookahead_starved() const { return s_.planner.lookahead_starved(); }
  // The step that the machine is at: the program runs ahead of /FLY moves, but not of one of /NEXT,
  // which goes on beside it.
  machine::Place place() const;
  // The same, but of a motion of /NEXT, too.
  machine::Place motion_place() const {
    return under_way() != nullptr ? s_.note.place : situation_.place;
  }

  // The machine stands there, and nothing is planned.
  void PutAt(const motion::AxisPose& axes) { s_.planned_axes = axes; }

  // The motion behind all others. Precondition: none of /NEXT goes on. Errors: of Planner::Append;
  // nothing has changed then but
  // the tag of the command.
  Status Append(motion::MoveCommand&& command, const MoveNote& note);
  // Something that happens behind what was appended: its tag.
  std::uint64_t AppendMark();
  // The machine stands behind what was appended: the passage that is open becomes a stop.
  void EndChain();
  // The program goes on beside the motions from this tag on. `ran_ahead`: they are behind a /FLY
  // passage, and it waits for them to begin.
  void GoOnBeside(std::uint64_t tag, bool ran_ahead);
  // One more instruction is carried out between two motions of a passage. False: they are too many,
  // and the passage becomes a stop.
  bool RunsAhead();
  // How many more may be, and that so many were.
  int may_run_ahead() const;
  void RanAhead(int instructions) { s_.run_ahead += instructions; }

  // Marks take effect at once, motions begin.
  void Start();
  // When the motion under way is over, or one is to begin; kForever when none is.
  SimTime NextEvent() const;
  // The motion under way is over, and its move perhaps, too.
  void Arrive();
  // Reports what of the motion under way was not yet reported: something about it changes now.
  void TellUpToNow();

  // The motion under way comes to rest on its path, at once, and its move is over where it stands:
  // /END, /TIME, a MOVE that takes over. Such moves end in a stop, so the ramp never leaves their
  // path. False: it stands already, and settles.
  bool EndHere();
  // A MOVE takes over from that of /NEXT. False: it came to its end before.
  bool TakeOver();
  // An error: the motions end here, or where they would. False: the machine stands.
  bool EndForError(bool at_once);
  // The run is over: the machine stays where it is, and nothing follows.
  void Freeze();
  // Tells what the motions not begun would leave their travel by.
  void TellViolationsToCome();

  // --- ride_stop.cc, ride_hold.cc, ride_override.cc: keys on the way. motion.md 6 ---

  motion::RideProtocol& protocol() { return s_.path.protocol(); }
  const motion::RideProtocol& protocol() const { return s_.path.protocol(); }

  // HOLD: ends the motions at the first target where the machine can come to rest: that of the move
  // under way, or of a later one when its passage has begun or is too near. The program has run
  // ahead by then; what it appended behind that move waits, and is planned anew at START. Nothing
  // changes on the last move, or when not enough is planned yet. OPT-4.17
  void Hold();
  // STOP: the machine comes to rest along the planned path, over as many motions as that takes, and
  // START goes on from there over the same path. False: not enough is planned yet to come to rest
  // on; the program runs ahead a little more. OPT-4.18
  bool Stop();
  // It has come to rest for either: the place of the move that was under way.
  machine::Place Rest();
  // START. Errors, of a machine that was moved: those of a MOVE from there; then nothing is left to
  // ride.
  Status Resume();
  // Motions not begun are planned with the new value. The one under way goes over to it from where
  // it is; a bend that has begun, or is too near to slow down before it, keeps its shape and speed.
  // Where moves are too short to slow down on one of them, it slows down along the planned path.
  // A machine that brakes for a stop too near for anything else goes on braking. OPT-4.38
  void ChangeOverride(double percent);

  // --- ride_moved.cc: moved by hand while it is halted. OPT-6.42, LIVE-5.06 ---

  bool may_be_moved() const;
  // It stands here now. At START the move that was interrupted goes to its end from here, a circle
  // through its via point; a hole goes back to where it was left, one of a passage to its begin.
  void MoveTo(const motion::AxisPose& axes);

 private:
  struct ChainPlace {
    motion::PlannedMotion motion;
    motion::PathState state;
    bool under_way = false;
  };
  // Where a chain that is planned anew goes on: after the way that brings the acceleration to zero,
  // and the speed down where it must.
  struct Onward {
    std::size_t own = 0;         // of the commands appended: that of that place
    double lead_length = 0.0;    // of that way, by the s of the motion
    double speed = 0.0;          // at its end, by the same s
    double speed_on_move = 0.0;  // by that of the command
    double measure = 1.0;        // s of what is planned anew per s of the motion
    motion::MoveCommand first;   // what is left of the command then
  };

  // That way over several motions.
  struct LongLead {
    std::optional<LeadAlong> way{};
    bool under_way = false;  // its first motion is
    std::size_t first = 0;   // else the place of that among the items before it
    double share = 1.0;      // of the new speed: the corners behind may ask for less
  };

  void Drain();
  void EndBeside();
  void TellMotion(SimTime until);
  void TellEnd(const motion::PlannedMotion& motion, bool here);
  bool settles() const;  // at the end of the motion under way
  const MoveNote* NoteOf(std::uint64_t tag) const;
  MoveNote* NoteOf(std::uint64_t tag);

  void HoldOverManyMoves();
  void HoldBehind(std::uint64_t tag, std::vector<motion::PlannedItem> kept);
  void HoldCommandsBehind(std::uint64_t target);
  void PlanHeld();

  Status GoFromHere();
  std::vector<motion::AppendedCommand> NotOver() const;
  Status BeginHere(std::vector<motion::AppendedCommand>& rest, std::size_t first);
  void LeadBack(std::vector<motion::AppendedCommand>& rest, std::size_t circle);

  double FractionOf(const MoveNote& note) const;
  void AdaptToOverride(motion::AppendedCommand& item);
  void AdaptMotions();
  bool ReplanChain();
  std::optional<motion::AppendedCommand> UnderOverride(std::uint64_t tag);
  std::size_t PlaceOfAppended(std::uint64_t tag) const;
  bool ReplanFrom(const ChainPlace& place, const std::vector<motion::PlannedItem>& kept);
  bool ReplanAlong(LongLead& lead, const motion::PlannedMotion& last,
                   const std::vector<motion::PlannedItem>& kept);
  template <class Go>
  bool TakeOnward(const Onward& onward, const motion::AppendedCommand& rest, Go go);
  std::optional<Onward> OnwardFrom(const ChainPlace& place, const motion::MoveCommand& command,
                                   double speed) const;
  std::optional<motion::Planner> PlanOnward(const Onward& onward,
                                            std::span<const motion::AppendedCommand> later) const;
  void GoOnward(const ChainPlace& place, const Onward& onward,
                std::vector<motion::PlannedItem> kept);
  void GoAlong(const LongLead& lead, std::vector<motion::PlannedMotion> motions,
               const std::vector<motion::PlannedItem>& kept);

  RideState& s_;
  const Situation& situation_;
  const Beam& beam_;
  const OptimoParameters& parameters_;
  Travel& travel_;
  const Telling& telling_;
  RideListener& listener_;
};

// "LIN", as moves are told.
std::string_view NameOfPath(PathType path);

}  // namespace rmlcell::optimo
