#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <string>

#include "engine/machine/observer.h"
#include "engine/machine/tools.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/language/linker.h"

// What the family gives to those who handle its programs without running them.
namespace rmlcell::optimo::testing::family_tools {
namespace {

const machine::Tools& Tools() { return *OptimoFamily().tools(); }
machine::Parameters Standard() { return machine::Parameters(OptimoFamily().parameters()); }

std::string ObjectOf(const std::string& text) {
  const machine::CompiledProgram made = Tools().Compile({"a.S", text}, Standard(), {});
  EXPECT_TRUE(made.ok) << text;
  return made.object;
}

// OPT-2.04: the numbers of an inch source are not for the control, so nothing is said of them.
TEST(FamilyTools, FormatsInchSourcesWhateverTheirNumbers) {
  const std::string text = "SPEED 200\n";
  const machine::FormattedText metric = Tools().Format({"a.S", text});
  EXPECT_FALSE(metric.readable);
  EXPECT_FALSE(metric.diagnostics.empty());
  const machine::FormattedText inch = Tools().Format({"a.SI", text});
  EXPECT_TRUE(inch.readable);
  EXPECT_TRUE(inch.diagnostics.empty());
  const machine::FormattedText good = Tools().Format({"a.S", "SPEED 20\n"});
  EXPECT_TRUE(good.readable);
  EXPECT_TRUE(good.diagnostics.empty());
}

// Advice is no matter of the form.
TEST(FamilyTools, FormatGivesNoAdvice) {
  EXPECT_TRUE(Tools().Format({"a.S", "GOTO 10\nVI[2]=1\n10 VI[3]=1\n"}).diagnostics.empty());
}

// OPT-1.08: an object that is stored is no larger than the machine takes, here 100 characters; one
// that is not stored may be.
TEST(FamilyTools, CompilesToASize) {
  machine::Parameters small = Standard();
  ASSERT_TRUE(small.Set("OBJECT_LIMIT", 100.0));
  std::string text;
  for (int k = 0; k < 50; ++k) text += "VI[2]=VI[2]+1\n";
  EXPECT_FALSE(Tools().Compile({"a.S", text}, small, {}).ok);
  const machine::CompiledProgram any = Tools().Compile({"a.S", text}, small, {.any_size = true});
  EXPECT_TRUE(any.ok);
  EXPECT_EQ(any.steps, 50);
  EXPECT_GT(any.object.size(), 100U);
}

// OPT-2.04: an inch source is to be converted first. The map gives the programmer his own text
// again, and is made for whoever asks for it, of what could be compiled.
TEST(FamilyTools, MapsTheSource) {
  const std::string text = "move (1.,2.,-3.,0.,0.)   ; here\n";
  const machine::CompiledProgram inch =
      Tools().Compile({"a.SI", text}, Standard(), {.inch = true, .source_map = true});
  EXPECT_FALSE(inch.ok);
  EXPECT_TRUE(inch.source_map.empty());
  ASSERT_FALSE(inch.diagnostics.empty());
  EXPECT_EQ(inch.diagnostics[0].code, ErrorCode::kSourceIsInch);
  const machine::CompiledProgram mapped =
      Tools().Compile({"a.S", text}, Standard(), {.source_map = true});
  const auto own = Tools().Decompile(mapped.object, mapped.source_map);
  ASSERT_TRUE(own);
  EXPECT_EQ(own->text, text);
  EXPECT_TRUE(own->own_text);
  EXPECT_FALSE(own->inch);
  const auto plain = Tools().Decompile(mapped.object, std::nullopt);
  ASSERT_TRUE(plain);
  EXPECT_FALSE(plain->own_text);
  EXPECT_TRUE(Tools().Compile({"a.S", text}, Standard(), {}).source_map.empty());
}

// The functions of a program in order of first use, without the program itself; an executable is
// smaller than the limit of the machine.
TEST(FamilyTools, LinksWithItsFunctions) {
  std::string text = "FUNCTION 45\nFUNCTION 44\nFUNCTION 45\n";
  for (int k = 0; k < 20; ++k) text += "VI[2]=VI[2]+1\n";  // more than the least limit
  const std::string main = ObjectOf(text);
  const std::string function = ObjectOf("VI[3]=1\n");
  const machine::ObjectLookup lookup = [&](int slot) -> std::optional<std::string_view> {
    return slot == 32 ? main : function;
  };
  const auto linked = Tools().Link(32, lookup, Standard());
  ASSERT_TRUE(linked);
  EXPECT_EQ(linked->functions, (std::vector<int>{45, 44}));
  const double size = ExecutableSize(DecodeExecutable(linked->executable).value());
  machine::Parameters small = Standard();
  ASSERT_TRUE(small.Set("EXECUTABLE_LIMIT", size));
  EXPECT_FALSE(Tools().Link(32, lookup, small));
  ASSERT_TRUE(small.Set("EXECUTABLE_LIMIT", size + 1.0));
  EXPECT_TRUE(Tools().Link(32, lookup, small));
}

// OPT-1.13: an executable is stored as that of its own program.
TEST(FamilyTools, ExecutablesBelongToTheirSlot) {
  const std::string main = ObjectOf("VI[3]=1\n");
  const auto linked = Tools().Link(
      32, [&](int) -> std::optional<std::string_view> { return main; }, Standard());
  ASSERT_TRUE(linked);
  EXPECT_TRUE(OptimoFamily().CheckExecutable(linked->executable, 32));
  const Status other = OptimoFamily().CheckExecutable(linked->executable, 33);
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(other.error().detail,
            "the executable is that of program 32, not of 33: store it as 132");
  EXPECT_FALSE(OptimoFamily().CheckExecutable("no executable", 32));
}

// The target of a MOVE to (1,2,3) that is moved, or turned by a quarter about Z, Y or X.
TEST(FamilyTools, TransformsAboutEachAxis) {
  const auto target = [](const machine::Displacement& by) {
    const std::string text = Tools().Transform("COORD ABSOL\nMOVE (1.,2.,3.,0.,0.)\n", by).text;
    double x = 0.0, y = 0.0, z = 0.0;
    const std::size_t at = text.find("MOVE (");
    EXPECT_NE(at, std::string::npos) << text;
    EXPECT_EQ(std::sscanf(text.c_str() + at, "MOVE (%lf,%lf,%lf", &x, &y, &z), 3) << text;
    return std::array<long, 3>{std::lround(x * 1e3), std::lround(y * 1e3), std::lround(z * 1e3)};
  };
  using Target = std::array<long, 3>;
  EXPECT_EQ(target({.move_mm = {10, 20, 30}}), (Target{11000, 22000, 33000}));
  EXPECT_EQ(target({.turn_rad = {M_PI / 2, 0, 0}}), (Target{-2000, 1000, 3000}));
  // The head of this machine stands upright: other turns change A and B too, or are refused.
  EXPECT_EQ(target({.turn_rad = {0, M_PI / 2, 0}}), (Target{3000, 2000, -1000}));
  EXPECT_EQ(target({.turn_rad = {0, 0, M_PI / 2}}), (Target{1000, -3000, 2000}));
}

// OPT-8.75: a shift is added to what is given to VR[86] to VR[91]: X, Y, Z and the turns about Z, Y
// and X.
TEST(FamilyTools, ShiftsTheWorkOffset) {
  std::string text;
  for (int k = 86; k <= 91; ++k) text += "VR[" + std::to_string(k) + "]=0.\n";
  const std::string made =
      Tools().Shift(text, {.move_mm = {10, 20, 30}, .turn_rad = {0.125, 0.25, 0.5}}).text;
  std::istringstream lines(made);
  for (const double wanted : {10.0, 20.0, 30.0, 0.125, 0.25, 0.5}) {
    std::string line;
    ASSERT_TRUE(std::getline(lines, line));
    EXPECT_EQ(std::stod(line.substr(line.find('=') + 1)), wanted) << line;
  }
}

// Objects that are none are refused by each of them.
TEST(FamilyTools, RefusesWhatIsNoObject) {
  const std::string good = ObjectOf("VI[3]=1\n");
  EXPECT_FALSE(Tools().List("none"));
  EXPECT_TRUE(Tools().List(good));
  EXPECT_FALSE(Tools().Decompile("none", std::nullopt));
  EXPECT_FALSE(Tools().Diff({.object = "none"}, {.object = good}));
  EXPECT_FALSE(Tools().Diff({.object = good}, {.object = "none"}));
  const auto diff = Tools().Diff({.object = good}, {.object = ObjectOf("VI[3]=1\nVI[4]=1\n")});
  ASSERT_TRUE(diff);
  ASSERT_EQ(diff->steps.size(), 1U);
  EXPECT_EQ(diff->steps[0].kind, machine::StepChange::Kind::kAdded);
  EXPECT_EQ(diff->steps[0].step_b, 2);
}

// OPT-10.17: programs 1 to 7 are reserved.
TEST(FamilyTools, ReservedPrograms) {
  EXPECT_TRUE(OptimoFamily().CheckSlot(0, "DELAY 1\n").empty());
  ASSERT_EQ(OptimoFamily().CheckSlot(1, "DELAY 1\n").size(), 1U);
  EXPECT_EQ(OptimoFamily().CheckSlot(1, "DELAY 1\n")[0].program, 1);
  EXPECT_EQ(OptimoFamily().CheckSlot(7, "DELAY 1\n").size(), 1U);
  EXPECT_TRUE(OptimoFamily().CheckSlot(8, "DELAY 1\n").empty());
}

TEST(FamilyTools, NamesOfVariables) {
  for (const char* name : {"VI[0]", "VR[99]", "IL[95]", "OA[0]"})
    EXPECT_TRUE(OptimoFamily().HasVariable(Standard(), name)) << name;
  for (const char* name : {"VI[100]", "VX[1]", "VI", ""})
    EXPECT_FALSE(OptimoFamily().HasVariable(Standard(), name)) << name;
}

// OPT-1.13: what became of the program itself is told, not only of its functions.
TEST(FamilyTools, ExecutablesOfAnAlteredOrLostProgram) {
  const std::string before = ObjectOf("VI[2]=1\n");
  const auto linked = Tools().Link(
      12, [&](int) -> std::optional<std::string_view> { return before; }, Standard());
  ASSERT_TRUE(linked);
  std::map<int, machine::StoredProgram> programs;
  programs[12].executable = machine::Bytes::Of(linked->executable);
  const auto lost = OptimoFamily().FindStaleExecutables(programs, {});
  ASSERT_EQ(lost.size(), 1U);
  EXPECT_EQ(lost[0].parts[0].reason, machine::StaleReason::kObjectMissing);
  programs[12].object = machine::Bytes::Of(ObjectOf("VI[2]=2\n"));
  const auto altered = OptimoFamily().FindStaleExecutables(programs, {});
  ASSERT_EQ(altered.size(), 1U);
  EXPECT_EQ(altered[0].parts[0].slot, 12);
  EXPECT_EQ(altered[0].parts[0].reason, machine::StaleReason::kObjectChanged);
}

// OPT-7.59: a name is whole: with both brackets, and of one of the groups.
TEST(FamilyTools, ANameOfAVariableIsWhole) {
  EXPECT_TRUE(OptimoFamily().HasVariable(Standard(), "vr[12]"));
  for (const char* name : {"VI[12", "VI[1", "VI12]", "[1]", "VRX[1]", "VI[]", "VI[1]]", "VI[-1]"})
    EXPECT_FALSE(OptimoFamily().HasVariable(Standard(), name)) << name;
}

// OPT-B.69: what may be rewritten is a text by its name and by its bytes.
TEST(FamilyTools, TextsMayBeRewritten) {
  EXPECT_TRUE(Tools().CheckIsText("12.S", "SPEED 20\n"));
  EXPECT_FALSE(Tools().CheckIsText("12.S", ObjectOf("SPEED 20\n")));
  const Status object = Tools().CheckIsText("12.O", "SPEED 20\n");
  ASSERT_FALSE(object);
  EXPECT_EQ(object.error().code, ErrorCode::kCellBadText);
  EXPECT_EQ(object.error().detail, "12.O is an object, not a source");
}

}  // namespace
}  // namespace rmlcell::optimo::testing::family_tools
