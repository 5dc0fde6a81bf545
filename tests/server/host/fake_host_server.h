#pragma once

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <iterator>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "rmlcell/v1/host.grpc.pb.h"
#include "server/base/credentials.h"
#include "tests/server/host/patient_host.h"

namespace rmlcell::server {

// Welcomes one host after the other, and notes what it is told.
class FakeHostServer final : public v1::HostService::Service {
 public:
  explicit FakeHostServer(const std::string& address) : address_(address) {
    grpc::ServerBuilder builder;
    builder.AddListeningPort(address, CredentialsOfServer());
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
  }
  // All lines end with it, also one that is taken up again at this moment.
  ~FakeHostServer() override { server_->Shutdown(std::chrono::system_clock::now()); }
  grpc::Status Host(grpc::ServerContext* context,
                    grpc::ServerReaderWriter<v1::HostResponse, v1::HostRequest>* stream) override {
    v1::HostRequest request;
    stream->Read(&request);
    {
      const std::lock_guard lock(mutex_);
      told_.push_back(request);
      changed_.notify_all();
      if (!refusal_.ok()) return refusal_;
      if (!next_refusal_.ok()) return std::exchange(next_refusal_, grpc::Status::OK);
      v1::HostResponse response;
      *response.mutable_welcome() = welcome_;
      stream->Write(response);
      if (orders_at_once) {
        response.mutable_order()->set_number(1);
        response.mutable_order()->mutable_start();
        stream->Write(response);
      }
      stream_ = stream;
      context_ = context;
    }
    while (stream->Read(&request)) {
      const std::lock_guard lock(mutex_);
      if (request.has_heartbeat()) {  // else it would be silent
        v1::HostResponse beat;
        beat.mutable_heartbeat()->set_number(request.heartbeat().number());
        stream->Write(beat);
      }
      told_.push_back(request);
      changed_.notify_all();
    }
    const std::lock_guard lock(mutex_);
    if (stream_ == stream) stream_ = nullptr;
    if (context_ == context) context_ = nullptr;
    ++ended_;
    changed_.notify_all();
    return grpc::Status::OK;
  }
  void Welcome(const v1::HostWelcome& welcome) {
    const std::lock_guard lock(mutex_);
    welcome_ = welcome;
  }
  // Whoever comes from now on; it may be one that comes again and again.
  void Refuse(const grpc::Status& refusal) {
    const std::lock_guard lock(mutex_);
    refusal_ = refusal;
  }
  // The next one that comes; who comes behind it is welcome.
  void RefuseOnce(const grpc::Status& refusal) {
    const std::lock_guard lock(mutex_);
    next_refusal_ = refusal;
  }
  void Tell(const v1::HostResponse& response) {
    std::unique_lock lock(mutex_);
    Await(lock, [this] { return stream_ != nullptr; });
    stream_->Write(response);
  }
  void Order(std::int64_t number) {
    v1::HostResponse response;
    response.mutable_order()->set_number(number);
    response.mutable_order()->mutable_start();
    Tell(response);
  }
  // Those of a kind, as soon as there are so many.
  std::vector<v1::HostRequest> Told(v1::HostRequest::MessageCase kind, std::size_t count) {
    std::unique_lock lock(mutex_);
    std::vector<v1::HostRequest> found;
    Await(lock, [&] {
      found.clear();
      std::ranges::copy_if(told_, std::back_inserter(found), [&](const v1::HostRequest& request) {
        return request.message_case() == kind;
      });
      return found.size() >= count;
    });
    return found;
  }
  // All of them, in order.
  std::vector<v1::HostRequest> Told() {
    const std::lock_guard lock(mutex_);
    return told_;
  }
  void EndLine() {
    const std::lock_guard lock(mutex_);
    if (context_ != nullptr) context_->TryCancel();
  }
  void AwaitEnds(int count) {
    std::unique_lock lock(mutex_);
    Await(lock, [&] { return ended_ >= count; });
  }
  const std::string& address() const { return address_; }

  bool orders_at_once = false;  // with its welcome

 private:
  static v1::HostWelcome OfFence7() {
    v1::HostWelcome welcome;
    welcome.set_fence(7);
    return welcome;
  }
  template <class Condition>
  void Await(std::unique_lock<std::mutex>& lock, Condition condition) {
    EXPECT_TRUE(changed_.wait_for(lock, kComesWithin, condition));
  }

  const std::string address_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<v1::HostRequest> told_;
  v1::HostWelcome welcome_ = OfFence7();
  grpc::Status refusal_{};  // guarded by mutex_, as all of these
  grpc::Status next_refusal_{};
  grpc::ServerReaderWriter<v1::HostResponse, v1::HostRequest>* stream_ = nullptr;
  grpc::ServerContext* context_ = nullptr;
  int ended_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

}  // namespace rmlcell::server
