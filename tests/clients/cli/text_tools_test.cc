// The off-line tools as verbs: which file is read, which one is written, what is said, and with
// which exit code.
#include "clients/cli/text_tools.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clients/cli/verbs.h"
#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing::UnorderedElementsAre;

class TextToolsTest : public testing::Test {
 protected:
  // The object of a source of this name, in the folder.
  std::string Object(const std::string& name, const std::string& source) {
    const std::string file = folder.Put(name, source);
    const std::string object = folder.File(name + ".O");
    EXPECT_EQ(Hear([&] { return Compile({.file = file, .output = object}, false); }).exit_code, 0);
    return object;
  }
  static std::size_t CountOf(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
      ++count;
    return count;
  }
  // A wrong use of the command: nothing is printed, and nothing done.
  static void ExpectUsage(const Told& told, const std::string& what) {
    EXPECT_EQ(told.exit_code, 2);
    EXPECT_EQ(told.output, "");
    EXPECT_THAT(told.errors, AllOf(HasSubstr("CELL-E9026"), HasSubstr(what)));
  }

  CliFolder folder;
};

// OPT-6.01: DECLARE is no step.
TEST_F(TextToolsTest, CompileSaysTheObjectItsSizeAndItsSteps) {
  const std::string file = folder.Put("12.S", "DECLARE X = VR[0]\nSPEED 20\nX = 1.\n");
  const Told told = Hear([&] { return Compile({.file = file}, false); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output, folder.File("12.O") + ": object of " +
                             std::to_string(folder.Read("12.O").size()) + " bytes, 2 steps\n");
  EXPECT_THAT(folder.Names(), UnorderedElementsAre("12.S", "12.O"));
}

TEST_F(TextToolsTest, CompileRefusesWhatIsEmptyOrMissing) {
  const std::string file = folder.Put("12.S", "");
  Told told = Hear([&] { return Compile({.file = file}, false); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.errors, AllOf(HasSubstr("CELL-E9017"), HasSubstr(file)));
  told = Hear([&] { return Compile({.file = folder.File("13.S")}, false); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.errors, HasSubstr("CELL-E9022"));
  EXPECT_THAT(folder.Names(), ElementsAre("12.S"));
}

TEST_F(TextToolsTest, TheObjectAndTheWordAboutItCannotBothGoToStandardOutput) {
  const std::string file = folder.Put("12.S", "SPEED 20\n");
  const ToolOptions both{.file = file, .output = "-", .json = true};
  ExpectUsage(Hear([&] { return Compile(both, false); }), "--json");
  LinkOptions link{.files = {file}, .slots = {}, .output = "-", .json = true};
  ExpectUsage(Hear([&] { return Link(link); }), "--json");
  const ToolOptions bytes{.file = file, .output = "-"};
  ExpectUsage(Hear([&] { return Compile(bytes, true); }), "--map");
  // Alone each of them is good, and standard output has the bytes of the file and no more.
  const Told told = Hear([&] { return Compile(bytes, false); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_THAT(folder.Names(), ElementsAre("12.S"));
  EXPECT_EQ(told.output, [&] {
    Object("12.S", "SPEED 20\n");
    return folder.Read("12.S.O");
  }());
}

// OPT-8.70
TEST_F(TextToolsTest, AMapGivesTheOwnTextBack) {
  const std::string own = "speed   20 ; slow\n";
  const std::string file = folder.Put("12.S", own);
  ASSERT_EQ(
      Hear([&] { return Compile({.file = file, .output = folder.File("a.O")}, true); }).exit_code,
      0);
  EXPECT_THAT(folder.Names(), UnorderedElementsAre("12.S", "a.O", "a.MAP"));
  Told told = Hear([&] { return Decompile({.file = folder.File("a.O")}); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output, own);
  // Under another name no map stands beside it.
  folder.Put("b.O", folder.Read("a.O"));
  told = Hear([&] { return Decompile({.file = folder.File("b.O")}); });
  EXPECT_THAT(told.output, AllOf(HasSubstr("SPEED 20"), Not(HasSubstr("slow"))));
  told =
      Hear([&] { return Decompile({.file = folder.File("a.O"), .output = folder.File("c.S")}); });
  EXPECT_EQ(told.output, folder.File("c.S") + ": source of " + folder.File("a.O") + "\n");
  EXPECT_EQ(folder.Read("c.S"), own);
}

TEST_F(TextToolsTest, AMapThatCannotBeWrittenLeavesNoObject) {
  const std::string file = folder.Put("12.S", "SPEED 20\n");
  folder.Put("12.MAP/here", "a folder is in the way");
  const Told told = Hear([&] { return Compile({.file = file}, true); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.errors, AllOf(HasSubstr("CELL-E9023"), HasSubstr("12.MAP")));
  EXPECT_THAT(folder.Names(), UnorderedElementsAre("12.S", "12.MAP"));
}

// OPT-2.04: the control knows no inches; a list of the text may be had.
TEST_F(TextToolsTest, AnInchSourceIsListedAndNotCompiled) {
  const std::string file = folder.Put("a.SI", "COORD ABSOL\nMOVE (10.,20.,-3.,0.,0.)\n");
  const Told told = Hear([&] { return Compile({.file = file}, false); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(told.errors, HasSubstr("OPT-E7030"));
  EXPECT_THAT(folder.Names(), ElementsAre("a.SI"));
  const Told list = Hear([&] { return List({.file = file}); });
  EXPECT_EQ(list.exit_code, 0);
  EXPECT_THAT(list.output, HasSubstr("MOVE (10"));
}

// OPT-8.72, OPT-8.73
TEST_F(TextToolsTest, AnObjectIsReadAsItsSource) {
  const std::string object = Object("12.S", "COORD ABSOL\nPATH LIN\nMOVE (1.,2.,3.,0.,0.)\n");
  const Told compiled =
      Hear([&] { return Compile({.file = object, .output = folder.File("again.O")}, false); });
  EXPECT_EQ(compiled.exit_code, 0);
  EXPECT_EQ(folder.Read("again.O"), folder.Read("12.S.O"));
  const Told list = Hear([&] { return List({.file = object}); });
  EXPECT_EQ(list.exit_code, 0);
  EXPECT_THAT(list.output, AllOf(HasSubstr("COORD ABSOL"), HasSubstr("PATH LIN")));
  const Told moved = Hear([&] {
    return Transform({{.file = object}, {10.0, 20.0, 30.0}, {}, {}});
  });
  EXPECT_EQ(moved.exit_code, 0);
  EXPECT_THAT(moved.output, HasSubstr("MOVE (11.0"));
}

TEST_F(TextToolsTest, WhatIsNoObjectIsRefused) {
  const std::string torn = folder.Put("12.O", "not the bytes of an object");
  for (const auto& tool : {+[](const ToolOptions& o) { return Compile(o, false); },
                           +[](const ToolOptions& o) { return Decompile(o); },
                           +[](const ToolOptions& o) { return List(o); },
                           +[](const ToolOptions& o) { return Compensate(o); }}) {
    const Told told = Hear([&] { return tool({.file = torn}); });
    EXPECT_EQ(told.exit_code, 2);
    EXPECT_EQ(told.output, "");
    EXPECT_THAT(told.errors, HasSubstr("OPT-E70"));
  }
  EXPECT_THAT(folder.Names(), ElementsAre("12.O"));
}

// OPT-9.02
TEST_F(TextToolsTest, LinkNamesTheFunctionsAndTheSlot) {
  const std::string main = folder.Put("12.S", "FUNCTION 44\nFUNCTION 45\n");
  folder.Put("44.S", "VR[0] = 1.\nENDTASK\n");
  const std::string object = Object("other.S", "VR[0] = 2.\nENDTASK\n");
  LinkOptions options{.files = {main, folder.File("44.S")}, .slots = {"45=" + object}};
  options.main_slot = 12;
  Told told = Hear([&] { return Link(options); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.errors, "");
  EXPECT_EQ(told.output, folder.File("12.X") +
                             ": executable of program 12 with FUNCTION 44, 45; store it in slot "
                             "112\n");
  // A program that calls nobody.
  folder.Put("13.S", "SPEED 20\n");
  told = Hear([&] { return Link({.files = {folder.File("13.S")}, .slots = {}}); });
  EXPECT_EQ(told.output,
            folder.File("13.X") + ": executable of program 13; store it in slot 113\n");
}

TEST_F(TextToolsTest, LinkSaysEachErrorOnce) {
  const std::string main = folder.Put("12.S", "FUNCTION 44\n");
  const std::string part = folder.Put("44.S", "SPEED 101\n");
  LinkOptions options{.files = {main, part}, .slots = {}, .main_slot = 12};
  Told told = Hear([&] { return Link(options); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.output, "");
  EXPECT_EQ(CountOf(told.errors, "error "), 1U) << told.errors;
  EXPECT_THAT(told.errors, HasSubstr("44.S:1:7: error OPT-E7004"));  // MAT: 1 to 100 percent
  folder.Put("44.S", "");
  options.files = {main, folder.path()};
  told = Hear([&] { return Link(options); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(CountOf(told.errors, "CELL-E9017"), 1U) << told.errors;
  EXPECT_THAT(told.errors, HasSubstr("program 44 is called, and its file is empty"));
  options.files = {main};
  told = Hear([&] { return Link(options); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.errors, HasSubstr("OPT-E7103"));
  EXPECT_THAT(folder.Names(), UnorderedElementsAre("12.S", "44.S"));
}

// OPT-B.40: five places for the sequence number.
TEST_F(TextToolsTest, FormatSaysWhatItChangedAndNothingElse) {
  const std::string crooked = folder.Put("a.S", "speed   20\n");
  const std::string straight = folder.Put("b.S", "     SPEED 20\n");
  Told told = Hear([&] { return Format({.files = {crooked, straight}, .check_only = true}); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.output, crooked + "\n");  // names alone, for scripts
  EXPECT_EQ(folder.Read("a.S"), "speed   20\n");
  told = Hear([&] { return Format({.files = {crooked, straight}}); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output, crooked + ": formatted\n");
  EXPECT_EQ(folder.Read("a.S"), "     SPEED 20\n");
  told = Hear([&] { return Format({.files = {crooked, straight}, .check_only = true}); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output, "");
}

TEST_F(TextToolsTest, FormatRefusesObjectsAndGoesOnWithTheOthers) {
  const std::string object = Object("12.S", "SPEED 20\n");
  const std::string before = folder.Read("12.S.O");
  const std::string crooked = folder.Put("a.S", "speed   20\n");
  Told told = Hear([&] { return Format({.files = {object}}); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.errors, AllOf(HasSubstr("CELL-E9024"), HasSubstr("decompile")));
  told = Hear([&] { return Format({.files = {folder.File("none.S"), object, crooked}}); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.errors, AllOf(HasSubstr("CELL-E9022"), HasSubstr("CELL-E9024")));
  EXPECT_EQ(told.output, crooked + ": formatted\n");
  EXPECT_EQ(folder.Read("12.S.O"), before);
  EXPECT_EQ(folder.Read("a.S"), "     SPEED 20\n");
}

TEST_F(TextToolsTest, FormatLeavesWhatItCannotRead) {
  const std::string bad = folder.Put("a.S", "SPEED @@@ 20\n");
  const Told told = Hear([&] { return Format({.files = {bad}}); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(told.errors, HasSubstr("a.S:1:"));
  EXPECT_EQ(folder.Read("a.S"), "SPEED @@@ 20\n");
}

// OPT-8.54, OPT-8.56: 1 in is 25.4 mm.
TEST_F(TextToolsTest, ConvertGoesBothWaysAndSaysWhich) {
  const std::string inches = folder.Put("part.SI", "MOVE (1.,2.,-3.,0.,0.)\n");
  Told told = Hear([&] { return Convert({.arguments = {inches}}); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output, folder.File("part.S") + ": millimetres and radians\n");
  EXPECT_THAT(folder.Read("part.S"), AllOf(HasSubstr("25.4"), HasSubstr("File part.S Created")));
  told = Hear([&] {
    return Convert({.arguments = {folder.File("part.S")}, .output = folder.File("back.SI")});
  });
  EXPECT_EQ(told.output, folder.File("back.SI") + ": inches and degrees\n");
  told = Hear([&] { return Convert({.arguments = {inches}, .output = "-"}); });
  EXPECT_EQ(told.exit_code, 0);
  // To no file: the header names the one that was read.
  EXPECT_THAT(told.output, AllOf(HasSubstr("25.4"), HasSubstr("part.SI"), Not(HasSubstr("\n-: "))));
  told = Hear([&] { return Convert({.arguments = {inches}, .output = "-", .json = true}); });
  EXPECT_THAT(json::parse(told.output)["content"].get<std::string>(), HasSubstr("25.4"));
  EXPECT_THAT(folder.Names(), UnorderedElementsAre("part.SI", "part.S", "back.SI"));
}

// OPT-8.60, OPT-8.63, OPT-8.64
TEST_F(TextToolsTest, ConvertSaysWhatIsWrongWithTheCall) {
  Told told = Hear([&] { return Convert({}); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_EQ(told.errors, "");
  EXPECT_THAT(told.output, AllOf(StartsWith("convert FILE.S "), HasSubstr("/m to millimetres")));
  told = Hear([&] { return Convert({.arguments = {folder.File("none.S")}}); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.errors, HasSubstr("OPT-E7703"));
  const std::string file = folder.Put("part.S", "SPEED 20\n");
  told =
      Hear([&] { return Convert({.arguments = {file}, .output = folder.File("none/part.SI")}); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.errors, HasSubstr("OPT-E7706"));
  const std::string object = Object("12.S", "SPEED 20\n");
  told = Hear([&] { return Convert({.arguments = {object, folder.File("b.SI"), "/i"}}); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.errors, AllOf(HasSubstr("CELL-E9024"), HasSubstr("decompile")));
  EXPECT_THAT(folder.Names(), UnorderedElementsAre("part.S", "12.S", "12.S.O"));
}

// OPT-8.11: the cut goes beside the path, by the radius of the beam.
TEST_F(TextToolsTest, CompensateWritesBesideTheSource) {
  const std::string body =
      "COORD ABSOL\nPATH LIN\nMOVE (0.,0.,0.,0.,0.)\nWORK 0,0/ON\nMOVE (10.,0.,0.,0.,0.)\nWORK "
      "0,0/OFF\n";
  const std::string file = folder.Put("part.S", ";$dia=1\n;$left\n" + body);
  Told told = Hear([&] { return Compensate({.file = file}); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output, folder.File("part.CMP") + ": compensated\n");
  EXPECT_THAT(folder.Read("part.CMP"), AllOf(HasSubstr("part.CMP"), HasSubstr("0.5")));
  told = Hear([&] { return Compensate({.file = file, .output = folder.File("other.S")}); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_THAT(folder.Read("other.S"), HasSubstr("other.S"));
  // A source with errors: nothing is written.
  const std::string bad = folder.Put("bad.S", ";$dia=1\n;$left\nSPEED @@@\n" + body);
  told = Hear([&] { return Compensate({.file = bad}); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.errors, HasSubstr("bad.S:3:7: error OPT-E7001"));
  EXPECT_THAT(folder.Names(), UnorderedElementsAre("part.S", "part.CMP", "other.S", "bad.S"));
}

// OPT-8.74, OPT-8.76
TEST_F(TextToolsTest, TransformTakesOneWayOfMoving) {
  const std::string file = folder.Put("part.S", "VR[86] = 1.\nMOVE (1.,2.,3.,0.,0.)\n");
  const auto transform = [&](std::vector<double> move, std::vector<double> turn,
                             std::vector<double> shift) {
    TransformOptions options{{.file = file}, std::move(move), std::move(turn), std::move(shift)};
    return Hear([&] { return Transform(options); });
  };
  ExpectUsage(transform({}, {}, {}), "nothing to do");
  ExpectUsage(transform({1, 0, 0}, {}, {1, 0, 0, 0, 0, 0}), "one or the other");
  ExpectUsage(transform({}, {1, 0, 0}, {1, 0, 0, 0, 0, 0}), "one or the other");
  EXPECT_THAT(transform({1, 0, 0}, {}, {}).output, HasSubstr("MOVE (2.0"));
  EXPECT_THAT(transform({}, {}, {2, 0, 0, 0, 0, 0}).output, HasSubstr("VR[86] = 3.0"));
}

// OPT-8.74: X, Y, Z, rz, ry, rx are added to VR[86] to VR[91], in this order.
TEST_F(TextToolsTest, ShiftAddsEachNumberToItsVariable) {
  const std::string file = folder.Put(
      "part.S", "VR[86] = 0.\nVR[87] = 0.\nVR[88] = 0.\nVR[89] = 0.\nVR[90] = 0.\nVR[91] = 0.\n");
  TransformOptions options{{.file = file}, {}, {}, {1.5, 2.5, 3.5, 0.25, 0.5, 0.75}};
  const Told told = Hear([&] { return Transform(options); });
  EXPECT_EQ(told.exit_code, 0);
  for (const char* row : {"VR[86] = 1.5", "VR[87] = 2.5", "VR[88] = 3.5", "VR[89] = 0.25",
                          "VR[90] = 0.5", "VR[91] = 0.75"})
    EXPECT_THAT(told.output, HasSubstr(row));
}

TEST_F(TextToolsTest, InchSourcesAreNotTransformed) {
  const std::string file = folder.Put("part.SI", "MOVE (1.,2.,3.,0.,0.)\n");
  const Told told = Hear([&] { return Transform({{.file = file}, {1, 0, 0}, {}, {}}); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(told.errors, HasSubstr("part.SI"));
}

TEST_F(TextToolsTest, WhatIsRewrittenSaysOfWhat) {
  const std::string file = folder.Put("part.S", "MOVE (1.,2.,3.,0.,0.)\n");
  const std::string output = folder.File("out.S");
  Told told = Hear([&] {
    return Transform({{.file = file, .output = output}, {1, 0, 0}, {}, {}});
  });
  EXPECT_EQ(told.output, output + ": rewritten from " + file + "\n");
  told = Hear([&] { return List({.file = file, .output = output}); });
  EXPECT_EQ(told.output, output + ": list of " + file + "\n");
  folder.Put("part.S", "SPEED 101\n");
  told = Hear([&] { return List({.file = file}); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.errors, HasSubstr("OPT-E7004"));
  folder.Put("part.S", "SPEED @@@\n");
  told = Hear([&] { return Transform({{.file = file}, {1, 0, 0}, {}, {}}); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(told.errors, HasSubstr("part.S:1:7: error OPT-E7001"));
}

// Tools that give no object tell errors, no advice.
TEST_F(TextToolsTest, AListHasNoAdvice) {
  const std::string file = folder.Put("part.S", "VR[50] = 1.\n");  // OPT-7.104: kept for Amada
  EXPECT_EQ(Hear([&] { return List({.file = file}); }).errors, "");
  EXPECT_THAT(Hear([&] { return Compile({.file = file}, false); }).errors,
              HasSubstr("warning OPT-E7"));
}

// The exit code of a line of the command; nothing: it cannot be read.
std::optional<int> ExitOfLine(std::vector<std::string> words) {
  int exit_code = 0;
  CLI::App app;
  AddTextToolVerbs(app, exit_code);
  std::ranges::reverse(words);
  std::optional<int> code;
  Hear([&] {
    try {
      app.parse(words);
      code = exit_code;
    } catch (const CLI::ParseError&) {
    }
    return 0;
  });
  return code;
}

// OPT-8.74, OPT-8.76: as many numbers as there are axes, no more.
TEST_F(TextToolsTest, PlacesHaveAllTheirNumbersAndNoMore) {
  const std::string file = folder.Put("part.S", "VR[86] = 1.\nMOVE (1.,2.,3.,0.,0.)\n");
  for (const auto& [option, wanted] :
       {std::pair{"--move", 3}, std::pair{"--turn", 3}, std::pair{"--shift", 6}}) {
    std::string numbers = "0";
    for (int count = 1; count <= 7; ++count) {
      const std::optional<int> code = ExitOfLine({"transform", file, option, numbers});
      EXPECT_EQ(code.has_value(), count == wanted) << option << " " << numbers;
      numbers += ",0";
    }
  }
}

// OPT-1.10: programs have the numbers 1 to 99. What --slot names is one word, the program follows.
TEST_F(TextToolsTest, LinkTakesTheSlotsThatThereAre) {
  const std::string part = folder.Put("part.S", "FUNCTION 44\n");
  const std::string function = "44=" + folder.Put("f.S", "VR[0] = 1.\n");
  for (const char* slot : {"1", "99"})
    EXPECT_EQ(ExitOfLine({"link", "--slot", function, part, "--main", slot}), 0) << slot;
  for (const char* slot : {"0", "100", "x"})
    EXPECT_EQ(ExitOfLine({"link", "--slot", function, part, "--main", slot}), std::nullopt) << slot;
}

// Of errors that are too many to be told one by one, the places are of the file, too.
TEST_F(TextToolsTest, ErrorsOnlyCountedAreOfTheFileThatIsRewritten) {
  std::string text;
  for (int line = 0; line < 1100; ++line) text += "SPEED @@@\n";
  const std::string file = folder.Put("part.S", text);
  const TransformOptions options{{.file = file, .output = {}, .json = true}, {1, 0, 0}, {}, {}};
  const Told told = Hear([&] { return Transform(options); });
  EXPECT_EQ(told.exit_code, 1);
  const json found = json::parse(told.output, nullptr, false)["findings"];
  ASSERT_TRUE(found.contains("gathered")) << told.output.substr(0, 1000);
  ASSERT_GE(found["gathered"].size(), 1U);
  for (const json& kind : found["gathered"]) {
    EXPECT_EQ(kind["first"].value("file", ""), file);
    EXPECT_EQ(kind["last"].value("file", ""), file);
  }
}

// OPT-8.53: what cannot be converted is copied, and it is said of which line.
TEST_F(TextToolsTest, ALineThatIsCopiedIsTold) {
  const std::string file = folder.Put("part.S", "SPEED 20\nSPEED @@@\n");
  const Told told = Hear([&] { return Convert({.arguments = {file}}); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_THAT(told.errors, HasSubstr("part.S:2:7: warning OPT-E7711: the line is copied: "));
  EXPECT_EQ(told.output, folder.File("part.SI") + ": inches and degrees\n");
  EXPECT_THAT(folder.Read("part.SI"), HasSubstr("SPEED @@@\n"));
}

}  // namespace
}  // namespace rmlcell::cli
