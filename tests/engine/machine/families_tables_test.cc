#include <gtest/gtest.h>

#include <map>
#include <set>

#include "engine/families/families.h"
#include "engine/machine/observer.h"
#include "engine/machine/run.h"
#include "engine/machine/shape.h"

// The tables that families hand over, whatever the family.
namespace rmlcell::machine {
namespace {

std::string Upper(std::string_view text) {
  std::string upper(text);
  for (char& c : upper) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  return upper;
}

TEST(FamilyTables, ParametersAreCompleteAndTheirDefaultsAreInRange) {
  for (const MachineFamily* family : families::Families()) {
    std::set<std::string> names;
    for (const ParameterInfo& info : family->parameters()) {
      const std::string where = std::string(family->info().id) + " " + std::string(info.name);
      EXPECT_TRUE(names.insert(Upper(info.name)).second) << where << " stands twice";
      EXPECT_FALSE(info.text.empty()) << where;
      EXPECT_FALSE(info.rule.empty()) << where;
      Parameters parameters(family->parameters());
      if (info.choices.empty()) {
        EXPECT_LE(info.minimum, info.maximum) << where;
        EXPECT_TRUE(parameters.Set(info.name, info.standard)) << where;
        EXPECT_TRUE(parameters.Set(info.name, info.minimum)) << where;
        EXPECT_TRUE(parameters.Set(info.name, info.maximum)) << where;
      } else {
        EXPECT_TRUE(parameters.Set(info.name, parameters.Word(info.name))) << where;
        EXPECT_EQ(info.choices.find("  "), std::string_view::npos) << where;
      }
    }
  }
}

TEST(FamilyTables, EveryProfileCanBeApplied) {
  for (const MachineFamily* family : families::Families()) {
    std::set<std::string_view> ids;
    for (const MachineProfile& profile : family->profiles()) {
      EXPECT_TRUE(ids.insert(profile.id).second) << profile.id;
      EXPECT_FALSE(profile.title.empty()) << profile.id;
      Parameters parameters(family->parameters());
      const Status applied = parameters.Apply(profile);
      EXPECT_TRUE(applied) << profile.id << ": " << applied.error().detail;
    }
  }
}

// A travel whose ends are the wrong way round, or a machine without one, makes no picture.
TEST(FamilyTables, EveryProfileHasATravel) {
  for (const MachineFamily* family : families::Families()) {
    for (const MachineProfile& profile : family->profiles()) {
      Parameters parameters(family->parameters());
      ASSERT_TRUE(parameters.Apply(profile));
      const MachineShape shape = family->Shape(parameters);
      ASSERT_FALSE(shape.travel.empty()) << profile.id;
      EXPECT_LT(shape.travel.min.x(), shape.travel.max.x()) << profile.id;
      EXPECT_LT(shape.travel.min.y(), shape.travel.max.y()) << profile.id;
      EXPECT_LT(shape.travel.min.z(), shape.travel.max.z()) << profile.id;
    }
  }
}

TEST(FamilyTables, IdsAndExtensionsBelongToOneFamily) {
  std::set<std::string_view> ids;
  std::set<std::string> extensions;
  for (const MachineFamily* family : families::Families()) {
    EXPECT_TRUE(ids.insert(family->info().id).second);
    EXPECT_EQ(families::FindFamily(family->info().id), family);
    std::string_view rest = family->info().extensions;
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find(' '), rest.size());
      const std::string extension(rest.substr(0, end));
      EXPECT_EQ(extension.front(), '.');
      EXPECT_TRUE(extensions.insert(Upper(extension)).second) << extension;
      EXPECT_EQ(families::FamilyOfFileName("a" + extension), family);
      EXPECT_EQ(families::FamilyOfFileName("a" + Upper(extension)), family);
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
  EXPECT_EQ(families::FindFamily("lathe"), nullptr);
  EXPECT_EQ(families::FindFamily(""), nullptr);
  EXPECT_EQ(families::FamilyOfFileName("a.txt"), nullptr);
  EXPECT_EQ(families::FamilyOfFileName(""), nullptr);
}

// docs/facts.md: a figure is known by its name.
TEST(FamilyTables, FiguresHaveNamesUnitsAndMeanings) {
  for (const MachineFamily* family : families::Families()) {
    std::set<std::string_view> names;
    for (const FigureInfo& figure : family->figures()) {
      EXPECT_TRUE(names.insert(figure.name).second) << figure.name;
      EXPECT_FALSE(figure.text.empty()) << figure.name;
      EXPECT_EQ(figure.said.find('#') != std::string_view::npos, !figure.row.empty())
          << figure.name;
    }
  }
}

// OPT-4.17: HOLD has no effect on an Optimo in REMOTE, where STOP holds instead; a mill has no such
// mode, and ends its move first.
TEST(HoldKey, HoldsARunOfEveryFamily) {
  struct Case {
    SourceFile source;
    std::string_view why_in_remote;
  };
  const std::map<std::string_view, Case> cases = {
      {"optimo",
       {{"part.S", "MOVE (521.02,2201.2,-50.,0.,0.)\nMOVE (621.02,2201.2,-50.,0.,0.)\n"}, "STOP"}},
      {"rml1", {{"part.rml", "PA;PU4000,0;PU0,0;PU4000,0;PU0,0;"}, "HOLD"}}};
  struct Listener final : RunObserver {
    void OnHalt(const Halt& halt) override {
      why = halt.why;
      reason = halt.reason;
    }
    std::string why;
    HaltReason reason{};
  };
  for (const MachineFamily* family : families::Families()) {
    const FamilyInfo& info = family->info();
    const Case& one = cases.at(info.id);
    for (const Mode mode : {Mode::kRemote, Mode::kCycle}) {
      RunSetup setup{Parameters(family->parameters())};
      const Translation made = family->Translate(one.source, setup.parameters, {});
      ASSERT_TRUE(made.ok) << info.id;
      setup.programs[1] = {.name = "part", .object = Bytes::Of(ObjectOf(made, one.source.bytes))};
      setup.main_program = 1;
      setup.mode = mode;
      Listener listener;
      Result<std::unique_ptr<machine::Run>> run = family->NewRun(std::move(setup), listener);
      ASSERT_TRUE(bool(run)) << info.id;
      EXPECT_EQ((*run)->Advance(FromSeconds(0.1)), RunPhase::kRunning) << info.id;
      (*run)->Apply({.at = (*run)->state().time, .kind = HoldKey(info, mode)});
      EXPECT_EQ((*run)->Advance(FromSeconds(1000.0)), RunPhase::kHalted) << info.id;
      EXPECT_EQ(listener.why, mode == Mode::kRemote ? one.why_in_remote : "HOLD") << info.id;
      EXPECT_EQ(listener.reason, listener.why == "STOP" ? HaltReason::kStop : HaltReason::kHold)
          << info.id;
    }
  }
}

// observer.h: what halts a run decides what lets it go on, so nobody has to read words for it.
TEST(HaltReasons, AreToldByEveryFamily) {
  const std::map<std::string_view, SourceFile> by_program = {
      {"optimo", {"part.S", "PAUSE\nPAUSE\n"}},
      {"rml1", {"part.rml", "PA;PU4000,0;!NR;PU0,0;PU100,0;"}}};
  const std::map<std::string_view, SourceFile> without = {
      {"optimo", {"part.S", "OL[20] = 1\nOL[20] = 0\nOL[20] = 1\n"}},
      {"rml1", {"part.rml", "PA;PU4000,0;PU0,0;PU100,0;"}}};
  struct Listener final : RunObserver {
    void OnHalt(const Halt& halt) override { reasons.push_back(halt.reason); }
    std::vector<HaltReason> reasons;
  };
  for (const MachineFamily* family : families::Families()) {
    const FamilyInfo& info = family->info();
    const auto first_halt = [&](const SourceFile& source, Mode mode,
                                std::optional<ProgramStep> breakpoint) {
      RunSetup setup{Parameters(family->parameters())};
      const Translation made = family->Translate(source, setup.parameters, {});
      EXPECT_TRUE(made.ok) << info.id;
      setup.programs[1] = {.name = "part", .object = Bytes::Of(ObjectOf(made, source.bytes))};
      setup.main_program = 1;
      setup.mode = mode;
      setup.breakpoint = breakpoint;
      // Somebody is there who could let it go on.
      setup.inputs = {{.at = FromSeconds(5000.0), .kind = InputKind::kStart}};
      Listener listener;
      Result<std::unique_ptr<machine::Run>> run = family->NewRun(std::move(setup), listener);
      EXPECT_TRUE(bool(run)) << info.id;
      (*run)->Advance(FromSeconds(1000.0));
      EXPECT_FALSE(listener.reasons.empty()) << info.id;
      return listener.reasons.empty() ? HaltReason::kHold : listener.reasons.front();
    };
    EXPECT_EQ(first_halt(by_program.at(info.id), Mode::kCycle, {}), HaltReason::kProgram)
        << info.id;
    EXPECT_EQ(first_halt(without.at(info.id), Mode::kSingle, {}), HaltReason::kSingle) << info.id;
    EXPECT_EQ(first_halt(without.at(info.id), Mode::kCycle, ProgramStep{.program = 1, .step = 2}),
              HaltReason::kBreakpoint)
        << info.id;
  }
}

}  // namespace
}  // namespace rmlcell::machine
