#include "engine/machine/machine_note.h"

#include <algorithm>
#include <array>
#include <limits>
#include <ranges>
#include <utility>

#include "engine/core/number_text.h"

namespace rmlcell::machine {
namespace {

constexpr std::size_t kBreakpointsRead = 10'000;  // as many as a machine once could have

constexpr std::string_view kHeader = "rmlcell machine 1";
constexpr std::size_t kAlarmsMax = 10'000;  // of one kind there is one
constexpr std::array kModes = {Mode::kRemote, Mode::kCycle, Mode::kSingle, Mode::kRepeat,
                               Mode::kManual};

// Of what a person reads, in one line.
std::string OneLine(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  }
  return text;
}

class Lines {
 public:
  template <class... Values>
  void Add(std::string_view key, const Values&... values) {
    text_ += key;
    ((text_ += ' ', Put(values)), ...);
    text_ += '\n';
  }
  std::string Take() { return std::move(text_); }

 private:
  void Put(std::string_view text) { text_ += text; }
  void Put(const char* text) { text_ += text; }
  void Put(const std::string& text) { text_ += text; }
  void Put(double value) { text_ += ShortestText(value); }
  template <std::integral Number>
  void Put(Number value) {
    text_ += std::to_string(value);
  }

  std::string text_;
};

// The words of one line; the last one may be the rest of it.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}

  std::string_view Next() {
    const std::size_t end = std::min(rest_.find(' '), rest_.size());
    const std::string_view word = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    return word;
  }
  std::string_view Rest() { return std::exchange(rest_, {}); }

  template <std::integral Number>
  void Take(Number& number, long long low, long long high) {
    const auto value = ParseInteger(Next());
    if (!value || *value < low || *value > high) {
      good_ = false;
    } else {
      number = static_cast<Number>(*value);
    }
  }
  void Take(bool& flag) {
    int value = 0;
    Take(value, 0, 1);
    flag = value == 1;
  }
  void Take(SimTime& time) {
    std::int64_t ns = 0;
    Take(ns, 0, std::numeric_limits<std::int64_t>::max());
    time = SimTime(ns);
  }
  void Take(ProgramStep& step) {
    Take(step.program, 0, kSlotMax);
    Take(step.step, 0, std::numeric_limits<int>::max());
  }
  void Refuse() { good_ = false; }
  bool good() const { return good_ && rest_.empty(); }

 private:
  std::string_view rest_;
  bool good_ = true;
};

constexpr long long kAny = std::numeric_limits<std::int64_t>::max();
constexpr int kIntMax = std::numeric_limits<int>::max();

void TakeAlarm(Words& words, MachineNote& note) {
  Alarm alarm;
  words.Take(alarm.id, 1, kAny);
  const std::string_view symbol = words.Next();
  const auto row = std::ranges::find(Catalogue(), symbol, &CatalogueEntry::symbol);
  if (row == Catalogue().end() || note.alarms.size() >= kAlarmsMax) return words.Refuse();
  alarm.code = row->code;
  words.Take(alarm.at);
  words.Take(alarm.place.program, 0, kSlotMax);
  words.Take(alarm.place.step, 0, kIntMax);
  words.Take(alarm.place.line, 0, kIntMax);
  words.Take(alarm.place.byte_offset, -1, kAny);
  alarm.detail = std::string(words.Rest());
  note.alarms.push_back(std::move(alarm));
}

void TakeBreakpoint(Words& words, MachineNote& note) {
  Breakpoint breakpoint;
  words.Take(breakpoint.at);
  words.Take(breakpoint.from_pass, 1, static_cast<long long>(kBreakpointPassMax));
  breakpoint.condition = words.Rest();
  if (note.breakpoints.size() >= kBreakpointsRead) return words.Refuse();
  note.breakpoints.push_back(std::move(breakpoint));
}

