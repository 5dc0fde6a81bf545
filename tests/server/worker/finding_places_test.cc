// How many places of a kind of finding are known, so that each is told once.
#include <gtest/gtest.h>

#include <vector>

#include "server/worker/job_events.h"

namespace rmlcell::server {
namespace {

// A thousand of each kind; what comes behind them counts each time that it comes.
TEST(FindingPlaces, AThousandAreKnown) {
  std::vector<v1::JobEvent> sent;
  JobEvents events([&sent](const v1::WorkerEvents& batch) {
    sent.insert(sent.end(), batch.events().begin(), batch.events().end());
  });
  const auto find = [&events](int step) {
    Diagnostic finding;
    finding.code = ErrorCode::kHoleRadiusZero;
    finding.step = step;
    events.OnDiagnostic(SimTime(step), finding);
  };
  for (int twice = 0; twice < 2; ++twice) {
    for (int step = 1; step <= 1'000; ++step) find(step);
  }
  for (int time = 0; time < 3; ++time) find(1'001);
  events.TellRest();
  events.Flush();
  ASSERT_EQ(sent.size(), 6U);
  EXPECT_EQ(sent.back().gathered().count(), 995 + 3);
  EXPECT_EQ(sent.back().gathered().first().step(), 6);
  EXPECT_EQ(sent.back().gathered().last().step(), 1'001);
}

}  // namespace
}  // namespace rmlcell::server
