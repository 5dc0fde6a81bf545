#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <random>
#include <thread>

#include "tests/server/forwarding_store.h"

namespace rmlcell::server {

// A store as a network and a busy database make it: of the calls that workers cause some fail
// before anything is done and some when it is done already, and hints are lost, late or come twice.
// Thread-safe.
class FaultyStore final : public ForwardingStore {
 public:
  // Of `one_in` calls one fails before, and one behind; of the hints every third is lost.
  FaultyStore(storage::Store& store, unsigned seed, unsigned one_in)
      : ForwardingStore(store), random_(seed), one_in_(one_in) {}

  // From now on nothing fails.
  void Heal() { healed_ = true; }
  int failures() const { return failures_; }

  std::unique_ptr<Subscription> Watch(std::function<void()> changed) override {
    return std::make_unique<LateHints>(*this, std::move(changed));
  }
  std::int64_t AwaitJobs(storage::JobRequest request,
                         storage::Done<std::vector<storage::LeasedJob>> done) override {
    const When when = Draw();
    if (when == When::kBefore) {
      done(Away());
      return 0;
    }
    return store_.AwaitJobs(std::move(request), [when, done = std::move(done)](auto leased) {
      if (when == When::kBehind) return done(Away());
      done(std::move(leased));
    });
  }
  Result<storage::JobRecord> Renew(const storage::Lease& lease,
                                   std::chrono::milliseconds duration) override {
    return Try([&] { return store_.Renew(lease, duration); });
  }
  void Append(const storage::Lease& lease, std::vector<storage::NewEvent> events,
              std::function<void(Result<std::int64_t>)> done) override {
    const When when = Draw();
    if (when == When::kBefore) return done(Away());
    store_.Append(lease, std::move(events),
                  [when, done = std::move(done)](const Result<std::int64_t>& written) {
                    done(when == When::kBehind ? Result<std::int64_t>(Away()) : written);
                  });
  }
  Result<storage::JobRecord> Finish(const storage::Lease& lease,
                                    const storage::JobEnd& end) override {
    return Try([&] { return store_.Finish(lease, end); });
  }
  Result<storage::JobRecord> AddProducts(std::int64_t job,
                                         const storage::LateProducts& products) override {
    return Try([&] { return store_.AddProducts(job, products); });
  }
  Result<storage::JobRecord> HandBack(const storage::Lease& lease,
                                      const storage::LossPolicy& policy) override {
    return Try([&] { return store_.HandBack(lease, policy); });
  }
  Result<storage::JobRecord> Abandon(const storage::Lease& lease,
                                     const storage::LossPolicy& policy) override {
    return Try([&] { return store_.Abandon(lease, policy); });
  }
  Result<std::vector<storage::JobRecord>> Expire(const storage::LossPolicy& policy) override {
    return Try([&] { return store_.Expire(policy); });
  }
  Result<storage::MachineMemory> GetMachineMemory(std::string_view machine,
                                                  const WantsPrograms& wants_programs) override {
    return Try([&] { return store_.GetMachineMemory(machine, wants_programs); });
  }
  Result<std::vector<storage::TakenOrder>> TakeOrders(std::string_view server) override {
    // What was taken and did not arrive is gone: that is what "once" means. So it fails before.
    if (Draw() != When::kNever) return Away();
    return store_.TakeOrders(server);
  }

 private:
  enum class When { kNever, kBefore, kBehind };

  // Passes on two of three hints, every fifth twice, and within a third of a second the others.
  class LateHints final : public Subscription {
   public:
    LateHints(FaultyStore& store, std::function<void()> changed)
        : store_(store), changed_(std::move(changed)) {
      late_ = std::jthread([this](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
          {
            std::unique_lock lock(mutex_);
            wake_.wait_for(lock, stop, std::chrono::milliseconds(300), [] { return false; });
          }
          if (lost_.exchange(false)) Tell();
        }
      });
      inner_ = store.store_.Watch([this] {
        const unsigned roll = store_.Roll(15);
        if (roll % 3 == 0) {
          lost_ = true;
        } else {
          Tell();
          if (roll % 5 == 1) Tell();
        }
      });
    }
    ~LateHints() override {
      inner_.reset();
      late_.request_stop();
      wake_.notify_all();
      late_.join();
    }

   private:
    void Tell() {
      const std::lock_guard calling(calling_);
      changed_();
    }

    FaultyStore& store_;
    std::function<void()> changed_;
    std::atomic<bool> lost_ = false;
    std::mutex calling_;
    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::jthread late_;
    std::unique_ptr<Subscription> inner_;
  };

  static Error Away() { return {ErrorCode::kCellStoreUnavailable, "the line broke", {}}; }

  unsigned Roll(unsigned sides) {
    const std::lock_guard lock(mutex_);
    return static_cast<unsigned>(random_() % sides);
  }
  When Draw() {
    if (healed_) return When::kNever;
    const unsigned roll = Roll(one_in_);
    if (roll > 1) return When::kNever;
    ++failures_;
    return roll == 0 ? When::kBefore : When::kBehind;
  }

  template <class Call>
  auto Try(Call call) -> decltype(call()) {
    const When when = Draw();
    if (when == When::kBefore) return Away();
    auto done = call();
    if (when == When::kBehind) return Away();
    return done;
  }

  std::mutex mutex_;
  std::mt19937 random_;
  unsigned one_in_;
  std::atomic<bool> healed_ = false;
  std::atomic<int> failures_ = 0;
};

}  // namespace rmlcell::server
