#include "clients/cli/handbox_screen.h"

#include <algorithm>
#include <cstddef>
#include <numbers>
#include <string_view>
#include <utility>

#include "clients/cli/handbox_keys.h"
#include "clients/cli/machine_call.h"
#include "clients/cli/terminal.h"

namespace rmlcell::cli {
namespace {

constexpr std::size_t kDisplayWidth = 20;  // OPT-4.01
constexpr std::size_t kDisplayColumn = 2;
constexpr std::size_t kFactsColumn = 30;

enum class Look { kPlain, kBold, kReversed };

// Text of one line, and its width beside the marks in it.
class Line {
 public:
  explicit Line(bool marks) : marks_(marks) {}

  // Nothing where it is beyond the column: what came before was too long.
  Line& To(std::size_t column) { return Add(std::string(column - std::min(column, width_), ' ')); }
  // Foreign text may stand in it. What is too long is cut off.
  Line& Add(std::string_view text, Look look = Look::kPlain) {
    std::string shown = Visible(text);
    const auto begins = [](char byte) {
      return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U;
    };
    std::size_t end = 0;
    for (; end < shown.size(); ++end) {
      if (!begins(shown[end])) continue;
      if (width_ == static_cast<std::size_t>(kHandboxColumns)) break;
      ++width_;
    }
    shown.resize(end);
    if (marks_ && look != Look::kPlain && !shown.empty())
      shown = (look == Look::kBold ? "\x1b[1m" : "\x1b[7m") + shown + "\x1b[0m";
    text_ += shown;
    return *this;
  }
  std::string Take() { return std::move(text_); }

