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
    std::vector<v1::HostOrderAnswer> of_jobs{};
    std::chrono::nanoseconds since{0};
  };

  // `of_a_job`: its queue asks again where it hears nothing, and would take a refusal for a run
  // that never began.
  void Add(v1::HostOrderAnswer answer, bool of_a_job) {
    (of_a_job ? next_of_jobs_ : next_).push_back(std::move(answer));
  }
  // The line to the server is gone, whose orders have numbers above 0: what is asked over the next
  // one is something else.
  void ForgetLine() {
    const auto of_the_line = [](const auto& answer) { return answer.number() > 0; };
    std::erase_if(next_, of_the_line);
    std::erase_if(next_of_jobs_, of_the_line);
    for (const auto& batch : under_way_) {
      std::erase_if(batch->answers, of_the_line);
      std::erase_if(batch->of_jobs, of_the_line);
    }
  }

  // Of what is written from now on.
  std::shared_ptr<Batch> Begin(std::chrono::nanoseconds now) {
    auto batch = std::make_shared<Batch>(Batch{.answers = std::exchange(next_, {}),
                                               .of_jobs = std::exchange(next_of_jobs_, {}),
                                               .since = now});
    if (!batch->answers.empty() || !batch->of_jobs.empty()) under_way_.push_back(batch);
    return batch;
  }
  void End(const std::shared_ptr<Batch>& batch) { under_way_.remove(batch); }

  // Of writes that take longer than `patience`: whoever asked has waited for long enough, and is
  // told that it acts, and no more.
  std::vector<v1::HostOrderAnswer> TakeLate(std::chrono::nanoseconds now,
                                            std::chrono::nanoseconds patience) {
    std::vector<v1::HostOrderAnswer> late;
    for (const auto& batch : under_way_) {
      if (now - batch->since <= patience) break;
      for (v1::HostOrderAnswer& answer : std::exchange(batch->answers, {})) {
        *answer.mutable_refusal() = bridge::ToErrorDetail(
            {ErrorCode::kCellJournal, "it acts, but the disk does not answer", {}});
        late.push_back(std::move(answer));
      }
    }
    return late;
  }

 private:
  std::vector<v1::HostOrderAnswer> next_;
  std::vector<v1::HostOrderAnswer> next_of_jobs_;
  std::list<std::shared_ptr<Batch>> under_way_;  // the oldest first
};

}  // namespace rmlcell::server
