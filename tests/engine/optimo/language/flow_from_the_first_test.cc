// What the first instruction does to those behind it, what is known behind a FUNCTION, and which
// programs are called.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/optimo/language/linker.h"
#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo::flow_from_the_first {
namespace {

// How often this is said of a program.
auto TimesSaid(std::string_view text, int number, std::string_view rule) {
  const Compilation compiled = Compile(text, "", {.advice = true});
  return std::ranges::count_if(compiled.diagnostics, [&](const Diagnostic& d) {
    return Lookup(d.code).number == number && d.rule == rule;
  });
}

const std::string kLines = "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0.,0.,0.,0.,0.)\n";

// OPT-7.22
TEST(FlowFromTheFirst, AProgramMayBeginWithItsReturn) {
  EXPECT_EQ(TimesSaid("RETURN\n", 7504, "OPT-7.22"), 1);
  EXPECT_EQ(TimesSaid("TASK 1\nRETURN\n", 7504, "OPT-7.22"), 0);
  // OPT-7.20: and so may a subroutine before its TASK.
  EXPECT_EQ(TimesSaid("10 RETURN\nTASK 1\nGOSUB 10\n", 7033, "OPT-7.20"), 0);
  EXPECT_EQ(TimesSaid("10 ENDTASK\nTASK 1\nGOSUB 10\n", 7033, "OPT-7.20"), 1);
}

// OPT-2.48: what a jump back leads to may need standstill.
TEST(FlowFromTheFirst, AJumpToTheFirstInstructionMayStop) {
  const std::string moves = "MOVE (0.,0.,0.,0.,0.)\nMOVE (9.,0.,0.,0.,0.)/FLY\nGOTO 10\n";
  EXPECT_EQ(TimesSaid("10 DELAY 1\n" + moves, 7032, "OPT-2.48"), 1);
  EXPECT_EQ(TimesSaid("10 ACCEL 5\nDELAY 1\n" + moves, 7032, "OPT-2.48"), 1);
  EXPECT_EQ(TimesSaid("10 ACCEL 5\n" + moves, 7032, "OPT-2.48"), 0);
}

// OPT-2.50, OPT-3.21: a process of kind 1 pierces by its own WORKDEF; the beam alone does not.
TEST(FlowFromTheFirst, AWorkStopsWhereItPierces) {
  const auto stops = [](const std::string& before, const std::string& work) {
    return TimesSaid(
        before + kLines + "MOVE (9.,0.,0.,0.,0.)/FLY\n" + work + "MOVE (20.,0.,0.,0.,0.)\n", 7032,
        "OPT-2.48");
  };
  const std::string some = "WORKDEF 1,0 (8.,75.,1.,50.)\nWORKDEF 1,2 (8.,75.,0.,50.)\n",
                    none = "WORKDEF 1,0 (8.,75.,0.,50.)\nWORKDEF 1,1 (8.,75.,1.,50.)\n";
  EXPECT_EQ(stops(some, "WORK 1,0/ON\n"), 1);
  EXPECT_EQ(stops(some, "WORK 1,2/ON\n"), 0);
  EXPECT_EQ(stops(none, "WORK 1,0/ON\n"), 0);
  EXPECT_EQ(stops(none, "WORK 1,1/ON\n"), 1);
  EXPECT_EQ(stops(none, "WORK 1,1/OFF\n"), 0);
  EXPECT_EQ(stops(none, "WORK 0,1/ON\n"), 0);
  // What does not stop does not go on either.
  EXPECT_EQ(stops(none, "WORK 1,1/OFF\nDELAY 1\n"), 1);
  EXPECT_EQ(stops(none, "WORK 0,1/ON\nDELAY 1\n"), 1);
  EXPECT_EQ(stops(none, "WORK 1,0/ON\nDELAY 1\n"), 1);
  // OPT-3.38: one with a condition waits for it, whatever that reads.
  EXPECT_EQ(stops("", "WORK 0,0/ON/START (VL[1])\n"), 1);
  // Where the WORKDEFs of a process disagree, or a dwell is computed, neither is known.
  const std::string with = "WORKDEF 1,0 (8.,75.,1.,50.)\n",
                    without = "WORKDEF 1,0 (8.,75.,0.,50.)\n";
  for (const std::string& before :
       {with + without, without + with, std::string("WORKDEF 1,0 (8.,75.,VR[1],50.)\n")}) {
    EXPECT_EQ(stops(before, "WORK 1,0/ON\n"), 0) << before;
    EXPECT_EQ(stops(before, "WORK 1,0/ON\nDELAY 1\n"), 0) << before;
  }
}

// OPT-2.47, OPT-2.48, OPT-7.20: behind a RETURN stands what follows its GOSUB; that is what is
// told.
TEST(FlowFromTheFirst, AReturnStopsWhereItsGosubGoesOn) {
  const auto told = [](const std::string& behind, std::string_view rule) {
    return TimesSaid(kLines + "GOSUB 100\n" + behind +
                         "MOVE (20.,0.,0.,0.,0.)\nENDTASK\n100 MOVE (9.,0.,0.,0.,0.)/FLY\nRETURN\n",
                     7032, rule);
  };
  EXPECT_EQ(told("DELAY 1\n", "OPT-2.48"), 1);
  EXPECT_EQ(told("DELAY 1\n", "OPT-2.47"), 0);
  EXPECT_EQ(told("CALL 2\n", "OPT-2.47"), 1);
  EXPECT_EQ(told("", "OPT-2.48"), 0);
}

// OPT-2.47, OPT-2.48: it may go on where one way does, whatever the other one comes to.
TEST(FlowFromTheFirst, AMoveOnOneWayGoesOn) {
  const auto told = [](const std::string& one, const std::string& other) {
    const std::string text = kLines + "MOVE (9.,0.,0.,0.,0.)/FLY\nIF VL[1] THEN 10\n" + one +
                             "ENDTASK\n10 ACCEL 5\n" + other;
    return TimesSaid(text, 7032, "OPT-2.47") + TimesSaid(text, 7032, "OPT-2.48");
  };
  const std::string goes = "MOVE (20.,0.,0.,0.,0.)\n", stops = "DELAY 1\n";
  EXPECT_EQ(told(goes, stops), 0);
  EXPECT_EQ(told(stops, goes), 0);
  EXPECT_EQ(told(goes, ""), 0);
  EXPECT_EQ(told(stops, stops), 1);
}

// OPT-7.20, OPT-B.22: a subroutine of one instruction changes nothing.
TEST(FlowFromTheFirst, ASubroutineMayBeItsReturnAlone) {
  const std::string move = "MOVE (9.,0.,0.,0.,0.)\nENDTASK\n900 RETURN\n";
  EXPECT_EQ(TimesSaid(kLines + "SPEED 0\nGOSUB 900\n" + move, 7307, "OPT-B.22"), 1);
  EXPECT_EQ(TimesSaid(kLines + "SPEED 5\nGOSUB 900\n" + move, 7307, "OPT-B.22"), 0);
}

// OPT-5.45: what a program sets behind a FUNCTION is known again.
TEST(FlowFromTheFirst, ModesAreKnownAgainBehindAFunction) {
  const auto told = [](const std::string& path) {
    return TimesSaid("FUNCTION 44\nCOORD ABSOL\n" + path +
                         "OL[11]=ON\nWORK 0,0/ON\nDELAY 1\nMOVE (9.,0.,0.,0.,0.)\n",
                     7033, "OPT-5.45");
  };
  EXPECT_EQ(told("PATH PTP\n"), 1);
  EXPECT_EQ(told("PATH LIN\n"), 0);
  EXPECT_EQ(told(""), 0);
}

// OPT-5.48: an axis along the tool is not off it, and one against it is by half a turn, however the
// numbers are rounded.
TEST(FlowFromTheFirst, AnAxisAlongTheToolIsNotOffIt) {
  const auto list = [](const std::vector<double>& values) {
    std::string all;
    for (const double value : values) all += (all.empty() ? "(" : ",") + std::to_string(value);
    return all + ")";
  };
  std::string along = "COORD ABSOL\nPATH HOLE (5.)\n", against = along;
  constexpr int kHoles = 900;
  for (int n = 0; n < kHoles; ++n) {
    const double a_rad = n % 30 / 32.0, b_rad = n / 30 / 32.0;  // as they are written
    const double x = 900.0 * std::sin(b_rad) * std::sin(a_rad),
                 y = -900.0 * std::sin(b_rad) * std::cos(a_rad), z = 900.0 * std::cos(b_rad);
    const std::string move = "MOVE " + list({0.0, 0.0, 0.0, a_rad, b_rad}) + "/VIA ";
    along += move + list({x, y, z, 0.0, 0.0}) + "\n";
    against += move + list({-x, -y, -z, 0.0, 0.0}) + "\n";
  }
  EXPECT_EQ(TimesSaid(along, 7033, "OPT-5.48"), 0);
  EXPECT_EQ(TimesSaid(against, 7033, "OPT-5.48"), kHoles);
  for (const Diagnostic& d : Compile(against, "", {.advice = true}).diagnostics) {
    if (d.rule == "OPT-5.48") {
      EXPECT_TRUE(d.detail.starts_with("the axis of the hole is 180.00 degrees")) << d.detail;
    }
  }
}

// OPT-2.51: where two ways come together the tip may be at either target; behind COORD it is at
// none that is known.
TEST(FlowFromTheFirst, ATargetIsKnownWhereAllWaysAgree) {
  const auto told = [](const std::string& first, const std::string& second) {
    return TimesSaid("COORD ABSOL\nPATH LIN\nIF VL[1] THEN 10\nMOVE (" + first +
                         ",0.,0.,0.,0.)\nGOTO 20\n10 MOVE (" + second +
                         ",0.,0.,0.,0.)\n20 MOVE (9.5,0.,0.,0.,0.)/FLY\n"
                         "MOVE (50.,0.,0.,0.,0.)\n",
                     7314, "OPT-2.51");
  };
  EXPECT_EQ(told("9.", "9."), 1);
  EXPECT_EQ(told("9.", "30."), 0);
  EXPECT_EQ(told("30.", "9."), 0);
  EXPECT_EQ(TimesSaid("PATH LIN\nCOORD ABSOL\nMOVE (50.,0.,0.,0.,0.)/FLY\n"
                      "MOVE (90.,0.,0.,0.,0.)\n",
                      7314, "OPT-2.51"),
            0);
}

class CallsOfPrograms : public testing::Test {
 protected:
  // The slots that are asked for, in order; `missing` has no executable.
  std::vector<int> AskedFor(int main_slot, int missing = 0) {
    std::vector<int> asked;
    const ObjectLookup lookup = [&](int slot) -> std::optional<std::string_view> {
      const auto found = objects_.find(slot);
      if (found == objects_.end()) return std::nullopt;
      return found->second;
    };
    const Status status = CheckCalls(main_slot, [&](int slot) -> Result<Executable> {
      asked.push_back(slot);
      if (slot == missing) return Error{ErrorCode::kProgramMissing, "gone", {}};
      return Link(slot, lookup, {});
    });
    EXPECT_EQ(static_cast<bool>(status), missing == 0);
    if (!status) {
      EXPECT_EQ(status.error().code, ErrorCode::kProgramMissing);
    }
    return asked;
  }
  void Store(int slot, const std::string& text) { objects_[slot] = MustCompile(text).object; }

