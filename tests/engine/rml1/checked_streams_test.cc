// What a family tells of its words, of machines that cannot be and of streams that it checks, and
// which memory it can do without.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/machine/language_word.h"
#include "engine/machine/shape.h"
#include "engine/machine/standing.h"
#include "engine/rml1/command_table.h"
#include "engine/rml1/rml1_family.h"
#include "tests/engine/rml1/run_support.h"

// T1: 100 units in a mm, Z0 20 mm below the top.
namespace rmlcell::rml1 {
namespace {

machine::Translation CheckedOnT1(std::string_view stream,
                                 const machine::BytesKeeper* keeper = nullptr) {
  return Rml1Family().Translate({.name = "part.rml", .bytes = stream, .keeper = keeper},
                                ParametersOf("t1"), {});
}

// One word for each command, by name; each is written as its name and what stands behind it, and
// has the rule of its command.
TEST(CheckedStreams, WordsOfTheLanguage) {
  const std::vector<machine::LanguageWord> words = Rml1Family().words();
  ASSERT_EQ(words.size(), CommandTable().size());
  EXPECT_TRUE(std::ranges::is_sorted(words, {}, &machine::LanguageWord::name));
  for (const CommandRow& row : CommandTable()) {
    const auto word = std::ranges::find(words, row.name, &machine::LanguageWord::name);
    ASSERT_NE(word, words.end()) << row.name;
    EXPECT_TRUE(word->form.empty() || word->form.starts_with(row.name)) << row.name;
    EXPECT_FALSE(word->text.empty()) << row.name;
    EXPECT_EQ(word->rule, row.rule) << row.name;
  }
}

// A machine that cannot be has no shape, no variable and no state, and carries nothing out.
TEST(CheckedStreams, AMachineThatCannotBe) {
  const machine::MachineFamily& family = Rml1Family();
  machine::Parameters wrong = ParametersOf("t1");
  ASSERT_TRUE(wrong.Set("X_MAX", -5.0).ok());
  const machine::MachineShape shape = family.Shape(wrong);
  EXPECT_FALSE(shape.has_work_origin);
  EXPECT_FALSE(shape.limits.has_value());
  EXPECT_FALSE(family.HasVariable(wrong, "X"));
  const Status fits = family.CheckParameters(wrong);
  ASSERT_FALSE(fits);
  EXPECT_EQ(fits.error().code, ErrorCode::kCellParameterRange);
  const auto standing = family.NewStanding(wrong, {});
  ASSERT_FALSE(standing);
  EXPECT_EQ(standing.error().code, ErrorCode::kCellParameterRange);
  const machine::Translation made =
      family.Translate({.name = "part.rml", .bytes = "PU;"}, wrong, {});
  EXPECT_FALSE(made.ok);
  ASSERT_EQ(made.diagnostics.size(), 1U);
  EXPECT_EQ(made.diagnostics[0].code, ErrorCode::kCellParameterRange);
  EXPECT_TRUE(made.diagnostics[0].detail.starts_with("X_MIN is 0, not below X_MAX"));
  EXPECT_EQ(made.diagnostics[0].step, 0);
}

TEST(CheckedStreams, AStateThatIsNone) {
  const auto standing = Rml1Family().NewStanding(ParametersOf("t1"), "something else");
  ASSERT_FALSE(standing);
  EXPECT_EQ(standing.error().code, ErrorCode::kCellBadText);
}

// What refuses a stream as a whole is of no command, and its figures are known all the same.
TEST(CheckedStreams, ARefusalIsOfNoCommand) {
  const machine::Translation empty = CheckedOnT1("");
  ASSERT_EQ(empty.diagnostics.size(), 1U);
  EXPECT_EQ(empty.diagnostics[0].step, 0);
  EXPECT_TRUE(empty.figures.empty());
  const machine::Translation noise = CheckedOnT1(std::string(300, '$'));
  ASSERT_FALSE(noise.diagnostics.empty());
  EXPECT_EQ(noise.diagnostics[0].code, ErrorCode::kRml1NoProgram);
  EXPECT_EQ(noise.diagnostics[0].step, 0);
  const Figures figures = ByName(noise.figures);
  EXPECT_EQ(figures.at("foreign_share"), 100.0);
  EXPECT_EQ(figures.at("errors"), 300.0);
}

// RML1-3C.08: a stream that never pauses waits for no key.
TEST(CheckedStreams, WithoutAPauseNothingWaits) {
  const Figures never = ByName(CheckedOnT1("PU;PD;").figures);
  EXPECT_FALSE(never.contains("waits_for_key"));
  EXPECT_TRUE(never.contains("least_time"));
  EXPECT_EQ(ByName(CheckedOnT1("PU;!NR;PD;").figures).at("waits_for_key"), 1.0);
}

// RML1-9.42: the place of a command that is not complete is its first byte.
TEST(CheckedStreams, WhereACommandIsTorn) {
  const machine::Translation made = CheckedOnT1("PU1,1;\nPD5");
  ASSERT_EQ(made.diagnostics.size(), 1U);
  EXPECT_EQ(made.diagnostics[0].code, ErrorCode::kRml1IncompleteCommand);
  EXPECT_EQ(made.diagnostics[0].where,
            (SourceSpan{.line = 2, .column = 1, .length = 1, .byte_offset = 7}));
  EXPECT_EQ(made.diagnostics[0].step, 0);
  EXPECT_EQ(made.diagnostics[0].file, "part.rml");
}

// RML1-9.42, RML1-3A.34: a call is torn where it begins, and a mark ends it.
TEST(CheckedStreams, WhereACallIsTorn) {
  const auto places = [](const std::string& stream) {
    std::vector<std::int64_t> offsets;
    for (const Diagnostic& finding : CheckedOnT1(stream).diagnostics) {
      EXPECT_EQ(finding.code, ErrorCode::kRml1IncompleteCommand) << stream;
      offsets.push_back(finding.where.byte_offset);
    }
    return offsets;
  };
  EXPECT_EQ(places("PU1,1;\n^"), std::vector<std::int64_t>{7});
  EXPECT_EQ(places("PU1,1;\n^P"), std::vector<std::int64_t>{7});
  EXPECT_EQ(places("PU1,1;\n^ !"), std::vector<std::int64_t>{9});
  EXPECT_EQ(places("PU1,1;\n^!P"), std::vector<std::int64_t>{8});
}

// RML1-9.11: a Z0 that the machine is left with is one that was moved, in a check and in a run;
// where it goes up and down nobody is told where to set it.
TEST(CheckedStreams, Z0ThatIsLeftElsewhere) {
  const std::string left = "!MC0;PU1,1;!ZO-2500;";
  EXPECT_NEAR(ByName(CheckedOnT1(left).figures).at("z0_lowered"), 5.0, 1e-9);
  TestRun run(ParametersOf("t1"), left);
  run.AdvanceToEnd();
  EXPECT_NEAR(run.figures().at("z0_lowered"), 5.0, 1e-9);

  const Figures stays = ByName(CheckedOnT1("!MC0;V10;Z0,0,-10;Z100,0,-10;").figures);
  EXPECT_TRUE(stays.contains("origin.zmin") && stays.contains("origin.zmax"));
  const Figures moved =
      ByName(CheckedOnT1("!MC0;V10;!ZO-1500;Z0,0,-10;!ZO-2500;Z100,0,-10;!ZO-2000;").figures);
  EXPECT_NEAR(moved.at("z0_raised"), 5.0, 1e-9);
  EXPECT_NEAR(moved.at("z0_lowered"), 5.0, 1e-9);
  EXPECT_FALSE(moved.contains("origin.zmin") || moved.contains("origin.zmax"));
  EXPECT_TRUE(moved.contains("origin.xmin"));
}

// figures.h: where a run did it first: the program, the command, its line and its byte.
TEST(CheckedStreams, FiguresOfARunHaveTheirPlace) {
  machine::RunSetup setup = SetupOf(ParametersOf("t1"), "!MC0;V10;\nZ100,0,-100;Z200,0,-100;");
  setup.programs[7] = setup.programs[1];
  setup.programs.erase(1);
  setup.main_program = 7;
  TestRun run(std::move(setup));
  run.AdvanceToEnd();
  int found = 0;
  for (const machine::Figure& figure : run->figures()) {
    if (figure.name != "spindle_stands_length") continue;
    ++found;
    EXPECT_GT(figure.value, 1.0);
    EXPECT_EQ(figure.first,
              (machine::Place{.program = 7, .step = 3, .line = 2, .byte_offset = 10}));
  }
  EXPECT_EQ(found, 1);
}

class CountedReleases final : public machine::BytesKeeper {
 public:
  void Release() const override { ++count; }
  mutable int count = 0;
};

// bytes.h: what a check has read of a long stream need not stay in memory, part by part.
TEST(CheckedStreams, ACheckReleasesWhatItHasRead) {
  const CountedReleases keeper;
  const std::string stream(2 * machine::kReleaseEvery + 100, ';');
  EXPECT_TRUE(CheckedOnT1(stream, &keeper).ok);
  EXPECT_EQ(keeper.count, 3);
  EXPECT_TRUE(CheckedOnT1(stream).ok);
}

// A pause behind two such parts.
std::string LongStreamWithAPause() {
  std::string stream = "PA;!MC0;";
  while (stream.size() < 2 * machine::kReleaseEvery)
    stream += "PU1,1;;;;;;;;;;;;;;;;;;;;;;;;;;;\nPU2,2;;;;;;;;;;;;;;;;;;;;;;;;;;;\n";
  return stream + "!NR;PU3,3;";
}

// Nor what a run has read, which says so once, however often it is asked to go on behind that.
TEST(CheckedStreams, ARunReleasesWhatItHasRead) {
  const std::string stream = LongStreamWithAPause();
  const auto keeper = std::make_shared<const CountedReleases>();
  machine::RunSetup setup = SetupOf(ParametersOf("t1"), {});
  setup.programs[1].object = machine::Bytes(keeper, stream);
  machine::RunObserver silent;
  const auto run = Rml1Family().NewRun(std::move(setup), silent).value();
  while (run->Advance(kForever) == machine::RunPhase::kRunning) {
  }
  ASSERT_EQ(run->Advance(kForever), machine::RunPhase::kHalted);
  const int released = keeper->count;
  EXPECT_GE(released, 1);
  EXPECT_LE(released, 2);
  for (int call = 0; call < 5; ++call) run->Advance(kForever);
  EXPECT_EQ(keeper->count, released);
}

// A run that is put back to its beginning reads all of it once more, and says so as often again.
TEST(CheckedStreams, ARunThatIsPutBackReleasesAnew) {
  const std::string stream = LongStreamWithAPause();
  const auto keeper = std::make_shared<const CountedReleases>();
  machine::RunSetup setup = SetupOf(ParametersOf("t1"), {});
  setup.programs[1].object = machine::Bytes(keeper, stream);
  machine::RunObserver silent;
  const auto run = Rml1Family().NewRun(std::move(setup), silent).value();
  const auto beginning = run->Save();
  const auto to_the_pause = [&run] {
    while (run->Advance(kForever) == machine::RunPhase::kRunning) {
    }
    return run->Advance(kForever);
  };
  ASSERT_EQ(to_the_pause(), machine::RunPhase::kHalted);
  const int released = keeper->count;
  EXPECT_GE(released, 1);
  run->Restore(*beginning);
  ASSERT_EQ(to_the_pause(), machine::RunPhase::kHalted);
  EXPECT_EQ(keeper->count, 2 * released);
}

// figures.h: nor what is read once more to tell the lines of places: a way through the work without
// the spindle, in the second line, behind two such parts of the stream.
TEST(CheckedStreams, PlacesFarBehindAreTold) {
  const CountedReleases keeper;
  std::string stream(2 * machine::kReleaseEvery, ';');
  const auto begins = static_cast<std::int64_t>(stream.size() + std::string("\n!MC0;V10;").size());
  stream += "\n!MC0;V10;Z100,0,-100;Z200,0,-100;";
  const machine::Translation made = CheckedOnT1(stream, &keeper);
  ASSERT_TRUE(made.ok);
  EXPECT_EQ(keeper.count, 3 + 2);
  int found = 0;
  for (const machine::Figure& figure : made.figures) {
    if (figure.name != "spindle_stands_length") continue;
    ++found;
    EXPECT_EQ(figure.first, (machine::Place{.step = 3, .line = 2, .byte_offset = begins}));
  }
  EXPECT_EQ(found, 1);
  EXPECT_EQ(ByName(CheckedOnT1(stream).figures), ByName(made.figures));
}

}  // namespace
}  // namespace rmlcell::rml1
