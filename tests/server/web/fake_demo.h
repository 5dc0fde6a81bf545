#pragma once

#include <cstdint>
#include <string>

namespace rmlcell::v1 {
class ExplainErrorResponse;
class Job;
class WatchCellResponse;
}  // namespace rmlcell::v1

namespace rmlcell::web::testing {

// What WatchCell tells: snapshots of jobs in every state and of two machines, then a running job
// that makes progress and ends.
class DemoStory {
 public:
  explicit DemoStory(std::int64_t after_sequence) : sequence_(after_sequence) {}

  // False: nothing to tell just now.
  bool Next(v1::WatchCellResponse& response);

 private:
  std::int64_t sequence_;
  int tick_ = 0;
};

// The running job of the story when it has ended.
void EndOfDemoJob(v1::Job& job);

// Rows of the real catalogue, as the server gives them.
void Explain(const std::string& code, v1::ExplainErrorResponse& response);

}  // namespace rmlcell::web::testing
