#include "clients/cli/remote_call.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "clients/cli/request_id.h"
#include "google/rpc/status.pb.h"
#include "proto/bridge/findings.h"
#include "tests/clients/cli/cli_folder.h"
#include "tests/engine/core/untold.h"

namespace rmlcell::cli {
namespace {

using testing::HasSubstr;

TEST(FullName, ANameIsTakenWithItsCollectionAndWithout) {
  EXPECT_EQ(FullName("jobs", "17"), "jobs/17");
  EXPECT_EQ(FullName("jobs", "jobs/17"), "jobs/17");
  EXPECT_EQ(FullName("machines", "optimo-1"), "machines/optimo-1");
  EXPECT_EQ(FullName("projects", "projects"), "projects/projects");
  EXPECT_EQ(FullName("projects", "projects-2"), "projects/projects-2");
  EXPECT_EQ(FullName("machines", "jobs/17"), "machines/jobs/17");  // which the server refuses
}

// What a server makes of an error.
grpc::Status StatusOf(const Error& error, const std::vector<Diagnostic>& findings = {},
                      const UntoldFindings& dropped = {}) {
  const google::rpc::Status rich = bridge::ToRpcStatus(error, findings, dropped);
  return {static_cast<grpc::StatusCode>(rich.code()), rich.message(), rich.SerializeAsString()};
}

Told HearRefused(const grpc::Status& status, bool as_json = false) {
  return Hear([&] { return Refused(status, {.server = "127.0.0.1:1", .json = as_json}); });
}

TEST(Refused, TheExitCodeTellsWrongUseFromTheRest) {
  Told told = HearRefused(StatusOf({ErrorCode::kCellInvalidArgument, "slot is 0", {}}));
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(told.errors, HasSubstr("rmlcell: CELL-E9003: "));
  EXPECT_THAT(told.errors, HasSubstr("slot is 0"));
  EXPECT_EQ(HearRefused(StatusOf({ErrorCode::kCellNotFound, "jobs/7", {}})).exit_code, 3);
  EXPECT_EQ(HearRefused(StatusOf({ErrorCode::kCellEtagMismatch, {}, {}})).exit_code, 3);
}

TEST(Refused, WithoutAServerItsAddressIsTold) {
  const Told told = HearRefused({grpc::StatusCode::UNAVAILABLE, "connection refused"}, true);
  EXPECT_EQ(told.exit_code, 3);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(told.errors, HasSubstr("no server answers at 127.0.0.1:1 (connection refused)"));
  // A server that stops is one that answers.
  const Told stops = HearRefused(StatusOf({ErrorCode::kCellUnavailable, "it stops", {}}));
  EXPECT_EQ(stops.exit_code, 3);
  EXPECT_THAT(stops.errors, HasSubstr("CELL-E9002"));
}

TEST(Refused, FindingsOfAProgramAreShownAndAreErrorsOfTheProgram) {
  const std::vector<Diagnostic> findings = {{.code = ErrorCode::kNameUndeclared,
                                             .severity = Severity::kCompile,
                                             .detail = "SPEDE",
                                             .file = "12.S",
                                             .where = {.line = 3, .column = 1}}};
  UntoldFindings untold = Untold(3, ErrorCode::kNameUndeclared, 7);
  untold.Add(Untold(2, ErrorCode::kShortFly));
  const grpc::Status status =
      StatusOf({ErrorCode::kNameUndeclared, "has errors", {}}, findings, untold);
  const Told told = HearRefused(status);
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.output, "");
  EXPECT_TRUE(told.errors.starts_with("rmlcell: 12.S:3:1: error OPT-E7011: SPEDE")) << told.errors;
  // Three errors that did not fit into the answer, and two advices, which refuse nothing.
  EXPECT_THAT(told.errors,
              HasSubstr("\nrmlcell: and 3 more OPT-E7011, lines 7 to 9\n"
                        "rmlcell: and 2 more findings; rmlcell check of the file tells them\n"));
  EXPECT_EQ(HearRefused(status, true).exit_code, 1);
}

// What stops a program is told; what else is wrong with bytes that are none is only counted.
TEST(Refused, BytesThatAreNoProgramAreRefusedInAFewLines) {
  std::vector<Diagnostic> findings = {{.code = ErrorCode::kRml1NoProgram,
                                       .severity = Severity::kCompile,
                                       .detail = "61.2 %",
                                       .file = "a.rml"}};
  for (int line = 1; line <= 32; ++line) {
    findings.push_back({.code = ErrorCode::kRml1UnknownCommand,
                        .severity = Severity::kDevice,
                        .file = "a.rml",
                        .where = {.line = line, .column = 1}});
  }
  const Told told = HearRefused(StatusOf({ErrorCode::kRml1NoProgram, "61.2 %", {}}, findings));
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(std::count(told.errors.begin(), told.errors.end(), '\n'), 2) << told.errors;
  EXPECT_TRUE(
      told.errors.starts_with("rmlcell: a.rml: error RML1-E8007: 61.2 %; store the output"));
  EXPECT_THAT(told.errors, HasSubstr("rml1 from-gcode"));
  EXPECT_THAT(told.errors, HasSubstr("rmlcell: and 32 more findings; "));
  // Errors of one kind are told as a check tells them: five, then their count and extent.
  for (Diagnostic& finding : findings) {
    finding.code = ErrorCode::kNameUndeclared;
    finding.severity = Severity::kCompile;
  }
  const Told many = HearRefused(StatusOf({ErrorCode::kNameUndeclared, "SPEDE", {}}, findings));
  EXPECT_EQ(std::count(many.errors.begin(), many.errors.end(), '\n'), 6) << many.errors;
  EXPECT_THAT(many.errors, HasSubstr("\nrmlcell: and 28 more OPT-E7011, lines 5 to 32\n"));
}

TEST(Refused, TheDetailsArePrintedAsJsonWhereThatIsAskedFor) {
  const Told told = HearRefused(StatusOf({ErrorCode::kCellNotFound, "jobs/7", {}}), true);
  const auto status = nlohmann::json::parse(told.output, nullptr, false);
  EXPECT_EQ(status["code"], 5);  // NOT_FOUND
  ASSERT_EQ(status["details"].size(), 3U);
  EXPECT_EQ(status["details"][1]["code"], "CELL-E9004");
  EXPECT_EQ(status["details"][1]["message"], "jobs/7");
  EXPECT_EQ(status["details"][2]["locale"], "en");
}

// 128 bits in hexadecimal digits: nobody else makes the same one.
TEST(RequestId, Has32DigitsAndIsNeverTheSame) {
  const std::string one = NewRequestId();
  EXPECT_EQ(one.size(), 32U);
  EXPECT_EQ(one.find_first_not_of("0123456789abcdef"), std::string::npos) << one;
  EXPECT_NE(NewRequestId(), one);
}

}  // namespace
}  // namespace rmlcell::cli
