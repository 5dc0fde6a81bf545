#include <array>
#include <charconv>
#include <string>

#include "engine/core/hex.h"
#include "engine/core/number_text.h"
#include "engine/simulation/report/report.h"
#include "engine/simulation/report/trace.h"

namespace rmlcell::simulation {
namespace {

constexpr int kTimeDecimals = 6;    // microseconds
constexpr int kLengthDecimals = 6;  // as in every report: motion.md 8.2
constexpr int kAngleDecimals = 6;

void Word(std::string& line, std::string_view word) {
  line += ' ';
  line += word;
}

void Whole(std::string& line, char before, int value) {
  std::array<char, 16> room;
  room[0] = before;
  line.append(room.data(), std::to_chars(room.data() + 1, room.data() + room.size(), value).ptr);
}

void Number(std::string& line, double value, int decimals) {
  line += ' ';
  AppendTrimmed(line, value, decimals);
}

void Point(std::string& line, std::string_view name, const motion::MachinePoint& point) {
  Word(line, name);
  for (const double value : {point.x(), point.y(), point.z()}) Number(line, value, kLengthDecimals);
}

void Named(std::string& line, std::string_view name, double value, int decimals) {
  Word(line, name);
  Number(line, value, decimals);
}

// Words of a program may hold anything: one record stays one line.
void Quoted(std::string& line, std::string_view text) {
  line += " \"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') line += '\\';
    if (byte < 0x20 || byte == 0x7F) {
      line += "\\x" + HexOf({&c, 1});
    } else {
      line += c;
    }
  }
  line += '"';
}

void MoveText(std::string& line, const TraceRecord& record) {
  Word(line, record.text);
  Point(line, "tip", record.tip.tip);
  Named(line, "A", record.tip.a_rad, kAngleDecimals);
  Named(line, "B", record.tip.b_rad, kAngleDecimals);
  Point(line, "point", record.program_point.from_origin());
  Named(line, "feed", record.feed_mm_s, kLengthDecimals);
}

void SignalText(std::string& line, const TraceRecord& record) {
  Word(line, SignalName(record.signal));
  const bool indexed =
      record.signal == machine::Signal::kOutput || record.signal == machine::Signal::kAnalogue;
  if (indexed) line += '[' + std::to_string(record.index) + ']';
  Number(line, record.value, kLengthDecimals);
  if (record.signal == machine::Signal::kBeam && record.value != 0.0) {
    Named(line, "power", record.detail, kLengthDecimals);
  }
  if (record.signal == machine::Signal::kSpindle && record.value != 0.0) {
    Named(line, "rpm", record.detail, kLengthDecimals);
  }
}

}  // namespace

std::string_view TraceKindName(TraceKind kind) {
  switch (kind) {
    case TraceKind::kMove:
      return "move";
    case TraceKind::kSignal:
      return "signal";
    case TraceKind::kWait:
      return "wait";
    case TraceKind::kHalt:
      return "halt";
    case TraceKind::kResume:
      return "resume";
    case TraceKind::kProgram:
      return "program";
    case TraceKind::kMessage:
      return "message";
    case TraceKind::kFinding:
      return "finding";
    case TraceKind::kEnd:
      return "end";
  }
  return "unknown";
}

std::string_view SignalName(machine::Signal signal) {
  switch (signal) {
    case machine::Signal::kOutput:
      return "output";
    case machine::Signal::kAnalogue:
      return "analogue";
    case machine::Signal::kShutter:
      return "shutter";
    case machine::Signal::kBeam:
      return "beam";
    case machine::Signal::kSchedule:
      return "schedule";
    case machine::Signal::kGas:
      return "gas";
    case machine::Signal::kSensor:
      return "sensor";
    case machine::Signal::kSpindle:
      return "spindle";
    case machine::Signal::kSpindleSpeed:
      return "spindle_speed";
    case machine::Signal::kRotaryTable:
      return "rotary_table";
  }
  return "unknown";
}

std::string_view WaitKindName(machine::WaitKind kind) {
  switch (kind) {
    case machine::WaitKind::kDwell:
      return "dwell";
    case machine::WaitKind::kPierce:
      return "pierce";
    case machine::WaitKind::kSpinUp:
      return "spin_up";
    case machine::WaitKind::kCondition:
      return "condition";
    case machine::WaitKind::kOperator:
      return "operator";
    case machine::WaitKind::kLoad:
      return "load";
  }
  return "unknown";
}

std::string TraceText(const TraceRecord& record) {
  std::string line;
  AppendTraceText(record, line);
  return line;
}

void AppendTraceText(const TraceRecord& record, std::string& line) {
  AppendFixed(line, ToSeconds(record.at), kTimeDecimals);
  Whole(line, ' ', record.place.program);
  Whole(line, '/', record.place.step);
  Word(line, TraceKindName(record.kind));
  switch (record.kind) {
    case TraceKind::kMove:
      MoveText(line, record);
      break;
    case TraceKind::kSignal:
      SignalText(line, record);
      break;
    case TraceKind::kWait:
      Word(line, WaitKindName(record.wait));
      Number(line, ToSeconds(record.duration), kTimeDecimals);
      break;
    case TraceKind::kHalt:
      Quoted(line, record.text);
      break;
    case TraceKind::kResume:
      break;
    case TraceKind::kProgram:
      Word(line, record.text);
      Word(line, std::to_string(record.index));
      break;
    case TraceKind::kMessage:
      Quoted(line, record.text);
      break;
    case TraceKind::kFinding:
      Word(line, SeverityName(record.severity));
      Word(line, CodeText(*record.code));
      Quoted(line, record.text);
      break;
    case TraceKind::kEnd:
      Word(line, OutcomeText(record.outcome));
      if (record.code) {
        Word(line, CodeText(*record.code));
        Quoted(line, record.text);
      }
      break;
  }
}

}  // namespace rmlcell::simulation
