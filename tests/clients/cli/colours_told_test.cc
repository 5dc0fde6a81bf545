// What is red, yellow or green on a terminal: how serious it is, whatever it is called.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "clients/cli/findings_text.h"
#include "clients/cli/messages.h"
#include "clients/cli/rml1_tools.h"
#include "clients/cli/terminal.h"
#include "clients/cli/verdict_text.h"
#include "tests/clients/cli/cli_folder.h"
#include "tests/clients/cli/on_terminal.h"

namespace rmlcell::cli {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kInRed = "\x1b[31m";
constexpr const char* kInYellow = "\x1b[33m";
constexpr const char* kInGreen = "\x1b[32m";

class ColoursTold : public testing::Test {
 protected:
  ColoursTold() { ::unsetenv("NO_COLOR"); }
  ~ColoursTold() override { ::setenv("NO_COLOR", "1", 1); }
  static std::string Shown(const std::function<void()>& draw) {
    return OnTerminal(STDOUT_FILENO, stdout, draw);
  }
  static std::string Shown(const std::string& text) {
    return Shown([&] { Print(text); });
  }
};

TEST_F(ColoursTold, OfVerdicts) {
  const auto shown = [](v1::Verdict verdict) {
    return Shown([verdict] { Print(VerdictText(verdict)); });
  };
  EXPECT_THAT(shown(v1::VERDICT_GOOD), StartsWith(kInGreen + std::string("GOOD\x1b[0m")));
  EXPECT_THAT(shown(v1::VERDICT_BAD), StartsWith(kInRed + std::string("BAD\x1b[0m")));
  EXPECT_THAT(shown(v1::VERDICT_DOUBTFUL), StartsWith(kInYellow + std::string("DOUBTFUL\x1b[0m")));
}

// What was carried out is no good news where its verdict is BAD.
TEST_F(ColoursTold, OfOutcomes) {
  const auto shown = [](v1::Outcome::Kind kind, v1::Verdict verdict) {
    v1::Outcome outcome;
    outcome.set_kind(kind);
    outcome.set_verdict(verdict);
    return Shown([outcome] { Print(OutcomeLine(outcome)); });
  };
  using Outcome = v1::Outcome;
  EXPECT_THAT(shown(Outcome::KIND_COMPLETED, v1::VERDICT_GOOD), StartsWith(kInGreen));
  EXPECT_THAT(shown(Outcome::KIND_COMPLETED, v1::VERDICT_DOUBTFUL), StartsWith(kInGreen));
  EXPECT_THAT(shown(Outcome::KIND_COMPLETED, v1::VERDICT_BAD), StartsWith("completed"));
  EXPECT_THAT(shown(Outcome::KIND_FAILED, v1::VERDICT_BAD), StartsWith(kInRed));
  EXPECT_THAT(shown(Outcome::KIND_STOPPED, v1::VERDICT_BAD), StartsWith(kInYellow));
  EXPECT_THAT(shown(Outcome::KIND_CANCELLED, v1::VERDICT_UNSPECIFIED), StartsWith(kInYellow));
}

TEST_F(ColoursTold, OfFindings) {
  const auto shown = [](Severity severity, Judged judged) {
    const std::vector<Diagnostic> findings = {
        {.code = ErrorCode::kPracticeAdvice, .severity = severity, .judged = judged}};
    return Shown([&findings] { PrintFindings(findings, {}, {}); });
  };
  EXPECT_THAT(shown(Severity::kCompile, Judged::kNo), StartsWith(kInRed));
  EXPECT_THAT(shown(Severity::kAdvice, Judged::kNo), StartsWith(kInYellow));
  EXPECT_THAT(shown(Severity::kWarning, Judged::kNo), StartsWith(kInYellow));
  EXPECT_THAT(shown(Severity::kAdvice, Judged::kBad), StartsWith(kInRed));
}

TEST_F(ColoursTold, OfWhatACommandOfAStreamDoes) {
  const CliFolder folder;
  const auto shown = [&](const std::string& stream) {
    MillToolOptions options;
    options.file = folder.Put("a.rml", stream);
    return Shown([&] { static_cast<void>(ExplainStream(options)); });
  };
  const std::string indent(20, ' ');
  EXPECT_THAT(shown("PA;PU0,0;PD99999,0;PU;"), HasSubstr(kInRed + indent));  // the verdict is BAD
  EXPECT_THAT(shown("PA;!MC1;PU0,0;PQ;PU;"), HasSubstr(kInRed + indent));
  EXPECT_THAT(shown("PA;VS50;!MC1;PU0,0;PD500,0;PU;"), HasSubstr(kInYellow + indent));
}

}  // namespace
}  // namespace rmlcell::cli
