// An error without details has none in its answer, in either form of JSON.
#include <google/rpc/status.pb.h>
#include <gtest/gtest.h>

#include <string>

#include "server/web/rpc_status.h"

namespace rmlcell::web {
namespace {

TEST(LeastErrors, WithoutDetailsThereAreNone) {
  google::rpc::Status rich;
  rich.set_code(5);
  rich.set_message("no such job");
  const RpcStatus status{.code = 5, .message = rich.message(), .details = rich.SerializeAsString()};
  ASSERT_FALSE(status.details.empty());
  const std::string plain = R"({"code":"not_found","message":"no such job"})";
  EXPECT_EQ(ConnectErrorJson(status), plain);
  EXPECT_EQ(PlainErrorJson(status), plain);
}

// Where a caller's request is to blame whatever the error is by itself.
TEST(LeastErrors, ACodeThatIsGivenStandsInTheDetails) {
  const Error error{ErrorCode::kCellNotFound, "jobs/7", {}};
  const RpcStatus own = FromError(error);
  const RpcStatus given = FromError(error, 3);
  google::rpc::Status rich;
  ASSERT_TRUE(rich.ParseFromString(own.details));
  EXPECT_EQ(rich.code(), 5);
  ASSERT_TRUE(rich.ParseFromString(given.details));
  EXPECT_EQ(rich.code(), 3);
  EXPECT_EQ(given.code, 3);
  EXPECT_EQ(given.message, own.message);
  EXPECT_EQ(rich.message(), own.message);
}

}  // namespace
}  // namespace rmlcell::web