  std::map<int, std::string> objects_;
};

// OPT-7.01, OPT-7.07: by number or by its name, from a FUNCTION as well, each once.
TEST_F(CallsOfPrograms, LeadToWhatIsCalledByItsNumber) {
  Store(12, "CALL 44\nFUNCTION 20\nVI[2] = 1\nCALL VI[2]\n");
  Store(20, "DECLARE OTHER = 46\nGO OTHER\n");
  Store(44, "CALL 12\nCALL 45 (VR[1]+2)\n");
  Store(45, "SPEED 5\n");
  Store(46, "GO 12\n");
  std::vector<int> asked = AskedFor(12);
  EXPECT_EQ(asked.front(), 12);
  std::ranges::sort(asked);
  EXPECT_EQ(asked, (std::vector<int>{12, 44, 45, 46}));
  EXPECT_EQ(AskedFor(12, 45).back(), 45);
  EXPECT_EQ(AskedFor(45), std::vector<int>{45});
}

// OPT-9.01, OPT-B.69: a FUNCTION by the name of its number comes back from the object.
TEST_F(CallsOfPrograms, AFunctionByNameComesBack) {
  for (const char* text : {"DECLARE N = 44\nFUNCTION N (5)\n", "FUNCTION 44 (VR[1])\n",
                           "DECLARE N = 44\nFUNCTION 44 (N)\nFUNCTION N\n"}) {
    const std::string object = MustCompile(text).object;
    const Result<Module> module = DecodeObject(object);
    ASSERT_TRUE(module) << text;
    EXPECT_EQ(EncodeObject(*module), object) << text;
  }
}

// OPT-7.20, OPT-B.22: also where it is the first instruction of all, before the TASK.
TEST(FlowFromTheFirst, ASubroutineMayBeTheFirstInstruction) {
  const auto told = [](const std::string& speed) {
    return TimesSaid("10 RETURN\nTASK 1\n" + kLines + speed + "GOSUB 10\nMOVE (9.,0.,0.,0.,0.)\n",
                     7307, "OPT-B.22");
  };
  EXPECT_EQ(told("SPEED 0\n"), 1);
  EXPECT_EQ(told("SPEED 5\n"), 0);
}

// OPT-7.109: a subroutine that begins with the first instruction is no part of the program.
TEST(FlowFromTheFirst, MovesOfTheFirstSubroutineAreItsOwn) {
  EXPECT_EQ(TimesSaid("900 MOVE (3.,0.,0.,0.,0.)\nRETURN\nTASK 1\n"
                      "SYSDEF (1.,0.,0.,0.,0.,0.)\nPATH PTP\nCOORD ROBOT\nMOVE (1.,0.,0.,0.,0.)\n"
                      "COORD ABSOL\nMOVE (2.,0.,0.,0.,0.)\nGOSUB 900\nENDTASK\n",
                      7033, "OPT-7.109"),
            0);
}

// OPT-9.12, OPT-3.47: what stands before TASK 1 is never reached, be it the first instruction only.
TEST(FlowFromTheFirst, WhatStandsBeforeTheTaskIsNotReached) {
  EXPECT_EQ(TimesSaid("SPEED 5\nTASK 1\nSPEED 6\n", 7033, "OPT-3.47"), 1);
  EXPECT_EQ(TimesSaid("TASK 1\nSPEED 6\n", 7033, "OPT-3.47"), 0);
}

}  // namespace
}  // namespace rmlcell::optimo::flow_from_the_first
