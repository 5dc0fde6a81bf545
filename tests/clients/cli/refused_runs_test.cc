// What `rmlcell simulate` and `rmlcell check` refuse, each before anything is
// told or written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "clients/cli/local.h"
#include "clients/cli/program_files.h"
#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing::UnorderedElementsAre;

class RefusedRuns : public testing::Test {
 protected:
  RefusedRuns() { ::setenv("NO_COLOR", "1", 1); }
  SimulateOptions Laser() const {
    SimulateOptions options;
    options.files = {folder_.Put("12.S", "VI[2] = 7\n")};
    return options;
  }
  // A mill's stream that is longer than what is looked at before it runs.
  SimulateOptions LongStream(const std::string& end) const {
    std::string stream = "PA;!PZ-100,200;PU0,0;";
    while (stream.size() < 3 * bridge::ProgramStream::kBeginning)
      stream += "PD100,200;PD200,300;\n";
    SimulateOptions options;
    options.files = {folder_.Put("long.rml", stream + end)};
    options.machine.profile = "srm-20";
    return options;
  }
  // A wrong call, of which nothing is told but why.
  static void ExpectRefusal(const Told& told, ErrorCode code, const std::string& said) {
    EXPECT_EQ(told.exit_code, 2) << said;
    EXPECT_EQ(told.output, "") << said;
    EXPECT_THAT(told.errors,
                AllOf(StartsWith("rmlcell: " + CodeText(code) + ": "), HasSubstr(said)));
  }
  static void ExpectRefused(const SimulateOptions& options, ErrorCode code,
                            const std::string& said) {
    ExpectRefusal(Hear([&] { return Simulate(options); }), code, said);
  }

  CliFolder folder_;
};

TEST_F(RefusedRuns, ByTheirOptions) {
  SimulateOptions options = Laser();
  options.machine.file = folder_.File("none.toml");
  ExpectRefused(options, ErrorCode::kCellFileUnreadable, options.machine.file);
  options = Laser();
  options.machine.origin = {1.0, 2.0};
  ExpectRefused(options, ErrorCode::kCellUsage, "--origin: programs of ");
  options = Laser();
  options.mode = "cycles";
  ExpectRefused(options, ErrorCode::kCellUsage, "'cycles': modes are ");
  options = Laser();
  options.simul = "13/1";
  ExpectRefused(options, ErrorCode::kCellUsage, "--simul, --break: there is no program 13");
  options = Laser();
  options.budget = "steps=0";
  ExpectRefused(options, ErrorCode::kCellUsage, "'steps=0': write steps=N,time=SECONDS");
  options = Laser();
  options.variables = "VR[5..4]";
  ExpectRefused(options, ErrorCode::kCellInvalidArgument, "variables: 'VR[5..4]': write VR[0..9]");
  options = Laser();
  options.inputs_file = folder_.Put("keys.txt", "0.5 IL[20] = 1\nnever\n");
  ExpectRefused(options, ErrorCode::kCellBadText, options.inputs_file + ":2: ");
  options = Laser();
  options.slots = {"x=" + options.files[0]};
  ExpectRefused(options, ErrorCode::kCellUsage, "'x=" + options.files[0] + "': write 44=FILE");
}

TEST_F(RefusedRuns, ByWhatTheyBringAlong) {
  SimulateOptions options = Laser();
  options.state_in = folder_.File("none");
  ExpectRefused(options, ErrorCode::kCellFileUnreadable, options.state_in);
  options = Laser();
  options.state_in = folder_.Put("state", "no state of a machine\n");
  ExpectRefused(options, ErrorCode::kCellBadText, "");
  options = Laser();
  options.milling.block = {.stock = "10x10x10", .tool = "flat:3", .material = {}, .target = {}};
  ExpectRefused(options, ErrorCode::kCellInvalidArgument, "--stock is for mills");
  options = Laser();
  options.plot = {"speed,colour", folder_.File("p.svg")};
  ExpectRefused(options, ErrorCode::kCellUsage, "");
  options = Laser();
  options.samples = {"0", folder_.File("s.csv")};
  ExpectRefused(options, ErrorCode::kCellUsage, "");
  options = Laser();
  options.samples = {"10", folder_.File("none/s.csv")};
  ExpectRefused(options, ErrorCode::kCellFileUnwritable,
                folder_.File("none/s.csv") + ": cannot be written");
  EXPECT_THAT(folder_.Names(), UnorderedElementsAre("12.S", "state"));
}

