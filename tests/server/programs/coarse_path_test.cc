// The path of a stored program at the levels of detail that there are (motion.md 9), and what the
// tools say of texts in inches and of objects.
#include <gtest/gtest.h>

#include "engine/simulation/toolpath/toolpath_level.h"
#include "server/base/config.h"
#include "server/programs/memory_tools.h"
#include "server/programs/program_book.h"
#include "server/programs/program_views.h"
#include "server/programs/text_tools.h"
#include "server/records/toolpath_levels.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

class CoarsePath : public testing::Test {
 protected:
  ProgramViews::Toolpath Path(int level) {
    v1::StreamProgramToolpathRequest request;
    request.set_name("machines/optimo-1/programs/45");
    request.set_level(level);
    return Must(ProgramViews(programs).Path(request));
  }

  ServerBed bed;
  Config config;
  ProgramBook programs{bed.store(), config};
  MemoryTools tools{bed.store(), programs};
};

// A circle needs the more points the finer it is.
TEST_F(CoarsePath, HasFewerPointsOfACircle) {
  const auto stored =
      programs.Store({.name = "machines/optimo-1/programs/45",
                      .file_name = "a.S",
                      .bytes = "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE "
                               "(1000.,900.,-500.,0.,0.)\nPATH CIR\n"
                               "MOVE (1200.,900.,-500.,0.,0.)/VIA (1100.,1000.,-500.,0.,0.)\n"});
  ASSERT_TRUE(stored) << stored.error.error.detail;
  constexpr int kMost = simulation::kToolpathLevelMax;
  const ProgramViews::Toolpath fine = Path(0);
  const ProgramViews::Toolpath coarse = Path(kMost);
  EXPECT_LT(coarse.frames.size(), fine.frames.size());
  EXPECT_EQ(coarse.header.bytes(), static_cast<std::int64_t>(coarse.frames.size()));
  EXPECT_EQ(coarse.header.level(), kMost);
  const double kept_mm = fine.header.tolerance_mm();
  EXPECT_EQ(coarse.header.tolerance_mm(), simulation::LevelTolerance(kept_mm, kMost));
  // What a header says of all levels is how large each of them is.
  v1::ToolpathHeader header;
  AddLevels(fine.frames, kept_mm, header);
  ASSERT_EQ(header.levels_size(), kMost + 1);
  for (const int level : {0, 1, kMost})
    EXPECT_EQ(header.levels(level).bytes(), static_cast<std::int64_t>(Path(level).frames.size()));
  EXPECT_LT(header.levels(1).bytes(), header.levels(0).bytes());
  EXPECT_LT(header.levels(kMost).bytes(), header.levels(1).bytes());
}

// OPT-2.04: the name of a file says that it is in inches, also where it is to be linked.
TEST_F(CoarsePath, ATextInInchesIsNotLinked) {
  const auto said = [this](const std::string& file_name) {
    v1::LinkProgramRequest request;
    request.set_slot(32);
    v1::LinkProgramRequest::Part& part = *request.add_programs();
    part.set_slot(32);
    part.mutable_program()->set_file_name(file_name);
    part.mutable_program()->set_content("MOVE (10.0,2.0,-1.0,0.0,0.0)\n");
    const v1::LinkProgramResponse made = Must(tools.Link(request));
    EXPECT_EQ(made.executable().empty(), !made.findings().ok());
    return made.findings().diagnostics_size() > 0 ? made.findings().diagnostics(0).code() : "";
  };
  EXPECT_EQ(said("32.SI"), CodeText(ErrorCode::kSourceIsInch));
  EXPECT_EQ(said("32.S"), "");
}

// There is nothing wrong with an object that can be listed.
TEST(ListedObject, IsGood) {
  v1::MakeListingRequest request;
  request.mutable_program()->set_file_name("a.O");
  request.mutable_program()->set_content(ObjectOf("DELAY 2.5\nSTOP\n"));
  const v1::MakeListingResponse listed = Must(ListText(request));
  EXPECT_TRUE(listed.findings().ok());
  EXPECT_NE(listed.content().find("DELAY"), std::string::npos);
}

// ConvertProgramRequest.target: said so, it counts for a name that says nothing.
TEST(ConvertedText, IsInTheUnitsThatAreWanted) {
  const auto converted = [](v1::ConvertProgramRequest::Target target) {
    v1::ConvertProgramRequest request;
    request.mutable_program()->set_file_name("part");
    request.mutable_program()->set_content("MOVE (254.0,508.0,-25.4,0.0,0.0)\n");
    request.set_output_name("made");
    request.set_target(target);
    const auto made = ConvertText(request, "today");
    return made ? made->content() : "refused: " + std::string(made.error().detail);
  };
  const std::string inch = converted(v1::ConvertProgramRequest::TARGET_INCH);
  EXPECT_NE(inch.find("20."), std::string::npos) << inch;
  EXPECT_EQ(inch.find("508."), std::string::npos) << inch;
  const std::string metric = converted(v1::ConvertProgramRequest::TARGET_METRIC);
  EXPECT_NE(metric.find("12903.2"), std::string::npos) << metric;
}

// Its head has the time that the caller says, or else that of the server.
TEST(ConvertedText, HasATimeInItsHead) {
  v1::ConvertProgramRequest request;
  request.mutable_program()->set_file_name("part.SI");
  request.mutable_program()->set_content("MOVE (1.,2.,-3.,90.,0.)\n");
  const auto head = [&request] {
    const std::string content = Must(ConvertText(request, "Thu Mar 04 08:52:34 1993")).content();
    return content.substr(0, content.find('\n'));
  };
  EXPECT_NE(head().find("Thu Mar 04 08:52:34 1993"), std::string::npos) << head();
  request.set_date("Fri Mar 05 09:00:00 1993");
  EXPECT_NE(head().find("Fri Mar 05 09:00:00 1993"), std::string::npos) << head();
  EXPECT_EQ(head().find("Thu Mar 04"), std::string::npos) << head();
}

// What is wrong with a text is told with its form; of inches nothing is, as they are converted
// first.
TEST(FormattedText, TellsWhatIsWrongWithMillimetres) {
  const auto findings = [](const std::string& file_name) {
    v1::FormatProgramRequest request;
    request.mutable_program()->set_file_name(file_name);
    request.mutable_program()->set_content("MOVE (\n");
    return Must(FormatText(request)).findings();
  };
  EXPECT_FALSE(findings("a.S").ok());
  EXPECT_GT(findings("a.S").diagnostics_size(), 0);
  EXPECT_EQ(findings("a.SI").diagnostics_size(), 0);
}

}  // namespace
}  // namespace rmlcell::server
