// What of an error still fits a header, to the byte: 6 KiB of details.
#include <gtest/gtest.h>

#include "google/rpc/status.pb.h"
#include "proto/bridge/findings.h"
#include "rmlcell/v1/common.pb.h"
#include "server/services/call.h"

namespace rmlcell::server {
namespace {

constexpr std::size_t kSixKibibytes = 6144;

v1::ErrorDetail ToldIn(const grpc::Status& status) {
  google::rpc::Status rich;
  v1::ErrorDetail detail;
  EXPECT_TRUE(rich.ParseFromString(status.error_details()));
  EXPECT_TRUE(rich.details(1).UnpackTo(&detail));
  return detail;
}

// With a value that stands beside the text and makes the whole so many bytes.
Error OfBytes(std::size_t bytes) {
  std::string value(bytes - 1000, 'v');
  const auto made = [&value] {
    Detail detail = "a text";
    detail += Detail("", {"name", value, ""});
    return Error{ErrorCode::kCellNotFound, std::move(detail), {}};
  };
  const std::size_t size = bridge::ToRpcStatus(made(), {}, {}).ByteSizeLong();
  value.resize(value.size() + bytes - size);
  EXPECT_EQ(bridge::ToRpcStatus(made(), {}, {}).ByteSizeLong(), bytes);
  return made();
}

TEST(ErrorSizes, ValuesAreToldAsLongAsThereIsRoom) {
  const grpc::Status fits = ToGrpcStatus(OfBytes(kSixKibibytes));
  EXPECT_EQ(fits.error_details().size(), kSixKibibytes);
  EXPECT_EQ(ToldIn(fits).arguments_size(), 1);
  const v1::ErrorDetail cut = ToldIn(ToGrpcStatus(OfBytes(kSixKibibytes + 1)));
  EXPECT_EQ(cut.arguments_size(), 0);
  EXPECT_EQ(cut.message(), "a text");
}

TEST(ErrorSizes, FindingsAreToldAsLongAsThereIsRoom) {
  const Error error{ErrorCode::kLiteralRange, "SPEED 101", {}};
  const auto findings = [&](std::size_t bytes) {
    std::vector<Diagnostic> all(
        2, {.code = ErrorCode::kLiteralRange, .severity = Severity::kAlarm, .detail = "d"});
    all[1].detail = std::string(bytes - 2000, 'd');
    const std::size_t size = bridge::ToRpcStatus(error, all, {}).ByteSizeLong();
    all[1].detail = std::string(bytes - 2000 + bytes - size, 'd');
    EXPECT_EQ(bridge::ToRpcStatus(error, all, {}).ByteSizeLong(), bytes);
    return all;
  };
  const v1::ErrorDetail both = ToldIn(ToGrpcStatus(error, findings(kSixKibibytes)));
  EXPECT_EQ(both.diagnostics_size(), 2);
  EXPECT_EQ(both.diagnostics_dropped(), 0);
  const v1::ErrorDetail one = ToldIn(ToGrpcStatus(error, findings(kSixKibibytes + 1)));
  EXPECT_EQ(one.diagnostics_size(), 1);
  EXPECT_EQ(one.diagnostics_dropped(), 1);
  EXPECT_EQ(one.diagnostics(0).message(), "d");
}

}  // namespace
}  // namespace rmlcell::server