bool TakeLine(std::string_view line, MachineNote& note) {
  Words words(line);
  const std::string_view key = words.Next();
  if (key == "time") {
    words.Take(note.time);
  } else if (key == "on") {
    words.Take(note.on);
  } else if (key == "emergency") {
    words.Take(note.emergency);
  } else if (key == "cover_open") {
    words.Take(note.cover_open);
  } else if (key == "mode") {
    const auto mode =
        std::ranges::find(kModes, words.Next(), static_cast<std::string_view (*)(Mode)>(&Name));
    if (mode == kModes.end()) return false;
    note.mode = *mode;
  } else if (key == "override") {
    const auto percent = ParseDouble(words.Next());
    if (!percent || !(*percent > 0.0) || *percent > 1000.0) return false;
    note.override_percent = *percent;
  } else if (key == "simulation") {
    words.Take(note.simulation.emplace());
  } else if (key == "breakpoint") {
    TakeBreakpoint(words, note);
  } else if (key == "alarm") {
    TakeAlarm(words, note);
  } else if (key == "last_alarm") {
    words.Take(note.last_alarm, 0, kAny);
  } else if (key == "last_run") {
    words.Take(note.last_run, 0, kAny);
  } else if (key == "shown") {
    words.Take(note.shown.program, 0, kSlotMax);
    words.Take(note.shown.step, 0, kIntMax);
    note.shown.instruction = words.Rest();
  } else if (key == "message") {
    const std::string_view code = words.Rest();
    const std::vector<const CatalogueEntry*> rows = FindByText(code);
    if (rows.size() != 1 || CodeText(rows.front()->code) != code) return false;
    note.message = rows.front()->code;
  } else if (key == "gates") {
    for (int& program : note.gates) words.Take(program, 0, kSlotMax);
  } else if (key == "handbox") {
    note.handbox = words.Rest();
  } else {
    return false;
  }
  return words.good();
}

}  // namespace

std::string_view Name(Mode mode) {
  switch (mode) {
    case Mode::kRemote:
      return "REMOTE";
    case Mode::kCycle:
      return "CYCLE";
    case Mode::kSingle:
      return "SINGLE";
    case Mode::kRepeat:
      return "REPEAT";
    case Mode::kManual:
      break;
  }
  return "MANUAL";
}

std::string WriteMachineNote(const MachineNote& note) {
  Lines lines;
  lines.Add(kHeader);
  lines.Add("time", note.time.count());
  lines.Add("on", note.on ? 1 : 0);
  lines.Add("emergency", note.emergency ? 1 : 0);
  if (note.cover_open) lines.Add("cover_open", 1);
  lines.Add("mode", Name(note.mode));
  lines.Add("override", note.override_percent);
  if (note.simulation) lines.Add("simulation", note.simulation->program, note.simulation->step);
  for (const Breakpoint& breakpoint : note.breakpoints) {
    lines.Add("breakpoint", breakpoint.at.program, breakpoint.at.step, breakpoint.from_pass,
              OneLine(breakpoint.condition));
  }
  for (const Alarm& alarm : note.alarms) {
    lines.Add("alarm", alarm.id, Lookup(alarm.code).symbol, alarm.at.count(), alarm.place.program,
              alarm.place.step, alarm.place.line, alarm.place.byte_offset, OneLine(alarm.detail));
  }
  lines.Add("last_alarm", note.last_alarm);
  lines.Add("last_run", note.last_run);
  if (note.shown != ShownStep())
    lines.Add("shown", note.shown.program, note.shown.step, note.shown.instruction);
  if (note.message) lines.Add("message", CodeText(*note.message));
  if (note.gates != std::array<int, kGates>()) lines.Add("gates", note.gates[0], note.gates[1]);
  if (!note.handbox.empty()) lines.Add("handbox", OneLine(note.handbox));
  lines.Add("family");
  return lines.Take() + note.family;
}

Result<MachineNote> ReadMachineNote(std::string_view text) {
  const Error bad{ErrorCode::kCellBadText, "this is no state of a machine of this version", {}};
  MachineNote note;
  bool first = true;
  for (;;) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return bad;
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 1);
    if (line == "family") break;
    if (first ? line != kHeader : !TakeLine(line, note)) return bad;
    first = false;
  }
  if (first) return bad;
  note.family = text;
  return note;
}

}  // namespace rmlcell::machine
