// What the off-line tools give back: the text itself, and the name that it has from there on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <numbers>
#include <string>
#include <utility>

#include "server/programs/text_tools.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;

constexpr const char* kOneMove = "COORD ABSOL\nPATH LIN\nMOVE (1000.,900.,-500.,0.,0.)\n";

// X and Y of the first move.
std::pair<double, double> FirstTarget(const std::string& text) {
  const std::string begin = "MOVE (";
  const std::size_t at = text.find(begin);
  if (at == std::string::npos) {
    ADD_FAILURE() << "no move in: " << text;
    return {};
  }
  char* end = nullptr;
  const double x = std::strtod(text.c_str() + at + begin.size(), &end);
  return {x, std::strtod(end + 1, nullptr)};
}

// OPT-B.40: words in upper case, one blank between them, the comment as it was.
TEST(TextsOfTools, AFormattedText) {
  v1::FormatProgramRequest request;
  request.mutable_program()->set_file_name("a.S");
  request.mutable_program()->set_content("speed   20 ; slow\n");
  const std::string content = Must(FormatText(request)).content();
  EXPECT_THAT(content, HasSubstr("SPEED 20"));
  EXPECT_THAT(content, HasSubstr("; slow"));
}

// OPT-8.56: its own name with the other ending, or the one that was given.
TEST(TextsOfTools, TheNameOfAConvertedText) {
  const auto name = [](const std::string& input, const std::string& output) {
    v1::ConvertProgramRequest request;
    request.mutable_program()->set_file_name(input);
    request.mutable_program()->set_content("STOP\n");
    request.set_output_name(output);
    return Must(ConvertText(request, "Thu Mar 04 08:52:34 1993")).file_name();
  };
  EXPECT_EQ(name("newbit.SI", ""), "newbit.S");
  EXPECT_EQ(name("part1.S", ""), "part1.SI");
  EXPECT_EQ(name("part1.S", "new"), "new.SI");
}

// OPT-8.11, OPT-8.15: left of the cut by half of its width.
TEST(TextsOfTools, ACompensatedText) {
  v1::CompensateProgramRequest request;
  request.mutable_program()->set_file_name("part.S");
  request.mutable_program()->set_content(
      ";$dia=0.508\n;$left\nPATH LIN\nMOVE (0.,0.,0.,0.,0.)\nWORK 0,0/ON\n"
      "MOVE (10.,0.,0.,0.,0.)\nWORK 0,0/OFF\n");
  EXPECT_THAT(Must(CompensateText(request, "today")).content(),
              HasSubstr("MOVE (10.00000,0.25400,"));
}

// OPT-8.76: moved, and turned about Z by the first of the three.
TEST(TextsOfTools, ATransformedText) {
  v1::TransformProgramRequest request;
  request.mutable_program()->set_file_name("part.S");
  request.mutable_program()->set_content(kOneMove);
  request.mutable_translation()->set_x(1.5);
  request.mutable_translation()->set_y(-2.0);
  const auto moved = FirstTarget(Must(TransformText(request)).content());
  EXPECT_NEAR(moved.first, 1001.5, 1e-6);
  EXPECT_NEAR(moved.second, 898.0, 1e-6);
  request.clear_translation();
  for (const double turn : {std::numbers::pi / 2.0, 0.0, 0.0}) request.add_rotation(turn);
  const auto turned = FirstTarget(Must(TransformText(request)).content());
  EXPECT_NEAR(turned.first, -900.0, 1e-3);
  EXPECT_NEAR(turned.second, 1000.0, 1e-3);
}

// OPT-8.74: what a program gives VR[86] to VR[91] has the offset added.
TEST(TextsOfTools, AShiftedText) {
  v1::ShiftProgramRequest request;
  request.mutable_program()->set_file_name("part.S");
  request.mutable_program()->set_content("VR[86] = 0.\nVR[89] = 1.\n");
  request.mutable_translation()->set_x(30.0);
  for (const double turn : {0.5, 0.0, 0.0}) request.add_rotation(turn);
  EXPECT_EQ(Must(ShiftText(request)).content(), "VR[86] = 30.0\nVR[89] = 1.5\n");
}

}  // namespace
}  // namespace rmlcell::server
