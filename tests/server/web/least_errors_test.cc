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

}  // namespace
}  // namespace rmlcell::web
