#include "engine/rml1/rml1_family.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "engine/machine/shape.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

// Whatever it is.
machine::Translation TranslateText(std::string_view bytes, bool advice = true) {
  return Rml1Family().Translate({.name = "part.rml", .bytes = bytes}, ParametersOf("t1"),
                                {.advice = advice, .forced = true});
}

TEST(Rml1Family, TellsWhatItIs) {
  const machine::MachineFamily& family = Rml1Family();
  EXPECT_EQ(family.info().id, "rml1");
  EXPECT_FALSE(family.info().has_executables);
  EXPECT_TRUE(family.info().hold_in_remote);
  EXPECT_TRUE(family.info().turns_in_degrees);
  EXPECT_TRUE(family.info().cover_stops_jog);
  EXPECT_TRUE(family.info().start_takes_back);
  EXPECT_TRUE(family.info().has_breakpoints);
  EXPECT_EQ(family.info().torn, ErrorCode::kRml1IncompleteCommand);
  EXPECT_EQ(family.info().waiting.size(), 1U);
  EXPECT_EQ(family.info().schedules, 0);
  EXPECT_FALSE(family.parameters().empty());
  EXPECT_FALSE(family.profiles().empty());
}

// Every figure that a run gives stands in the table of the family, with its unit; and every figure
// of the table can be given.
TEST(Rml1Family, ListsItsFigures) {
  std::map<std::string, std::string> listed;
  for (const machine::FigureInfo& info : Rml1Family().figures()) {
    EXPECT_FALSE(info.text.empty()) << info.name;
    EXPECT_TRUE(listed.emplace(info.name, info.unit).second) << info.name;
  }
  machine::Parameters parameters = ParametersOf("t1a");
  ASSERT_TRUE(parameters.Set("SEQUENCES", "ALL").ok());
  ASSERT_TRUE(parameters.Set("SKIP", "VPANEL").ok());
  ASSERT_TRUE(parameters.Set("BUFFER", 256.0).ok());
  std::set<std::string> given;
  const auto collect = [&](const std::vector<machine::Figure>& figures) {
    for (const machine::Figure& figure : figures) {
      ASSERT_TRUE(listed.contains(figure.name)) << figure.name;
      EXPECT_EQ(listed[figure.name], figure.unit) << figure.name;
      given.insert(figure.name);
    }
  };
  TestRun run(
      parameters,
      "D1,1;F;H;I;M;R;V;W;Z1,1,1;@;^PA;DF;IN;PA;PD;PR;PU;VS;!DW;!MC;!NR;!PZ;!RC;!VZ;!ZM;!ZO;"
      "!ZZ;!ZE A5;J;!CO;!SL;!SP;!RD;X;5;W-1;"
      "\x1b.k;\x1b.T-\x1b.T70000:\x1b.T1;2;3;4;5;:");
  run.AdvanceToEnd();
  run.Press(machine::InputKind::kStart);
  run.AdvanceToEnd();
  collect(run->figures());
  ASSERT_TRUE(parameters.Set("SKIP", "PNC3000").ok());
  TestRun older(parameters, "!1;!0;");
  older.AdvanceToEnd();
  collect(older->figures());
  // Feed rates and a spindle speed that T1A does not have, and a lift of 0.4 mm; work of 200 mm on
  // an MDX-15, which would be 80 mm long on a machine with 100 units in a millimetre.
  TestRun limited(ParametersOf("t1a"), "!RC20000;VS90;!PZ-100,40;PU100,100;PD200,100;");
  limited.AdvanceToEnd();
  collect(limited->figures());
  TestRun large(ParametersOf("mdx-15"), "VS10;!PZ-100,200;PD8000,100;");
  large.AdvanceToEnd();
  collect(large->figures());
  // From 2 to 201 mm and from -200.5 to -1 mm in travels of 200 mm; the same in Y, of 150 mm.
  for (const std::string corners : {"PU200,200;PD20100,15100;", "PU-100,-100;PD-20050,-15050;"}) {
    TestRun beyond(ParametersOf("t1a"), "VS10;!PZ-100,200;" + corners);
    beyond.AdvanceToEnd();
    collect(beyond->figures());
  }
  std::set<std::string> never;
  for (const auto& [name, unit] : listed) {
    if (!given.contains(name)) never.insert(name);
  }
  // A stored program meets no line error, and its sender heeds flow control.
  EXPECT_EQ(never, (std::set<std::string>{"communication_errors.15", "communication_errors.16"}));
}

