// One fault has one finding, with the words for what is missing; what follows from it is not told.
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/optimo/language/evaluate.h"
#include "engine/optimo/language/gosub_depth.h"
#include "engine/optimo/language/linker.h"
#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo::one_finding {
namespace {

// "7003 expected ..." of the only finding; else how many there are.
std::string OnlyOne(std::string_view text, bool advice = false) {
  const Compilation compiled = Compile(text, "", {.advice = advice});
  if (compiled.diagnostics.size() != 1)
    return std::to_string(compiled.diagnostics.size()) + " findings";
  const Diagnostic& d = compiled.diagnostics[0];
  return std::to_string(Lookup(d.code).number) + " " + std::string(d.detail);
}

// OPT-3.01, OPT-3.13
TEST(OneFinding, OfTheNumbersOfAProcess) {
  EXPECT_EQ(OnlyOne("WORK X,0/ON\n"), "7003 expected the kind 0, 1 or 2, found 'X'");
  EXPECT_EQ(OnlyOne("WORK 1 0/ON\n"), "7003 expected ',' and the process number, found '0'");
  EXPECT_EQ(OnlyOne("WORK 1,X/ON\n"), "7003 expected a process number, found 'X'");
  EXPECT_EQ(OnlyOne("WORKDEF 1,X (8.,75.,1.,50.)\n"), "7003 expected a process number, found 'X'");
}

// OPT-3.03, OPT-3.04: how many values each kind takes.
TEST(OneFinding, OfTheValuesOfAWorkdef) {
  EXPECT_EQ(OnlyOne("WORKDEF 0,0 (5)\n"), "7019 WORKDEF 0 has 1 value, needs none");
  EXPECT_EQ(OnlyOne("WORKDEF 1,0 (5, 6)\n"),
            "7019 WORKDEF 1 has 2 values, needs 4 or 5: speed, power, delay, peak [, schedule]");
}

// OPT-7.66: what is given to a variable that can only be read is not looked at, nor how many of
// them there are.
TEST(OneFinding, OfAVariableThatCanOnlyBeRead) {
  for (const char* text : {"IL[3] = 5\n", "LET VI[98] = ON\n", "IA[1] = VL[80]\n",
                           "ASSIGN IL[97] = 0 /8\n", "ASSIGN IA[1] = 0 /4\n"})
    EXPECT_EQ(FindingsOf(text), std::vector<int>{7016}) << text;
}

// OPT-2.43, OPT-7.50: each value of an attribute is looked at.
TEST(OneFinding, OfANameInAnAttribute) {
  for (const char* attributes :
       {"/START (XX)", "/END (XX)", "/TIME (XX,5)", "/VIA (XX,2,3,0,0)", "/VIA (1,2,3,0,XX)",
        "/START (VL[1])/END (XX)", "/START (XX)/END (VL[1])", "/END (VL[1])/TIME (XX,5)"})
    EXPECT_EQ(OnlyOne("5 MOVE (1,2,3,0,0)" + std::string(attributes) + "\n"),
              "7011 XX is not declared")
        << attributes;
  // In whatever order they stand before what cannot stand there.
  EXPECT_EQ(OnlyOne("MOVE (1,2,3,0,0)/END (VL[1])/START (VL[2])/FLYY\n"),
            "7003 expected an attribute behind '/', found 'FLYY'");
}

// OPT-7.91: words without effect are proposed like instructions, those of attributes are not.
TEST(OneFinding, OfAMistypedWordProposesWhatBeginsAStatement) {
  EXPECT_EQ(OnlyOne("CONTT 3\n"),
            "7011 'CONTT' is no instruction and no declared name; did you mean CONT?");
  EXPECT_EQ(OnlyOne("FLYY 3\n"), "7011 'FLYY' is no instruction and no declared name");
}

// OPT-7.59, OPT-1.32, OPT-7.53
TEST(OneFinding, OfAnIndexAndADigit) {
  EXPECT_EQ(OnlyOne("VR[] = 5\n"), "7003 expected an index, found ']'");
  EXPECT_EQ(OnlyOne("VR[@] = 5\n"), "7001 '@' cannot stand here");
  EXPECT_EQ(OnlyOne("VR[5..] = 5\n"), "7005 '5..' is no number");
  EXPECT_EQ(OnlyOne("VR[0] = 5:\n"), "7001 ':' cannot stand here");
  EXPECT_EQ(OnlyOne("VR[0] = 1.5:\n"), "7001 ':' cannot stand here");
}

// OPT-6.01: a DECLARE that is wrong is no step either, and another instruction is one.
TEST(OneFinding, OfAStepHasItsNumber) {
  for (const auto& [first, step] : {std::pair("DECLARE 5\n", 1), std::pair("SPEED #\n", 2)}) {
    const Compilation compiled = Compile(first + std::string("SPEED 101\n"), "", {.advice = false});
    ASSERT_EQ(compiled.diagnostics.size(), 2U) << first;
    EXPECT_EQ(compiled.diagnostics[1].step, step) << first;
  }
}

// OPT-7.43: what is given to a constant is not looked at.
TEST(OneFinding, OfAConstantThatIsAssigned) {
  for (const char* value : {"ON", "2", "VL[80]"}) {
    const Compilation compiled =
        Compile("DECLARE X = 1\nX = " + std::string(value) + "\n", "", {.advice = false});
    ASSERT_EQ(compiled.diagnostics.size(), 1U) << value;
    EXPECT_EQ(compiled.diagnostics[0].code, ErrorCode::kConstantAssigned) << value;
  }
}

// OPT-2.31
TEST(OneFinding, OfAViaWithoutItsValues) {
  EXPECT_EQ(OnlyOne("MOVE (1,2,3,0,0)/VIA\nSTOP\n"), "7019 /VIA has 0 values, needs 5");
  EXPECT_EQ(OnlyOne("MOVE (1,2,3,0,0)/VIA (1)\nSTOP\n"), "7019 /VIA has 1 value, needs 5");
}

// OPT-B.59
TEST(OneFinding, OfATimer) {
  EXPECT_EQ(OnlyOne("TIMER 5.\n"), "7003 expected '(' and a time, found '5.'");
  EXPECT_EQ(OnlyOne("10 TIMER (5. 10)\n"), "7003 expected ',' and a sequence number, found '10'");
  EXPECT_EQ(OnlyOne("10 TIMER (5., 10 STOP\n"), "7003 expected ')', found 'STOP'");
}

// OPT-9.22, OPT-9.23, OPT-7.41
TEST(OneFinding, OfADefineAndADeclare) {
  EXPECT_EQ(OnlyOne("DECLARE 5\n"), "7003 expected a name, found '5'");
  EXPECT_EQ(OnlyOne("DEFINE 5 = INT\n"), "7003 expected PAR, found '5'");
  EXPECT_EQ(OnlyOne("DEFINE PAR[X] = INT\n"), "7003 expected an index, found 'X'");
  EXPECT_EQ(OnlyOne("DEFINE PAR[0 = INT\n"), "7003 expected ']', found '='");
  EXPECT_EQ(OnlyOne("DEFINE PAR[0 = LOGIC\nVR[1] = PAR[0]\n"), "7003 expected ']', found '='");
  EXPECT_EQ(OnlyOne("DEFINE PAR[0] = 5\n"), "7003 expected FLOAT, INT or LOGIC, found '5'");
  EXPECT_EQ(OnlyOne("DECLARE X =\nSPEED 5\n"), "7003 expected a number, a constant or a variable");
  EXPECT_EQ(OnlyOne("DECLARE X ="),
            "7002 expected a number, a constant or a variable before the end of the text");
}

// OPT-B.87: a mark of two characters is one at the very end of the text, too.
TEST(OneFinding, OfAComparisonAtTheEnd) {
  for (const char* mark : {"<", ">", "=", "<=", ">=", "<>"})
    EXPECT_EQ(OnlyOne("VL[1] = VR[1] " + std::string(mark)),
              "7002 expected a number, a variable, a name or '(' before the end of the text")
        << mark;
}

// OPT-7.91: names are proposed as well as instructions.
TEST(OneFinding, OfAMistypedNameProposesIt) {
  EXPECT_EQ(OnlyOne("DECLARE XHOME = VR[1]\nXHOEM 5.\n"),
            "7011 'XHOEM' is no instruction and no declared name; did you mean XHOME?");
}

// OPT-7.89, OPT-7.60: what has no type has no wrong one.
TEST(OneFinding, OfANameThatIsNotKnown) {
  EXPECT_EQ(OnlyOne("VL[0] = XX + 1\n"), "7011 XX is not declared");
  EXPECT_EQ(OnlyOne("VL[0] = NOT XX + 1\n"), "7011 XX is not declared");
  EXPECT_EQ(OnlyOne("VR[0] = (XX AND ON) + 1\n"), "7011 XX is not declared");
  EXPECT_EQ(OnlyOne("VR[0] = VL[XX] + 1\n"), "7011 XX is not declared");
  EXPECT_EQ(OnlyOne("VR[0] = (ON AND XX) + 1\n"), "7011 XX is not declared");
  EXPECT_EQ(OnlyOne("DECLARE N = 200\nVR[0] = VL[N] + 1\n"),
            "7017 N is no INTEGER constant from 0 to 99");
  EXPECT_EQ(OnlyOne("VR[0] = (5 AND ON) + 1\n"), "7018 a number where a logical value is needed");
  EXPECT_EQ(OnlyOne("VR[0] = (VL[80] = ON) + 1\n"),
            "7018 a logical value where a number is needed");
  // OPT-7.62
  EXPECT_EQ(FindingsOf("WORK 1,3/ON/START (VR[80] > 1E30)\n", true), std::vector<int>{7004});
  // One that is good has a type.
  EXPECT_EQ(OnlyOne("DECLARE N = 5\nVR[0] = VL[N] + 1\n"),
            "7018 a logical value where a number is needed");
  // An instruction of which something is not known is given no advice, even the first one.
  for (const char* attributes : {"/START (XX)", "/START (VL[80])/END (XX)"})
    EXPECT_EQ(FindingsOf("WORK 1,3/ON" + std::string(attributes) + "\nDECLARE XX = #\n", true),
              std::vector<int>{7001})
        << attributes;
}

// OPT-B.42, OPT-7.01, OPT-7.07
TEST(OneFinding, OfLettersInTheNumberOfAProgram) {
  for (const char* word : {"CALL ", "GO ", "FUNCTION "}) {
    const Compilation compiled = Compile(word + std::string("46X\n"), "", {.advice = false});
    ASSERT_EQ(compiled.diagnostics.size(), 1U) << word;
    EXPECT_EQ(compiled.diagnostics[0].detail, "letters in a number") << word;
  }
}

// OPT-1.03, OPT-1.30: a carriage return at the end of the text is none of it.
TEST(OneFinding, OfACarriageReturnIsNone) {
  EXPECT_EQ(FindingsOf("SPEED 5\n\r"), std::vector<int>{});
  EXPECT_EQ(FindingsOf("SPEED 5\r"), std::vector<int>{});
  EXPECT_EQ(FindingsOf("SPEED 5\n \r\r"), std::vector<int>{});
  // Nor are several before a line end, also where the statement goes on.
  EXPECT_EQ(FindingsOf("SPEED 5\r\r\nSPEED 6 \r\r\r\nSPEED 7\r\r"), std::vector<int>{});
  EXPECT_EQ(FindingsOf("MOVE (1,2,\r\r\n3,0,0)\r\r\n"), std::vector<int>{});
  EXPECT_EQ(FindingsOf("SPEED 5\n\rX\n"), std::vector<int>{7001});
}

// OPT-7.91, OPT-E.7023: behind a fault an assignment is a statement of its own, and what stands
// behind a line without effect as well, whatever that left open.
TEST(OneFinding, OfAStatementLeavesTheNextOnesAlone) {
  const auto statements = [](std::string_view text) {
    Findings findings;
    return Parse(text, findings, Places::kStatements).statements.size();
  };
  for (const char* next : {"X1= 5", "X1 = 5", "X1 \t = 5", "VR[1]= 5", "VR [ 1 ]  = 5"}) {
    EXPECT_EQ(statements("VR[2] = (1 #\n+ 2\n" + std::string(next) + "\n"), 2U) << next;
    EXPECT_EQ(statements("MOVE (1, 2\n" + std::string(next) + "\n"), 2U) << next;
  }
  EXPECT_EQ(statements("VR[2] = (1\nX1 = (5\n+ 2)\nSTOP\n"), 3U);
  EXPECT_EQ(statements("CONT (\nX1\nSTOP\n"), 3U);
  // What has no name before its '=' is none.
  for (const char* next : {"= 5", "1 = 5", "[1] = 5"})
    EXPECT_EQ(statements("VR[2] = (1 #\n+ 2\n" + std::string(next) + "\n"), 1U) << next;
  EXPECT_EQ(FindingsOf("CONT (\nX1\n"), (std::vector<int>{7023, 7011}));
}

// OPT-B.40, OPT-2.35: a number in parentheses with its sign is one number, from the sign to the
// parenthesis.
TEST(OneFinding, OfANumberWithItsSignIsOfAllOfIt) {
  const auto place = [](std::string_view text) {
    const Compilation compiled = Compile(text, "", {.advice = false});
    EXPECT_EQ(compiled.diagnostics.size(), 1U) << text;
    return compiled.diagnostics.empty() ? SourceSpan{} : compiled.diagnostics[0].where;
  };
  EXPECT_EQ(place("SPEED -( 5 ) ; x\n"), (SourceSpan{1, 7, 6, 6}));
  EXPECT_EQ(place("SPEED - (5)\nSTOP\n"), (SourceSpan{1, 7, 5, 6}));
  EXPECT_EQ(place("SPEED -5\nSTOP\n"), (SourceSpan{1, 7, 2, 6}));
  EXPECT_EQ(place("WORKDEF 1,0 (-(5),75.,1.,50.)\n"), (SourceSpan{1, 14, 4, 13}));
  // OPT-2.43: in whatever order attributes are written.
  EXPECT_EQ(place("MOVE (1,2,3,0,0)/END (IL[20])/VIA (1,2,XX,0,0)\n"), (SourceSpan{1, 40, 2, 39}));
  EXPECT_EQ(place("MOVE (1,2,3,0,0)/END (XX)/VIA (1,2,3,0,0)\n"), (SourceSpan{1, 23, 2, 22}));
}

// OPT-7.48: with a name that is refused, and with the variables of that word.
TEST(OneFinding, OfARefusedNameOfVariables) {
  EXPECT_EQ(FindingsOf("DECLARE VR = 1\nVR[0] = 2\nLET VR[1] = 3\nLET VR = 4\nVL[VR] = ON\n"),
            std::vector<int>{7009});
}

// OPT-7.87: NOT of nothing is 1 and no other number.
TEST(OneFinding, NotGivesOneOrNothing) {
  EXPECT_EQ(Operate(Node::kNot, 0.0F, 0.0F).number, 1.0F);
  EXPECT_EQ(Operate(Node::kNot, 1.0F, 0.0F).number, 0.0F);
  EXPECT_EQ(Operate(Node::kNot, -3.0F, 0.0F).number, 0.0F);
}

// OPT-7.21: the GOSUB that leads back is told, wherever it stands in the text.
TEST(OneFinding, OfARingIsItsGosubThatLeadsBack) {
  const std::vector<LevelEdge> edges = {{0, 1, true}, {1, 2, true}, {2, 0, true}};
  using Places = std::vector<std::uint32_t>;
  EXPECT_EQ(FindNesting(3, 2, edges).recursive, Places{1});
  EXPECT_EQ(FindNesting(3, 0, edges).recursive, Places{2});
  EXPECT_EQ(FindNesting(3, 1, edges).recursive, Places{0});
}

// OPT-B.42: behind a number stand the operators that are words and those of IF without a blank, and
// no other letters.
TEST(OneFinding, OfLettersBehindANumberIsNoneWhereAWordGoesOn) {
  for (const char* text :
       {"VR[0] = 7MOD 3\n", "VL[0] = VR[1] > 5AND VL[2]\n", "VL[0] = VR[1] > 5OR VL[2]\n",
        "VL[0] = VR[1] > 5XOR VL[2]\n", "10 IF VR[1] > 5THEN 10\n"})
    EXPECT_EQ(FindingsOf(text), std::vector<int>{}) << text;
  EXPECT_EQ(OnlyOne("VR[0] = 7SIN(1.)\n"), "7005 letters in a number");
  EXPECT_EQ(OnlyOne("10 IF VR[1] > 5GOTO 10\n"), "7005 letters in a number");
}

// OPT-7.59, OPT-7.87: what is missing around an index, and behind NOT.
TEST(OneFinding, OfAVariableThatIsNotFinished) {
  EXPECT_EQ(OnlyOne("VR = 5\n"), "7003 expected '[' and an index, found '='");
  EXPECT_EQ(OnlyOne("VR[0] = VR + 1\n"), "7003 expected '[' and an index, found '+'");
  EXPECT_EQ(OnlyOne("VR[\nSTOP\n"), "7003 expected an index");
  EXPECT_EQ(OnlyOne("VR[5 = 3\n"), "7003 expected ']', found '='");
  const std::string value = "7003 expected a number, a variable, a name or '(', found ";
  EXPECT_EQ(OnlyOne("VL[0] = NOT )\n"), value + "')'");
  EXPECT_EQ(OnlyOne("VL[0] = VL[1] AND NOT ,\nSTOP\n"), value + "','");
}

// OPT-7.91: a declared name without '=' is no mistyped instruction; one that is used, and that
// nobody declared, may be.
TEST(OneFinding, OfANameWithoutItsEqualsSign) {
  EXPECT_EQ(OnlyOne("DECLARE X1 = VR[1]\nX1 5\n"), "7003 expected '=', found '5'");
  EXPECT_EQ(OnlyOne("LET X1 5\n"), "7003 expected '=', found '5'");
  EXPECT_EQ(FindingsOf("VR[0] = QQ\nQQ 5\n"), (std::vector<int>{7011, 7011}));
}

// OPT-7.15, OPT-7.17, OPT-3.01, OPT-7.01, OPT-2.54, OPT-9.22, OPT-7.102: what is missing where a
// statement stops.
TEST(OneFinding, OfAStatementIsWhereItStops) {
  EXPECT_EQ(OnlyOne("10 GOTO 5.\n"), "7003 expected a sequence number, found '5.'");
  EXPECT_EQ(OnlyOne("10 GOTO VI[2] (10, X1)\n"), "7003 expected a sequence number, found 'X1'");
  EXPECT_EQ(OnlyOne("WORKDEF 0,0, 5\n"), "7003 expected '(' and the parameters, found '5'");
  EXPECT_EQ(OnlyOne("WORKDEF 0,0,\nSTOP\n"), "7003 expected '(' and the parameters");
  EXPECT_EQ(FindingsOf("WORKDEF 2,0, (5)\n"), std::vector<int>{});
  EXPECT_EQ(OnlyOne("CALL 4.5\n"), "7003 expected a whole program number, found '4.5'");
  EXPECT_EQ(OnlyOne("FUNCTION STOP\n"), "7003 expected a program number, found 'STOP'");
  EXPECT_EQ(OnlyOne("10 IF VL[1] STOP 10\n"), "7003 expected THEN, found 'STOP'");
  EXPECT_EQ(OnlyOne("10 IF VL[1] THEN 10 STOP 10\n"),
            "7003 expected the end of the statement, found 'STOP'");
  EXPECT_EQ(OnlyOne("MOVE (1,2,3,0,0)/TIME 5\n"), "7003 expected '(' and a time, found '5'");
  EXPECT_EQ(OnlyOne("DEFINE PAR INT\n"), "7003 expected '=', found 'INT'");
  EXPECT_EQ(OnlyOne("DECLARE X1 = VI[1]\nASSIGN OL[32]=X1 5 /4\n"),
            "7003 expected '/' and the number of outputs, found '5'");
  EXPECT_EQ(OnlyOne("ASSIGN OL[32]=5X /4\n"), "7005 letters in a number");
}

// OPT-7.41, OPT-7.42, OPT-B.85: what DECLARE takes, and a '/' behind it.
TEST(OneFinding, OfWhatIsDeclared) {
  EXPECT_EQ(FindingsOf("DECLARE X1 = +5\n"), std::vector<int>{});
  EXPECT_EQ(OnlyOne("DECLARE X1 = Y1 5\n"),
            "7014 DECLARE takes a number, a constant or a variable");
  EXPECT_EQ(OnlyOne("DECLARE X1 = VR[100]\n"), "7017 index 100 is outside 0..99");
  EXPECT_EQ(OnlyOne("DECLARE X1 = 4 / 2\n"), "7014 DECLARE takes no expression");
  EXPECT_EQ(OnlyOne("DECLARE X1 = 4 /CLOCK\n"), "7022 'CLOCK' is not available on the Optimo");
  EXPECT_EQ(OnlyOne("DECLARE X1 = 4 /INTR\n"), "7022 'INTR' is not available on the Optimo");
}

// OPT-9.23, OPT-7.89: the PAR whose DEFINE is wrong has no type, and each other one has its own.
TEST(OneFinding, OfAParameterWithoutAType) {
  EXPECT_EQ(FindingsOf("DEFINE PAR[3] = LOGC\nVL[0] = PAR[3]\n"), std::vector<int>{7025});
  EXPECT_EQ(FindingsOf("DEFINE PAR[3] = LOGC\nVL[0] = PAR[0]\n"), (std::vector<int>{7025, 7018}));
}

// OPT-7.89: of what has a wrong part nothing more is said, whichever part it is.
TEST(OneFinding, OfASumWithALogicalValue) {
  for (const char* text : {"VL[0] = (IL[3] + 1) AND VL[1]\n", "VL[0] = (1 + IL[3]) AND VL[1]\n",
                           "VR[0] = (IL[3] > 1) + 1\n", "VR[0] = (1 > IL[3]) + 1\n"})
    EXPECT_EQ(OnlyOne(text), "7018 a logical value where a number is needed") << text;
}

// OPT-7.85: what an unknown name is compared with is not what is wrong.
TEST(OneFinding, OfAnUnknownNameThatIsCompared) {
  for (const char* text :
       {"VL[0] = XX = IL[3]\n", "VL[0] = IL[3] = XX\n", "VL[0] = XX <> IL[3]\n",
        "VL[0] = XX = 2.5\n", "VR[0] = (XX = IL[3]) + 1\n", "VR[0] = (IL[3] <> XX) + 1\n"})
    EXPECT_EQ(FindingsOf(text), std::vector<int>{7011}) << text;
  // What cannot be compared has no type either.
  EXPECT_EQ(OnlyOne("VR[0] = (IL[3] = VR[1]) + 1\n"),
            "7018 a logical value is compared with a number");
}

// OPT-1.33: an assignment behind a line that lacks its value is a statement of its own.
TEST(OneFinding, OfADeclareWithoutAValueLeavesTheNextLine) {
  EXPECT_EQ(FindingsOf("DECLARE X1 =\nQQ = 3\n"), (std::vector<int>{7014, 7011}));
  EXPECT_EQ(OnlyOne("VR[0] = (1. + 2.\nVR[5] = 3.\n"), "7003 expected ')'");
}

// OPT-B.85, OPT-1.33: what a statement that stopped had open is open in no other one.
TEST(OneFinding, OfAStatementEndsWithIt) {
  EXPECT_EQ(FindingsOf("TCP (0,0/6,0,0,1)\nVR[1] = VR[2] / 2\n"), std::vector<int>{7019});
  for (const char* open : {"VR[0] = (#)\n", "VR[0] = ABS(#)\n"}) {
    std::string text;
    for (int n = 0; n < kNestingMax; ++n) text += open;
    EXPECT_EQ(FindingsOf(text + "VR[0] = (1.)\nVR[0] = ABS(1.)\n"),
              std::vector<int>(static_cast<std::size_t>(kNestingMax), 7001))
        << open;
  }
}

// OPT-7.89, OPT-3.61, OPT-B.59: the value of an instruction is looked at once.
TEST(OneFinding, OfTheValueOfAnInstruction) {
  for (const char* word : {"SPEED ", "ACCEL ", "OVERSH ", "DELAY ", "SETERR ", "GO ", "CALL "})
    EXPECT_EQ(OnlyOne(word + std::string("VL[1]\n")),
              "7018 a logical value where a number is needed")
        << word;
  EXPECT_EQ(OnlyOne("SETERR -1\n"), "7004 the value must be 1 to 9999");
  for (const char* text : {"TIMER (QQ,5)\n5\n", "IF QQ THEN 5\n5\n", "WAIT QQ\n", "SETERR QQ\n"})
    EXPECT_EQ(OnlyOne(text), "7011 QQ is not declared") << text;
}

// OPT-7.43, OPT-7.60: a name is only proposed where it would not be the next error: no constant to
// be assigned, and nothing but an INTEGER constant as an index.
TEST(OneFinding, OfANameProposesWhatFits) {
  EXPECT_EQ(OnlyOne("DECLARE XHOME = 5\nXHOEM = 3\n"), "7011 XHOEM is not declared");
  EXPECT_EQ(OnlyOne("DECLARE XHOME = VR[1]\nXHOEM = 3\n"),
            "7011 XHOEM is not declared; did you mean XHOME?");
  for (const char* value : {"VR[1]", "7.5"})
    EXPECT_EQ(OnlyOne("DECLARE VALVE = " + std::string(value) + "\nVR[VAVLE] = 1\n"),
              "7011 VAVLE is not declared")
        << value;
  EXPECT_EQ(OnlyOne("DECLARE VALVE = 7\nVR[VAVLE] = 1\n"),
            "7011 VAVLE is not declared; did you mean VALVE?");
  EXPECT_EQ(OnlyOne("DECLARE VALVE = 7.5\nVR[1] = VAVLE\n"),
            "7011 VAVLE is not declared; did you mean VALVE?");
}

// OPT-7.42, OPT-7.48: what a DECLARE is told of its value and of its name.
TEST(OneFinding, OfADeclareThatIsRefused) {
  EXPECT_EQ(OnlyOne("DECLARE X1 = 4 + ON\n"), "7014 DECLARE takes no expression");
  EXPECT_EQ(OnlyOne("DECLARE SPEED = 1\n"), "7009 'SPEED' is reserved");
  EXPECT_EQ(OnlyOne("DECLARE FUNCTION1 = 1\n"),
            "7009 'FUNCTION1' is reserved: eight characters count");
}

// OPT-7.46: a long name is told once, and not where nobody declared it.
TEST(OneFinding, OfALongName) {
  EXPECT_EQ(FindingsOf("DECLARE POSITION1 = VR[1]\nPOSITION1 = 5.\nPOSITION2 = 6.\n"),
            std::vector<int>{7012});
  EXPECT_EQ(FindingsOf("POSITION1 = 5.\n"), std::vector<int>{7011});
}

// OPT-2.43, OPT-3.38, OPT-7.98: each attribute once, one of those that exclude each other, and one
// of those that must be there.
TEST(OneFinding, OfAttributesThatDoNotFit) {
  EXPECT_EQ(OnlyOne("WORK 0,0/ON/ON\n"), "7021 'ON' stands twice");
  EXPECT_EQ(OnlyOne("WORK 0,0/ON/OFF\n"), "7021 'OFF' contradicts another attribute");
  EXPECT_EQ(OnlyOne("GO 46/C/S\n"), "7021 'S' contradicts another attribute");
  EXPECT_EQ(OnlyOne("TIMER /DIS/AUTO\n"), "7021 'AUTO' contradicts another attribute");
  EXPECT_EQ(OnlyOne("WORK 0,0\nSTOP\n"), "7003 expected /ON or /OFF");
  EXPECT_EQ(OnlyOne("UPDATE IL\nSTOP\n"), "7003 expected /ON or /OFF");
}

// OPT-7.72, OPT-7.82: the parenthesis that is missing is told, not what follows from it.
TEST(OneFinding, OfAParenthesisThatIsNotClosed) {
  for (const char* text : {"VR[0] = SIN(1. STOP\n", "VR[0] = (1. STOP\n"})
    EXPECT_EQ(OnlyOne(text), "7003 expected ')', found 'STOP'") << text;
}

// OPT-7.16: each instruction that leads to a missing number is told, once.
TEST(OneFinding, OfEachJumpToAMissingNumber) {
  EXPECT_EQ(FindingsOf("GOTO 20\nGOSUB 20\n"), (std::vector<int>{7008, 7008}));
  EXPECT_EQ(FindingsOf("IF VL[1] THEN 20 ELSE 20\n"), std::vector<int>{7008});
}

// OPT-7.23, OPT-6.01: the lines of an IF behind the one where it stopped are part of it, and no
// steps; behind another statement they are none.
TEST(OneFinding, OfAnIfOverSeveralLines) {
  const Compilation compiled =
      Compile("IF #\nTHEN 10\nELSE 20\nSPEED 101\n", "", {.advice = false});
  ASSERT_EQ(compiled.diagnostics.size(), 2U);
  EXPECT_EQ(compiled.diagnostics[0].code, ErrorCode::kBadCharacter);
  EXPECT_EQ(compiled.diagnostics[1].code, ErrorCode::kLiteralRange);
  EXPECT_EQ(compiled.diagnostics[1].step, 2);
  EXPECT_EQ(FindingsOf("IF #\nELSE 20\n"), std::vector<int>{7001});
  EXPECT_EQ(FindingsOf("IF #\nSTOP\nTHEN 10\n"), (std::vector<int>{7001, 7003}));
}

}  // namespace
}  // namespace rmlcell::optimo::one_finding
