#include "clients/cli/handbox_screen.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "clients/cli/handbox_keys.h"

namespace rmlcell::cli {
namespace {

// An Optimo in MANUAL, with a program selected.
HandboxView Standing() {
  HandboxView view;
  view.marks = false;
  view.panel.set_display("P=45S=0012I=MOVE    ");
  view.panel.set_mode(v1::OPERATING_MODE_MANUAL);
  for (const char* lamp : {"MANUAL", "ROB", "SHIFT"}) view.panel.add_lamps(lamp);
  view.panel.set_holder("anna");
  view.panel.set_run_on_mm(15.26);
  view.panel.set_run_on_rad(0.5);
  v1::MachineStatus& status = view.status;
  status.set_machine("machines/optimo-1");
  status.set_state(v1::MACHINE_STATE_IDLE);
  status.set_override_percent(40.0);
  status.set_zeroed(true);
  status.mutable_control()->set_client("rmlcell handbox");
  const auto axis = [&status](const char* name, double value, v1::Unit unit) {
    v1::AxisValue& made = *status.add_axes();
    made.set_axis(name);
    made.set_value(value);
    made.set_unit(unit);
  };
  axis("X", 1234.5, v1::UNIT_MILLIMETRE);
  axis("Y", 0.0, v1::UNIT_MILLIMETRE);
  axis("Z", -400.125, v1::UNIT_MILLIMETRE);
  axis("A", 1.5707963267948966, v1::UNIT_RADIAN);
  axis("B", -0.1, v1::UNIT_RADIAN);
  return view;
}

// Without blanks at the end of lines.
std::string Text(const HandboxView& view) {
  std::string text = "\n";
  for (const std::string& line : HandboxLines(view))
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  return text;
}

// LIVE-7.11
TEST(HandboxScreen, ShowsTheHandboxWithWhatToType) {
  HandboxView view = Standing();
  view.down = {"X+"};
  view.note = "REC: OPT-E7601: this key is not enabled";
  EXPECT_EQ(Text(view), R"(
 optimo-1  IDLE  MANUAL  override 40 %                        q or Ctrl-C quits

  +----------------------+    lamps    MANUAL  ROB  SHIFT
  | P=45S=0012I=MOVE     |    pressed  by anna (rmlcell handbox)
  +----------------------+    runs on  15.3 mm, 28.6 deg when let go

  X  1234.500  Y     0.000  Z  -400.125  mm   A    90.000  B    -5.730  deg


  ( MODE<   ) MODE>   _ OVER-   + OVER+             s START Spc STOP    h HOLD
Tab*SHIFT   S STEP    N NOTE    O ZERO  Hom HOME              ! EMERGENCY STOP

  R*ROB     W ABS     T TCP       7         8         9       < PREV    > NEXT
  x>X+      y Y+      z Z+        4         5         6       r REC     m MOD
  X X-      Y Y-      Z Z-        1         2         3     Del DEL     e ERR
  a A+      b B+      c C+        0       . POINT   - MINUS Ent ENT
  A A-      B B-      C C-

  j JOB     t TCP     d DYN     p PATH    w WORK    l DLY     v MOV     o OUT
  g DEB     k CAL     P PAR     D DISP
    F1        F2        F3        F4        F5        F6        F7        F8

  REC: OPT-E7601: this key is not enabled
  Axes move while a key repeats, or the mouse is down on it. 1: yes, 0: no.
)");
}

// What a person must see: what the control asks, and why nothing goes.
TEST(HandboxScreen, ShowsWhatFlashesAndWhatIsWrong) {
  HandboxView view = Standing();
  view.panel.set_flashing(true);
  view.status.set_zeroed(false);
  view.status.set_hold_reason(v1::HOLD_REASON_PANEL);
  v1::Alarm& alarm = *view.status.add_alarms();
  alarm.set_id(3);
  alarm.mutable_diagnostic()->set_code("OPT-E12");
  alarm.mutable_diagnostic()->set_message("emergency stop");
  view.panel.set_message_code("OPT-E12");
  const std::string text = Text(view);
  for (const char* part :
       {"flashing", "alarm 3 OPT-E12: emergency stop; held by PANEL; axes without reference",
        "\n  OPT-E12\n"})
    EXPECT_NE(text.find(part), std::string::npos) << part << text;
  view.marks = true;
  const std::string light = Text(view);
  view.flash = true;
  EXPECT_NE(Text(view), light);
  view.panel.set_flashing(false);
  const std::string still = Text(view);
  view.flash = false;
  EXPECT_EQ(Text(view), still);
}

// Lines of the screen, from 0.
std::string LineOf(const HandboxView& view, std::size_t row) {
  std::istringstream text(Text(view).substr(1));
  std::string line;
  for (std::size_t at = 0; at <= row; ++at) std::getline(text, line);
  return line;
}

TEST(HandboxScreen, SaysWhatRunsOnAndWhoPresses) {
  HandboxView view = Standing();
  const auto runs_on = [&](double mm, double rad) {
    view.panel.set_run_on_mm(mm);
    view.panel.set_run_on_rad(rad);
    return LineOf(view, 4).substr(30);
  };
  EXPECT_EQ(runs_on(0.0, 0.0), "runs on  -");
  EXPECT_EQ(runs_on(1.0, 0.0), "runs on  1.0 mm, 0.0 deg when let go");
  EXPECT_EQ(runs_on(0.0, 0.5), "runs on  0.0 mm, 28.6 deg when let go");
  view.status.mutable_control()->clear_client();
  EXPECT_EQ(LineOf(view, 3).substr(30), "pressed  by anna");
  view.panel.clear_holder();
  EXPECT_EQ(LineOf(view, 3).substr(30), "pressed  by nobody");
}

// The program that was started, where the place names none; none: somebody's hand.
TEST(HandboxScreen, SaysWhatRuns) {
  HandboxView view = Standing();
  EXPECT_EQ(LineOf(view, 7), "");
  view.status.set_door_open(true);
  view.status.mutable_run()->set_run(5);
  EXPECT_EQ(LineOf(view, 7), "  door open; run 5, by hand");
  view.status.mutable_run()->set_program(1);
  EXPECT_EQ(LineOf(view, 7), "  door open; run 5, program 1, step 0");
  view.status.mutable_run()->mutable_place()->set_program(45);
  view.status.mutable_run()->mutable_place()->set_step(7);
  EXPECT_EQ(LineOf(view, 7), "  door open; run 5, program 45, step 7");
}

TEST(HandboxScreen, HasAButtonWhereItsKeyIs) {
  HandboxView view = Standing();
  const std::vector<std::string> lines = HandboxLines(view);
  ASSERT_EQ(lines.size(), 24U);
  for (const std::string& line : lines) EXPECT_LE(line.size(), 80U) << line;
  for (const HandboxKey& key : AllHandboxKeys()) {
    const std::string button =
        lines[static_cast<std::size_t>(key.row)].substr(static_cast<std::size_t>(key.cell) * 10);
    EXPECT_EQ(button.substr(4, key.label.size()), key.label);
    const std::string typed(key.typed == key.label ? "" : key.typed);
    EXPECT_EQ(button.substr(0, 3), std::string(3 - typed.size(), ' ') + typed);
  }
}

// Names of people and messages come from elsewhere: they must not steer a terminal.
TEST(HandboxScreen, DrawsNoForeignSequence) {
  HandboxView view = Standing();
  view.panel.set_holder("\x1b[2Jmallory");
  view.panel.set_display("\x1b]0;\x07");
  view.note = std::string(300, 'n') + "\x1b[6n";
  for (const std::string& line : HandboxLines(view)) {
    EXPECT_EQ(line.find('\x1b'), std::string::npos) << line;
    EXPECT_LE(line.size(), 80U);
  }
}

// LIVE-7.11: the whole of it, or the reason why not; nothing that looks like a button.
TEST(HandboxScreen, SaysThatATerminalIsTooSmall) {
  HandboxView view = Standing();
  for (const auto& [rows, columns] : {std::pair{23, 80}, std::pair{24, 79}, std::pair{5, 20}}) {
    view.rows = rows;
    view.columns = columns;
    EXPECT_FALSE(HasRoom(view));
    const std::vector<std::string> lines = HandboxLines(view);
    EXPECT_LE(lines.size(), static_cast<std::size_t>(rows));
    EXPECT_EQ(lines[0], "too small: " + std::to_string(columns) + " x " + std::to_string(rows));
    for (const std::string& line : lines) EXPECT_LE(line.size(), static_cast<std::size_t>(columns));
  }
  view.rows = 0;
  view.columns = 0;
  EXPECT_TRUE(HandboxLines(view).empty());
  view.rows = 24;
  view.columns = 80;
  EXPECT_TRUE(HasRoom(view));
  view.rows = 60;
  view.columns = 200;
  EXPECT_TRUE(HasRoom(view));
}

TEST(HandboxScreen, DrawsWhatHasChanged) {
  EXPECT_EQ(Redrawn({}, {"a", "", "c"}), "\x1b[1;1H\x1b[Ka\x1b[3;1H\x1b[Kc");
  EXPECT_EQ(Redrawn({"a", "b", "c"}, {"a", "B", "c"}), "\x1b[2;1H\x1b[KB");
  EXPECT_EQ(Redrawn({"a", "b"}, {"a"}), "\x1b[2;1H\x1b[K");
  EXPECT_EQ(Redrawn({"a"}, {"a"}), "");
  EXPECT_EQ(Redrawn({}, {"", "b"}), "\x1b[2;1H\x1b[Kb");
  EXPECT_EQ(Redrawn({"a"}, {""}), "\x1b[1;1H\x1b[K");
}

}  // namespace
}  // namespace rmlcell::cli
