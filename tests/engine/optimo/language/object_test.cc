#include <gtest/gtest.h>

#include <random>

#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

constexpr char kProgram[] =
    "DECLARE X = VR[1]\nDECLARE N = 7\n10\n20 X = VR[N] + 2.5 * SIN(PI)\n30 MOVE (X,2.,3.,0.,0.) "
    "/VIA (1.,2.,3.,4.,5.)/FLY\n"
    "WORKDEF 1,2 (8.,75.,1.,50.,12)\nIF NOT IL[3] AND VL[1] THEN 20 ELSE 30\nEXTERN FOO\nUPDATE IL "
    "/ON\n40\n";

std::string WithChecksum(std::string object) {
  // CRC-32, bit by bit: another way than the product's table.
  std::uint32_t sum = 0xFFFFFFFFU;
  object.resize(object.size() - 4);
  for (const char c : object) {
    sum ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) sum = (sum & 1U) != 0 ? sum >> 1 ^ 0xEDB88320U : sum >> 1;
  }
  sum = ~sum;
  for (int byte = 0; byte < 4; ++byte) object += static_cast<char>(sum >> (8 * byte) & 0xFF);
  return object;
}

// OPT-B.69
TEST(Object, EncodesDecodesAndEncodesToTheSameBytes) {
  const std::string object = MustCompile(kProgram).object;
  const Result<Module> module = DecodeObject(object);
  ASSERT_TRUE(module) << module.error().detail;
  EXPECT_EQ(EncodeObject(*module), object);
  EXPECT_EQ(WithChecksum(object), object);
}

// OPT-B.70
TEST(Object, AMoveTakesAtMostThirtyTwoBytes) {
  const std::size_t empty = MustCompile("").object.size();
  EXPECT_LE(MustCompile("MOVE (1.,2.,3.,0.,0.)\n").object.size() - empty, 32U);
}

// OPT-B.71, OPT-E.7034
TEST(Object, OneFlippedBitIsFound) {
  const std::string object = MustCompile(kProgram).object;
  for (std::size_t bit = 0; bit < object.size() * 8; ++bit) {
    std::string damaged = object;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ 1 << bit % 8);
    const Result<Module> module = DecodeObject(damaged);
    ASSERT_FALSE(module) << "bit " << bit;
    EXPECT_EQ(module.error().code, ErrorCode::kObjectCorrupt);
  }
}

// OPT-B.71
TEST(Object, CutObjectsAreRefused) {
  const std::string object = MustCompile(kProgram).object;
  for (std::size_t length = 0; length < object.size(); ++length) {
    EXPECT_FALSE(DecodeObject(object.substr(0, length)));
  }
  EXPECT_FALSE(DecodeObject(object + '\0'));
}

// Damage with a right checksum: refused, or an object that comes back from its own text.
TEST(Object, HostileBytesNeverBreakTheDecoder) {
  const std::string object = MustCompile(kProgram).object;
  std::mt19937 random(20240521);
  int accepted = 0;
  for (int round = 0; round < 60'000; ++round) {
    std::string damaged = object;
    const std::size_t changes = 1 + random() % 3;
    for (std::size_t c = 0; c < changes; ++c) {
      damaged[4 + random() % (damaged.size() - 8)] = static_cast<char>(random());
    }
    damaged = WithChecksum(damaged);
    const Result<Module> module = DecodeObject(damaged);
    if (!module) continue;
    ++accepted;
    const std::string text = Decompile(*module);
    const Compilation again = Compile(text, "", {.advice = false});
    ASSERT_EQ(again.object, damaged) << "round " << round << "\n" << text;
  }
  EXPECT_GT(accepted, 100);
}

