#pragma once

#include <chrono>
#include <cstdint>
#include <list>
#include <memory>
#include <utility>
#include <vector>

#include "proto/bridge/findings.h"
#include "rmlcell/v1/host.pb.h"

namespace rmlcell::server {

// Answers that wait until what they tell of is on the disk. LIVE-3.21
class AnswersDue {
 public:
  // With one write.
  struct Batch {
    std::vector<v1::HostOrderAnswer> answers{};
    std::chrono::nanoseconds since{0};
  };

  void Add(v1::HostOrderAnswer answer) { next_.push_back(std::move(answer)); }
  // The line to the server is gone, whose orders have numbers above 0: what is asked over the next
  // one is something else.
  void ForgetLine() {
    const auto of_the_line = [](const auto& answer) { return answer.number() > 0; };
    std::erase_if(next_, of_the_line);
    for (const auto& batch : under_way_) std::erase_if(batch->answers, of_the_line);
  }

  // Of what is written from now on.
  std::shared_ptr<Batch> Begin(std::chrono::nanoseconds now) {
    auto batch = std::make_shared<Batch>(Batch{.answers = std::exchange(next_, {}), .since = now});
    if (!batch->answers.empty()) under_way_.push_back(batch);
    return batch;
  }
  void End(const std::shared_ptr<Batch>& batch) { under_way_.remove(batch); }

  // Of writes that take longer than `patience`: whoever asked has waited for long enough, and is
  // told that it acts, and no more.
  std::vector<v1::HostOrderAnswer> TakeLate(std::chrono::nanoseconds now,
                                            std::chrono::nanoseconds patience) {
    std::vector<v1::HostOrderAnswer> late;
    while (!under_way_.empty() && now - under_way_.front()->since > patience) {
      for (v1::HostOrderAnswer& answer : std::exchange(under_way_.front()->answers, {})) {
        *answer.mutable_refusal() = bridge::ToErrorDetail(
            {ErrorCode::kCellJournal, "it acts, but the disk does not answer", {}});
        late.push_back(std::move(answer));
      }
      under_way_.pop_front();
    }
    return late;
  }

 private:
  std::vector<v1::HostOrderAnswer> next_;
  std::list<std::shared_ptr<Batch>> under_way_;  // the oldest first
};

}  // namespace rmlcell::server
