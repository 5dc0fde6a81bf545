#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "engine/machine/observer.h"
#include "engine/machine/run.h"

// The ordered list of everything about a run that could be seen from outside. Streamed: one record
// at a time, nothing is kept.
namespace rmlcell::simulation {

// A trace of this many records is some gigabytes of JSON: longer ones are cut off, and the report
// says so.
inline constexpr std::uint64_t kTraceRecordsMax = 10'000'000;

enum class TraceKind {
  kMove,    // a MOVE or coordinate set carried out
  kSignal,  // an output, the beam, the shutter, the spindle ... changed
  kWait,    // a dwell or another wait is over
  kHalt,    // PAUSE, STOP, HOLD, breakpoint, !NR
  kResume,
  kProgram,  // CALL, GO, return; `index` is the program
  kMessage,  // of the program to the operator
  kFinding,  // error or warning, with its code
  kEnd,      // always last: how the run ended
};

// Views are valid during the call of the sink only.
struct TraceRecord {
  std::uint64_t number = 0;  // from 1 without a gap
  TraceKind kind = TraceKind::kMove;
  SimTime at{0};
  machine::Place place;
  std::string_view text;  // path of a move, why of a halt, words of a message, detail of a finding

  // kMove
  motion::TipPose tip;  // machine frame
  motion::AxisPose axes;
  motion::ProgramPoint program_point;
  double program_a = 0.0;
  double program_b = 0.0;
  double feed_mm_s = 0.0;

  // kSignal
  machine::Signal signal = machine::Signal::kOutput;
  int index = 0;  // also kProgram
  double value = 0.0;
  double detail = 0.0;

  // kWait
  machine::WaitKind wait = machine::WaitKind::kDwell;
  SimTime duration{0};  // `at` is the end

  // kFinding, and kEnd when there is a code
  std::optional<ErrorCode> code;
  Severity severity = Severity::kAdvice;
  machine::OutcomeKind outcome = machine::OutcomeKind::kCompleted;  // kEnd
};

std::string_view TraceKindName(TraceKind kind);         // "move"
std::string_view SignalName(machine::Signal signal);    // "output"
std::string_view WaitKindName(machine::WaitKind kind);  // "dwell"

// One line of text without line end: "12.345678 45/7 move LIN tip 1.0 2.0 3.0 A 0.0 B 0.0
// feed 50.0".
std::string TraceText(const TraceRecord& record);
void AppendTraceText(const TraceRecord& record, std::string& line);  // the same

// Takes one record; false: no more.
using TraceSink = std::function<bool(const TraceRecord&)>;

// Turns what a run tells into records.
class TraceRecorder final : public machine::RunObserver {
 public:
  // Precondition: `sink` is not empty.
  explicit TraceRecorder(TraceSink sink, std::uint64_t records_max = kTraceRecordsMax);

  void OnMove(const machine::MoveDone& move) override;
  void OnSignal(const machine::SignalChange& change) override;
  void OnWait(const machine::Wait& wait) override;
  void OnHalt(const machine::Halt& halt) override;
  void OnResume(SimTime at, const machine::Place& place) override;
  void OnProgram(SimTime at, const machine::Place& place, std::string_view what,
                 int program) override;
  void OnMessage(SimTime at, const machine::Place& place, std::string_view text) override;
  void OnDiagnostic(SimTime at, const Diagnostic& diagnostic) override;

  // Once, when the run is over. The end is recorded even when the budget is used up.
  void End(SimTime at, const machine::Outcome& outcome);

  std::uint64_t records() const { return records_; }
  std::uint64_t dropped() const { return dropped_; }

 private:
  TraceRecord* Begin(TraceKind kind, SimTime at, const machine::Place& place);
  void Emit();

  TraceSink sink_;
  std::uint64_t records_max_;
  std::uint64_t records_ = 0;
  std::uint64_t dropped_ = 0;
  bool closed_ = false;
  TraceRecord record_;
};

}  // namespace rmlcell::simulation