// OPT-B.40: objects were written with the sign of "-(5)" beside its literal; they are read as what
// they mean.
TEST(Object, ASignBesideItsLiteralIsReadAsOne) {
  const auto with_signs = [](const std::string& literal, const std::string& signs) {
    std::string object = MustCompile("VR[0] = " + literal + "\n").object;
    const std::size_t value = object.find(literal == "5" ? std::string("\x01\x05\x00", 3)
                                                         : std::string("\x01\x00\x80", 3));
    return WithChecksum(object.insert(value, signs));
  };
  const std::string negate(1, static_cast<char>(0x20 + static_cast<int>(Node::kNegate)));
  const std::string less_five = with_signs("5", negate);
  ASSERT_TRUE(DecodeObject(less_five));
  EXPECT_EQ(EncodeObject(*DecodeObject(less_five)), MustCompile("VR[0] = -5\n").object);
  EXPECT_EQ(*ObjectToSource(with_signs("5", negate + negate)), "     LET VR[0] = 5\n");
  EXPECT_EQ(*ObjectToSource(with_signs("-32768", negate)), "     LET VR[0] = 32768.0\n");
}

// The bytes of the records of a program without names and without numbers at its end, as
// hexadecimal digits.
std::string RecordsOf(const std::string& text) {
  const std::string object = MustCompile(text).object;
  const std::string_view head("LMR\x01\x01\x00\x00", 7);  // version 1, one record
  EXPECT_EQ(object.substr(0, head.size()), head) << text;
  std::string digits;
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  for (std::size_t at = head.size(); at + 4 < object.size(); ++at) {
    const auto byte = static_cast<unsigned char>(object[at]);
    digits += {kDigits[byte >> 4], kDigits[byte & 15]};
  }
  return digits;
}

struct BytesRow {
  const char* text;
  const char* bytes;
};

// OPT-B.70: objects are kept for years, so the code of each instruction stays what it is. Literals:
// 01 and two bytes.
TEST(Object, EachInstructionHasItsCode) {
  for (const BytesRow& row : {
           BytesRow{"MOVE (1,2,3,4,5)", "01010100010200010300010400010500"},
           BytesRow{"COORD ABSOL", "0200"},
           BytesRow{"COORD ROBOT", "0201"},
           BytesRow{"PATH PTP", "030000"},
           BytesRow{"PATH LIN", "030100"},
           BytesRow{"PATH CIR", "030200"},
           BytesRow{"PATH HOLE (5)", "030301010500"},
           BytesRow{"SPEED 5", "04010500"},
           BytesRow{"ACCEL 5", "05010500"},
           BytesRow{"OVERSH 5", "06010500"},
           BytesRow{"DELAY 5", "07010500"},
           BytesRow{"SYSDEF", "0800"},
           BytesRow{"SYSDEF (1,2,3,4,5,6)", "0806010100010200010300010400010500010600"},
           BytesRow{"TCP (1,2,3/4,5,6)", "09010100010200010300010400010500010600"},
           BytesRow{"WORKDEF 0,9", "0A000900"},
           BytesRow{"WORKDEF 2,5 (15)", "0A020501010F00"},
           BytesRow{"WORK 0,3/ON", "8B80010003"},
           BytesRow{"WORK 0,3/OFF", "8B80020003"},
           BytesRow{"GO 46", "0C012E00"},
           BytesRow{"CALL 46 (5)", "0D02012E00010500"},
           BytesRow{"FUNCTION 46", "0E01012E00"},
           BytesRow{"GOTO 10", "0F0A00"},
           BytesRow{"GOTO VI[2] (10,9999)", "101102020A000F27"},
           BytesRow{"GOSUB 10", "110A00"},
           BytesRow{"IF VL[1] THEN 10", "121201010A00"},
           BytesRow{"IF VL[1] THEN 10 ELSE 11", "121201020A000B00"},
           BytesRow{"WAIT IL[3]", "131303"},
           BytesRow{"RETURN", "14"},
           BytesRow{"ENDTASK", "15"},
           BytesRow{"PAUSE", "16"},
           BytesRow{"STOP", "17"},
           BytesRow{"ERR 10", "180A00"},
           BytesRow{"NOERR", "19"},
           BytesRow{"SETERR 5", "1A010500"},
           BytesRow{"TASK 1", "1B01"},
           BytesRow{"TIMER (5,10)", "1C010105000A00"},
           BytesRow{"VR[1] = 5", "1D1001010500"},
           BytesRow{"DEFINE PAR[1] = FLOAT", "1F0001"},
           BytesRow{"DEFINE PAR[1] = INT", "1F0101"},
           BytesRow{"DEFINE PAR[1] = LOGIC", "1F0201"},
           BytesRow{"ASSIGN OL[32] = 5 /8", "20081420010500"},
           BytesRow{"UPDATE IL, OL /ON", "A1800103"},
           BytesRow{"IMAGE", "220F"},
           BytesRow{"IMAGE IA", "2204"},
           BytesRow{"REAL OA", "2308"},
           BytesRow{"BREAK 7", "240700"},
           BytesRow{"SIMUL 300, 45", "25AC022D"},
           BytesRow{"ZERO", "26"},
           BytesRow{"CONT 3", "2706434F4E542033"},
       }) {
    EXPECT_EQ(RecordsOf(std::string(row.text) + "\n"), row.bytes) << row.text;
  }
}

