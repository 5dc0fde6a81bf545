#include <gtest/gtest.h>
#include <sys/mman.h>

#include "engine/optimo/language/evaluate.h"
#include "engine/optimo/language/program.h"
#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

// Every limit on both sides.
TEST(Parser, NestingHasALimit) {
  const auto nested = [](int depth) {
    return "VR[0] = " + std::string(static_cast<std::size_t>(depth), '(') + "1." +
           std::string(static_cast<std::size_t>(depth), ')') + "\n";
  };
  EXPECT_TRUE(FindingsOf(nested(kNestingMax)).empty());
  EXPECT_EQ(FindingsOf(nested(kNestingMax + 1)), (std::vector<int>{7003}));
  const auto functions = [](int depth) {
    std::string text = "VR[0] = ";
    for (int n = 0; n < depth; ++n) text += "ABS(";
    return text + "1." + std::string(static_cast<std::size_t>(depth), ')') + "\n";
  };
  EXPECT_TRUE(FindingsOf(functions(kNestingMax)).empty());
  EXPECT_EQ(FindingsOf(functions(kNestingMax + 1)), (std::vector<int>{7003}));
  // Side by side they are not inside each other.
  std::string row = "VR[0] = 1.";
  for (int n = 0; n <= kNestingMax; ++n) row += "+(1.)+ABS(1.)";
  EXPECT_TRUE(FindingsOf(row + "\n").empty());
}

