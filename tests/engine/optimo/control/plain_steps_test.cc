#include "engine/optimo/control/plain_steps.h"

#include <gtest/gtest.h>

#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/control/program_context.h"
#include "engine/optimo/language/compiler.h"
#include "tests/engine/optimo/control/run_text.h"
#include "tests/engine/optimo/language/random_expression.h"

// Plain steps do what the same instructions do one by one. A breakpoint, of whatever program, has
// the control look at each of them.
namespace rmlcell::optimo::testing::plain_steps {
namespace {

const machine::ProgramStep kElsewhere{.program = 99, .step = 1};

std::vector<std::string> AllVariables() {
  std::vector<std::string> names;
  for (const std::string group : {"VR", "VI", "VL"}) {
    for (int n = 0; n < 10; ++n) names.push_back(group + "[" + std::to_string(n) + "]");
  }
  return names;
}

// What is told of a run: steps with their lines, variables that it goes by, events.
class Told final : public machine::RunObserver {
 public:
  void OnStep(SimTime at, const machine::Place& place, std::string_view name) override {
    Tell(at, place, name);
  }
  void OnMove(const machine::MoveDone& move) override { Tell(move.at, move.place, "move"); }
  void OnSignal(const machine::SignalChange& change) override {
    Tell(change.at, change.place, "signal " + std::to_string(change.index));
  }
  void OnDiagnostic(SimTime at, const Diagnostic& found) override {
    Tell(at, {.program = found.program, .step = found.step}, found.detail);
  }
  void OnAssumed(const machine::Assumed& assumed) override {
    Tell({}, {}, std::string(assumed.group) + std::to_string(assumed.index));
  }
  std::vector<std::string> lines;

 private:
  void Tell(SimTime at, const machine::Place& place, std::string_view what) {
    lines.push_back(std::to_string(at.count()) + " " + std::to_string(place.program) + "/" +
                    std::to_string(place.step) + " " + std::string(what));
  }
};

struct Ended {
  std::vector<std::string> told;
  std::vector<std::string> values;
  machine::Outcome outcome;
  std::uint64_t steps = 0;
  SimTime time{0};
};

// Saved and restored in its middle where `restored`.
Ended EndOf(machine::RunSetup setup, bool restored = false) {
  Told told;
  Result<std::unique_ptr<machine::Run>> run = OptimoFamily().NewRun(std::move(setup), told);
  if (restored) {
    (*run)->Advance(SimTime(0));
    const std::unique_ptr<machine::RunSnapshot> saved = (*run)->Save();
    const std::vector<std::string> before = told.lines;
    (*run)->Advance(kForever);
    (*run)->Restore(*saved);
    told.lines = before;
  }
  while ((*run)->Advance(kForever) == machine::RunPhase::kRunning) {
  }
  Ended ended{.told = told.lines, .outcome = (*run)->outcome()};
  for (const machine::NamedVariable& one : machine::ReadVariables(**run, AllVariables()))
    ended.values.push_back(one.name + " " + one.value.text);
  ended.steps = (*run)->steps_executed();
  ended.time = (*run)->state().time;
  return ended;
}

void ExpectSame(const Ended& one, const Ended& other, const std::string& text) {
  EXPECT_EQ(one.told, other.told) << text;
  EXPECT_EQ(one.values, other.values) << text;
  EXPECT_EQ(one.outcome.kind, other.outcome.kind) << text;
  EXPECT_EQ(one.outcome.code, other.outcome.code) << text;
  EXPECT_EQ(one.outcome.detail, other.outcome.detail) << text;
  EXPECT_EQ(one.outcome.place, other.outcome.place) << text;
  EXPECT_EQ(one.steps, other.steps) << text;
  EXPECT_EQ(one.time, other.time) << text;
}

// Statements of all plain kinds, right in their form; what they do together is left to chance.
class Writer {
 public:
  explicit Writer(std::uint32_t seed) : random_(seed) {}

  std::string Program(int lines, bool main) {
    std::string text = main ? "COORD ABSOL\nPATH LIN\n" : Pick({"", "DEFINE PAR[0]=INT\n"});
    for (int n = 0; n < 6; ++n)
      text += "VR[" + std::to_string(n) + "]=" + Pick({"1.", "2", "-.5"}) + "\n";
    for (int n = 0; n < lines; ++n) {
      if (n % 3 == 0) text += std::to_string(10 + n) + " ";
      text += Statement(lines, main) + "\n";
    }
    return text + (main ? "ENDTASK\n" : "RETURN\n") + "800 VI[0]=VI[0]+1\nRETURN\n";
  }