// The run has been: what it told stays told.
TEST_F(RefusedRuns, AProductThatCannotBeWritten) {
  for (const auto& ask : std::vector<std::function<void(SimulateOptions&, const std::string&)>>{
           [](SimulateOptions&options, const std::string&file) { options.svg = file; },
           [](SimulateOptions&options, const std::string&file) { options.toolpath = file; },
           [](SimulateOptions&options, const std::string&file) { options.state_out = file; },
           [](SimulateOptions&options, const std::string&file) {
             options.plot = {"speed", file};
           }}) {
    SimulateOptions options = Laser();
    ask(options, folder_.File("none/file"));
    ExpectRefused(options, ErrorCode::kCellFileUnwritable, folder_.File("none/file") + ": ");
  }
  SimulateOptions options = Laser();
  options.samples = {"10", "/dev/full"};
  ExpectRefused(options, ErrorCode::kCellFileUnwritable, "/dev/full: not written to its end");
}

// OPT-1.11: an executable is made at START; of what does not translate none is.
TEST_F(RefusedRuns, AnExecutableThatCannotBeMade) {
  SimulateOptions options = Laser();
  options.files = {folder_.Put("12.S", "FUNCTION 44\n")};
  options.executables = {"12"};
  const Told alone = Hear([&] { return Simulate(options); });
  EXPECT_EQ(alone.exit_code, 2) << alone.output;
  EXPECT_THAT(alone.errors, HasSubstr("44"));
  options.files = {folder_.Put("12.S", "SPEED 101\n")};
  const Told wrong = Hear([&] { return Simulate(options); });
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.output,
              AllOf(HasSubstr("12.S:1:7: error OPT-E7004: "), HasSubstr("verdict       BAD\n")));
}