// OPT-B.70, OPT-2.43: attributes are one bit each, whatever their order; what they hold comes in
// the order of the bits, and the sequence number of /TIME at the end.
TEST(Object, EachAttributeHasItsBit) {
  const std::string values = "010100010200010300010400010500";
  for (const BytesRow& row : {
           BytesRow{"/FLY", "02"},
           BytesRow{"/NEXT", "20"},
           BytesRow{"/INF", "40"},
       }) {
    EXPECT_EQ(RecordsOf("MOVE (1,2,3,4,5)" + std::string(row.text) + "\n"),
              "81" + std::string(row.bytes) + values);
  }
  EXPECT_EQ(RecordsOf("MOVE (1,2,3,4,5)/VIA (1,2,3,4,5)\n"), "8101" + values + values);
  EXPECT_EQ(RecordsOf("MOVE (1,2,3,4,5)/START (IL[3])\n"), "8104" + values + "1303");
  EXPECT_EQ(RecordsOf("MOVE (1,2,3,4,5)/END (IL[4])\n"), "8108" + values + "1304");
  EXPECT_EQ(RecordsOf("MOVE (1,2,3,4,5)/TIME (7,10)\n"), "8110" + values + "0107000A00");
  EXPECT_EQ(RecordsOf("MOVE (1,2,3,4,5)/TIME (7,10)/END (IL[4])/START (IL[3])/FLY\n"),
            "811E" + values + "13031304" + "0107000A00");
  EXPECT_EQ(RecordsOf("GO 46/C\n"), "8C8004012E00");
  EXPECT_EQ(RecordsOf("GO 46/R\n"), "8C8008012E00");
  EXPECT_EQ(RecordsOf("GO 46/S\n"), "8C8010012E00");
  EXPECT_EQ(RecordsOf("TIMER (5,10)/AUTO\n"), "9C8020010105000A00");
  EXPECT_EQ(RecordsOf("TIMER /DIS\n"), "9C804000");
  EXPECT_EQ(RecordsOf("10\n11 STOP\n"), "57020A000B00");
}

