#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "engine/optimo/language/byte_stream.h"
#include "engine/optimo/language/source_map.h"
#include "tests/engine/optimo/language/compile_text.h"

// What no compiler writes is refused though its checksum is right, whatever a reader would make of
// it. OPT-B.71, OPT-E.7034
namespace rmlcell::optimo::object_refusals {
namespace {

std::string BytesOf(std::string_view digits) {
  std::string bytes;
  for (std::size_t at = 0; at + 1 < digits.size(); at += 2)
    bytes += static_cast<char>(std::stoi(std::string(digits.substr(at, 2)), nullptr, 16));
  return bytes;
}

std::string Sealed(const std::string& body) {
  ByteWriter out;
  out.Raw(body);
  out.Fixed32(Checksum(body));
  return out.Take();
}

// `records` is their number, the table of names and the numbers at the end, then the records: all
// as hexadecimal digits.
std::string Object(std::string_view records) { return Sealed("LMR\x01" + BytesOf(records)); }

std::string DetailOf(const std::string& object) {
  const Result<Module> module = DecodeObject(object);
  if (module) return "good";
  EXPECT_EQ(module.error().code, ErrorCode::kObjectCorrupt);
  return module.error().detail;
}

struct Row {
  const char* what;
  const char* records;
};

TEST(ObjectRefusals, WhatTheCompilerWritesIsRead) {
  for (const Row& row : {
           Row{"SPEED 5", "01000004010500"},
           Row{"9999 STOP, 0 at the end",
               "01000100005701"
               "0F27"},
           Row{"GOTO 9999", "0100000F0F27"},
           Row{"DECLARE AZ09 = 7", "010104415A3039001E00010700"},
           Row{"DECLARE ZA90 = 7", "0101045A413930001E00010700"},
           Row{"VR[0] = 2^63", "0100001D1000020000005F"},
           Row{"VR[0] = -2^63", "0100001D100002000000DF"},
           Row{"VR[0] = 2^-64", "0100001D1000020000801F"},
           Row{"VR[0] = 0.", "0100001D10000200000000"},
           Row{"CALL 46", "0100000D01012E00"},
           Row{"CALL 46 with eight",
               "0100000D09012E00030303030303"
               "0303"},
           Row{"GOTO VI[2] (10)", "010000101102010A00"},
           Row{"SYSDEF", "0100000800"},
           Row{"BREAK 9999", "010000248F4E00"},
       }) {
    EXPECT_EQ(DetailOf(Object(row.records)), "good") << row.what;
  }
}

constexpr Row kRefused[] = {
    {"record 0", "01000000"},
    {"a record behind the last", "01000028"},
    {"one record too few", "02000004010500"},
    {"one too many",
     "01000004010500"
     "16"},
    {"numbers announced, and none there", "0100005700"},
    {"attributes announced, and none there", "0100008B000003"},
    {"sequence number 10000",
     "0100005701"
     "1027"},
    {"10000 at the end",
     "0100011027"
     "17"},
    {"a number twice", "01000057020A000A00"},
    {"a number once more at the end",
     "0100010A005701"
     "0A00"},
    {"GOTO 10000", "0100000F1027"},
    {"a name with '@'",
     "01010241"
     "40001E00010700"},
    {"a name with '['",
     "01010241"
     "5B001E00010700"},
    {"a name with '/'",
     "01010241"
     "2F001E00010700"},
    {"a name with ':'",
     "01010241"
     "3A001E00010700"},
    {"a name of small letters",
     "01010241"
     "61001E00010700"},
    {"a name with a digit ahead",
     "01010230"
     "41001E00010700"},
    {"a name with '@' ahead",
     "01010240"
     "41001E00010700"},
    {"a name with '[' ahead",
     "0101025B"
     "41001E00010700"},
    {"a name of no letter", "010100001E00010700"},
    {"the name of an instruction",
     "010104"
     "474F544F"
     "001E00010700"},
    {"a name twice",
     "0202"
     "0241"
     "420241"
     "42001E000107001E01010700"},
    {"a DECLARE without its name", "0100001E00010700"},
    {"a name that no DECLARE has",
     "0101024142"
     "0017"},
    {"the use of a name behind the last", "0201024142001E000107001D10000601"},
    {"an index behind the last name", "0201024142001E000107001D1801010500"},
    {"a tag between names and variables", "0100001D10000F"},
    {"tag 0", "0100001D100000"},
    {"a tag between indices and operators", "0201024142001E000107001D10002000"},
    {"the last leaf as an operator",
     "0100001D100025"
     "1001"},
    {"an operator behind the last",
     "0100001D12004304"
     "1201"},
    {"a REAL above 2^63", "0100001D1000020100005F"},
    {"a REAL below -2^63", "0100001D100002010000DF"},
    {"a REAL below 2^-64",
     "0100001D1000"
     "02FFFF7F1F"},
    {"a REAL of -0", "0100001D10000200000080"},
    {"an infinite REAL", "0100001D1000020000807F"},
    {"a REAL that is no number", "0100001D1000020000C07F"},
    {"CALL without a program", "0100000D00"},
    {"CALL with nine parameters",
     "0100000D0A012E00030303030303"
     "030303"},
    {"GO with a REAL", "0100000C0200002041"},
    {"GO with a sum", "0100000C38010500010500"},
    {"FUNCTION without a program", "0100000E00"},
    {"FUNCTION with a variable", "0100000E011102"},
    {"DECLARE with a name",
     "0202"
     "024142024143001E000107001E010600"},
    {"DECLARE with a sum", "0101024142001E0038010500010500"},
    {"ASSIGN with a REAL",
     "0100002008142002000020"
     "41"},
    {"LET to a number", "0100001D010500010500"},
    {"GOTO VI[2] ()", "01000010110200"},
    {"SYSDEF with three values", "0100000803010100010200010300"},
    {"SYSDEF with seven values", "0100000807010100010200010300010400010500010600010700"},
    {"PATH LIN with a radius",
     "0100000301"
     "01010500"},
    {"PATH HOLE without", "010000030300"},
    {"WORKDEF 0 with a value",
     "0100000A000901"
     "010500"},
    {"WORKDEF 1 with three values",
     "0100000A010903"
     "010500010500010500"},
    {"WORKDEF 2 without", "0100000A020900"},
    {"WORK without ON and OFF", "0100000B0003"},
    {"WORK with both", "0100008B80030003"},
    {"GO with two modes", "0100008C800C012E00"},
    {"IF without a target", "01000012120100"},
    {"IF with three",
     "0100001212010"
     "30A000A000A00"},
    {"TIMER without a time and /DIS", "0100001C00"},
    {"TIMER with a time and /DIS",
     "0100009C804001010500"
     "0A00"},
    {"BREAK 10000", "01000024904E00"},
    {"a word without effect that is none", "010000270143"},
    {"one in small letters", "0100002704636F6E74"},
    {"one with two blanks", "0100002707434F4E54202041"},
    {"one with a blank behind", "0100002705434F4E5420"},
    {"one with a comment", "0100002706434F4E54203B"},
    {"one with a line end", "0100002707434F4E5420410A"},
    {"an instruction as one", "010000270446555854"},
};

TEST(ObjectRefusals, WhatItDoesNotWriteIsNot) {
  for (const Row& row : kRefused) {
    EXPECT_EQ(DetailOf(Object(row.records)), "a record is damaged") << row.what;
  }
}

// What the form allows and the program's own rules do not is told as the compiler would.
TEST(ObjectRefusals, ErrorsOfTheProgramAreNamed) {
  for (const auto& [records, detail] : std::vector<std::pair<const char*, const char*>>{
           {"0100000C010000", "OPT-E7004 at step 1"},  // GO 0
           {"02000017"
            "0C016400",
            "OPT-E7004 at step 2"},                      // GO 100
           {"0100000C01FFFF", "a record is damaged"},    // GO -1: no whole number
           {"01000004016500", "OPT-E7004 at step 1"},    // SPEED 101
           {"0100001D13030400", "a record is damaged"},  // and a byte more
           {"0100001D130304", "OPT-E7016 at step 1"},    // IL[3] = ON
           {"0100001D100004", "OPT-E7018 at step 1"},    // VR[0] = ON
       }) {
    EXPECT_EQ(DetailOf(Object(records)), detail) << records;
  }
}

TEST(ObjectRefusals, WhatIsNoObjectIsTold) {
  EXPECT_EQ(DetailOf(""), "this is no object");
  EXPECT_EQ(DetailOf("LMR\x01"
                     "123"),
            "this is no object");
  EXPECT_EQ(DetailOf(Sealed("LMX\x01")), "this is no object");
  EXPECT_EQ(DetailOf(Sealed("LMR\x01")), "a record is damaged");
  EXPECT_EQ(DetailOf(Sealed("LMR\x02")), "object version 2 is not known");
  EXPECT_EQ(DetailOf("LMR\x01"
                     "1234"),
            "the checksum is wrong");
}

// OPT-B.40: parentheses nest as deep as the compiler takes them, and no deeper.
TEST(ObjectRefusals, ExpressionsNestAsDeepAsTheirTextMay) {
  Module module = MustCompile("VR[0] = PI\n").module;
  const ExprNode function{.op = Node::kAbs, .type = ValueType::kReal};
  module.nodes.insert(module.nodes.end(), kNestingMax, function);
  module.expression_ends.back() = static_cast<std::uint32_t>(module.nodes.size());
  EXPECT_TRUE(DecodeObject(EncodeObject(module)));
  module.nodes.push_back(function);
  ++module.expression_ends.back();
  EXPECT_EQ(DetailOf(EncodeObject(module)), "a record is damaged");
}

// OPT-1.05: a source map, too, is what was written or nothing.
TEST(ObjectRefusals, SourceMapsAreWhatWasWritten) {
  const std::string map = EncodeSourceMap(MapSource("SPEED 5\n", true, "an object"));
  const std::string body = map.substr(0, map.size() - 4);
  const auto with = [&](std::size_t at, char byte) {
    std::string changed = body;
    changed[at] = byte;
    return DecodeSourceMap(Sealed(changed));
  };
  ASSERT_TRUE(DecodeSourceMap(map));
  EXPECT_TRUE(DecodeSourceMap(map)->inch);
  ASSERT_TRUE(with(4, 0));
  EXPECT_FALSE(with(4, 0)->inch);
  EXPECT_FALSE(with(4, 2));    // flags
  EXPECT_FALSE(with(3, 2));    // version
  EXPECT_FALSE(with(2, 'R'));  // no map
  EXPECT_FALSE(with(13, 9));   // a text longer than there is
  EXPECT_FALSE(with(13, 7));   // or shorter
  EXPECT_FALSE(DecodeSourceMap(Sealed(body + "x")));
  for (const std::string& cut : {std::string(), std::string("LMS"), std::string("LMS\x01")})
    EXPECT_FALSE(DecodeSourceMap(Sealed(cut)));
}

// OPT-2.43: an instruction has the attributes that it may have, or none.
TEST(ObjectRefusals, AttributesAreThoseOfTheirInstruction) {
  const std::string move = "010100010200010300010400010500";
  EXPECT_EQ(DetailOf(Object("0100008102" + move)), "good");  // MOVE /FLY
  for (const Row& row : {
           Row{"SPEED /FLY", "0100008402010500"},
           Row{"WORK /ON/C", "0100008B80050000"},
           Row{"STOP with none though some are announced", "0100009700"},
       }) {
    EXPECT_EQ(DetailOf(Object(row.records)), "a record is damaged") << row.what;
  }
  // MOVE with a bit that means no attribute.
  EXPECT_EQ(DetailOf(Object("01000081808001" + move)), "a record is damaged");
}

// OPT-B.85: a division has parentheses of its own in TCP, and nowhere else.
TEST(ObjectRefusals, OnlyTcpPutsADivisionIntoParentheses) {
  const auto nested = [](int functions) {
    std::string text;
    for (int n = 0; n < functions; ++n) text += "ABS(";
    return text + "VR[1]" + std::string(static_cast<std::size_t>(functions), ')');
  };
  const auto tcp = [](const std::string& value) {
    return MustCompile("TCP (0., 0., " + value + " / 0., 0., 1.)\n");
  };
  EXPECT_EQ(DetailOf(MustCompile("VR[0] = VR[2] / " + nested(kNestingMax) + "\n").object), "good");
  EXPECT_EQ(DetailOf(tcp(nested(kNestingMax)).object), "good");
  Module module = tcp("(VR[2] / " + nested(kNestingMax - 1) + ")").module;
  EXPECT_EQ(DetailOf(EncodeObject(module)), "good");
  // One function more around VR[1], the second part of the third value.
  const ExprNode function{.op = Node::kAbs, .type = ValueType::kReal};
  module.nodes.insert(module.nodes.begin() + module.FirstNode(2) + 2, function);
  for (std::uint32_t value = 2; value < 6; ++value) ++module.expression_ends[value];
  EXPECT_EQ(DetailOf(EncodeObject(module)), "a record is damaged");
}

}  // namespace
}  // namespace rmlcell::optimo::object_refusals