// It runs while it is read, and is judged by all of it.
TEST_F(RefusedRuns, AStreamThatTurnsOutToBeNone) {
  SimulateOptions good = LongStream("PU0,0;");
  EXPECT_EQ(Hear([&] { return Simulate(good); }).errors, "");
  SimulateOptions options = LongStream(std::string(200'000, '\xff'));
  options.json = true;
  const Told told = Hear([&] { return Simulate(options); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.output, HasSubstr("RML1-E8007"));
  options.samples = {"10", folder_.File("s.csv")};
  EXPECT_EQ(Hear([&] { return Simulate(options); }).exit_code, 1);
  EXPECT_THAT(folder_.Names(), ElementsAre("long.rml"));
  SimulateOptions placed = LongStream("PU0,0;");
  placed.machine.file =
      folder_.Put("m.toml", "family = \"rml1\"\n[parameters]\nX_MIN = 100\nX_MAX = 50\n");
  placed.machine.profile = "";
  ExpectRefused(placed, ErrorCode::kCellParameterRange, "");
}

// A stream alone comes as it is read; of several files each is read whole.
TEST_F(RefusedRuns, OneStreamComesAsItIsRead) {
  const std::vector<std::string> one = LongStream("PU0,0;").files;
  const std::vector<std::string> two = {one[0], folder_.Put("2.rml", folder_.Read("long.rml"))};
  const auto nothing = [] {};
  const auto alone = OpenFiles(one, {}, 0, "", nothing);
  ASSERT_TRUE(alone);
  EXPECT_NE(alone->stream, nullptr);
  EXPECT_LT(alone->programs[0].bytes->size(), folder_.Read("long.rml").size());
  const auto both = OpenFiles(two, {}, 0, "", nothing);
  ASSERT_TRUE(both);
  EXPECT_EQ(both->stream, nullptr);
  EXPECT_EQ(both->programs[1].bytes->size(), folder_.Read("long.rml").size());
  const auto whole = LoadFiles(one, {}, 0, "");
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->stream, nullptr);
  const auto laser = OpenFiles(Laser().files, {}, 0, "", nothing);
  ASSERT_TRUE(laser);
  EXPECT_EQ(laser->stream, nullptr);
}

// Its beginning is none already: it is read to its end before it is refused.
TEST_F(RefusedRuns, AStreamWhoseBeginningIsNone) {
  SimulateOptions options;
  options.files = {folder_.Put("none.rml", std::string(200'000, '\xff'))};
  options.json = true;
  const Told told = Hear([&] { return Simulate(options); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.errors, "");
  EXPECT_THAT(told.output, HasSubstr("RML1-E8007"));
}

// A wrong call is told before anything of the files; what is wrong with their
// texts is no refusal.
TEST_F(RefusedRuns, OfAChecker) {
  CheckOptions options;
  options.files = {folder_.Put("12.S", "SPEED 5\n")};
  const auto refused = [](const CheckOptions& asked, ErrorCode code, const std::string& said) {
    ExpectRefusal(Hear([&] { return Check(asked); }), code, said);
  };
  CheckOptions wrong = options;
  wrong.inputs_file = folder_.File("none.txt");
  refused(wrong, ErrorCode::kCellFileUnreadable, wrong.inputs_file);
  wrong.inputs_file = folder_.Put("keys.txt", "0.5 IL[20]\n");
  refused(wrong, ErrorCode::kCellBadText, wrong.inputs_file + ":1: ");
  wrong = options;
  wrong.machine.file = folder_.File("none.toml");
  refused(wrong, ErrorCode::kCellFileUnreadable, wrong.machine.file);
  wrong = options;
  wrong.machine.profile = "srm-20";
  refused(wrong, ErrorCode::kCellInvalidArgument, "no profile 'srm-20'");
  wrong = options;
  wrong.machine.clamps_mm = 3.0;
  refused(wrong, ErrorCode::kCellUsage, "--clamps: ");
  wrong = options;
  wrong.files.push_back(folder_.Put("text", "SPEED 5\n"));
  refused(wrong, ErrorCode::kCellFamilyUnknownFromName,
          "'" + folder_.File("text") + "': give --family");
  wrong = options;
  wrong.fix = true;
  wrong.files = {folder_.Put("a.rml", "PU;")};
  refused(wrong, ErrorCode::kCellUsage, folder_.File("a.rml") + ": a stream of ");
  wrong.files = {folder_.File("none.S")};
  refused(wrong, ErrorCode::kCellFileUnreadable, folder_.File("none.S"));
  wrong.files = {folder_.Put("empty.S", "")};
  refused(wrong, ErrorCode::kCellEmptyProgram, folder_.File("empty.S"));
}

// With errors alone those of the motion stay, and nothing else of it.
TEST_F(RefusedRuns, OfAMotionTheErrorsAlone) {
  const std::string far = "COORD ROBOT\nMOVE (9000.,0.,0.,0.,0.)\n";
  CheckOptions options;
  options.files = {folder_.Put("1.S", far)};
  const Told all = Hear([&] { return Check(options); });
  options.errors_only = true;
  const Told errors = Hear([&] { return Check(options); });
  EXPECT_EQ(errors.exit_code, 1);
  EXPECT_THAT(errors.output, HasSubstr("1.S:2: error OPT-E7301: "));
  EXPECT_THAT(all.output, HasSubstr("1.S:2: error OPT-E7301: "));
  EXPECT_THAT(errors.output, Not(HasSubstr("advice")));
}

}  // namespace
}  // namespace rmlcell::cli