// OPT-B.70: the parts of expressions, the root first and its right side before the left one.
TEST(Object, EachPartOfAnExpressionHasItsCode) {
  for (const BytesRow& row : {
           BytesRow{"VR[0] = 2.5", "10000200002040"},
           BytesRow{"VR[0] = -2", "100001FEFF"},
           BytesRow{"VR[0] = PI", "100005"},
           BytesRow{"VR[0] = VR[1]", "10001001"},
           BytesRow{"VI[7] = VI[1]", "11071101"},
           BytesRow{"VL[0] = VL[1]", "12001201"},
           BytesRow{"VL[0] = IL[1]", "12001301"},
           BytesRow{"OL[32] = OL[1]", "14201401"},
           BytesRow{"VR[0] = IA[1]", "10001501"},
           BytesRow{"OA[1] = OA[99]", "16011663"},
           BytesRow{"VR[0] = PAR[7]", "10001707"},
           BytesRow{"VL[0] = ON", "120004"},
           BytesRow{"VL[0] = OFF", "120003"},
           BytesRow{"VR[0] = -PI", "10002605"},
           BytesRow{"VL[0] = NOT VL[1]", "1200271201"},
           BytesRow{"VR[0] = SIN(PI)", "10002805"},
           BytesRow{"VR[0] = COS(PI)", "10002905"},
           BytesRow{"VR[0] = TAN(PI)", "10002A05"},
           BytesRow{"VR[0] = ASIN(PI)", "10002B05"},
           BytesRow{"VR[0] = ACOS(PI)", "10002C05"},
           BytesRow{"VR[0] = ATAN(PI)", "10002D05"},
           BytesRow{"VR[0] = SQRT(PI)", "10002E05"},
           BytesRow{"VR[0] = EXP(PI)", "10002F05"},
           BytesRow{"VR[0] = LN(PI)", "10003005"},
           BytesRow{"VR[0] = LOG(PI)", "10003105"},
           BytesRow{"VR[0] = ABS(PI)", "10003205"},
           BytesRow{"VR[0] = INT(PI)", "10003305"},
           BytesRow{"VR[0] = PI^2", "10003401020005"},
           BytesRow{"VR[0] = PI*2", "10003501020005"},
           BytesRow{"VR[0] = PI/2", "10003601020005"},
           BytesRow{"VR[0] = PI MOD 2", "10003701020005"},
           BytesRow{"VR[0] = PI+2", "10003801020005"},
           BytesRow{"VR[0] = PI-2", "10003901020005"},
           BytesRow{"VL[0] = PI<2", "12003A01020005"},
           BytesRow{"VL[0] = PI<=2", "12003B01020005"},
           BytesRow{"VL[0] = PI=2", "12003C01020005"},
           BytesRow{"VL[0] = PI>=2", "12003D01020005"},
           BytesRow{"VL[0] = PI>2", "12003E01020005"},
           BytesRow{"VL[0] = PI<>2", "12003F01020005"},
           BytesRow{"VL[0] = VL[1] AND ON", "120040041201"},
           BytesRow{"VL[0] = VL[1] OR ON", "120041041201"},
           BytesRow{"VL[0] = VL[1] XOR ON", "120042041201"},
       }) {
    EXPECT_EQ(RecordsOf(std::string(row.text) + "\n"), "1D" + std::string(row.bytes)) << row.text;
  }
}

// OPT-B.71, OPT-E.7034: ignored lines have numbers of 16 bits, the last of which means none.
TEST(Object, IgnoredLinesHaveNumbers) {
  const Result<Module> one = DecodeObject(MustCompile("CONT X\n").object);
  ASSERT_TRUE(one);
  ASSERT_EQ(one->texts.size(), 1U);
  Module many = *one;
  for (int n = 1; n < 65535; ++n) {
    many.instructions.push_back(one->instructions[0]);
    many.instructions.back().name = static_cast<std::uint16_t>(n);
    many.texts.push_back(one->texts[0]);
  }
  EXPECT_TRUE(DecodeObject(EncodeObject(many)));
  many.instructions.push_back(one->instructions[0]);
  many.texts.push_back(one->texts[0]);
  EXPECT_FALSE(DecodeObject(EncodeObject(many)));
}