// A chain of any length is no nesting.
TEST(Parser, LongChainsAreFine) {
  std::string text = "VR[0] = 1.";
  for (int i = 0; i < 20'000; ++i) text += "+1.";
  EXPECT_TRUE(Compile(text + "\n", "", {.object_limit = 0}).ok);
}

// Operands that wait for their operator are bounded, too: 1+(1+(1+ ...
TEST(Parser, PendingOperandsAreBounded) {
  const auto pending = [](std::size_t operands) {
    std::string text = "VR[0] = ";
    for (std::size_t n = 1; n < operands; ++n) text += "1.-(";
    return text + "1." + std::string(operands - 1, ')') + "\n";
  };
  EXPECT_TRUE(FindingsOf(pending(kOperandStackMax)).empty());
  EXPECT_EQ(FindingsOf(pending(kOperandStackMax + 1)), (std::vector<int>{7003}));
}

// Wherever a text ends, in good statements and in bad ones, it is answered.
TEST(Parser, TextsMayEndAnywhere) {
  for (const std::string_view text :
       {"VR[1] = (2. + 3.\nABCDE [ 12 ] = 4.5 E - 10\n", "MOVE (1.,2.\n 10  FUNCTION 4 /FLY\n",
        "VL[0] = VR[1] <> 00.50 < = 7 >\n", "CONT a b  ;c\nCONT  \t\nCONT;\r\r\n",
        "10 ; one\r\n 0020 VR[1] = 2. *\n\n; two\n\xC3\xC3 # \r5\n", "SPEED 5 THEN 0x5 1..2 .\n"}) {
    for (std::size_t length = 0; length <= text.size(); ++length) {
      const std::string cut(text.substr(0, length));
      const Compilation compiled = Compile(cut, "", {});
      EXPECT_LE(compiled.diagnostics.size(), 6U) << cut;
      for (const Diagnostic& d : compiled.diagnostics)
        EXPECT_LE(d.where.byte_offset + d.where.length, static_cast<std::int64_t>(length)) << cut;
    }
  }
}

// Comments and statements keep their places.
TEST(Parser, KeepsPlaces) {
  const std::string text = "; one\n10 SPEED 20 ; two\n";
  Findings findings;
  const ParsedProgram program = Parse(text, findings);
  ASSERT_EQ(program.comments.size(), 2U);
  EXPECT_EQ(
      text.substr(program.comments[1].begin, program.comments[1].end - program.comments[1].begin),
      "; two");
  ASSERT_EQ(program.statements.size(), 1U);
  EXPECT_EQ(text.substr(program.statements[0].begin,
                        program.statements[0].end - program.statements[0].begin),
            "SPEED 20");
  EXPECT_EQ(program.label_places.at(0).offset, 6U);
}

// A statement reaches as far as it was read.
TEST(Parser, AWrongStatementEndsWhereItStopped) {
  Findings findings;
  const std::string text = ") 5 6 ; x\n10 SPEED 5 PATH LIN\n";
  const ParsedProgram program = Parse(text, findings);
  ASSERT_EQ(program.statements.size(), 2U);
  const auto span = [&](std::size_t n) {
    return text.substr(program.statements[n].begin,
                       program.statements[n].end - program.statements[n].begin);
  };
  EXPECT_EQ(span(0), ")");
  EXPECT_EQ(program.statements[0].tokens, 0U);
  EXPECT_EQ(span(1), "SPEED 5");
  EXPECT_EQ(program.statements[1].tokens, 2U);
}

// OPT-1.25: the message shows the first place.
TEST(Parser, DuplicateNumbersShowTheFirstLine) {
  const Compilation compiled = Compile("SPEED 5\n10 SPEED 5\n\n10 SPEED 6\n", "", {});
  ASSERT_EQ(compiled.diagnostics.size(), 1U);
  EXPECT_EQ(compiled.diagnostics[0].where.line, 4);
  EXPECT_NE(compiled.diagnostics[0].detail.find("line 2"), std::string::npos);
}

// A wrong statement is a step, so that the steps behind it keep their numbers.
TEST(Parser, WrongStatementsCountAsSteps) {
  const Compilation compiled = Compile("SPEED\nDECLARE 2X = VR[1]\nSPEED 101\n", "", {});
  ASSERT_EQ(compiled.diagnostics.size(), 3U);
  EXPECT_EQ(compiled.diagnostics[0].step, 1);
  EXPECT_EQ(compiled.diagnostics[2].step, 2);
}

// OPT-1.33: a fault in the values of a statement is told once, and nothing about their number.
TEST(Parser, AFaultInAListIsToldOnce) {
  for (const std::string list : {"(1.,)", "(,1.)", "(1. 2.)", "(1.", "((1.)"}) {
    for (const std::string before :
         {"MOVE ", "MOVE (1.,2.,3.,0.,0.) /VIA ", "MOVE (1.,2.,3.,0.,0.) /START ", "SYSDEF ",
          "TCP ", "PATH HOLE ", "WORKDEF 1,0 ", "WORKDEF 2,0,", "CALL 45 ", "FUNCTION 45 ",
          "TIMER "}) {
      EXPECT_EQ(FindingsOf(before + list + "\nSTOP\n").size(), 1U) << before << list;
    }
  }
}

// OPT-7.45, OPT-1.32: names have letters and digits; what is wrong is the other character.
TEST(Parser, ABadCharacterInANameIsWhatIsReported) {
  struct Row {
    std::string_view text;
    int column;
  };
  for (const Row& row : {Row{"X_1 = 5.\n", 2}, Row{"10 LENGTH_X = 5.\n", 10},
                         Row{"LET X_1 = 5.\n", 6}, Row{"DECLARE X_1 = VR[1]\n", 10},
                         Row{"VR_1 = 5.\n", 3}, Row{"VR[0] = X_1\n", 10}, Row{"SPED# 5\n", 5}}) {
    const Compilation compiled = Compile(row.text, "", {.advice = false});
    ASSERT_EQ(compiled.diagnostics.size(), 1U) << row.text;
    const Diagnostic& found = compiled.diagnostics[0];
    EXPECT_EQ(found.code, ErrorCode::kBadCharacter) << row.text;
    EXPECT_EQ(found.where.line, 1) << row.text;
    EXPECT_EQ(found.where.column, row.column) << row.text;
    EXPECT_EQ(found.where.length, 1) << row.text;
  }
}

// A mapping that nobody writes takes no memory.
TEST(Parser, ATextHasAGibibyteAtMost) {
  constexpr std::size_t kBytes = (std::size_t{1} << 30) + 1;
  void* room = mmap(nullptr, kBytes, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  ASSERT_NE(room, MAP_FAILED);
  Findings findings(1);
  const ParsedProgram program =
      Parse({static_cast<const char*>(room), kBytes}, findings, Places::kStatements);
  EXPECT_TRUE(program.statements.empty());
  const std::vector<Diagnostic> told = findings.Take("", "");
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0].code, ErrorCode::kCellTooLarge);
  munmap(room, kBytes);
}

}  // namespace
}  // namespace rmlcell::optimo
