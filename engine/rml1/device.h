#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "engine/rml1/action.h"
#include "engine/rml1/carriage.h"
#include "engine/rml1/command_reader.h"
#include "engine/rml1/data_buffer.h"
#include "engine/rml1/error_log.h"
#include "engine/rml1/finding.h"
#include "engine/rml1/programmed.h"
#include "engine/rml1/receive_path.h"
#include "engine/rml1/registers.h"

namespace rmlcell::rml1 {

// Where the command in progress stands in the stream.
struct CommandPlace {
  std::uint64_t number = 0;  // of the command, from 1; 0 before the first
  std::int64_t offset = 0;   // of the first byte of its name
  Op op = Op::kCall;
};

// Told what the device notices. No method may call back into the device.
class DeviceListener {
 public:
  virtual ~DeviceListener() = default;
  virtual void OnCommand(const CommandPlace&) {}  // right before its first effect
  virtual void OnFinding(const Finding&) {}       // errors up to the bound of the log, and advice
  // What is past that bound, and advice of a kind that was told often: in a word, to be counted.
  virtual void OnCounted(const Finding&) {}
  // Way in the work that the travel cut off, device units from the machine's zero.
  virtual void OnLost(const Carriage::LostLine&) {}
  // What the device's reader made of the byte at `offset`, before the device acts on it; not of one
  // with which nothing is complete.
  virtual void OnReading(const Reading&, const CommandReader&, std::int64_t /*offset*/) {}
  virtual void OnAbort(std::int64_t /*offset*/) {}  // ESC.K: what has not run is forgotten
};

// A mill or engraver without its clock: bytes go in, and out come actions, each to be carried out
// before the next byte is looked at. A value: a copy is a snapshot. It owns what section 7 lists as
// power-on state, and nothing of it grows without bound (RML1-7.07).
//
// To run it: Receive a byte, then call Step until it returns false, carrying out and popping the
// actions after each step; Read does both with many bytes at once. An action kPause stays at the
// front until the resume key is pressed: bytes that are received meanwhile wait in the buffer
// (RML1-3C.08).
class Device {
 public:
  // `profile` must outlive the device and its copies.
  explicit Device(const Profile& profile);

  // Takes one byte from the link through the receive path into the buffer. When the buffer is full
  // the byte is lost with communication error 16; room() is what flow control tells a sender.
  void Receive(unsigned char byte, std::int64_t offset, DeviceListener& listener);
  std::size_t room() const { return buffer_.room(); }
  std::size_t waiting() const { return buffer_.size(); }  // bytes received and not interpreted

  // A framing, parity or overrun error that the transport reports: error 15, and the byte is lost.
  void ReportLineError(std::int64_t offset, DeviceListener& listener);

  // Interprets as far as the next thing that happens; at most one byte. False when the buffer is
  // empty. Precondition: no action is waiting.
  bool Step(DeviceListener& listener) { return !buffer_.empty() && StepOn(listener); }

  // What Receive does with the bytes, each followed by Step until the buffer is empty, up to the
  // one that makes something happen: an action waits, or so many commands are over. A byte that did
  // so and must be looked at again is left: it is received a second time. The listener hears of no
  // readings. Precondition: the buffer is empty, and no action waits.
  struct Taken {
    std::size_t bytes = 0;  // from the front
    bool next = false;      // the byte behind them has been looked at
  };
  static constexpr std::uint64_t kAnyCommands = std::uint64_t{1} << 62;
  Taken Read(std::string_view bytes, std::int64_t offset, std::uint64_t commands,
             DeviceListener& listener);

  ActionQueue& actions() { return actions_; }
  const ActionQueue& actions() const { return actions_; }
  bool paused() const { return !actions_.empty() && actions_.front().kind == Action::Kind::kPause; }

  // What an action that is still waiting does to the spindle has not happened yet.
  bool spindle_turns() const;

  // A command, a name, a call or a control sequence is unfinished.
  bool pending() const { return reader_.pending() || path_.pending(); }
  std::int64_t pending_offset() const {
    return reader_.pending() ? reader_.pending_offset() : last_offset_;
  }

  // The stream is over: its last statement counts although nothing ended it (RML1-7.04).
  void EndOfData() {
    programmed_.Finish();
    ReliesOnZ0();
  }

