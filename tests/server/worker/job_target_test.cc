// What a job leaves of its block beside what should be left (MillTarget), the chips of its tool,
// and that work which is no run ends when it is asked to.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>

#include "engine/simulation/material/stl.h"
#include "engine/simulation/material/target.h"
#include "server/worker/material_files.h"
#include "tests/server/worker/runner_bed.h"
#include "tests/storage/quiet_process.h"

namespace rmlcell::server {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

// A groove of 20 mm along X at Y 15.1, 1 mm deep, and the same 1.5 mm deep. 100 units a mm.
constexpr const char* kShallow = "VS10;!VZ10;!PZ-100,200;!MC1;PU2010,1510;PD4010,1510;PU0,0;!MC0;";
constexpr const char* kDeep = "VS10;!VZ10;!PZ-150,200;!MC1;PU2010,1510;PD4010,1510;PU0,0;!MC0;";
// Does not move, and is over at the first step of its run.
constexpr const char* kMoment = "PA;";

class JobTargetRun : public JobRunnerTest {
 protected:
  static void SetTarget(const std::string& name, const std::string& bytes, bool is_file,
                        v1::WorkerAssignment& assignment) {
    v1::MillTarget& target = *MillingOf(assignment).mutable_target();
    target.set_picture(true);
    if (is_file) {
      target.mutable_file()->set_file_name(name);
    } else {
      target.mutable_inline_program()->set_file_name(name);
    }
    v1::AssignedProgram& given = *assignment.mutable_target();
    given.set_file_name(name);
    given.set_is_source(!is_file);
    given.set_content(bytes);
    given.set_size(static_cast<std::int64_t>(bytes.size()));
  }
  std::vector<std::string> Reasons() {
    std::vector<std::string> codes;
    const v1::Outcome outcome = Outcome();
    for (const v1::VerdictReason& reason : outcome.reasons()) codes.push_back(reason.code());
    return codes;
  }
  // What is done in the middle of the long work, and has come before that goes on: the clock of the
  // processor is looked at twice before, when the work begins and when its programs are prepared.
  // A run that is over at its first step looks at no clock.
  void OnceItIsLong(const std::function<void()>& act) {
    looks_ = 0;
    processor_time = [this, act] {
      if (++looks_ == 3) {
        act();
        EXPECT_TRUE(ComesToRest());
      }
      return 0.0;
    };
  }
  int looks_ = 0;
};

// 0.5 mm are missing of the groove of 20 x 3 mm with its two half discs, which is 67.07 mm2: left.
// But for its outermost cells, 0.2 mm of 49.42 mm all round: a wall may stand off by a cell.
TEST_F(JobTargetRun, IsComparedWithWhatIsLeft) {
  v1::WorkerAssignment assignment = Mill(kShallow);
  SetTarget("deep.rml", kDeep, false, assignment);
  Work(assignment);
  const v1::TargetFigures figures = Report().milling().target();
  EXPECT_EQ(figures.left_mm(), 0.5);
  EXPECT_EQ(figures.deep_mm(), 0.0);
  EXPECT_NEAR(figures.left_mm3(), 0.5 * (67.07 - 0.2 * 49.42), 0.5);
  EXPECT_EQ(figures.tolerance_mm(), 0.1);
  EXPECT_NEAR(figures.compared_mm2(), 60.0 * 30.0, 1e-6);
  EXPECT_EQ(Outcome().verdict(), v1::VERDICT_DOUBTFUL);
  EXPECT_THAT(Reasons(), ElementsAre("CELL-E9614"));
  EXPECT_THAT(Names(), ElementsAre("picture.svg", "report", "target.png", "toolpath"));
  EXPECT_THAT(Artifacts()["target.png"], StartsWith("\x89PNG\r\n\x1a\n"));
  MillingOf(assignment).mutable_target()->set_picture(false);
  MillingOf(assignment).mutable_target()->set_tolerance_mm(0.5);
  Work(assignment);
  EXPECT_EQ(Report().milling().target().tolerance_mm(), 0.5);
  EXPECT_EQ(Outcome().verdict(), v1::VERDICT_GOOD);
  EXPECT_THAT(Names(), ElementsAre("picture.svg", "report", "toolpath"));
}

// The other way round it is cut too deep: by a height map, by a body, and by a stored stream.
TEST_F(JobTargetRun, MayBeAFile) {
  v1::WorkerAssignment first = Mill(kShallow);
  MillingOf(first).set_height_map(true);
  MillingOf(first).set_stl(true);
  Work(first);
  auto files = Artifacts();
  for (const auto& [name, bytes] :
       {std::pair("height.png", files["height.png"]), std::pair("left.stl", files["left.stl"]),
        std::pair("", std::string(kShallow))}) {
    v1::WorkerAssignment assignment = Mill(kDeep);
    SetTarget(name, bytes, *name != '\0', assignment);
    if (*name == '\0') {
      MillingOf(assignment).mutable_target()->set_slot(7);
      assignment.mutable_target()->set_is_source(false);
    }
    Work(assignment);
    // Half a grey value of 5 mm in 65535, and 0.01 mm of the body.
    EXPECT_NEAR(Report().milling().target().deep_mm(), 0.5, 0.0101) << name;
    EXPECT_NEAR(Report().milling().target().left_mm(), 0.0, 0.0101) << name;
    EXPECT_EQ(Outcome().verdict(), v1::VERDICT_BAD) << name;
    EXPECT_THAT(Reasons(), ElementsAre("CELL-E9613")) << name;
  }
}

// A target that was too large for the assignment: its parts are those of slot 0.
TEST_F(JobTargetRun, MayFollowInParts) {
  v1::WorkerAssignment assignment = Mill(kShallow);
  SetTarget("deep.rml", kDeep, false, assignment);
  const std::string bytes(kDeep);
  assignment.mutable_target()->clear_content();
  v1::WorkResponse parts[2];
  parts[0].mutable_blob()->set_chunk(bytes.substr(0, 20));
  parts[1].mutable_blob()->set_chunk(bytes.substr(20));
  Work(assignment, {parts[0], parts[1]});
  EXPECT_EQ(Report().milling().target().left_mm(), 0.5);
}

// What cannot be compared ends the job before its run, with what the command says.
TEST_F(JobTargetRun, ThatCannotBeEndsTheJob) {
  struct Row {
    const char* name;
    const char* bytes;
    const char* code;
    const char* said;
  };
  const Row rows[] = {
      {"a.png", "\x89PNG\r\n\x1a\n", "CELL-E9024", "target a.png: no height map"},
      {"a.stl", "solid\nfaced\n", "CELL-E9024", "target a.stl: no STL: line 2: 'faced'"},
      {"", "solid\nfacet normal 0 0 1\nvertex 900 0 0\nvertex 901 0 0\nvertex 900 1 0\nendfacet\n",
       "CELL-E9003", "target: the target lies beside the block"},
  };
  for (const Row& row : rows) {
    v1::WorkerAssignment assignment = Mill(kShallow);
    SetTarget(row.name, row.bytes, true, assignment);
    EXPECT_TRUE(Work(assignment));
    EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_FAILED);
    EXPECT_EQ(Outcome().code(), row.code) << row.said;
    EXPECT_THAT(Outcome().message(), HasSubstr(row.said));
    EXPECT_THAT(Names(), ElementsAre());
  }
}

