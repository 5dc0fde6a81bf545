// `rmlcell machine log`: how far it reads the log of the cell.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "clients/cli/messages.h"
#include "rmlcell/v1/cell.grpc.pb.h"
#include "tests/clients/cli/fake_machine.h"

namespace rmlcell::cli {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct FakeLog final : v1::CellService::Service {
  explicit FakeLog(CallNotes& notes) : calls(notes) {}
  grpc::Status WatchCell(grpc::ServerContext*, const v1::WatchCellRequest* request,
                         grpc::ServerWriter<v1::WatchCellResponse>* writer) override {
    calls.Add("WatchCell", *request);
    for (const v1::WatchCellResponse& one : told) writer->Write(one);
    return end;
  }
  CallNotes& calls;
  std::vector<v1::WatchCellResponse> told{};
  grpc::Status end{};
};

class MachineLogVerbTest : public MachineWords {
 protected:
  MachineLogVerbTest() {
    server_.reset();
    server_ = std::make_unique<FakeServer>(folder_, std::vector<grpc::Service*>{&machine_, &log_});
    machine_.watched.emplace_back().set_sequence(2);
    Happens(1).mutable_run_begun()->set_run(3);
    Happens(1).mutable_changed();  // nothing that belongs there
    Happens(2).mutable_run_begun()->set_run(4);
    Happens(3).mutable_run_begun()->set_run(5);
  }
  // A call may still be answered: the server goes before the log.
  ~MachineLogVerbTest() override { server_.reset(); }
  v1::MachineEvent& Happens(int sequence) {
    v1::WatchCellResponse& made = log_.told.emplace_back();
    made.set_sequence(sequence);
    made.mutable_event()->mutable_time()->set_nanos(7'000'000);
    return *made.mutable_event()->mutable_machine();
  }
  static std::string Line(int run) {
    return When({}) + ".007  run " + std::to_string(run) + " begins\n";
  }
  const std::string asked_ =
      "WatchMachine name: \"machines/m\"\n"
      "WatchCell subscriptions { id: \"machine\" machines { names: \"machines/m\" } } "
      "after_sequence: 0\n";

  FakeLog log_{calls_};
};

TEST_F(MachineLogVerbTest, GoesToWhatHappenedLast) {
  const Told told = Say("log m");
  EXPECT_EQ(told.exit_code, kGood) << told.errors;
  EXPECT_EQ(told.output, Line(3) + Line(4));
  EXPECT_EQ(told.errors, "");
  EXPECT_EQ(Calls(), asked_);
}

TEST_F(MachineLogVerbTest, NothingHasHappened) {
  machine_.watched[0].set_sequence(0);
  EXPECT_EQ(Say("log m").output, "");
  EXPECT_EQ(Calls(), "WatchMachine name: \"machines/m\"\n");
  EXPECT_EQ(Say("log m --follow").output, Line(3) + Line(4) + Line(5));
}

TEST_F(MachineLogVerbTest, FollowsToTheEndOfTheServer) {
  log_.told[2].clear_what();
  log_.told[2].mutable_gap();
  Told told = Say("log m --follow");
  EXPECT_EQ(told.exit_code, kGood);
  EXPECT_EQ(told.output, Line(3) + Line(5));
  EXPECT_EQ(told.errors, "rmlcell: events are missing here: the log was cut meanwhile\n");
  log_.end = {grpc::StatusCode::ABORTED, "it ends"};
  told = Say("log m --follow", true);
  EXPECT_EQ(told.exit_code, kConnection);
  EXPECT_EQ(std::ranges::count(told.output, '\n'), 3);
  EXPECT_THAT(told.output, StartsWith("{"));
  EXPECT_THAT(told.errors, HasSubstr("rmlcell: it ends\n"));
}

TEST_F(MachineLogVerbTest, AMachineThatIsNone) {
  machine_.watched.clear();
  machine_.refused["WatchMachine"] = {grpc::StatusCode::NOT_FOUND, "no machine"};
  Told told = Say("log m");
  EXPECT_EQ(told.exit_code, kConnection);
  EXPECT_EQ(told.errors, "rmlcell: no machine\n");
  machine_.refused.clear();
  told = Say("log m");
  EXPECT_EQ(told.exit_code, kConnection);
  EXPECT_THAT(told.errors, HasSubstr("the server tells nothing"));
}

}  // namespace
}  // namespace rmlcell::cli