// RML1-1.08, RML1-9.10: what reports and pictures need, in mm.
TEST(Rml1Family, TellsTheShapeOfAMachine) {
  machine::Parameters parameters = ParametersOf("mdx-40a-rotary");
  const machine::MachineShape shape = Rml1Family().Shape(parameters);
  EXPECT_EQ(shape.travel.min, (motion::MachineVector{34, 0, -68}));
  EXPECT_EQ(shape.travel.max, (motion::MachineVector{305, 305, 0}));
  EXPECT_TRUE(shape.has_work_origin);
  EXPECT_EQ(shape.work_origin, (motion::MachineVector{34, 0, -20}));
  EXPECT_FALSE(shape.five_axis);
  EXPECT_EQ(shape.laser_watts, 0.0);
  ASSERT_TRUE(shape.limits.has_value());
  EXPECT_EQ(shape.limits->axes.speed[2], 30.0);
  EXPECT_EQ(shape.limits->tip_speed_mm_s, 50.0);
}

// The object is the raw stream, whatever is in it.
TEST(Rml1Family, TranslatesAnyBytesToThemselves) {
  std::string bytes;
  for (int byte = 0; byte < 256; ++byte) bytes += static_cast<char>(byte);
  const machine::Translation translation = TranslateText(bytes);
  EXPECT_TRUE(translation.ok);
  EXPECT_EQ(machine::ObjectOf(translation, bytes), bytes);
}

// What is no RML-1 is refused, unless it is forced: more than a tenth of it belongs to no command.
TEST(Rml1Family, RefusesWhatIsNoRml1) {
  const auto translate = [](const std::string& bytes) {
    return Rml1Family().Translate({.name = "part.rml", .bytes = bytes}, ParametersOf("t1"), {});
  };
  const std::string good = "PU100,100;";  // 10 bytes
  std::string stream;
  for (int k = 0; k < 90; ++k) stream += good;
  EXPECT_TRUE(translate(stream + std::string(100, '$')).ok);  // 100 of 1000
  const machine::Translation refused = translate(stream + std::string(101, '$'));
  EXPECT_FALSE(refused.ok);
  EXPECT_EQ(refused.object, "");
  ASSERT_FALSE(refused.diagnostics.empty());
  EXPECT_EQ(refused.diagnostics[0].code, ErrorCode::kRml1NoProgram);
  EXPECT_EQ(refused.diagnostics[0].detail, "10.1 % of the bytes belong to no command");
  EXPECT_TRUE(TranslateText(stream + std::string(101, '$')).ok);  // forced
  // Few bytes are looked at as 256, as long as no more than a word of 7 letters or a quarter of
  // them is foreign: 25 of 256 are less than a tenth, 26 more.
  const auto foreign_of = [&](std::size_t foreign, std::size_t all) {
    return translate(stream.substr(0, all - foreign) + std::string(foreign, '$')).ok;
  };
  EXPECT_TRUE(foreign_of(7, 7));
  EXPECT_FALSE(foreign_of(8, 8));
  EXPECT_TRUE(foreign_of(10, 40));   // a quarter
  EXPECT_FALSE(foreign_of(20, 70));  // more
  EXPECT_TRUE(foreign_of(25, 105));
  EXPECT_FALSE(foreign_of(26, 106));
  const machine::Translation noise = translate(std::string(22, '$'));
  EXPECT_EQ(noise.diagnostics.at(0).detail, "100.0 % of the bytes belong to no command");
}

TEST(Rml1Family, RefusesAnEmptyStream) {
  const machine::Translation translation = TranslateText("");
  EXPECT_FALSE(translation.ok);
  ASSERT_EQ(translation.diagnostics.size(), 1U);
  EXPECT_EQ(translation.diagnostics[0].code, ErrorCode::kCellEmptyProgram);
}

// RML1-6.07: each finding has code, place and rule; RML1-2.05, RML1-2.19, RML1-3C.01.
TEST(Rml1Family, TellsFindingsWithTheirPlace) {
  const machine::Translation translation = TranslateText("PU1,1;\n  $ !XY;\nW-1;\n\x9f");
  ASSERT_EQ(translation.diagnostics.size(), 4U);
  const auto& found = translation.diagnostics;
  EXPECT_EQ(FormatDiagnostic(found[0], "").substr(0, 78),
            "part.rml:2:3: device error RML1-E1: '$' begins no command [RML1-2.05]; correct");
  EXPECT_EQ(found[0].where, (SourceSpan{.line = 2, .column = 3, .length = 1, .byte_offset = 9}));
  EXPECT_EQ(found[1].where, (SourceSpan{.line = 2, .column = 5, .length = 3, .byte_offset = 11}));
  EXPECT_EQ(found[2].code, ErrorCode::kRml1ParameterRange);
  EXPECT_EQ(found[2].detail, "W -1");
  EXPECT_EQ(found[2].where.line, 3);
  EXPECT_EQ(found[2].step, 2);
  EXPECT_EQ(found[3].detail, "0x9F begins no command");
}

