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
