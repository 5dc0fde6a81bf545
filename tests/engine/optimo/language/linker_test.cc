#include "engine/optimo/language/linker.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <string_view>

#include "engine/core/units.h"
#include "engine/optimo/language/byte_stream.h"
#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

class Linker : public testing::Test {
 protected:
  void Store(int slot, const std::string& text) { objects_[slot] = MustCompile(text).object; }
  ObjectLookup Lookup() {
    return [this](int slot) -> std::optional<std::string_view> {
      const auto found = objects_.find(slot);
      return found == objects_.end() ? std::nullopt
                                     : std::optional<std::string_view>(found->second);
    };
  }
  int ErrorOfLinking(int slot, const LinkOptions& options = {}) {
    const Result<Executable> executable = Link(slot, Lookup(), options);
    return executable ? 0 : rmlcell::Lookup(executable.error().code).number;
  }
  std::map<int, std::string> objects_;
};

// OPT-9.02
TEST_F(Linker, FunctionsAreAppendedOnceWithReturns) {
  Store(32, "FUNCTION 44\nFUNCTION 44\nFUNCTION 45\nENDTASK\n");
  Store(44, "SPEED 5\nENDTASK\n");
  Store(45, "FUNCTION 44\nFUNCTION 46\n");
  Store(46, "SPEED 6\n");
  const Result<Executable> executable = Link(32, Lookup(), {});
  ASSERT_TRUE(executable);
  std::vector<int> slots;
  for (const LinkedModule& module : executable->modules) slots.push_back(module.slot);
  EXPECT_EQ(slots, (std::vector<int>{32, 44, 45, 46}));
  EXPECT_EQ(executable->modules[0].module.instructions[3].op, Op::kEndtask);
  EXPECT_EQ(executable->Find(44)->module.instructions[1].op, Op::kReturn);
}

// OPT-9.03, OPT-9.04, OPT-E.7103
TEST_F(Linker, MissingFunctionsAreErrors) {
  Store(32, "FUNCTION 44\n");
  EXPECT_EQ(ErrorOfLinking(32), 7103);
  EXPECT_EQ(ErrorOfLinking(33), 7102);
}

// OPT-9.06, OPT-E.7104
TEST_F(Linker, AFunctionIsNotTheMainProgram) {
  Store(25, "FUNCTION 25\n");
  EXPECT_EQ(ErrorOfLinking(25), 7104);
  Store(32, "FUNCTION 44\n");
  Store(44, "FUNCTION 32\n");
  EXPECT_EQ(ErrorOfLinking(32), 7104);
}

// OPT-9.03, OPT-9.04, OPT-9.06, OPT-9.11, OPT-E.7034: which FUNCTION, where it stands, and what is
// wrong with its bytes.
TEST_F(Linker, WhatIsWrongIsSaidWithItsPlace) {
  const auto said = [this](int slot) {
    const Result<Executable> executable = Link(slot, Lookup(), {});
    return executable ? std::string() : std::string(executable.error().detail);
  };
  EXPECT_EQ(said(33), "program 33 is not stored");
  Store(32, "SPEED 5\nFUNCTION 44\n");
  EXPECT_EQ(said(32), "no object for FUNCTION 44 in program 32, step 2");
  objects_[44] = "no object at all";
  EXPECT_EQ(ErrorOfLinking(44), 7034);
  EXPECT_EQ(said(44), "this is no object");
  EXPECT_EQ(ErrorOfLinking(32), 7034);
  EXPECT_EQ(said(32), "FUNCTION 44: this is no object");
  Store(44, "FUNCTION 32\n");
  EXPECT_EQ(said(32), "FUNCTION 32 in program 44, step 1 is the main program");
  Store(44, "TASK 2\n");
  EXPECT_EQ(said(32), "FUNCTION 44 has TASK, but no TASK 1");
  // One that was given by hand stands in no program.
  Store(kNoProgram, "FUNCTION 45\n");
  EXPECT_EQ(said(kNoProgram), "no object for FUNCTION 45");
}

// The published values of FNV-1a with 64 bits.
TEST(HashOfAnObject, IsThePublishedOne) {
  EXPECT_EQ(HashObject(""), 0xCBF29CE484222325U);
  EXPECT_EQ(HashObject("a"), 0xAF63DC4C8601EC8CU);
  EXPECT_EQ(HashObject("foobar"), 0x85944171F73967E8U);
}

// OPT-9.07
TEST_F(Linker, AFunctionMayCallItself) {
  Store(32, "FUNCTION 44\n");
  Store(44, "IF VL[1] THEN 10\nFUNCTION 44\n10 RETURN\n");
  EXPECT_EQ(ErrorOfLinking(32), 0);
}

