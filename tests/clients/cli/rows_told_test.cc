// Which figures have a row, what an event says of a finding that is judged, and where an executable
// goes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "clients/cli/findings_text.h"
#include "clients/cli/messages.h"
#include "clients/cli/terminal.h"
#include "clients/cli/text_tools.h"
#include "engine/families/families.h"
#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

// Of what there is none of nothing is said, except where that is worth a word.
TEST(RowsTold, OfFiguresThatAreNothing) {
  ::setenv("NO_COLOR", "1", 1);
  int silent = 0, told = 0;
  for (const machine::MachineFamily* family : families::Families()) {
    for (const machine::FigureInfo& info : family->figures()) {
      using enum machine::FigureInfo::Where;
      if (info.row.empty() || (info.where != kCheck && info.where != kBoth)) continue;
      const auto rows = [&](double value) {
        const std::vector<machine::Figure> figures = {
            {.name = std::string(info.name), .value = value}};
        return FigureRows(*family, figures, Zero::kWork);
      };
      EXPECT_THAT(rows(2.0), HasSubstr(std::string(info.row))) << info.name;
      EXPECT_EQ(rows(0.0).empty(), !info.when_zero) << info.name;
      ++(info.when_zero ? told : silent);
    }
  }
  EXPECT_GT(silent, 0);
  EXPECT_GT(told, 0);
}

// While nothing is judged the word advice would be too little said; and only that word goes.
TEST(RowsTold, OfFindingsOfAJob) {
  v1::JobEvent event;
  v1::Diagnostic& finding = *event.mutable_diagnostic();
  finding.set_code("OPT-E7033");
  finding.set_message("too fast");
  const auto line = [&](v1::Severity severity, v1::Verdict verdict) {
    finding.set_severity(severity);
    finding.set_verdict(verdict);
    return EventLine(event);
  };
  const std::string unjudged = line(v1::SEVERITY_ADVICE, v1::VERDICT_UNSPECIFIED);
  EXPECT_THAT(unjudged, HasSubstr("OPT-E7033"));
  EXPECT_THAT(unjudged, Not(HasSubstr("advice")));
  const auto stays = [&](v1::Severity severity, v1::Verdict verdict) {
    const std::string told = line(severity, verdict);
    EXPECT_THAT(told, EndsWith("  " + FindingLine(finding)));
    return told;
  };
  EXPECT_THAT(stays(v1::SEVERITY_ADVICE, v1::VERDICT_GOOD), HasSubstr("  advice OPT-E7033"));
  EXPECT_THAT(stays(v1::SEVERITY_ADVICE, v1::VERDICT_BAD), HasSubstr("  BAD OPT-E7033"));
  EXPECT_THAT(stays(v1::SEVERITY_WARNING, v1::VERDICT_UNSPECIFIED), HasSubstr("  warning OPT-"));
  EXPECT_THAT(stays(v1::SEVERITY_COMPILE, v1::VERDICT_UNSPECIFIED), HasSubstr("  error OPT-"));
}

// Bytes and JSON do not go to the same place.
TEST(RowsTold, OfAnExecutable) {
  const CliFolder folder;
  const std::string file = folder.Put("12.S", "SPEED 5\n");
  const auto link = [&](const std::string& output, bool json) {
    LinkOptions options;
    options.files = {file};
    options.output = output;
    options.json = json;
    return Hear([&] { return Link(options); });
  };
  EXPECT_EQ(link(folder.File("a.X"), false).exit_code, 0);
  const Told to_output = link("-", false);
  EXPECT_EQ(to_output.exit_code, 0);
  EXPECT_EQ(to_output.output, folder.Read("a.X"));
  EXPECT_EQ(link(folder.File("b.X"), true).exit_code, 0);
  EXPECT_EQ(folder.Read("b.X"), folder.Read("a.X"));
  const Told refused = link("-", true);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(refused.output, "");
}

}  // namespace
}  // namespace rmlcell::cli
