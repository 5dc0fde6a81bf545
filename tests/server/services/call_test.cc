// How errors go over the wire: within what gRPC and its clients take of headers.
#include "server/services/call.h"

#include <gtest/gtest.h>

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "proto/bridge/findings.h"
#include "rmlcell/v1/common.pb.h"
#include "rmlcell/v1/job.pb.h"
#include "rmlcell/v1/machine.pb.h"
#include "rmlcell/v1/machine_control.pb.h"
#include "server/services/account_service.h"
#include "server/services/host_refusal.h"
#include "tests/engine/core/untold.h"

namespace rmlcell::server {
namespace {

v1::ErrorDetail DetailOf(const grpc::Status& status) {
  google::rpc::Status rich;
  v1::ErrorDetail detail;
  EXPECT_TRUE(rich.ParseFromString(status.error_details()));
  EXPECT_EQ(rich.code(), static_cast<int>(status.error_code()));
  EXPECT_EQ(rich.message(), status.error_message());
  EXPECT_EQ(rich.details_size(), 3);
  EXPECT_TRUE(rich.details(1).UnpackTo(&detail));
  return detail;
}

std::vector<Diagnostic> Findings(std::size_t count) {
  Diagnostic finding{.code = ErrorCode::kLiteralRange,
                     .severity = Severity::kAlarm,
                     .detail = std::string(100, 'd')};
  return std::vector<Diagnostic>(count, finding);
}

// LIVE-5.02: all that fails, where a machine refuses a start.
TEST(CallStatus, ARefusedStartTellsAllThatIsInTheWay) {
  v1::HostOrderAnswer answer;
  answer.mutable_refusal()->set_code("CELL-E9423");
  answer.mutable_refusal()->set_message("jobs run in REMOTE alone");
  answer.mutable_machine_refusal()->set_machine("machines/mill-1");
  for (const char* code : {"CELL-E9423", "CELL-E9433"}) {
    v1::StartBlocker& blocker = *answer.add_start_blockers();
    blocker.set_code(code);
    blocker.set_message(std::string("why ") + code);
  }
  google::rpc::Status rich;
  ASSERT_TRUE(rich.ParseFromString(RefusalOf(answer).error_details()));
  google::rpc::PreconditionFailure all;
  for (const google::protobuf::Any& one : rich.details()) one.UnpackTo(&all);
  ASSERT_EQ(all.violations_size(), 2);
  EXPECT_EQ(all.violations(0).type(), "CELL-E9423");
  EXPECT_EQ(all.violations(1).type(), "CELL-E9433");
  EXPECT_EQ(all.violations(1).subject(), "machines/mill-1");
  EXPECT_EQ(all.violations(1).description(), "why CELL-E9433");
  answer.clear_start_blockers();
  ASSERT_TRUE(rich.ParseFromString(RefusalOf(answer).error_details()));
  for (const google::protobuf::Any& one : rich.details())
    EXPECT_FALSE(one.Is<google::rpc::PreconditionFailure>());
}

// What the machine says of itself is asked for rightly, and stands in the way; another error is
// that of the call.
TEST(CallStatus, ARefusalOfTheMachineIsNoWrongCall) {
  struct Row {
    ErrorCode code;
    Severity severity;
    grpc::StatusCode status;
  };
  constexpr auto kInTheWay = grpc::StatusCode::FAILED_PRECONDITION;
  for (const Row& row :
       {Row{ErrorCode::kTargetOutOfTravel, Severity::kAlarm, kInTheWay},
        Row{ErrorCode::kFunctionMissing, Severity::kFatal, kInTheWay},
        Row{ErrorCode::kCmosFull, Severity::kMessage, kInTheWay},
        Row{ErrorCode::kBadCharacter, Severity::kCompile, grpc::StatusCode::INVALID_ARGUMENT},
        Row{ErrorCode::kCellNotFound, Lookup(ErrorCode::kCellNotFound).severity,
            grpc::StatusCode::NOT_FOUND}}) {
    ASSERT_EQ(Lookup(row.code).severity, row.severity);
    v1::HostOrderAnswer answer;
    answer.mutable_refusal()->set_code(CodeText(row.code));
    EXPECT_EQ(RefusalOf(answer).error_code(), row.status) << CodeText(row.code);
  }
}

TEST(CallStatus, HasCodeTextAndFindings) {
  const grpc::Status status =
      ToGrpcStatus(Error{ErrorCode::kCellNotFound, "jobs/7", {}}, Findings(2), Untold(3));
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(status.error_message(), bridge::ErrorText({ErrorCode::kCellNotFound, "jobs/7", {}}));
  const v1::ErrorDetail detail = DetailOf(status);
  EXPECT_EQ(detail.code(), "CELL-E9004");
  EXPECT_EQ(detail.message(), "jobs/7");
  EXPECT_EQ(detail.diagnostics_size(), 2);
  EXPECT_EQ(detail.diagnostics_dropped(), 3);
}

// A text of a thousand bytes is told whole, of a longer one its first thousand.
TEST(CallStatus, LongTextsAreCut) {
  const auto told = [](std::size_t size) {
    return DetailOf(ToGrpcStatus(Error{ErrorCode::kCellInvalidArgument, std::string(size, 'x'), {}},
                                 {}, {}))
        .message();
  };
  EXPECT_EQ(told(999), std::string(999, 'x'));
  EXPECT_EQ(told(1000), std::string(1000, 'x'));
  EXPECT_EQ(told(1001), std::string(1000, 'x') + "...");
  EXPECT_EQ(told(1'000'000), std::string(1000, 'x') + "...");
}

// What clients take of headers holds for the named values of a text, too.
TEST(CallStatus, LongNamedValuesAreLeftOut) {
  const auto status = [](std::size_t size) {
    return ToGrpcStatus(Error{ErrorCode::kCellInvalidArgument,
                              "no parameter '" + Told("parameter", std::string(size, 'x')) + "'",
                              {}});
  };
  EXPECT_EQ(DetailOf(status(100)).arguments_size(), 1);
  for (const std::size_t size : {std::size_t{4'000}, std::size_t{1'000'000}}) {
    EXPECT_LE(status(size).error_details().size(), std::size_t{6} << 10) << size;
    EXPECT_EQ(DetailOf(status(size)).arguments_size(), 0);
    EXPECT_EQ(status(size).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  }
}

// Findings are not what is too much then.
TEST(CallStatus, ALongNamedValueTakesNoFindingsAlong) {
  const Error error{ErrorCode::kLiteralRange, Told("text", std::string(9'000, 'x')), {}};
  const v1::ErrorDetail detail = DetailOf(ToGrpcStatus(error, Findings(3), {}));
  EXPECT_EQ(detail.arguments_size(), 0);
  EXPECT_EQ(detail.diagnostics_size(), 3);
}

// Of many findings the first are told, as many as fit in 6 KiB, and the others counted.
TEST(CallStatus, ManyFindingsAreCutAndCounted) {
  const Error error{ErrorCode::kLiteralRange, "SPEED 101", {}};
  for (const std::size_t count : {std::size_t{10}, std::size_t{100}, std::size_t{1000}}) {
    const grpc::Status status =
        ToGrpcStatus(error, Findings(count), Untold(5, ErrorCode::kLiteralRange));
    EXPECT_LE(status.error_details().size(), std::size_t{6} << 10) << count;
    const v1::ErrorDetail detail = DetailOf(status);
    EXPECT_GT(detail.diagnostics_size(), 0) << count;
    EXPECT_EQ(static_cast<std::size_t>(detail.diagnostics_size() + detail.diagnostics_dropped()),
              count + 5)
        << count;
    // Twice as many would not have fitted.
    const auto told = static_cast<std::size_t>(detail.diagnostics_size());
    const std::size_t twice_bytes =
        bridge::ToRpcStatus(error, Findings(told * 2 + 1), Untold(5, ErrorCode::kLiteralRange))
            .ByteSizeLong();
    EXPECT_TRUE(told == count || twice_bytes > std::size_t{6} << 10) << count;
  }
}

// One finding alone may be too much: then there is none, and it is counted.
TEST(CallStatus, AFindingThatDoesNotFitIsCounted) {
  std::vector<Diagnostic> findings = Findings(1);
  findings[0].detail = std::string(7 << 10, 'd');
  const v1::ErrorDetail detail =
      DetailOf(ToGrpcStatus(Error{ErrorCode::kLiteralRange, {}, {}}, findings, {}));
  EXPECT_EQ(detail.diagnostics_size(), 0);
  EXPECT_EQ(detail.diagnostics_dropped(), 1);
}

// limits.message_bytes holds for the message as it goes over the wire, and is no limit below.
TEST(CallSize, AMessageOfTheLimitPassesAndOneByteMoreDoesNot) {
  const Gate gate("secret");
  Executor executor(1);
  v1::ErrorDetail request;
  request.set_message(std::string(1000, 'x'));
  const auto size = static_cast<std::int64_t>(request.SerializeAsString().size());
  const auto check = [&](std::int64_t bytes_max) {
    return CheckRequest(
        {.gate = gate, .executor = executor, .compute = executor, .message_bytes_max = bytes_max},
        request);
  };
  EXPECT_TRUE(check(size + 1));
  EXPECT_TRUE(check(size));
  const Status refused = check(size - 1);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCellTooLarge);
  EXPECT_EQ(refused.error().detail.find("the message has " + std::to_string(size) +
                                        " bytes, one call takes " + std::to_string(size - 1)),
            0U)
      << refused.error().detail;
  EXPECT_NE(refused.error().detail.find("by chunks"), std::string::npos);
}

// LIVE-9.03, LIVE-9.04: what moves a machine says which request it is, what stops it need not; of
// what only reads nobody asks.
TEST(CallRequestId, IsAskedForWhereTheContractRequiresIt) {
  const Gate gate("secret");
  Executor executor(1);
  const auto check = [&](const google::protobuf::Message& request) {
    return CheckRequest(
        {.gate = gate, .executor = executor, .compute = executor, .message_bytes_max = 1000},
        request);
  };
  v1::StartMachineRequest start;
  const Status refused = check(start);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(refused.error().detail.find("request_id: "), 0U);
  start.set_request_id("one");
  EXPECT_TRUE(check(start));
  EXPECT_TRUE(check(v1::StopMachineRequest()));
  EXPECT_TRUE(check(v1::SubmitJobRequest()));
  EXPECT_TRUE(check(v1::GetMachineRequest()));
}

// A lane that is full is a bound that is reached: it may go better later.
TEST(CallStatus, AFullLaneIsExhausted) {
  EXPECT_EQ(LaneFull().code, ErrorCode::kCellResourceExhausted);
  EXPECT_EQ(ToGrpcStatus(LaneFull()).error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
}

// account.proto GetCaller: who calls, and what he may; what is for a later version says so.
TEST(CallAccount, SaysWhoCallsAndWhatHeMay) {
  const Gate gate("secret");
  Executor executor(1);
  AccountService service(
      {.gate = gate, .executor = executor, .compute = executor, .message_bytes_max = 1000});
  grpc::ServerBuilder builder;
  builder.RegisterService(&service);
  const auto server = builder.BuildAndStart();
  const auto stub = v1::AccountService::NewStub(server->InProcessChannel({}));
  grpc::ClientContext context;
  v1::GetCallerResponse caller;
  ASSERT_TRUE(stub->GetCaller(&context, {}, &caller).ok());
  EXPECT_EQ(caller.name(), "local");
  ASSERT_EQ(caller.grants_size(), 1);
  const auto& may = caller.grants(0).permissions();
  EXPECT_EQ(std::vector<int>(may.begin(), may.end()),
            (std::vector<int>{v1::PERMISSION_VIEW, v1::PERMISSION_STOP, v1::PERMISSION_PROGRAM,
                              v1::PERMISSION_OPERATE, v1::PERMISSION_ADMINISTER}));
  grpc::ClientContext later;
  v1::ListUsersResponse users;
  const grpc::Status status = stub->ListUsers(&later, {}, &users);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::UNIMPLEMENTED);
  EXPECT_EQ(DetailOf(status).code(), "CELL-E9014");
  server->Shutdown(std::chrono::system_clock::now());
  server->Wait();
}

}  // namespace
}  // namespace rmlcell::server