// OPT-9.05, OPT-E.7105
TEST_F(Linker, ThirtyTwoFunctionsFit) {
  std::string main;
  for (int f = 1; f <= 32; ++f) {
    Store(f, "SPEED 5\n");
    main += "FUNCTION " + std::to_string(f) + "\n";
  }
  Store(99, main);
  EXPECT_EQ(ErrorOfLinking(99), 0);
  Store(33, "SPEED 5\n");
  Store(99, main + "FUNCTION 33\n");
  EXPECT_EQ(ErrorOfLinking(99), 7105);
}

// OPT-9.11, OPT-E.7108
TEST_F(Linker, FunctionsEnterAtTaskOne) {
  Store(32, "FUNCTION 44\n");
  Store(44, "TASK 2\n");
  EXPECT_EQ(ErrorOfLinking(32), 7108);
  Store(44, "TASK 2\nTASK 1\n");
  EXPECT_EQ(ErrorOfLinking(32), 0);
  Store(44, "SPEED 5\n");
  EXPECT_EQ(ErrorOfLinking(32), 0);
}

// OPT-9.19
TEST_F(Linker, TheRotaryTableIsBuiltIn) {
  Store(32, "FUNCTION 99 (90.)\n");
  EXPECT_EQ(ErrorOfLinking(32), 7103);
  EXPECT_EQ(ErrorOfLinking(32, {.rotary_table = true}), 0);
}

// OPT-B.72: 16, and 4 for the end of the module; a MOVE with five REAL literals and /FLY has 30.
TEST_F(Linker, SizesFollowTheModel) {
  const auto size = [this](const std::string& text) {
    Store(32, text);
    return ExecutableSize(*Link(32, Lookup(), {}));
  };
  EXPECT_EQ(size(""), 20U);
  EXPECT_EQ(size("MOVE (1.,2.,3.,0.,0.)/FLY\n") - 20U, 30U);
  EXPECT_EQ(size("VR[1] = VR[2] + 5\n") - 20U, 4U + 2U + 2U + 3U + 1U);
  EXPECT_EQ(size("10 GOTO 10\n") - 20U, 4U + 3U);
  EXPECT_EQ(size("DECLARE X = VR[1]\n"), 20U);
  Store(44, "");
  EXPECT_EQ(size("FUNCTION 44\n"), 20U + 4U + 3U + 8U + 4U);
}

// OPT-B.72: 4 a step, 5 a REAL literal, 3 an INTEGER one and a target, 2 a variable, 1 an operator,
// function, attribute, ON or OFF.
TEST_F(Linker, EachInstructionHasItsSize) {
  struct Row {
    const char* text;
    std::uint32_t size;
  };
  for (const Row& row : {
           Row{"SPEED 5\n", 4 + 3},
           Row{"SPEED 5.\n", 4 + 5},
           Row{"SPEED 40000.+VR[1]\n", 4 + 5 + 2 + 1},
           Row{"VR[1] = -SIN(PI)\n", 4 + 2 + 5 + 1 + 1},
           Row{"OL[11] = ON\n", 4 + 2 + 1},
           Row{"VL[1] = NOT VL[2] AND IL[3] = OFF\n", 4 + 2 + 1 + 2 + 1 + 2 + 1 + 1},
           Row{"COORD ABSOL\n", 4},
           Row{"PATH HOLE (5.)\n", 4 + 5},
           Row{"WORKDEF 1,2 (8.,75.,1.,50.)\n", 4 + 3 + 3 + 20},
           Row{"WORKDEF 0,0\n", 4 + 3 + 3},
           Row{"WORK 1,2/ON\n", 4 + 3 + 3 + 1},
           Row{"WORK 1,2/ON/START (IL[20])/NEXT\n", 4 + 3 + 3 + 3 + 2},
           Row{"TASK 1\n", 4 + 3},
           Row{"DEFINE PAR[0] = INT\n", 4 + 3},
           Row{"ASSIGN OL[32] = 5 /8\n", 4 + 2 + 3 + 3},
           Row{"BREAK 7\n", 4 + 3},
           Row{"BREAK 7, 45\n", 4 + 3 + 3},
           Row{"SIMUL 7, 45\n", 4 + 3 + 3},
           Row{"UPDATE IL, OL /ON\n", 4 + 1},
           Row{"IMAGE\n", 4},
           Row{"10 GOTO VI[2] (10,10,10)\n", 4 + 2 + 9},
           Row{"10 IF VL[1] THEN 10 ELSE 10\n", 4 + 2 + 6},
           Row{"10 TIMER (5.,10) /AUTO\n", 4 + 5 + 3 + 1},
           Row{"TIMER /DIS\n", 4 + 1},
           Row{"10 MOVE (1.,2.,3.,0.,0.)/TIME (2.,10)\n", 4 + 25 + 5 + 3 + 1},
           Row{"MOVE (1.,2.,3.,0.,0.)/VIA (1.,2.,3.,0.,0)\n", 4 + 25 + 23 + 1},
           Row{"GO 46 /C\n", 4 + 3 + 1},
           Row{"CALL 46 (VR[1],5.)\n", 4 + 3 + 2 + 5},
           Row{"DECLARE X = 5.\nVR[1] = X\n", 4 + 2 + 5},
           Row{"DECLARE X = VR[2]\nVR[1] = X\n", 4 + 2 + 2},
       }) {
    Store(32, row.text);
    EXPECT_EQ(ExecutableSize(*Link(32, Lookup(), {})), 20U + row.size) << row.text;
  }
}

