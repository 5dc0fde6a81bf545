// What the lines of a host carry, and how much of it (live.md 3.06).
#include <gtest/gtest.h>
#include <unistd.h>

#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>

#include "server/host/further_lines.h"
#include "server/host/host_line.h"
#include "tests/server/host/fake_host_server.h"

namespace rmlcell::server {
namespace {

class LineBounds : public testing::Test {
 protected:
  LineBounds() : folder_(testing::TempDir() + "/line-bounds-" + std::to_string(::getpid())) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    server_ = std::make_unique<FakeHostServer>("unix:" + folder_ + "/a");
  }
  ~LineBounds() override {
    server_.reset();
    std::filesystem::remove_all(folder_);
  }
  template <class Condition>
  bool Eventually(Condition condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kComesWithin, condition);
  }
  // So many orders have come, whatever became of them.
  bool HasHeard(std::size_t count) {
    return Eventually([&] {
      const WaitingMessages::Taken taken = lines_.TakeMessages();
      heard_ += taken.messages.size() + taken.refused.size() + taken.stops.size();
      return heard_ >= count;
    });
  }

  const std::string folder_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t heard_ = 0;
  std::unique_ptr<FakeHostServer> server_;
  FurtherLines lines_{[this] {
                        const std::lock_guard lock(mutex_);
                        changed_.notify_all();
                      },
                      kComesWithin};
};

// A server that was lost and is found again sees the handbox again.
TEST_F(LineBounds, AServerThatIsFoundAgainSeesTheHandbox) {
  lines_.Keep({server_->address()}, {});
  ASSERT_TRUE(Eventually([this] { return lines_.TakeFresh(); }));
  server_->EndLine();
  server_->Told(v1::HostRequest::kHello, 2);
  ASSERT_TRUE(Eventually([this] { return lines_.TakeFresh(); }));
  v1::HandboxPanel panel;
  panel.set_display("P=45");
  lines_.SendPanel(panel);
  EXPECT_EQ(server_->Told(v1::HostRequest::kPanel, 1)[0].panel().display(), "P=45");
}

// Of 10,000 that nobody has answered the oldest is given up for the next one.
TEST_F(LineBounds, TenThousandOrdersAreWaitedFor) {
  lines_.Keep({server_->address()}, {});
  ASSERT_TRUE(Eventually([this] { return lines_.TakeFresh(); }));
  for (std::int64_t order = 1; order <= 10'000; ++order) server_->Order(order);
  ASSERT_TRUE(HasHeard(10'000));
  EXPECT_TRUE(lines_.IsAskedFor(-1));
  EXPECT_TRUE(lines_.IsAskedFor(-10'000));
  server_->Order(10'001);
  ASSERT_TRUE(HasHeard(10'001));
  EXPECT_FALSE(lines_.IsAskedFor(-1));
  EXPECT_TRUE(lines_.IsAskedFor(-2));
  EXPECT_TRUE(lines_.IsAskedFor(-10'001));
}

// The state of a machine comes whole, however large it is.
TEST_F(LineBounds, AWelcomeMayBeLarge) {
  v1::HostWelcome welcome;
  welcome.set_fence(7);
  welcome.mutable_mark()->set_state(std::string(std::size_t{6} << 20, 's'));
  server_->Welcome(welcome);
  const auto joined = HostLine::Join(
      server_->address(), {}, [](const v1::HostResponse&) {}, [] {});
  ASSERT_TRUE(joined) << joined.error().detail;
  EXPECT_EQ(joined->message.mark().state().size(), std::size_t{6} << 20);
}

}  // namespace
}  // namespace rmlcell::server