// OPT-B.71, OPT-E.7034: with a right checksum, too, nothing is read that the language does not
// have. The last byte of the first `bytes` of the record is changed.
TEST(Object, WhatTheLanguageDoesNotHaveIsRefused) {
  constexpr std::size_t kHead = 7;
  struct Row {
    const char* text;
    std::size_t bytes;
    int good, bad;
  };
  for (const Row& row : {
           Row{"COORD ABSOL", 2, 1, 2},
           Row{"PATH LIN", 2, 2, 4},
           Row{"PATH LIN", 2, 0, 3},
           Row{"WORKDEF 0,3", 2, 0, 3},
           Row{"WORKDEF 0,3", 3, 9, 10},
           Row{"WORK 0,3/ON", 4, 2, 3},
           Row{"WORK 0,3/ON", 5, 9, 10},
           Row{"DEFINE PAR[1] = INT", 2, 2, 3},
           Row{"DEFINE PAR[1] = INT", 3, 7, 8},
           Row{"UPDATE IL /ON", 4, 15, 16},
           Row{"UPDATE IL /ON", 4, 1, 0},
           Row{"IMAGE IL", 2, 15, 16},
           Row{"REAL IL", 2, 8, 0},
           Row{"BREAK 7", 2, 1, 0},
           Row{"BREAK 7", 3, 99, 100},
           Row{"VR[0] = VR[1]", 3, 99, 100},
           Row{"VR[0] = PAR[1]", 5, 7, 8},
           Row{"VR[0] = PI", 4, 5, 7},
           Row{"VR[0] = -PI", 4, 0x2D, 0x27},
           Row{"SPEED 5", 3, 100, 101},
           Row{"GO 46", 3, 99, 100},
           Row{"GO 46", 3, 1, 0},
           Row{"GOTO 10", 3, 0x27, 0x28},
           Row{"STOP", 1, 0x16, 0x3F},
       }) {
    const std::string object = MustCompile(std::string(row.text) + "\n").object;
    const auto with = [&](int byte) {
      std::string changed = object;
      changed[kHead + row.bytes - 1] = static_cast<char>(byte);
      return DecodeObject(WithChecksum(changed));
    };
    EXPECT_TRUE(with(row.good)) << row.text << " " << row.good;
    const Result<Module> refused = with(row.bad);
    ASSERT_FALSE(refused) << row.text << " " << row.bad;
    EXPECT_EQ(refused.error().code, ErrorCode::kObjectCorrupt);
  }
}

// OPT-6.01, OPT-6.04: what was read has its steps, as what was compiled.
TEST(Object, StepsAreCountedWhenItIsRead) {
  const Result<Module> module =
      DecodeObject(MustCompile("DECLARE X = VR[1]\nX = 1.\nSTOP\n").object);
  ASSERT_TRUE(module);
  EXPECT_EQ(module->step_count, 2U);
  EXPECT_EQ(module->instructions[2].step, 2U);
}

// OPT-B.70: names stand once in a table, numbers at the end of the text behind it.
TEST(Object, NamesAndTheLastNumbersStandAhead) {
  const std::string object =
      MustCompile("DECLARE AB = 7\nDECLARE C1 = VR[2]\nVI[AB] = C1\n10\n").object;
  const std::string_view expected(
      "LMR\x01\x03\x02\x02"
      "AB\x02"
      "C1\x01\x0A\x00"
      "\x1E\x00\x01\x07\x00"
      "\x1E\x01\x10\x02"
      "\x1D\x19\x00\x06\x01",
      29);
  EXPECT_EQ(object.substr(0, object.size() - 4), expected);
}

// OPT-1.21: comments are not in the object, names and numbers are.
TEST(Object, HoldsNoComments) {
  EXPECT_EQ(MustCompile("SPEED 5 ; a comment\n; another\n").object,
            MustCompile("SPEED 5\n").object);
}

// OPT-7.53: 40000 is REAL, 5 stays INTEGER.
TEST(Object, KeepsTheFormOfLiterals) {
  EXPECT_EQ(*ObjectToSource(
                MustCompile("VR[0] = 40000\nVR[0] = 5\nVR[0] = -32768\nVR[0] = 32768\n").object),
            "     LET VR[0] = 40000.0\n     LET VR[0] = 5\n     LET VR[0] = -32768\n     LET VR[0] "
            "= 32768.0\n");
}

}  // namespace
}  // namespace rmlcell::optimo