 private:
  const bool marks_;
  std::size_t width_ = 0;
  std::string text_;
};

std::string Padded(std::string text, std::size_t width) {
  text.resize(std::max(text.size(), width), ' ');
  return text;
}

bool IsLit(const HandboxView& view, std::string_view lamp) {
  return std::ranges::find(view.panel.lamps(), lamp) != view.panel.lamps().end();
}

// What is typed, and the label: "x X+". "x>X+" is held, "R*ROB" is lit.
void AddButton(const HandboxView& view, const HandboxKey& key, Line& line) {
  const bool is_held = view.down.contains(std::string(key.name));
  // Lamps have the label of their key; but of two keys TCP it is the one of the jog.
  const bool is_lit = key.name != "TCP" && IsLit(view, key.label);
  constexpr std::size_t kTyped = 3;
  const auto begin = static_cast<std::size_t>(key.cell * kHandboxCell);
  const std::string_view typed = key.typed == key.label ? std::string_view() : key.typed;
  line.To(begin + kTyped - typed.size()).Add(typed, Look::kBold);
  line.Add(is_held ? ">" : is_lit ? "*" : " ");
  // As wide whatever it says, where it is reversed.
  constexpr std::size_t kLabel = 5;
  line.Add(Padded(std::string(key.label), kLabel),
           is_held || is_lit ? Look::kReversed : Look::kPlain);
}

std::string ButtonLine(const HandboxView& view, int row) {
  std::vector<const HandboxKey*> keys;
  for (const HandboxKey& key : AllHandboxKeys()) {
    if (key.row == row) keys.push_back(&key);
  }
  std::ranges::sort(keys, {}, &HandboxKey::cell);
  Line line(view.marks);
  for (const HandboxKey* key : keys) AddButton(view, *key, line);
  return line.Take();
}

std::string TitleLine(const HandboxView& view) {
  const v1::MachineStatus& status = view.status;
  std::string title = " " + status.machine().substr(status.machine().find('/') + 1) + "  " +
                      Short(v1::MachineState_Name(status.state()), "MACHINE_STATE_") + "  " +
                      Short(v1::OperatingMode_Name(view.panel.mode()), "OPERATING_MODE_") +
                      "  override " + Fixed(status.override_percent(), 0) + " %";
  constexpr std::string_view kQuit = "q or Ctrl-C quits ";
  title = Padded(title, static_cast<std::size_t>(kHandboxColumns) - kQuit.size());
  return Line(view.marks).Add(title + std::string(kQuit), Look::kReversed).Take();
}

std::string LampsText(const HandboxView& view) {
  std::string text;
  for (const std::string& lamp : view.panel.lamps()) text += (text.empty() ? "" : "  ") + lamp;
  return text;
}

std::string HolderText(const HandboxView& view) {
  const v1::ControlLease& control = view.status.control();
  if (view.panel.holder().empty()) return "nobody";
  return view.panel.holder() + (control.client().empty() ? "" : " (" + control.client() + ")");
}

std::string RunOnText(const HandboxView& view) {
  const double degrees = view.panel.run_on_rad() * 180.0 / std::numbers::pi;
  if (view.panel.run_on_mm() <= 0.0 && degrees <= 0.0) return "-";
  return Fixed(view.panel.run_on_mm(), 1) + " mm, " + Fixed(degrees, 1) + " deg when let go";
}

std::string PositionLine(const HandboxView& view) {
  Line line(view.marks);
  bool turns = false;
  line.Add("  ");
  for (const v1::AxisValue& axis : view.status.axes()) {
    if ((axis.unit() == v1::UNIT_RADIAN) != turns) line.Add("mm   ");
    turns = axis.unit() == v1::UNIT_RADIAN;
    std::string value = Fixed(turns ? axis.value() * 180.0 / std::numbers::pi : axis.value(), 3);
    value.insert(0, 9 - std::min<std::size_t>(9, value.size()), ' ');
    line.Add(axis.axis(), Look::kBold).Add(" " + value + "  ");
  }
  if (!view.status.axes().empty()) line.Add(turns ? "deg" : "mm");
  return line.Take();
}

// What a person should know before pressing anything.
std::string WarningLine(const HandboxView& view) {
  const v1::MachineStatus& status = view.status;
  std::string text;
  const auto add = [&text](const std::string& one) { text += (text.empty() ? "  " : "; ") + one; };
  for (const v1::Alarm& alarm : status.alarms())
    add("alarm " + std::to_string(alarm.id()) + " " + alarm.diagnostic().code() + ": " +
        alarm.diagnostic().message());
  if (status.hold_reason() != v1::HOLD_REASON_UNSPECIFIED)
    add("held by " + Short(v1::HoldReason_Name(status.hold_reason()), "HOLD_REASON_"));
  if (status.door_open()) add("door open");
  if (!status.zeroed()) add("axes without reference");
  if (status.has_run()) {
    const v1::MachineRun& run = status.run();
    const int program = run.place().program() > 0 ? run.place().program() : run.program();
    add("run " + std::to_string(run.run()) +
        (program > 0 ? ", program " + std::to_string(program) + ", step " +
                           std::to_string(run.place().step())
                     : ", by hand"));
  }
  return Line(view.marks).Add(text, Look::kBold).Take();
}

std::vector<std::string> TooSmall(const HandboxView& view) {
  const auto columns = static_cast<std::size_t>(std::max(view.columns, 0));
  std::vector<std::string> lines = {
      "too small: " + std::to_string(view.columns) + " x " + std::to_string(view.rows),
      "needs " + std::to_string(kHandboxColumns) + " x " + std::to_string(kHandboxRows),
      "Space STOP  h HOLD", "! EMERGENCY STOP", "q quits"};
  lines.resize(std::min(lines.size(), static_cast<std::size_t>(std::max(view.rows, 0))));
  for (std::string& line : lines) line.resize(std::min(line.size(), columns));
  return lines;
}

// The display in its frame, and facts beside it.
void AddTop(const HandboxView& view, std::vector<std::string>& lines) {
  const auto frame = [&](std::string_view text, std::string_view head, const std::string& fact) {
    return Line(view.marks)
        .To(kDisplayColumn)
        .Add(text)
        .To(kFactsColumn)
        .Add(head)
        .Add(fact)
        .Take();
  };
  lines.push_back(TitleLine(view));
  lines.emplace_back();
  lines.push_back(frame("+----------------------+", "lamps    ", LampsText(view)));
  const bool dark = view.panel.flashing() && view.flash;
  std::string display = Visible(view.panel.display());
  display.resize(kDisplayWidth, ' ');
  lines.push_back(Line(view.marks)
                      .To(kDisplayColumn)
                      .Add("|")
                      .Add(" " + display + " ", dark ? Look::kReversed : Look::kBold)
                      .Add("|")
                      .To(kFactsColumn)
                      .Add("pressed  by " + HolderText(view))
                      .Take());
  lines.push_back(
      frame(view.panel.flashing() ? "+------ flashing ------+" : "+----------------------+",
            "runs on  ", RunOnText(view)));
  lines.emplace_back();
  lines.push_back(PositionLine(view));
  lines.push_back(WarningLine(view));
}

}  // namespace

bool HasRoom(const HandboxView& view) {
  return view.rows >= kHandboxRows && view.columns >= kHandboxColumns;
}

std::vector<std::string> HandboxLines(const HandboxView& view) {
  if (!HasRoom(view)) return TooSmall(view);
  std::vector<std::string> lines;
  AddTop(view, lines);
  for (int row = static_cast<int>(lines.size()); row < kHandboxRows - 2; ++row)
    lines.push_back(ButtonLine(view, row));
  std::string note = view.note;
  if (note.empty() && !view.panel.message_code().empty()) note = view.panel.message_code();
  lines.push_back(Line(view.marks).Add("  " + note, Look::kBold).Take());
  lines.push_back(
      Line(view.marks)
          .Add("  Axes move while a key repeats, or the mouse is down on it. 1: yes, 0: no.")
          .Take());
  return lines;
}

std::string Redrawn(const std::vector<std::string>& before, const std::vector<std::string>& now) {
  std::string text;
  for (std::size_t row = 0; row < std::max(before.size(), now.size()); ++row) {
    const std::string_view line = row < now.size() ? std::string_view(now[row]) : "";
    if (row < before.size() && before[row] == line) continue;
    if (row >= before.size() && line.empty()) continue;  // it is blank as it comes
    // Cleared before: behind a line as wide as the screen that would clear its last character.
    text += "\x1b[" + std::to_string(row + 1) + ";1H\x1b[K" + std::string(line);
  }
  return text;
}

}  // namespace rmlcell::cli
