#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/optimo/offline/convert.h"

namespace rmlcell::optimo {
namespace {

// "in out direction" of a good call, or the number of its error.
std::string Read(const std::vector<std::string>& arguments) {
  const auto request = ReadConvertArguments(arguments);
  if (!request) return std::to_string(Lookup(request.error().code).number);
  if (!*request) return "usage";
  return (*request)->input + " " + (*request)->output + " " +
         ((*request)->direction == Direction::kToInch ? "inch" : "metric");
}

// OPT-8.54, OPT-8.56
TEST(ConvertArguments, ExtensionsTellTheDirection) {
  EXPECT_EQ(Read({"part1.s"}), "part1.s part1.si inch");
  EXPECT_EQ(Read({"newbit.si"}), "newbit.si newbit.s metric");
  EXPECT_EQ(Read({"part1.s", "new"}), "part1.s new.si inch");
  EXPECT_EQ(Read({"a.b/part"}), "7704");
}

// OPT-8.55
TEST(ConvertArguments, NoArgumentsAskForTheUsage) { EXPECT_EQ(Read({}), "usage"); }

// OPT-8.57, OPT-8.67
TEST(ConvertArguments, SwitchesAllowOtherExtensions) {
  EXPECT_EQ(Read({"optimo.old", "/i"}), "optimo.old optimo.si inch");
  EXPECT_EQ(Read({"optimo.new", "/m"}), "optimo.new optimo.s metric");
  EXPECT_EQ(Read({"PART1.SI", "/M"}), "PART1.SI PART1.S metric");
  EXPECT_EQ(Read({"/work/part1.s", "/tmp/out"}), "/work/part1.s /tmp/out.si inch");
}

// OPT-8.58, OPT-E.7701
TEST(ConvertArguments, ContradictionsAreRefused) {
  EXPECT_EQ(Read({"part1.s", "/m"}), "7701");
  EXPECT_EQ(Read({"newbit.si", "/i"}), "7701");
  EXPECT_EQ(Read({"a.s", "b.s"}), "7701");
  EXPECT_EQ(Read({"a.old", "/i", "/m"}), "7701");
}

// OPT-8.72: .CMP is metric, so inches do not go there, and it is not to become metric.
TEST(ConvertArguments, CompensatedFilesAreMetric) {
  EXPECT_EQ(Read({"part1.s", "out.CMP"}), "7701");
  EXPECT_EQ(Read({"part1.old", "out.cmp", "/i"}), "7701");
  EXPECT_EQ(Read({"part1.CMP", "/m"}), "7701");
  EXPECT_NE(Read({"part1.CMP", "/i"}), "7701");
  EXPECT_NE(Read({"part1.si", "out.CMP"}), "7701");
}

// OPT-8.59, OPT-8.61, OPT-E.7702, OPT-E.7704
TEST(ConvertArguments, SwitchesAndDirectionsThatAreNone) {
  EXPECT_EQ(Read({"a.s", "/x"}), "7702");
  EXPECT_EQ(Read({"optimo.old"}), "7704");
}

// OPT-8.54, OPT-8.56, OPT-8.57, OPT-8.58, OPT-8.67: names, folders and extensions of both letters.
TEST(ConvertArguments, NamesKeepTheirFolderAndTheirLetters) {
  EXPECT_EQ(Read({"A.S"}), "A.S A.SI inch");
  EXPECT_EQ(Read({"a.Si"}), "a.Si a.s metric");
  EXPECT_EQ(Read({"x.y/a.s"}), "x.y/a.s x.y/a.si inch");
  EXPECT_EQ(Read({"x\\a.S", "b"}), "x\\a.S b.SI inch");
  EXPECT_EQ(Read({"a", "/i"}), "a a.si inch");
  EXPECT_EQ(Read({"x.y/a", "/m"}), "x.y/a x.y/a.s metric");
  EXPECT_EQ(Read({"/m", "a.si", "x.y/b"}), "a.si x.y/b.s metric");
  EXPECT_EQ(Read({"a.si", "b.new"}), "a.si b.new metric");
  EXPECT_EQ(Read({"a.s", "b.new"}), "a.s b.new inch");
  EXPECT_EQ(Read({"a.", "/I"}), "a. a.si inch");
  EXPECT_EQ(Read({"a.si", "b.si"}), "7701");
  EXPECT_EQ(Read({"a.old", "b.si", "/m"}), "7701");
  EXPECT_EQ(Read({"a.s", "/i", "/i"}), "a.s a.si inch");
  EXPECT_EQ(Read({"a.s", "/"}), "7702");
  EXPECT_EQ(Read({"a.s", "/mm"}), "7702");
}

// OPT-8.62, OPT-8.64, OPT-E.7705, OPT-E.7707
TEST(ConvertArguments, TooFewAndTooManyNames) {
  EXPECT_EQ(Read({"/i"}), "7705");
  EXPECT_EQ(Read({"a.s", "b.si", "c"}), "7707");
}

}  // namespace
}  // namespace rmlcell::optimo