  const Registers& registers() const { return registers_; }
  const Carriage& carriage() const { return carriage_; }
  const Programmed& programmed() const { return programmed_; }
  const ErrorLog& command_errors() const { return command_errors_; }
  const ErrorLog& link_errors() const { return link_errors_; }
  const ReceivePath& path() const { return path_; }
  const CommandPlace& command() const { return command_; }
  std::uint64_t commands_done() const { return commands_done_; }  // executed to their end
  std::uint64_t speeds_limited() const { return speeds_limited_; }
  // Coordinates and tool heights that were refused: the tool does not go where the program says.
  std::uint64_t positions_refused() const { return positions_refused_; }
  // Of the bytes that came out of the buffer, those that belong to no command, in percent: of 256
  // where they are fewer and no more than a word or a quarter of them is foreign.
  double foreign_percent() const;
  // Where the first set lost a part that it would have cut; number 0: none did.
  const CommandPlace& first_lost() const { return first_lost_; }
  const CommandPlace& first_refused() const { return first_refused_; }

  // The furthest that !ZO took Z0 from where it was before the program, for a motion or for the
  // end, and which one began it.
  struct MovedZ0 {
    double by = 0.0;  // device units
    CommandPlace at{};
  };
  const MovedZ0& raised() const { return raised_; }
  const MovedZ0& lowered() const { return lowered_; }

  // The first commands that rely on what was set before the program; number 0: none does.
  struct Assumed {
    CommandPlace mode;     // whether coordinates are absolute
    CommandPlace heights;  // Z1, Z2
  };
  const Assumed& assumed() const { return assumed_; }

  // The state of an earlier run (machine_state.h), limited to what this profile can do. Only before
  // the first byte.
  void Restore(const Registers& registers, const Point& at);

 private:
  // A set in progress of a command with sets, or the numbers of a fixed one.
  struct Operands {
    std::array<double, 3> set{};    // numbers of the set in progress
    std::array<Number, 2> fixed{};  // parameters of a fixed command
    int count = 0;                  // of the set or the list
    bool any = false;               // a parameter was read
    bool ran = false;               // a set was executed
    bool dropped = false;           // a value was out of range: the rest of the list is dropped

    void Begin() {
      count = 0;
      any = ran = dropped = false;
    }
  };
  // The group of !ZE in progress.
  struct Group {
    Point to;
    bool has_y = false;
    bool has_a = false;
    Programmed::AxisGroup named;
  };

  Carriage::Context context() { return {*profile_, registers_, actions_}; }
  bool StepOn(DeviceListener& listener);
  void ToBuffer(unsigned char byte, std::int64_t offset, DeviceListener& listener);
  void Act(const Reading& reading, unsigned char byte, DeviceListener& listener);
  void OnReadError(unsigned char byte, DeviceListener& listener);
  // An action waits, or so many commands are over.
  bool Happened(std::uint64_t done_max) const {
    return !actions_.empty() || commands_done_ >= done_max;
  }
  void TakeThroughBuffer(const ByteSpan& bytes, std::uint64_t done_max, DeviceListener& listener);
  bool IsFarFromLimits() const;  // of numbers, by more than a whole set may lead
  bool TakeParameters(ByteSpan& bytes, DeviceListener& listener);
  bool TakeByte(ByteSpan& bytes, DeviceListener& listener);
  void OnName() {
    ++command_.number;
    command_.offset = reader_.command_offset();
    command_.op = reader_.row().op;
    operands_.Begin();
    told_ = false;
  }
  void CarryOutSet(DeviceListener& listener);
  void EndCommand(DeviceListener& listener) {
    if (operands_.ran && operands_.count == 0) {  // sets, all of them carried out
      ++commands_done_;
    } else {
      OnEnd(listener);
    }
  }
  void OnParameter(DeviceListener& listener);
  void OnEnd(DeviceListener& listener);