// At most kDiagnosticsMax are listed; of the rest each kind is counted, to its last place.
TEST(Rml1Family, BoundsItsDiagnostics) {
  const machine::Translation translation = TranslateText(std::string(10'000, '5'));
  EXPECT_EQ(translation.diagnostics.size(), machine::kDiagnosticsMax);
  EXPECT_EQ(translation.diagnostics_dropped.count(), 9'000U);
  EXPECT_TRUE(TranslateText(std::string(1000, '5')).diagnostics_dropped.empty());
}

// Every kind by itself, however many there are: of 1500 clipped motions, one a line behind the
// first, and of 120,000 bytes that are no command, which are more than the log of the device holds
// (RML1-6.10), 1000 findings in all are kept.
TEST(Rml1Family, CountsEachKindToItsLastPlace) {
  std::string stream = "PA;!MC1;\n";
  for (int k = 0; k < 1500; ++k) stream += k % 2 == 0 ? "PD0,-100;\n" : "PD10,-100;\n";
  stream += std::string(120'000, '$');
  stream += "\nPU0,0;$\n";
  const machine::Translation translation =
      Rml1Family().Translate({.name = "part.rml", .bytes = stream},
                             machine::Parameters(Rml1Family().parameters()), {.forced = true});
  ASSERT_EQ(translation.diagnostics.size(), machine::kDiagnosticsMax);
  const auto kept = [&](ErrorCode code) {
    return static_cast<std::uint64_t>(
        std::ranges::count(translation.diagnostics, code, &Diagnostic::code));
  };
  const auto& kinds = translation.diagnostics_dropped.kinds();
  const GatheredFindings& clipped = kinds.at(ErrorCode::kRml1Clipped);
  EXPECT_EQ(clipped.count + kept(ErrorCode::kRml1Clipped), 1500U);
  EXPECT_EQ(clipped.last.where.line, 1501);
  EXPECT_EQ(clipped.last.file, "part.rml");
  const GatheredFindings& foreign = kinds.at(ErrorCode::kRml1UnknownCommand);
  EXPECT_EQ(foreign.count + kept(ErrorCode::kRml1UnknownCommand), 120'001U);
  EXPECT_EQ(foreign.first.where.line, 1502);
  EXPECT_EQ(foreign.last.where.line, 1503);
  EXPECT_EQ(foreign.last.where.column, 7);
  EXPECT_EQ(foreign.last.file, "part.rml");
  EXPECT_EQ(kinds.at(ErrorCode::kRml1LogCut).count, 1U);
}

// What is no stream is shown by one finding of each kind behind the refusal; the others are
// counted.
TEST(Rml1Family, OfForeignTextEachKindIsToldOnce) {
  const machine::Translation translation =
      Rml1Family().Translate({.name = "part.rml",
                              .bytes = "G21 G90\nG0 Z5\nG0 X10 Y10\nM3 S5000\nG1 Z-1 F100\n"
                                       "G1 X20 F200\nG0 Z5\nM5\n"},
                             *machine::MakeParameters(Rml1Family(), "srm-20", {}), {});
  ASSERT_FALSE(translation.ok);
  ASSERT_FALSE(translation.diagnostics.empty());
  EXPECT_EQ(translation.diagnostics[0].code, ErrorCode::kRml1NoProgram);
  std::set<ErrorCode> kinds;
  for (const Diagnostic& finding : translation.diagnostics)
    EXPECT_TRUE(kinds.insert(finding.code).second) << CodeText(finding.code);
  EXPECT_GT(translation.diagnostics_dropped.count(), 0U);
  for (const auto& [code, kind] : translation.diagnostics_dropped.kinds())
    EXPECT_TRUE(kinds.contains(code)) << CodeText(code);
}

// A check tells of the first 1000 pauses and counts the rest, as of every advice (RML1-9.06); each
// at its command.
TEST(Rml1Family, BoundsWhatItTellsOfPauses) {
  std::string stream;
  for (int k = 0; k < 1005; ++k) stream += "!NR;";
  const machine::Translation translation = TranslateText(stream);
  ASSERT_EQ(translation.diagnostics.size(), 1000U);
  EXPECT_EQ(translation.diagnostics_dropped.count(), 5U);
  const Diagnostic& second = translation.diagnostics[1];
  EXPECT_EQ(second.code, ErrorCode::kRml1PausedAtEnd);
  EXPECT_EQ(second.rule, "RML1-3C.08");
  EXPECT_EQ(second.step, 2);
  EXPECT_EQ(second.where, (SourceSpan{.line = 1, .column = 5, .length = 3, .byte_offset = 4}));
}

// RML1-9.42, RML1-3C.08, RML1-3A.46: advice, and silence where none is wanted.
TEST(Rml1Family, AdvisesWhereWanted) {
  const std::string stream = "F99;!NR;PD30000,0;PU1,1";
  // With the number of the command; what was not ended is no command yet.
  std::vector<std::pair<ErrorCode, int>> told;
  for (const Diagnostic& d : TranslateText(stream).diagnostics) told.emplace_back(d.code, d.step);
  EXPECT_EQ(told, (std::vector<std::pair<ErrorCode, int>>{{ErrorCode::kRml1SpeedClamped, 1},
                                                          {ErrorCode::kRml1PausedAtEnd, 2},
                                                          {ErrorCode::kRml1Clipped, 3},
                                                          {ErrorCode::kRml1IncompleteCommand, 0}}));
  EXPECT_TRUE(TranslateText(stream, false).diagnostics.empty());
  EXPECT_EQ(TranslateText("5;", false).diagnostics.size(), 1U);  // errors are no advice
}

// Lines and columns stay right, and the check linear, in a file that is one line of a megabyte with
// link errors in the middle of commands.
TEST(Rml1Family, FindsPlacesInLongLines) {
  std::string stream = "\n";
  for (int i = 0; i < 100'000; ++i) stream += "PU1\x1b.B,2;";
  const machine::Translation translation = TranslateText(stream);
  ASSERT_GT(translation.diagnostics.size(), 3U);
  EXPECT_EQ(translation.diagnostics[0].code, ErrorCode::kRml1BadSequence);
  EXPECT_EQ(translation.diagnostics[0].where.line, 2);
  EXPECT_EQ(translation.diagnostics[0].where.column, 6);
  EXPECT_EQ(translation.diagnostics[1].code,
            ErrorCode::kRml1WrongParameters);  // PU with one number
  EXPECT_EQ(translation.diagnostics[1].where.column, 1);
}

machine::ProjectBundle BundleOf(int slot, std::string_view bytes) {
  machine::ProjectBundle bundle;
  bundle.programs.push_back({.slot = slot, .file = {.name = "a.rml", .bytes = bytes}});
  return bundle;
}

machine::TransferPlan PlanOf(const machine::ProjectBundle& bundle) {
  return Rml1Family().PlanTransfer(bundle, ParametersOf("t1"), {});
}

TEST(Rml1Family, PlansTheTransferOfPrograms) {
  machine::ProjectBundle bundle = BundleOf(1, "PU1,1;");
  bundle.programs.push_back({.slot = 99, .file = {.name = "b.rml", .bytes = "XX;"}});
  const machine::TransferPlan plan = PlanOf(bundle);
  ASSERT_TRUE(plan.ok);
  ASSERT_EQ(plan.programs.size(), 2U);
  EXPECT_EQ(plan.programs[0].object, "PU1,1;");
  EXPECT_EQ(plan.programs[0].source, "PU1,1;");
  EXPECT_EQ(plan.programs[1].slot, 99);
  ASSERT_EQ(plan.diagnostics.size(), 1U);  // a device error does not refuse it
  EXPECT_EQ(plan.diagnostics[0].program, 99);
  EXPECT_EQ(plan.diagnostics[0].file, "b.rml");
}

// Every program or none: whatever a mill cannot take is refused with its reason.
TEST(Rml1Family, RefusesWhatAMillCannotTake) {
  const auto refusal = [](const machine::ProjectBundle& bundle) {
    const machine::TransferPlan plan = PlanOf(bundle);
    EXPECT_FALSE(plan.ok);
    EXPECT_TRUE(plan.programs.empty());
    return plan.diagnostics.at(0).detail;
  };
  machine::ProjectBundle schedules = BundleOf(1, "PU;");
  schedules.schedules.push_back({.number = 1, .name = "x"});
  EXPECT_EQ(refusal(schedules), "Roland mill or engraver, RML-1 has no laser schedules");
  machine::ProjectBundle processes = BundleOf(1, "PU;");
  processes.processes.push_back({.kind = 1, .process = 1, .values = {}, .note = {}});
  EXPECT_EQ(refusal(processes), "Roland mill or engraver, RML-1 has no process definitions");
  machine::ProjectBundle inch = BundleOf(1, "PU;");
  inch.programs[0].inch = true;
  EXPECT_EQ(refusal(inch), "a stream is in units of its machine, not in inches");
  EXPECT_EQ(refusal(BundleOf(0, "PU;")), "slot 0 is not one of 1 to 99");
  EXPECT_EQ(refusal(BundleOf(100, "PU;")), "slot 100 is not one of 1 to 99");
  machine::ProjectBundle twice = BundleOf(7, "PU;");
  twice.programs.push_back(twice.programs[0]);
  EXPECT_EQ(refusal(twice), "slot 7 has two programs");
  EXPECT_EQ(refusal(BundleOf(1, "")), "the stream has no bytes");
}

}  // namespace
}  // namespace rmlcell::rml1
