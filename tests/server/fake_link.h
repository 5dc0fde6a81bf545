#pragma once

#include <gtest/gtest.h>

#include <mutex>
#include <optional>
#include <vector>

#include "server/machines/hosts.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {

// What the server says to a host.
class FakeLink final : public HostLink {
 public:
  void Send(v1::HostResponse message) override {
    const std::lock_guard lock(mutex_);
    messages_.push_back(std::move(message));
  }
  void Close(const Error& why) override {
    const std::lock_guard lock(mutex_);
    closed_ = why;
  }
  std::vector<v1::HostResponse> All() const {
    const std::lock_guard lock(mutex_);
    return messages_;
  }
  // The newest of a kind, once there is one.
  std::optional<v1::HostResponse> Newest(v1::HostResponse::MessageCase kind) const {
    std::optional<v1::HostResponse> newest;
    EXPECT_TRUE(Eventually([&] {
      for (const v1::HostResponse& message : All()) {
        if (message.message_case() == kind) newest = message;
      }
      return newest.has_value();
    }));
    return newest;
  }
  bool closed() const {
    const std::lock_guard lock(mutex_);
    return closed_.has_value();
  }

 private:
  mutable std::mutex mutex_;
  std::vector<v1::HostResponse> messages_;
  std::optional<Error> closed_;
};

}  // namespace rmlcell::server