// OPT-9.10, OPT-E.7106: smaller than the limit.
TEST_F(Linker, TheExecutableStaysBelowTheLimit) {
  Store(32, "MOVE (1.,2.,3.,0.,0.)/FLY\n");
  EXPECT_EQ(ErrorOfLinking(32, {.executable_limit = 51}), 0);
  EXPECT_EQ(ErrorOfLinking(32, {.executable_limit = 50}), 7106);
  EXPECT_EQ(LinkOptions{}.executable_limit, 32768U);
}

// OPT-1.15, OPT-B.71
TEST_F(Linker, ExecutablesAreBytes) {
  Store(32, "FUNCTION 44 (7.)\n");
  Store(44, "DEFINE PAR[0] = INT\nVI[2] = PAR[0]\nENDTASK\n");
  const std::string bytes = EncodeExecutable(*Link(32, Lookup(), {}));
  EXPECT_TRUE(bytes.starts_with("LMX\x01"));  // version 1
  const Result<Executable> again = DecodeExecutable(bytes);
  ASSERT_TRUE(again);
  EXPECT_EQ(EncodeExecutable(*again), bytes);
  EXPECT_EQ(again->modules[1].object_hash, HashObject(*Lookup()(44)));
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x20);
    EXPECT_FALSE(DecodeExecutable(damaged)) << at;
    EXPECT_FALSE(DecodeExecutable(bytes.substr(0, at))) << at;
  }
  EXPECT_FALSE(DecodeExecutable(bytes + '\0'));
}

// OPT-9.05, OPT-B.71, OPT-7.06: one program and at most 32 functions, each of a number of its own
// from 1 to 99.
TEST_F(Linker, ExecutablesHaveProgramsOfTheMemory) {
  Store(32, "SPEED 5\n");
  const Executable one = *Link(32, Lookup(), {});
  const auto decodes = [&](const std::vector<int>& slots) {
    Executable executable;
    for (const int slot : slots) {
      executable.modules.push_back(one.modules[0]);
      executable.modules.back().slot = slot;
    }
    return static_cast<bool>(DecodeExecutable(EncodeExecutable(executable)));
  };
  EXPECT_TRUE(decodes({1}));
  EXPECT_TRUE(decodes({99, 1}));
  EXPECT_FALSE(decodes({}));
  EXPECT_FALSE(decodes({0}));
  EXPECT_FALSE(decodes({100}));
  EXPECT_FALSE(decodes({5, 5}));
  std::vector<int> slots;
  for (int slot = 1; slot <= 33; ++slot) slots.push_back(slot);
  EXPECT_TRUE(decodes(slots));
  slots.push_back(34);
  EXPECT_FALSE(decodes(slots));
}

// OPT-B.71: with a right checksum, too, nothing is read that is no executable of this version, or
// whose programs are damaged.
TEST_F(Linker, WhatIsNoExecutableIsRefused) {
  Store(32, "SPEED 5\n");
  const std::string made = EncodeExecutable(*Link(32, Lookup(), {}));
  const std::string body = made.substr(0, made.size() - 4);
  const auto sealed = [](std::string_view bytes) {
    ByteWriter out;
    out.Raw(bytes);
    out.Fixed32(Checksum(bytes));
    return out.Take();
  };
  EXPECT_EQ(sealed(body), made);
  const std::size_t object = body.find("LMR");
  ASSERT_NE(object, std::string::npos);
  for (const std::size_t at :
       {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{3}, object, body.size() - 1}) {
    std::string changed = body;
    changed[at] = static_cast<char>(changed[at] + 1);
    const Result<Executable> decoded = DecodeExecutable(sealed(changed));
    ASSERT_FALSE(decoded) << at;
    EXPECT_EQ(decoded.error().code, ErrorCode::kObjectCorrupt) << at;
  }
  EXPECT_FALSE(DecodeExecutable(sealed(body + "x")));
  EXPECT_FALSE(DecodeExecutable(sealed(body.substr(0, body.size() - 1))));
}

// OPT-6.15, OPT-B.72: program 1 is a number like any other, 0 is none.
TEST_F(Linker, ABreakpointInProgramOneHasItsSize) {
  for (const auto& [text, size] :
       {std::pair{"BREAK 7, 1\n", 4U + 3U + 3U}, std::pair{"SIMUL 7, 1\n", 4U + 3U + 3U},
        std::pair{"BREAK 7, 0\n", 4U + 3U}}) {
    Store(32, text);
    EXPECT_EQ(ExecutableSize(*Link(32, Lookup(), {})), 20U + size) << text;
  }
}

}  // namespace
}  // namespace rmlcell::optimo
