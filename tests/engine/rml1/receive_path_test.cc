#include "engine/rml1/receive_path.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rmlcell::rml1 {
namespace {

// What came through, as text: data bytes, "<11>" for an error, "<K>" for ESC.K.
std::string PassThrough(ReceivePath& path, std::string_view bytes) {
  std::string out;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    if (const auto plain = path.Plain(byte)) {
      ReceivePath copy = path;
      const Received received = copy.Put(byte);
      EXPECT_EQ(received.count, 1);
      EXPECT_EQ(received.bytes[0].byte, *plain);
      EXPECT_FALSE(copy.pending());
    }
    const Received received = path.Put(byte);
    for (const LinkError error : received.errors) {
      if (error == LinkError::kNone) continue;
      out.append("<").append(std::to_string(static_cast<int>(error))).append(">");
    }
    if (received.abort) out += "<K>";
    for (int i = 0; i < received.count; ++i) {
      out += static_cast<char>(received.bytes[static_cast<std::size_t>(i)].byte);
    }
  }
  return out;
}
std::string PassThrough(std::string_view bytes, bool seven_bits = false, bool all = false) {
  ReceivePath path(seven_bits, all);
  return PassThrough(path, bytes);
}

// RML1-4.01 to 4.04: sequences are taken out wherever they occur, all else goes through in order.
TEST(ReceivePath, TakesSequencesOut) {
  EXPECT_EQ(PassThrough("PU10\x1b.K0,1;"), "PU10<K>0,1;");
  EXPECT_EQ(PassThrough("\x1bPU;"), "\x1bPU;");
  EXPECT_EQ(PassThrough("\x1b\x1b.KX"), "\x1b<K>X");
  EXPECT_EQ(PassThrough("\x1b\x1b\x1bX"), "\x1b\x1b\x1bX");
}

// RML1-4.05 to 4.07: an unsupported sequence.
TEST(ReceivePath, RefusesUnsupportedSequences) {
  EXPECT_EQ(PassThrough("\x1b.B;"), "<11>B;");
  EXPECT_EQ(PassThrough("\x1b.k"), "<11>k");
  EXPECT_EQ(PassThrough("\x1b.\x1b.K"), "<11><K>");
  EXPECT_EQ(PassThrough("\x1b..K"), "<11>.K");
}

// RML1-1.12: the top bit goes before anything looks at the byte; 0x9B is then an ESC.
TEST(ReceivePath, ClearsTheTopBitOnASevenBitLink) {
  EXPECT_EQ(PassThrough("\xD0\xD5\x9B\xAE\xCBX", true), "PU<K>X");
  EXPECT_EQ(PassThrough("\xD0", false), "\xD0");
}

// RML1-4.13 to 4.17: parameters of ESC.T.
TEST(ReceivePath, ReadsParameters) {
  ReceivePath path(false, true);
  EXPECT_EQ(PassThrough(path, "\x1b.T1;;65535;0:Z"), "Z");
  EXPECT_EQ(path.esc_t()[0], 1);
  EXPECT_FALSE(path.esc_t()[1].has_value());
  EXPECT_EQ(path.esc_t()[2], 65535);
  EXPECT_EQ(path.esc_t()[3], 0);
  EXPECT_FALSE(path.esc_t()[4].has_value());
  EXPECT_EQ(PassThrough(path, "\x1b.T99999999999999999999;-"), "<13><12>-");
  EXPECT_FALSE(path.esc_t()[0].has_value());  // a new sequence begins with defaults
}

// RML1-4.19: one error for all surplus parameters; with an overflow of the last one, both are told.
TEST(ReceivePath, IgnoresSurplusParameters) {
  EXPECT_EQ(PassThrough("\x1b.T1;2;3;4;5;6;7;8:X", false, true), "<14>X");
  EXPECT_EQ(PassThrough("\x1b.T1;2;3;4;70000;:X", false, true), "<13><14>X");
  EXPECT_EQ(PassThrough("\x1b.T1;2;3;4;5;70000;70000:X", false, true), "<14>X");
  EXPECT_EQ(PassThrough("\x1b.T1;2;3;4;5;70000:X", false, true), "<14>X");
  EXPECT_EQ(PassThrough("\x1b.T1;2;3;4;5:X", false, true), "X");
  EXPECT_EQ(PassThrough("\x1b.M1;2;3;4;5;6;:X", false, true), "<14>X");
}

// RML1-4.18: ESC inside a sequence begins a new one.
TEST(ReceivePath, LetsEscapeEndASequence) {
  EXPECT_EQ(PassThrough("\x1b.T1\x1b.KX", false, true), "<12><K>X");
}

// RML1-4.24: what reaches the data buffer never holds a sequence, so nothing that reads the buffer
// again, as a replot would, could act on one; and no kind of link is known here.
TEST(ReceivePath, LeavesNoSequenceInTheData) {
  const std::string alphabet("\x1b.KMT;:1A", 9);
  for (int number = 0; number < 9 * 9 * 9 * 9 * 9; ++number) {
    std::string bytes;
    for (int rest = number, i = 0; i < 5; ++i, rest /= 9) {
      bytes += alphabet[static_cast<std::size_t>(rest % 9)];
    }
    const std::string data = PassThrough(bytes, false, true);
    ASSERT_EQ(data.find("\x1b.K"), std::string::npos) << number;
  }
}

}  // namespace
}  // namespace rmlcell::rml1
