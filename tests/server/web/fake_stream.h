#pragma once

#include <grpcpp/support/server_callback.h>

#include <functional>
#include <mutex>
#include <set>
#include <utility>

#include "tests/server/web/fake_cell.h"

namespace rmlcell::web::testing {

// What a stream does after a message.
enum class Step { kMessage, kEnd, kWait };

// A stream that makes its next message when the last was taken. It waits, when told to, until Wake
// is called or the client leaves.
template <class Response>
class FakeStream : public grpc::ServerWriteReactor<Response> {
 public:
  // Fills in the next message, or sets the status of the end.
  using Next = std::function<Step(Response& response, grpc::Status& end)>;

  FakeStream(Counters& counters, Next next) : counters_(counters), next_(std::move(next)) {
    ++counters_.calls;
    ++counters_.open;
  }

  // Runs the script on after the constructor or after kWait.
  void Advance() {
    {
      const std::lock_guard lock(mutex_);
      if (busy_ || finished_) return;
      busy_ = true;
    }
    Continue();
  }

  void OnWriteDone(bool ok) override {
    if (!ok) {
      const std::lock_guard lock(mutex_);
      cancelled_ = true;
    }
    Continue();
  }

  void OnCancel() override {
    {
      const std::lock_guard lock(mutex_);
      cancelled_ = true;
      if (busy_ || finished_) return;
      busy_ = true;
    }
    Continue();
  }

  void OnDone() override {
    if (cancelled_) ++counters_.cancelled;
    if (on_done) on_done();
    --counters_.open;
    delete this;
  }

  std::function<void()> on_done;

 private:
  // Exactly one thread is here, or a write is under way, while busy_ is set.
  void Continue() {
    grpc::Status end = grpc::Status::OK;
    while (true) {
      {
        const std::lock_guard lock(mutex_);
        if (cancelled_) {
          finished_ = true;
          end = grpc::Status::CANCELLED;
          break;
        }
      }
      response_.Clear();
      const Step step = next_(response_, end);
      if (step == Step::kMessage) {
        this->StartWrite(&response_);
        return;
      }
      const std::lock_guard lock(mutex_);
      if (step == Step::kEnd) {
        finished_ = true;
        break;
      }
      if (!cancelled_) {
        busy_ = false;
        return;
      }
    }
    this->Finish(end);
  }

  Counters& counters_;
  Next next_;
  Response response_;
  std::mutex mutex_;
  bool busy_ = false;       // guarded by mutex_
  bool cancelled_ = false;  // guarded by mutex_
  bool finished_ = false;   // guarded by mutex_
};

}  // namespace rmlcell::web::testing