  // device_commands.cc
  // Right before the first effect, so that a name that is dropped again was never a command.
  void BeginCommand(DeviceListener& listener) {
    if (told_) return;
    told_ = true;
    programmed_.OnCommand(command_.op);
    listener.OnCommand(command_);
  }
  void ApplyEffects(const CommandRow& row) {
    if (row.mode != ModeChange::kNone) {
      registers_.absolute = row.mode == ModeChange::kAbsolute;
      registers_.mode_given = true;
    }
    if (row.tool != ToolChange::kNone) registers_.tool_down = row.tool == ToolChange::kDown;
  }
  // A lift above the top or a parking place beyond the travel costs nothing: it is only counted.
  void NoteClipping(double lost_before, DeviceListener& listener) {
    if (carriage_.lost().length > lost_before) TellClipping(listener);
  }
  void TellClipping(DeviceListener& listener);
  bool IsRelative(const CommandRow& row) const {
    return row.mode == ModeChange::kNone ? !registers_.absolute : row.mode == ModeChange::kRelative;
  }
  // Where the logical position is, by the numbers of a set.
  double Present(int index) const {
    const Point& logical = carriage_.logical();
    if (index == 0) return logical.x - profile_->origin_x;
    if (index == 1) return logical.y - profile_->origin_y;
    return logical.z - registers_.z0;
  }
  bool TakeCoordinate(DeviceListener& listener);
  void RunBare(DeviceListener& listener);
  void RunFixed(DeviceListener& listener);
  void OnAxisValue(DeviceListener& listener);
  void OnGroup(DeviceListener& listener);
  void ClearGroup();
  void SetXYSpeed(DeviceListener& listener);
  void SetZSpeed(DeviceListener& listener);
  double NearestSpeed(const motion::FeedSteps& steps, SpeedLimit& limit, DeviceListener& listener);
  void SetHeights(DeviceListener& listener);
  void SetDwell(DeviceListener& listener);
  void SetRotation();
  void SetSpindleSpeed(DeviceListener& listener);
  void MoveMachineZ(DeviceListener& listener);
  void SetZ0(DeviceListener& listener);
  void MoveZ0(double z);
  // When something goes by it, or the machine is left with it.
  void ReliesOnZ0() {
    if (z0_moved_by_.number != 0) NoteMovedZ0();
  }
  void NoteMovedZ0();
  // A coordinate is read in the mode that is in force.
  void ReliesOnMode() {
    if (!registers_.mode_given && assumed_.mode.number == 0) assumed_.mode = command_;
  }
  void ReliesOnHeights() {
    if (!registers_.heights_given && assumed_.heights.number == 0) assumed_.heights = command_;
  }
  void GivePlace(bool x, bool y) {
    if (registers_.place_given_by == 0) NotePlace(x, y);  // else both are given for good
  }
  void NotePlace(bool x, bool y);
  void RestoreDefaults();
  void StopSpindle(bool waits);

  // Errors of commands: the register, the log and the listener.
  void Report(FindingKind kind, DeviceListener& listener, double value = 0.0, Travel allowed = {});
  void Log(ErrorLog& log, Finding finding, DeviceListener& listener);
  void Advise(FindingKind kind, DeviceListener& listener, double value = 0.0);

  // Advice of one kind is told so many times; then it is only counted.
  static constexpr int kAdviceMax = 1000;

  const Profile* profile_;
  ReceivePath path_;
  DataBuffer buffer_;
  CommandReader reader_;
  Registers registers_;
  Carriage carriage_;
  ActionQueue actions_;
  Programmed programmed_;
  ErrorLog command_errors_;
  ErrorLog link_errors_;
  CommandPlace command_;
  Operands operands_;
  Group group_;
  bool told_ = false;             // OnCommand was called for the command in progress
  std::uint64_t clip_told_ = 0;   // number of the last command with advice on clipping
  std::int64_t last_offset_ = 0;  // of the byte received last
  std::uint64_t commands_done_ = 0;
  std::uint64_t speeds_limited_ = 0;
  std::uint64_t positions_refused_ = 0;
  std::uint64_t bytes_read_ = 0;
  std::uint64_t bytes_foreign_ = 0;
  CommandPlace first_lost_;
  CommandPlace first_refused_;
  MovedZ0 raised_;
  MovedZ0 lowered_;
  CommandPlace z0_moved_by_;
  Assumed assumed_;
  std::array<int, kFindingKindCount> advised_{};
};

}  // namespace rmlcell::rml1