 private:
  std::string Pick(std::vector<std::string> from) { return from[random_.Below(from.size())]; }
  std::string Label(int lines) {
    return std::to_string(
        10 + 3 * static_cast<int>(random_.Below(static_cast<std::size_t>(lines / 3 + 1))));
  }
  std::string Statement(int lines, bool main) {
    const std::string index = std::to_string(random_.Below(10));
    switch (random_.Below(main ? 14 : 11)) {
      case 0:
      case 1:
        return "VR[" + index + "]=" + random_.Numeric(2);
      case 2:
        return "VI[" + index + "]=" + random_.Numeric(1);
      case 3:
        return "VL[" + index + "]=" + random_.Logical(1);
      case 4:
        return "IF " + random_.Logical(1) + " THEN " + Label(lines);
      case 5:
        return "IF " + random_.Logical(1) + " THEN " + Label(lines) + " ELSE " + Label(lines);
      case 6:
        return "GOTO VI[" + index + "] (" + Label(lines) + "," + Label(lines) + ")";
      case 7:
        return "GOSUB 800";
      case 8:
        return "PAR[" + std::to_string(random_.Below(8)) + "]=" + random_.Numeric(1);
      case 9:
        return Pick({"TASK 1", "VI[9]=VI[9]+1", "VR[1]=PAR[0]+PAR[1]", "VR[2]=VI[98]+OA[3]"});
      case 10:
        return Pick(
            {"DECLARE N" + std::to_string(++names_) + "=1", "GOSUB 801", "VI[1]=VI[99]", "RETURN"});
      case 11:
        return Pick({"OL[16]=NOT OL[16]", "DELAY .1", "VL[3]=IL[20]", "ERR 800"});
      case 12:
        return "MOVE (9" + index + "0.,950.,-420.,0.,0.)" + Pick({"", "/FLY"});
      default:
        return "FUNCTION " + Pick({"2", "3"}) + " (" + random_.Numeric(1) + ",VR[1])";
    }
  }

