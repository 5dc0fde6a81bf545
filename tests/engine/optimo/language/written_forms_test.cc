// What is written of a program, as text and as bytes, and what of it is read again.
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "engine/optimo/language/byte_stream.h"
#include "engine/optimo/language/formatter.h"
#include "engine/optimo/language/printer.h"
#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo::written_forms {
namespace {

// OPT-1.27: a number alone on its line stays alone, one before its statement stays with it, and
// comments stay where they are.
TEST(WrittenForms, SequenceNumbersAndCommentsStayOnTheirLines) {
  for (const std::string text :
       {"10\n20   SPEED 5\n", "10\n20\n30   SPEED 5\n", "10\n20\n     SPEED 5\n",
        "; a\n10\n; b\n20   SPEED 5\n; c\n30\n; d\n", "10  ; a\n; b\n20  ; c\n     STOP  ; d\n",
        "     STOP\n; a\n10\n; b\n20  ; c\n"}) {
    EXPECT_EQ(Format(text).text, text);
    EXPECT_FALSE(Format(text).changed) << text;
  }
}

// OPT-B.40: blank lines stay before numbers that are alone on their lines, and behind their
// comments.
TEST(WrittenForms, BlankLinesStayBesideLoneNumbers) {
  for (const std::string text : {"     STOP\n\n10\n20   STOP\n\n\n30\n", "10  ; a\n\n     STOP\n",
                                 "10\n\n\n20\n\n     STOP\n", "\n10\n\n; a\n\n20\n"}) {
    EXPECT_EQ(Format(text).text, text);
    EXPECT_FALSE(Format(text).changed) << text;
  }
}

// printer.h: parentheses that the text needs behind a sign and behind NOT, and in TCP.
TEST(WrittenForms, SignsAndNotNeedParentheses) {
  const auto nesting = [](const std::string& target, const std::string& value) {
    const Compilation compiled = MustCompile(target + " = " + value + "\n");
    return PrintedNesting(compiled.module.Value(compiled.module.instructions[0], 1), false);
  };
  EXPECT_EQ(nesting("VR[9]", "-(VR[1]+VR[2])"), 1);
  EXPECT_EQ(nesting("VR[9]", "-(-VR[1])"), 1);
  EXPECT_EQ(nesting("VR[9]", "-VR[1]*VR[2]"), 0);
  EXPECT_EQ(nesting("VR[9]", "-(VR[1]*(VR[2]+VR[3]))"), 2);
  EXPECT_EQ(nesting("VR[9]", "SIN (-(VR[1]+VR[2]))"), 2);
  EXPECT_EQ(nesting("VL[9]", "NOT (VL[1] OR VL[2])"), 1);
  EXPECT_EQ(nesting("VL[9]", "NOT NOT VL[1]"), 0);
  EXPECT_EQ(nesting("VL[9]", "NOT (VR[1] = VR[2])"), 0);
}

// OPT-B.85: a division stands in parentheses in TCP, where it is in none.
TEST(WrittenForms, ADivisionInTcpStandsInParentheses) {
  const auto printed = [](const std::string& value) {
    const std::string text = "TCP (0., 0., " + value + " / 0., 0., 1.)\n";
    const std::string whole = Decompile(MustCompile(text).module);
    const std::string_view head = "     TCP (0.0, 0.0, ", tail = " / 0.0, 0.0, 1.0)\n";
    EXPECT_TRUE(whole.starts_with(head) && whole.ends_with(tail)) << whole;
    return whole.substr(head.size(), whole.size() - head.size() - tail.size());
  };
  for (const std::string value :
       {"(VR[1] / VR[2])", "(VR[1] / VR[2] + 1.0) * 2.0", "SIN(VR[1] / VR[2]) * 2.0",
        "((VR[1] + 1.0) / VR[2])", "(VR[1] / (VR[2] + 1.0))", "VR[1]"})
    EXPECT_EQ(printed(value), value);
}

// OPT-B.70, OPT-B.71: marks of values that nothing has are refused, whatever a reader would make of
// their bits.
TEST(WrittenForms, MarksThatNoValueHasAreRefused) {
  const auto reads = [](unsigned tag) {
    ByteWriter body;
    body.Raw("LMR\x01");
    for (const unsigned byte : {1U, 0U, 0U, 4U, tag, 5U}) body.Byte(byte);  // SPEED VR[5]
    ByteWriter sealed;
    sealed.Raw(body.bytes());
    sealed.Fixed32(Checksum(body.bytes()));
    return static_cast<bool>(DecodeObject(sealed.bytes()));
  };
  EXPECT_TRUE(reads(0x10));   // VR
  EXPECT_TRUE(reads(0x17));   // PAR
  EXPECT_FALSE(reads(0x18));  // one with a name as its index, and there is no name
  EXPECT_FALSE(reads(0));
  for (unsigned tag = 7; tag < 0x10; ++tag) EXPECT_FALSE(reads(tag)) << tag;
}

// OPT-7.45, OPT-B.71: a name begins with a letter in an object as well.
TEST(WrittenForms, NamesOfAnObjectBeginWithALetter) {
  const auto reads = [](std::string_view name) {
    ByteWriter body;
    body.Raw("LMR\x01");
    for (const unsigned byte : {1U, 1U}) body.Byte(byte);
    body.Text(name);
    for (const unsigned byte : {0U, 30U, 0U, 1U, 7U, 0U}) body.Byte(byte);  // DECLARE it = 7
    ByteWriter sealed;
    sealed.Raw(body.bytes());
    sealed.Fixed32(Checksum(body.bytes()));
    return static_cast<bool>(DecodeObject(sealed.bytes()));
  };
  EXPECT_TRUE(reads("A9"));
  EXPECT_TRUE(reads("Z"));
  for (const char* name : {"9A", "0Z", "@A", "[A", "A[", "a9", "A/", "A:", ""})
    EXPECT_FALSE(reads(name)) << name;
}

// OPT-7.49, OPT-B.71: each once, wherever they stand.
TEST(WrittenForms, NamesOfAnObjectAreDifferent) {
  const auto reads = [](const std::vector<std::string>& names) {
    ByteWriter body;
    body.Raw("LMR\x01");
    body.Whole(names.size());
    body.Whole(names.size());
    for (const std::string& name : names) body.Text(name);
    body.Byte(0);
    for (unsigned name = 0; name < names.size(); ++name) {
      for (const unsigned byte : {30U, name, 1U, 7U, 0U}) body.Byte(byte);  // DECLARE it = 7
    }
    ByteWriter sealed;
    sealed.Raw(body.bytes());
    sealed.Fixed32(Checksum(body.bytes()));
    return static_cast<bool>(DecodeObject(sealed.bytes()));
  };
  EXPECT_TRUE(reads({"B", "A", "D"}));
  EXPECT_FALSE(reads({"A", "A"}));
  EXPECT_FALSE(reads({"A", "B", "A"}));
  EXPECT_FALSE(reads({"D", "A", "B", "D"}));
}

// OPT-6.01: the line of each step, from the first to the end of the program.
TEST(WrittenForms, StepsHaveTheirLines) {
  const Compilation compiled =
      Compile("ACCEL 5\nDECLARE X = 5.\n; a\n10\nSPEED X\nSTOP\n", "", {.source = true});
  ASSERT_TRUE(compiled.ok);
  const std::vector<int> lines(compiled.step_lines.begin(), compiled.step_lines.end());
  EXPECT_EQ(lines, (std::vector<int>{1, 5, 6, 7}));
}

// OPT-1.27, OPT-B.69: whatever follows the table of names.
TEST(WrittenForms, ANameOfOneLetterStandsBeforeManyNumbers) {
  std::string text = "DECLARE Z = 7\n";
  for (int label = 1; label <= 127; ++label) {
    text += std::to_string(label) + "\n";
    const std::string object = MustCompile(text).object;
    const Result<Module> module = DecodeObject(object);
    ASSERT_TRUE(module) << label;
    EXPECT_EQ(module->end_labels.size(), static_cast<std::size_t>(label));
    EXPECT_EQ(EncodeObject(*module), object);
  }
}

// OPT-7.57, OPT-B.70: what ON, OFF and PI are as numbers.
TEST(WrittenForms, ConstantsComeBackAsTheirNumbers) {
  const auto value = [](const std::string& text) {
    const Result<Module> module = DecodeObject(MustCompile(text).object);
    return module ? module->Value(module->instructions[0], 1)[0].number : -1.0F;
  };
  EXPECT_EQ(value("VL[1] = ON\n"), 1.0F);
  EXPECT_EQ(value("VL[1] = OFF\n"), 0.0F);
  EXPECT_EQ(value("VR[1] = PI\n"), 3.14159F);
  for (const char* one : {"ON", "TRUE", "YES"}) {
    const Module module = MustCompile("VL[1] = " + std::string(one) + "\n").module;
    EXPECT_EQ(module.Value(module.instructions[0], 1)[0].number, 1.0F) << one;
  }
}

// What stands behind a word without effect is kept to its last letter.
TEST(WrittenForms, ALineWithoutEffectIsKept) {
  for (const std::string text : {"     CONT X\n", "     CONT 3 X\n", "     CONT X Y Z\n"})
    EXPECT_EQ(Decompile(MustCompile(text).module), text);
  EXPECT_EQ(Decompile(MustCompile("cont\t x  y \t\r\n").module), "     CONT X Y\n");
}

}  // namespace
}  // namespace rmlcell::optimo::written_forms
