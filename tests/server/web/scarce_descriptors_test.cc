// The web port of a process that can open nothing for a while.
#include <gtest/gtest.h>

#include <cerrno>
#include <cstring>
#include <future>
#include <string>

#include "tests/server/no_descriptors.h"
#include "tests/server/web/fake_cell.h"
#include "tests/server/web/raw_client.h"

namespace rmlcell::web::testing {
namespace {

// Who comes meanwhile waits, which is told, and is served when there is a descriptor again; so is
// who comes later.
TEST(ScarceDescriptors, WhoComesMeanwhileIsServedLater) {
  FakeResources resources;
  std::promise<std::string> told;  // more than once would throw
  const auto web = WebServer::Start(AnyPort(), nullptr, resources, {},
                                    [&told](const std::string& why) { told.set_value(why); });
  ASSERT_TRUE(web) << web.error().detail;
  const int port = (*web)->port();
  RawClient client;
  {
    const NoDescriptors none;
    client.Connect(port);
    EXPECT_TRUE(client.Send(Get("/favicon.svg")));
    EXPECT_EQ(told.get_future().get(), std::strerror(EMFILE));
  }
  EXPECT_EQ(client.Read().status, 200);
  EXPECT_EQ(Exchange(port, Get("/favicon.svg")).status, 200);
}

}  // namespace
}  // namespace rmlcell::web::testing