// The job's budgets hold for a program that is its target, too: 200 steps are more than one has.
TEST_F(JobTargetRun, HasTheBudgetsOfTheJob) {
  std::string endless = "VS10;!VZ10;!PZ-100,200;!MC1;";
  for (int i = 0; i < 1000; ++i) endless += "PD4010,1510;PD2010,1510;";
  v1::WorkerAssignment assignment = Mill(kShallow);
  SetTarget("endless.rml", endless, false, assignment);
  assignment.mutable_budget()->set_steps(200);
  Work(assignment);
  EXPECT_EQ(Outcome().code(), "CELL-E9304");
  EXPECT_THAT(Outcome().message(), HasSubstr("target endless.rml: the program does not run"));
}

// chip_loads.toml: aluminium at 3 mm takes 0.03 mm at most. 10 mm/s at 4500 rpm with two edges are
// 10 / (75 * 2) = 0.067 mm; at 10000 rpm 0.03 mm. Down it goes at a tenth of that.
TEST_F(JobTargetRun, TheChipsOfTheToolAreJudged) {
  v1::WorkerAssignment assignment =
      Mill("VS10;!VZ1;!PZ-100,200;!MC1;PU2010,1510;PD4010,1510;PU0,0;!MC0;");
  MillingOf(assignment).mutable_tool()->set_flutes(2);
  MillingOf(assignment).set_material("aluminium");
  MillingOf(assignment).set_rpm(4500.0);
  Work(assignment);
  EXPECT_THAT(Reasons(), ElementsAre("CELL-E9615"));
  MillingOf(assignment).set_rpm(10000.0);
  Work(assignment);
  EXPECT_THAT(Reasons(), ElementsAre());
}