  RandomExpression random_;
  int names_ = 0;
};

TEST(PlainSteps, DoWhatTheInstructionsDoOneByOne) {
  for (std::uint32_t seed = 0; seed < 400; ++seed) {
    Writer writer(seed);
    RunOptions options{.budget = {.steps = 1 + seed % 7 * 97}};
    options.programs = {{2, writer.Program(6, false)}, {3, writer.Program(9, false)}};
    const std::string main = writer.Program(24, true);
    const Ended plain = EndOf(SetupOf(main, options));
    ExpectSame(EndOf(SetupOf(main, options), true), plain, main);
    options.breakpoint = kElsewhere;
    ExpectSame(EndOf(SetupOf(main, options)), plain, main);
  }
}

// OPT-7.62, OPT-7.77: errors have the place of their own step, and nothing of it is done.
TEST(PlainSteps, AnErrorIsThatOfItsStep) {
  struct Row {
    std::string text;
    int code;
    int step;
  };
  for (const Row& row :
       {Row{"VR[1]=1.\nVR[2]=VR[1]/0.\n", 7201, 2},
        Row{"VR[1]=3.E18\nVR[1]=VR[1]*VR[1]\n", 7202, 2},
        Row{"VR[1]=40000.\nVI[1]=VR[1]\n", 7203, 2}, Row{"VR[1]=-1.\nVR[1]=SQRT(VR[1])\n", 7204, 2},
        Row{"VI[1]=1\nGOTO 900\n", 60, 2}, Row{"VI[1]=1\nRETURN\n", 7504, 2},
        Row{"10 GOSUB 10\n", 7503, 1}}) {
    const Ran ran = RunText(row.text, {.variables = {"VR[1]"}});
    EXPECT_EQ(CodeOf(ran), row.code) << row.text;
    EXPECT_EQ(ran.outcome.place.step, row.step) << row.text;
    EXPECT_EQ(ran.steps_begun.back(), row.step) << row.text;
  }
}

// What becomes too small is 0, of either sign; half an INTEGER is truncated towards it.
TEST(PlainSteps, NumbersAreRoundedAsTheLanguageSays) {
  ExpectValues({{"VR[1]=1.E-10\nVR[1]=VR[1]*VR[1]\n", "VR[1]", "0.0"},
                {"VR[1]=-1.E-10\nVR[1]=VR[1]/1.E12\nVL[1]=VR[1]=0\n", "VL[1]", "1"},
                {"VR[1]=-.5\nVI[1]=VR[1]\nVR[2]=VI[1]\n", "VR[2]", "0.0"},
                {"VR[1]=-2.75\nVI[1]=VR[1]\n", "VI[1]", "-2"},
                {"VR[1]=32767.9\nVI[1]=VR[1]\n", "VI[1]", "32767"}});
}

// OPT-7.85: a comparison that an IF ends with, and one that is a value.
TEST(PlainSteps, ComparisonsDecide) {
  struct Row {
    std::string op;
    bool less, equal, greater;
  };
  for (const Row& row :
       {Row{"<", true, false, false}, Row{"<=", true, true, false}, Row{"=", false, true, false},
        Row{">=", false, true, true}, Row{">", false, false, true}, Row{"<>", true, false, true}}) {
    for (const auto& [right, wanted] :
         {std::pair{"3.", row.less}, std::pair{"2.", row.equal}, std::pair{"1.", row.greater}}) {
      const std::string condition = "VR[1]" + row.op + "VR[2]";
      const Ran ran =
          RunText("VR[1]=2.\nVR[2]=" + std::string(right) + "\nVI[1]=0\nVL[1]=" + condition +
                      "\nIF " + condition + " THEN 10\nENDTASK\n10 VI[1]=1\n",
                  {.variables = {"VI[1]", "VL[1]"}});
      EXPECT_EQ(ran.variables.at("VI[1]"), wanted ? "1" : "0") << condition << right;
      EXPECT_EQ(ran.variables.at("VL[1]"), wanted ? "1" : "0") << condition << right;
    }
  }
}

// Each of the four operations with a variable as its target.
TEST(PlainSteps, OperationsGiveTheirVariable) {
  const std::string two = "VR[1]=7.\nVR[2]=2.\n";
  ExpectValues({{two + "VR[3]=VR[1]+VR[2]\n", "VR[3]", "9.0"},
                {two + "VR[3]=VR[1]-VR[2]\n", "VR[3]", "5.0"},
                {two + "VR[3]=VR[1]*VR[2]\n", "VR[3]", "14.0"},
                {two + "VR[3]=VR[1]/VR[2]\n", "VR[3]", "3.5"}});
}

Loaded LoadedText(const std::string& text) {
  Executable executable;
  Compilation compiled = Compile(text, "test.S", {.object_limit = 0, .advice = false});
  EXPECT_TRUE(compiled.ok) << text.substr(0, 200);
  executable.modules.push_back({.slot = 1, .module = std::move(compiled.module)});
  return Load(std::move(executable));
}

// A result that goes to its variable, and a comparison that decides, are no operations of their
// own.
TEST(PlainSteps, TheEndOfAStepDoesWhatComesBeforeIt) {
  for (const auto& [value, op] :
       {std::pair{"VR[1]+VR[2]", PlainOp::kVrAdd}, std::pair{"VR[1]-VR[2]", PlainOp::kVrSubtract},
        std::pair{"VR[1]*VR[2]", PlainOp::kVrMultiply},
        std::pair{"VR[1]/VR[2]", PlainOp::kVrDivide}, std::pair{"VR[1]", PlainOp::kSetVr}}) {
    const Loaded loaded = LoadedText("VR[3]=" + std::string(value) + "\n");
    const PlainOperation* at = loaded->plain[0].At(0);
    EXPECT_EQ(at[0].op, PlainOp::kBegin);
    EXPECT_EQ(at[1].op, op) << value;
    EXPECT_EQ(at[1].result, 3);
  }
  for (const auto& [compared, op] :
       {std::pair{"<", PlainOp::kIfLess}, std::pair{"<=", PlainOp::kIfLessEqual},
        std::pair{"=", PlainOp::kIfEqual}, std::pair{">=", PlainOp::kIfGreaterEqual},
        std::pair{">", PlainOp::kIfGreater}, std::pair{"<>", PlainOp::kIfNotEqual}}) {
    const Loaded loaded =
        LoadedText("IF VR[1]" + std::string(compared) + "VR[2] THEN 10\n10 VI[1]=1\n");
    const PlainOperation* at = loaded->plain[0].At(0);
    EXPECT_EQ(at[1].op, op) << compared;
    EXPECT_EQ(at[2].op, PlainOp::kGoOn);
  }
}

// The constants of a module have numbers of 16 bits: a step that needs one more is not plain.
TEST(PlainSteps, AModuleHasSoManyConstants) {
  std::string line = "VR[1]=VR[2]";
  for (int n = 0; n < 32; ++n) line += "+1.";
  std::string text;
  constexpr std::uint32_t kLines = 0x10000 / 32;
  for (std::uint32_t n = 0; n < kLines; ++n) text += line + "\n";
  const Loaded loaded = LoadedText(text + "VR[3]=VR[4]\nVI[3]=7\n");
  const PlainCode& code = loaded->plain[0];
  EXPECT_EQ(code.constants().size(), 0x10000U);
  EXPECT_EQ(code.At(kLines - 1)->op, PlainOp::kBegin);
  EXPECT_EQ(code.At(kLines)->op, PlainOp::kBegin);  // it needs none
  EXPECT_EQ(code.At(kLines + 1)->op, PlainOp::kLeave);
}

// A budget ends a run at the very step, and one call does so much.
TEST(PlainSteps, AreCounted) {
  const std::string text = "VI[1]=0\n10 VI[1]=VI[1]+1\nIF VI[1]<30000 THEN 10\n";
  EXPECT_EQ(RunText(text, {.budget = {.steps = 12'345}}).steps, 12'345U);
  machine::RunObserver nobody;
  Result<std::unique_ptr<machine::Run>> run = OptimoFamily().NewRun(SetupOf(text), nobody);
  EXPECT_EQ((*run)->Advance(kForever), machine::RunPhase::kRunning);
  EXPECT_EQ((*run)->steps_executed(), 20'000U);
  EXPECT_EQ((*run)->state().instruction, "LET");
  EXPECT_EQ((*run)->state().place.step, 2);
}

// An instruction may need 64 numbers between its operations; one that needs more is carried out by
// itself, and does the same.
TEST(PlainSteps, AnInstructionHasSoManyNumbers) {
  const auto sum = [](std::size_t operations) {
    std::string text = "VR[1]";
    for (std::size_t n = 0; n < operations; ++n) text += "+VR[2]";
    return text;
  };
  const auto begins = [](const std::string& text) {
    const Loaded loaded = LoadedText(text);
    return loaded->plain[0].At(0)->op == PlainOp::kBegin;
  };
  constexpr std::size_t kMost = 64;
  EXPECT_TRUE(begins("VR[3]=" + sum(kMost) + "\n"));
  EXPECT_FALSE(begins("VR[3]=" + sum(kMost + 1) + "\n"));
  // The comparison is one more of them.
  EXPECT_TRUE(begins("IF " + sum(kMost - 1) + "=64. THEN 10\n10 VI[1]=1\n"));
  EXPECT_FALSE(begins("IF " + sum(kMost) + "=65. THEN 10\n10 VI[1]=1\n"));
  const std::string more = sum(kMost + 1);
  const Ran ran = RunText("VR[1]=1.\nVR[2]=1.\nVR[3]=" + more + "\nVI[3]=0\nIF " + more +
                              "=66. THEN 10\nVI[3]=9\nVI[4]=9\nENDTASK\n10 FUNCTION 44 (" + more +
                              ")\nVI[5]=5\n",
                          {.programs = {{44, "VR[5]=PAR[0]\nRETURN\n"}},
                           .variables = {"VR[3]", "VR[5]", "VI[3]", "VI[4]", "VI[5]"}});
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(
      ran.variables,
      (std::map<std::string, std::string>{
          {"VR[3]", "66.0"}, {"VR[5]", "66.0"}, {"VI[3]", "0"}, {"VI[4]", "0"}, {"VI[5]", "5"}}));
}

// OPT-9.28: parameters that were not passed are 0, also where an earlier call passed some.
TEST(PlainSteps, ParametersAreThoseOfTheirOwnCall) {
  const Ran ran = RunText("VR[0]=0.\nFUNCTION 44 (7.,8.)\nFUNCTION 44 (9.)\n",
                          {.programs = {{44, "VR[1]=PAR[0]\nVR[2]=PAR[1]\nVR[3]=PAR[7]\nRETURN\n"}},
                           .variables = {"VR[1]", "VR[2]", "VR[3]"}});
  EXPECT_EQ(ran.variables.at("VR[1]"), "9.0");
  EXPECT_EQ(ran.variables.at("VR[2]"), "0.0");
  EXPECT_EQ(ran.variables.at("VR[3]"), "0.0");
}

// plain_code.h: each kind of plain instruction has its own operations, and what needs more than
// variables is none.
TEST(PlainSteps, EachKindHasItsOperations) {
  struct Row {
    std::string text;
    std::vector<PlainOp> operations;  // behind kBegin
  };
  using Does = PlainOp;
  const std::string labels = "10 VI[1]=1\n20 VI[1]=2\n";
  for (const Row& row :
       {Row{"VL[2]=VL[1]\n", {Does::kVl, Does::kSetVl}},
        Row{"VL[2]=OL[1]\n", {Does::kOl, Does::kSetVl}}, Row{"VL[1]=ON\n", {Does::kSetVl}},
        Row{"VI[1]=7\n", {Does::kSetVi}},
        Row{"VR[1]=SQRT(VR[2])\n", {Does::kOperate, Does::kSetVr}}, Row{"TASK 1\n", {Does::kGoOn}},
        Row{"GOTO 10\n" + labels, {Does::kGoTo}}, Row{"GOSUB 10\n" + labels, {Does::kGosub}},
        Row{"RETURN\n", {Does::kReturn}},
        Row{"IF VL[1] THEN 10\n" + labels, {Does::kVl, Does::kIf, Does::kGoOn}},
        Row{"IF VL[1] THEN 10 ELSE 20\n" + labels, {Does::kVl, Does::kIf, Does::kGoTo}},
        Row{"GOTO VI[1] (10,20)\n" + labels,
            {Does::kSelect, Does::kGoTo, Does::kGoTo, Does::kGoOn}}}) {
    const Loaded loaded = LoadedText(row.text);
    const PlainOperation* at = loaded->plain[0].At(0);
    ASSERT_EQ(at->op, Does::kBegin) << row.text;
    for (const PlainOp op : row.operations) EXPECT_EQ((++at)->op, op) << row.text;
  }
  for (const std::string text : {"DELAY 1\n", "OL[1]=ON\n", "VL[1]=IL[1]\n", "VR[1]=IA[5]\n"}) {
    const Loaded loaded = LoadedText(text);
    EXPECT_EQ(loaded->plain[0].At(0)->op, Does::kLeave) << text;
  }
}

// plain_code.h: what the control sets itself need not be known.
TEST(PlainSteps, WhatAStepReads) {
  const auto first_read = [](const std::string& text) {
    const Loaded loaded = LoadedText(text);
    return static_cast<std::size_t>(loaded->plain[0].At(0)->result);
  };
  EXPECT_EQ(first_read("VR[1]=VI[99]\n"), kAlwaysSet);
  EXPECT_EQ(first_read("VR[1]=VI[97]\n"), NumberOf({VariableGroup::kVi, 97}));
  EXPECT_EQ(first_read("VR[1]=PAR[3]\n"), NumberOf({VariableGroup::kPar, 3}));
}

// plain_code.h: a FUNCTION of the same executable is plain, with its arguments.
TEST(PlainSteps, AFunctionHasItsArguments) {
  Executable executable;
  for (const auto& [slot, text] :
       {std::pair{1, "FUNCTION 44 (VR[1],2.)\n"}, std::pair{44, "RETURN\n"}}) {
    Compilation compiled = Compile(text, "test.S", {.object_limit = 0, .advice = false});
    ASSERT_TRUE(compiled.ok) << text;
    executable.modules.push_back({.slot = slot, .module = std::move(compiled.module)});
  }
  const Loaded loaded = Load(std::move(executable));
  const PlainOperation* at = loaded->plain[0].At(0);
  ASSERT_EQ(at[0].op, PlainOp::kBegin);
  EXPECT_EQ(at[1].op, PlainOp::kArgument);
  EXPECT_EQ(at[2].op, PlainOp::kArgument);
  EXPECT_EQ(at[2].result, 1);
  EXPECT_EQ(at[3].op, PlainOp::kFunction);
  EXPECT_EQ(at[3].result, 2);
  EXPECT_EQ(at[3].target, 1U);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::plain_steps
