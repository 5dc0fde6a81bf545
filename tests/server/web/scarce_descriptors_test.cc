// The web port of a process that can open nothing for a while.
#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <chrono>
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

// web_server.h: each time of waiting is told once, however long it takes.
TEST(ScarceDescriptors, EachTimeOfWaitingIsToldOnce) {
  std::array<std::promise<std::string>, 64> told;  // more than there is time for
  std::array<std::future<std::string>, 64> heard;
  for (std::size_t i = 0; i < told.size(); ++i) heard[i] = told[i].get_future();
  std::size_t count = 0;  // of the thread that takes connections
  FakeResources resources;
  const auto web = WebServer::Start(AnyPort(), nullptr, resources, {}, [&](const std::string& why) {
    told.at(count++).set_value(why);
  });
  ASSERT_TRUE(web) << web.error().detail;
  for (const std::size_t round : {0U, 1U, 2U}) {
    RawClient client;
    {
      const NoDescriptors none;
      client.Connect((*web)->port());
      EXPECT_TRUE(client.Send(Get("/favicon.svg")));
      EXPECT_EQ(heard[round].wait_for(std::chrono::minutes(1)), std::future_status::ready) << round;
      EXPECT_EQ(heard[round + 1].wait_for(std::chrono::milliseconds(400)),
                std::future_status::timeout)
          << round;
    }
    EXPECT_EQ(client.Read().status, 200) << round;
  }
}

}  // namespace
}  // namespace rmlcell::web::testing