// A body of so many layers that only the order ends it: 300 of them over 4.5 million cells.
std::string Layers() {
  std::string stl(80, ' ');
  const auto put = [&](std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) stl += static_cast<char>(value >> shift & 0xFF);
  };
  constexpr int kLayers = 300;
  put(kLayers);
  for (int k = 0; k < kLayers; ++k) {
    for (const float value : {0.0F, 0.0F, 1.0F,     //
                              -1.0F, -1.0F, 0.0F,   //
                              200.0F, -1.0F, 0.0F,  //
                              -1.0F, 200.0F, 0.0F})
      put(std::bit_cast<std::uint32_t>(value));
    stl.append(2, '\0');
  }
  return stl;
}

TEST_F(JobTargetRun, ACancelIsObeyedWhileTheTargetIsMade) {
  std::string endless = "VS10;!VZ10;!PZ-100,200;!MC1;";
  for (int i = 0; i < 200'000; ++i) endless += "PD4010,1510;PD2010,1510;";
  for (const bool is_file : {true, false}) {
    v1::WorkerAssignment assignment = Mill(kShallow, 0.02);
    SetTarget(is_file ? "a.stl" : "a.rml", is_file ? Layers() : endless, is_file, assignment);
    OnceItIsLong([&] { server.Send(Order(v1::WorkerControl::KIND_CANCEL)); });
    Work(assignment);
    EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_CANCELLED) << is_file;
    EXPECT_EQ(Outcome().code(), "CELL-E9307") << is_file;
    EXPECT_THAT(Names(), ElementsAre()) << is_file;
    OnceItIsLong([&] { stopping = true; });
    Work(assignment);
    EXPECT_TRUE(HandedBack()) << is_file;
    EXPECT_FALSE(Finished()) << is_file;
    stopping = false;
  }
}

// The run is over in its first step; then heights, body and pictures of 18 million cells are made.
class LongProducts : public JobTargetRun {
 protected:
  static v1::WorkerAssignment Long() {
    v1::WorkerAssignment assignment = Mill(kMoment, 0.01);
    MillingOf(assignment).set_height_map(true);
    MillingOf(assignment).set_stl(true);
    return assignment;
  }
};

TEST_F(LongProducts, ACancelLeavesNoneOfThem) {
  OnceItIsLong([&] { server.Send(Order(v1::WorkerControl::KIND_CANCEL)); });
  Work(Long());
  // The run was over when it came.
  for (const v1::JobEvent& event : Events()) EXPECT_FALSE(event.has_input_applied());
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_CANCELLED);
  EXPECT_THAT(Names(), ElementsAre("picture.svg", "report", "toolpath"));
  EXPECT_EQ(Report().outcome().code(), "CELL-E9307");
}

TEST_F(LongProducts, AWorkerThatStopsGivesTheJobBack) {
  OnceItIsLong([&] { stopping = true; });
  Work(Long());
  EXPECT_TRUE(HandedBack());
  EXPECT_FALSE(Finished());
  EXPECT_THAT(Names(), ElementsAre());
}

TEST_F(LongProducts, ALeaseThatIsLostEndsTheWork) {
  OnceItIsLong([&] { server.Send(Release()); });
  Work(Long());
  EXPECT_FALSE(HandedBack());
  EXPECT_FALSE(Finished());
  EXPECT_THAT(Names(), ElementsAre());
}

// A second of the processor goes by between two looks at its clock: as many seconds as the run
// alone needs are too few for its files.
TEST_F(LongProducts, TheyCountAsProcessorTime) {
  int looks = 0;
  processor_time = [&looks] { return static_cast<double>(looks++); };
  // How often the clock is looked at while a run goes on is a matter of chance: this one is over at
  // its first step.
  v1::WorkerAssignment assignment = Long();
  MillingOf(assignment).set_height_map(false);
  MillingOf(assignment).set_stl(false);
  Work(assignment);
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  // The clock stands at 0 when the work begins.
  assignment.mutable_budget()->set_processor_ns(FromSeconds(looks - 1).count());
  looks = 0;
  Work(assignment);
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  MillingOf(assignment).set_height_map(true);
  MillingOf(assignment).set_stl(true);
  looks = 0;
  Work(assignment);
  EXPECT_EQ(Outcome().code(), "CELL-E9303");
  EXPECT_THAT(Names(), ElementsAre("report"));
  EXPECT_EQ(Report().outcome().code(), "CELL-E9303");
}

}  // namespace
}  // namespace rmlcell::server
