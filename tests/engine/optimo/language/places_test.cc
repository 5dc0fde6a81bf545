#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "tests/engine/optimo/language/compile_text.h"
#include "tests/engine/optimo/language/marked_text.h"

// What the compiler says, and of which characters. The braces of a row are no part of its text:
// they stand around what the finding is about.
namespace rmlcell::optimo {
namespace {

struct Row {
  std::string_view text;
  int number;
  std::string_view rule = "";
  int step = 1;
};

void ExpectAtItsPlace(const Row& row) {
  const Marked marked = WithoutBraces(row.text);
  const Compilation compiled = Compile(marked.text, "", {.advice = false});
  ASSERT_EQ(compiled.diagnostics.size(), 1U) << row.text;
  const Diagnostic& found = compiled.diagnostics[0];
  EXPECT_EQ(Lookup(found.code).number, row.number) << row.text;
  EXPECT_EQ(found.where, marked.span)
      << row.text << found.where.line << ":" << found.where.column << "+" << found.where.length;
  EXPECT_EQ(found.step, row.step) << row.text;
  EXPECT_EQ(found.rule, row.rule) << row.text;
  EXPECT_FALSE(found.detail.empty()) << row.text;
  EXPECT_EQ(compiled.ok, !IsError(found.severity)) << row.text;
}

// OPT-1.33, OPT-E.7001, OPT-E.7003, OPT-E.7005: what cannot stand where it stands.
TEST(Places, OfTokensThatCannotStandThere) {
  const std::vector<Row> rows = {
      {"SPEED {#}\n", 7001, "OPT-1.32"},
      {"SPEED 5{#$}5\n", 7001, "OPT-1.32"},
      {"SPEED 20 {\xC2\xB0} ; \xC2\xB0\n", 7001, "OPT-1.32"},
      {"SPEED 5 {PATH} LIN\n", 7003},
      {"SPEED{}\n", 7003},
      {"COORD {LIN}\n", 7003},
      {"PATH {ABSOL}\n", 7003},
      {"PATH LIN {(}3)\n", 7003},
      {"{)}\n", 7003},
      {"{FLY}\n", 7003},
      {"GOTO X{}\n", 7003},
      {"GOSUB {VI}[2]\n", 7003},
      {"IF VL[1] {GOTO} 5\n", 7003},
      {"VL[0] = 1 < 2 {<} 3\n", 7003, "OPT-B.43"},
      {"VR[0] = 1 + {NOT} VL[1]\n", 7003, "OPT-7.87"},
      {"VR[0] = SIN {5.}\n", 7003},
      {"WORK 0,0 /{FLYY}\n", 7003},
      {"DECLARE {2}X = VR[1]\n", 7003, "", 0},
      {"DECLARE X {VR}[1]\n", 7003, "", 0},
      {"DECLARE X = {1.2.3}\n", 7005, "OPT-B.42", 0},
      {"VR[0] = {5..}\n", 7005, "OPT-B.42"},
      {"VR[0] = {1E100}\n", 7005, "OPT-B.42"},
      {"VR[0] = 1. + {0}x5\n", 7005, "OPT-B.42"},
      {"UPDATE {VR} /ON\n", 7003},
      {"ASSIGN OL[32]={1.5} /4\n", 7003},
      {"ASSIGN OL[32]={-}VI[1] /4\n", 7003},
      {"BREAK {1.}\n", 7003},
      {"TIMER /{AUTO}\n", 7003},
      {"MOVE (1,2{/}FLY)\n", 7003},
      {"CALL 6 (1{/}ON)\n", 7003},
  };
  for (const Row& row : rows) ExpectAtItsPlace(row);
}

// OPT-E.7004, OPT-E.7006, OPT-E.7017, OPT-E.7402, OPT-E.7403: numbers outside their range.
TEST(Places, OfNumbersOutsideTheirRange) {
  const std::vector<Row> rows = {
      {"SPEED {101}\n", 7004, "OPT-2.35"},
      {"; a comment\n\n  10 ACCEL  {-1.5} ; no\n", 7004, "OPT-2.35"},
      {"SPEED 5\nOVERSH {-(1)}\n", 7004, "OPT-2.35", 2},
      {"DELAY {-1}\n", 7004, "OPT-3.45"},
      {"SETERR {0}\n", 7004, "OPT-3.61"},
      {"GO {100} /C\n", 7004, "OPT-7.06"},
      {"CALL {0} (1)\n", 7004, "OPT-7.06"},
      {"FUNCTION {100} (1)\n", 7004, "OPT-9.01"},
      {"VR[0] = 1 + {1E19}\n", 7004, "OPT-7.62"},
      {"BREAK {10000}\n", 7004, "OPT-6.15"},
      {"SIMUL 5, {100}\n", 7004, "OPT-6.15"},
      {"WORKDEF 1,0 ({0.}, 80., 1., 90.)\n", 7004, "OPT-3.08"},
      {"WORKDEF 1,0 (8., {101.}, 1., 90.)\n", 7004, "OPT-3.08"},
      {"WORKDEF 1,0 (8., 80., {-1.}, 90.)\n", 7004, "OPT-3.08"},
      {"WORKDEF 1,0 (8., 80., 1., {101.})\n", 7004, "OPT-3.08"},
      {"WORKDEF 1,0 (8., 80., 1., 90., {64})\n", 7403, "OPT-3.06"},
      {"WORKDEF 2,0 ({0})\n", 7403, "OPT-3.06"},
      {"WORKDEF {3},0\n", 7402, "OPT-3.02"},
      {"WORK 2,{10} /OFF\n", 7402, "OPT-3.02"},
      {"{ASSIGN OL[32]=0 /17} ; no\n", 7004, "OPT-7.102"},
      {"ASSIGN OL[32]={16} /4\n", 7206, "OPT-7.103"},
      {"{ASSIGN OL[97]=0 /4}\n", 7206, "OPT-7.103"},
      {"5 MOVE (1,2,3,4,5)/TIME ({-1.},5)/FLY\n", 7004, "OPT-2.54"},
      {"SPEED 5\n{10000} SPEED 5\n", 7006, "OPT-1.23", 2},
      {"GOTO {10000}\n", 7006, "OPT-1.23"},
      {"{99999999999} SPEED 5\n", 7006, "OPT-1.23"},
      {"GOTO {4294967297}\n", 7006, "OPT-1.23"},
      {"{00012} SPEED 5\n", 7006, "OPT-1.23"},
      {"GOSUB {00010}\n", 7006, "OPT-1.23"},
      {"VR[{100}] = 1.\n", 7017, "OPT-7.59"},
      {"VR[1] = PAR[{8}]\n", 7017, "OPT-7.59"},
      {"VR[1] = VR[{1.}]\n", 7017, "OPT-7.60"},
      {"VR[1] = VR[{VI}[2]]\n", 7017, "OPT-7.60"},
      {"DEFINE PAR[{8}] = INT\n", 7017, "OPT-9.21"},
      {"DECLARE F = 7.5\nSPEED 5\nVR[1] = 2. * {VR[F]}\n", 7017, "OPT-7.60", 2},
  };
  for (const Row& row : rows) ExpectAtItsPlace(row);
}

// OPT-E.7009, OPT-E.7010, OPT-E.7011, OPT-E.7012, OPT-E.7014: names.
TEST(Places, OfNames) {
  const std::vector<Row> rows = {
      {"DECLARE {C} = VR[1]\n", 7009, "OPT-7.48", 0},
      {"DECLARE {FUNCTION1} = VR[1]\n", 7009, "OPT-7.48", 0},
      {"DECLARE X = VR[1]\nDECLARE {X} = VR[2]\n", 7010, "OPT-7.49", 0},
      {"{FOO} 3\n", 7011, "OPT-7.91"},
      {"10 {START1} SPEED 5\n", 7011, "OPT-7.91"},
      {"SPEED 5\nVR[0] = 1. + {QQ}\n", 7011, "OPT-7.50", 2},
      {"{QQ} = 5.\n", 7011, "OPT-7.50"},
      {"MOVE (1,2,3,4,5)/VIA (1,2,{QQ},4,5)\n", 7011, "OPT-7.50"},
      {"CALL 6 ({QQ}, 1)\n", 7011, "OPT-7.50"},
      {"FUNCTION {QQ}\n", 7011, "OPT-7.50"},
      {"ASSIGN {QQ}=1 /4\n", 7011, "OPT-7.50"},
      {"FUNCTION 6 (1, 2, {QQ})\n", 7011, "OPT-7.50"},
      {"DECLARE {POSITION1} = VR[1]\n", 7012, "OPT-7.46", 0},
      {"DECLARE A1 = VR[1]{+}1\n", 7014, "OPT-7.42", 0},
      {"DECLARE A1 = {SIN}(1.)\n", 7014, "OPT-7.42", 0},
      {"DECLARE A1 = {-}VR[1]\n", 7014, "OPT-7.42", 0},
  };
  for (const Row& row : rows) ExpectAtItsPlace(row);
}

// OPT-E.7015, OPT-E.7016, OPT-E.7018: what is assigned and compared.
TEST(Places, OfTypesAndTargets) {
  const std::vector<Row> rows = {
      {"DECLARE K = 5.\n{K} = 6.\n", 7015, "OPT-7.43"},
      {"LET {IL[3]} = ON\n", 7016, "OPT-7.66"},
      {"{VI[98]} = 1\n", 7016, "OPT-7.66"},
      {"ASSIGN {IL[12]} = 1 /4\n", 7016, "OPT-7.66"},
      {"OL[32] = {VR[1]}\n", 7018, "OPT-7.89"},
      {"VR[1] = {IL[3]}\n", 7018, "OPT-7.89"},
      {"VL[0] = {VR[1]} AND VL[2]\n", 7018, "OPT-7.89"},
      {"VL[0] = VL[2] OR {2}\n", 7018, "OPT-7.89"},
      {"VR[0] = {VL[1]} + 1\n", 7018, "OPT-7.89"},
      {"VR[0] = SIN({ON})\n", 7018, "OPT-7.89"},
      {"VL[0] = IL[3] {=} VR[1]\n", 7018, "OPT-7.85"},
      {"VL[0] = {IL[3]} > 1\n", 7018, "OPT-7.89"},
      {"SPEED {VL[1]}\n", 7018, "OPT-7.89"},
      {"GOTO {VL[2]} (5)\n5\n", 7018, "OPT-7.89"},
      {"CALL {VL[1]}\n", 7018, "OPT-7.89"},
      {"ASSIGN OL[32]={VL[1]} /4\n", 7018, "OPT-7.89"},
      {"ASSIGN {VR[12]}=1 /4\n", 7018, "OPT-7.102"},
      {"MOVE (1,2,3,4,{ON})\n", 7018, "OPT-7.89"},
      {"MOVE (1,2,3,4,5) /FLY /VIA ({ON},2,3,4,5)\n", 7018, "OPT-7.89"},
      {"PATH HOLE ({ON})\n", 7018, "OPT-7.89"},
  };
  for (const Row& row : rows) ExpectAtItsPlace(row);
}

// OPT-E.7007, OPT-E.7008, OPT-E.7019, OPT-E.7021, OPT-E.7022: statements and their attributes.
TEST(Places, OfStatementsAndAttributes) {
  const std::vector<Row> rows = {
      {"10 SPEED 5\n{010} SPEED 6\n", 7007, "OPT-1.25", 2},
      {"SPEED 5\n{GOTO 20} ; no\n", 7008, "OPT-7.16", 2},
      {"{MOVE (1,2,3,4,5) /TIME (1., 20)}\n", 7008, "OPT-7.16"},
      {"5 {MOVE} (1.,2.,3.,0.)\n", 7019, "OPT-2.01"},
      {"{MOVE}\n", 7019, "OPT-2.01"},
      {"MOVE (1,2,3,4,5)/{VIA} (1,2,3)\n", 7019, "OPT-2.31"},
      {"{SYSDEF} (1,2,3)\n", 7019, "OPT-7.38"},
      {"{TCP} (0,0,3)\n", 7019, "OPT-4.72"},
      {"{TCP}\n", 7019, "OPT-4.72"},
      {"{MOVE} = 5\n", 7019, "OPT-2.01"},
      {"{TCP} (0,0,VR[1]/2/0,0,-5)\n", 7019, "OPT-B.85"},
      {"{WORKDEF} 0,0 (5)\n", 7019, "OPT-3.03"},
      {"{WORKDEF} 1,0 (5)\n", 7019, "OPT-3.04"},
      {"{WORKDEF} 2,0\n", 7019, "OPT-3.06"},
      {"SPEED 5 /{FLY}\n", 7020, "OPT-2.43"},
      {"MOVE (1,2,3,4,5)/FLY /{FLY}\n", 7021, "OPT-2.43"},
      {"WORK 0,0/ON/{OFF}\n", 7021, "OPT-2.43"},
      {"GO 46 /C/{S}\n", 7021, "OPT-2.43"},
      {"TIMER /DIS/{DIS}\n", 7021, "OPT-2.43"},
      {"{GET}\n", 7022, "OPT-W.17"},
      {"PATH {FRE}\n", 7022, "OPT-W.59"},
      {"VR[1] = {CLOCK}\n", 7022, "OPT-W.64"},
      {"5 TIMER (1.,5) /{INTR}\n", 7022, "OPT-W.64"},
      {"{CONT} 3\n", 7023, "OPT-E.7023"},
      {"{TASK 2}\n", 7023, "OPT-W.44"},
      {"{MOVE (1,2,3,4,5)/INF}\n", 7023, "OPT-2.61"},
      {"5 {WORK 0,0/ON /TIME (1.,5)}\n", 7023, "OPT-3.38"},
      {"DEFINE {VR}[1] = INT\n", 7025, "OPT-9.23"},
      {"DEFINE PAR[3] = {VR}\n", 7025, "OPT-9.23"},
      {"DEFINE PAR[0] = INT\n{DEFINE PAR[0] = INT}\n", 7025, "OPT-B.88", 2},
      {"VR[1] = PAR[1]\n{DEFINE PAR[1] = INT}\n", 7026, "OPT-9.25", 2},
      {"{CALL} 6 (1,2,3,4,5,6,7,8,9)\n", 7027, "OPT-9.20"},
      {"FUNCTION {VI}[2]\n", 7029, "OPT-9.01"},
      {"DECLARE V = VI[2]\nFUNCTION {V}\n", 7029, "OPT-9.01"},
      {"DEFINE {PAR} = INT\n", 7036, "OPT-9.24"},
  };
  for (const Row& row : rows) ExpectAtItsPlace(row);
}

struct Statement {
  std::string_view text;
  std::string_view attributes;  // those that it may have, each between blanks
};

// OPT-2.43, OPT-3.38, OPT-7.02, OPT-B.59, OPT-E.7020: each attribute on each instruction.
TEST(Places, OfAttributesThatAnInstructionDoesNotHave) {
  const std::vector<Statement> statements = {
      {"MOVE (1,2,3,4,5)", " VIA FLY START END TIME NEXT INF "},
      {"WORK 0,0 ", " ON OFF START END TIME NEXT "},
      {"GO 46", " C R S "},
      {"TIMER (1.,5)", " AUTO "},
      {"UPDATE OL", " ON OFF "},
      {"COORD ABSOL", ""},
      {"PATH LIN", ""},
      {"SPEED 5", ""},
      {"ACCEL 5", ""},
      {"OVERSH 5", ""},
      {"DELAY 5", ""},
      {"SYSDEF", ""},
      {"TCP (0,0,6/0,0,1)", ""},
      {"WORKDEF 0,0", ""},
      {"CALL 46", ""},
      {"FUNCTION 46", ""},
      {"GOTO 5", ""},
      {"GOTO VI[2] (5)", ""},
      {"GOSUB 5", ""},
      {"IF VL[0] THEN 5", ""},
      {"WAIT IL[20]", ""},
      {"RETURN", ""},
      {"ENDTASK", ""},
      {"PAUSE", ""},
      {"STOP", ""},
      {"ERR 5", ""},
      {"NOERR", ""},
      {"SETERR 5", ""},
      {"TASK 1", ""},
      {"VR[0] = 5", ""},
      {"LET VL[0] = VL[1]", ""},
      {"DECLARE X = 5", ""},
      {"DEFINE PAR[0] = INT", ""},
      {"ASSIGN OL[32] = 5 /4", ""},
      {"IMAGE OL", ""},
      {"REAL", ""},
      {"BREAK 7", ""},
      {"SIMUL 7", ""},
      {"ZERO", ""},
  };
  const std::vector<std::pair<std::string, std::string>> attributes = {{"VIA", " (1,2,3,4,5)"},
                                                                       {"FLY", ""},
                                                                       {"START", " (IL[20])"},
                                                                       {"END", " (IL[20])"},
                                                                       {"TIME", " (1.,5)"},
                                                                       {"NEXT", ""},
                                                                       {"INF", ""},
                                                                       {"ON", ""},
                                                                       {"OFF", ""},
                                                                       {"C", ""},
                                                                       {"R", ""},
                                                                       {"S", ""},
                                                                       {"AUTO", ""},
                                                                       {"DIS", ""}};
  for (const Statement& statement : statements) {
    for (const auto& [word, rest] : attributes) {
      const std::string head = "5 " + std::string(statement.text) + " /";
      const std::string text = head + word + rest + "\n";
      const bool allowed = statement.attributes.find(" " + word + " ") != std::string_view::npos;
      int refused = 0;
      for (const Diagnostic& d : Compile(text, "", {.advice = false}).diagnostics) {
        if (d.code != ErrorCode::kAttributeNotAllowed) continue;
        ++refused;
        EXPECT_EQ(d.where.column, static_cast<int>(head.size()) + 1) << text;
        EXPECT_EQ(d.where.length, static_cast<int>(word.size())) << text;
      }
      EXPECT_EQ(refused, allowed ? 0 : 1) << text;
    }
  }
}

// OPT-7.41, OPT-7.48, OPT-7.60, OPT-9.22, OPT-1.22: one error is told once, not again wherever what
// it was about is used.
TEST(Places, OfOneErrorAndNoneThatFollows) {
  for (const Row& row : {
           Row{"{DECLAER} DIST = VR[2]\nDIST = 5.\nVR[3] = DIST\n", 7011, "OPT-7.91"},
           Row{"DECLARE DIST = VR[2]{]}\nDIST = 5.\n", 7003, "", 0},
           Row{"DECLARE DIST = VR[1] {5}\nDIST = 5.\n", 7003, "", 0},
           Row{"DECLARE DIST = VR[{NOPE}]\nDIST = 5.\nVR[3] = DIST\n", 7011, "OPT-7.50", 0},
           Row{"DECLARE HALF = 5.5\nDECLARE DIST = {VR[HALF]}\nDIST = 5.\n", 7017, "OPT-7.60", 0},
           Row{"DEFINE PAR[0] = {LOGC}\nVL[0] = PAR[0]\nVR[0] = PAR[0]\n", 7025, "OPT-9.23"},
           Row{"DECLARE {C} = 5\nVR[C] = 1.\n", 7009, "OPT-7.48", 0},
           Row{"VR[0] = (1. + 2.{}\nVR[5] = 3.\n", 7003},
           Row{"ASSIGN {VR[1]} = 1 /4\n", 7018, "OPT-7.102"},
           Row{"{GOTO VI[2] (60,60)}\n", 7008, "OPT-7.16"},
       }) {
    ExpectAtItsPlace(row);
  }
  EXPECT_EQ(FindingsOf("ASSIGN VL[22] = 0 /100\n", true), std::vector<int>{7004});
}

}  // namespace
}  // namespace rmlcell::optimo
