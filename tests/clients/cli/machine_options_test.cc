// `rmlcell machine options`: how a machine lives.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/clients/cli/fake_machine.h"

namespace rmlcell::cli {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class MachineOptionsTest : public MachineWords {
 protected:
  MachineOptionsTest() {
    machine_.machine.set_name("machines/m");
    machine_.machine.set_etag("e");
  }
  v1::MachineOptions& options() { return *machine_.machine.mutable_options(); }
  // The options that it asks for.
  std::string Set(const std::string& words) {
    const Told told = Say("options m " + words);
    EXPECT_EQ(told.exit_code, kGood) << words << told.errors;
    std::string calls = Calls();
    const std::string head =
        "GetMachine name: \"machines/m\"\n"
        "UpdateMachine machine { name: \"machines/m\" etag: \"e\" options { ";
    const std::string tail = "} } update_mask { paths: \"options\" }\n";
    EXPECT_THAT(calls, AllOf(StartsWith(head), testing::EndsWith(tail)));
    return calls.substr(head.size(), calls.size() - head.size() - tail.size());
  }
};

TEST_F(MachineOptionsTest, EachIsShown) {
  EXPECT_EQ(Say("options m").output,
            "start=-\nserver-lost=-\nserver-lost-after=-\nlate-hold=-\npace=-\nlead=-\n"
            "lead-max=-\nhold=-\nhome=off\nunattended=off\nhalt-at-entry=off\n"
            "ticket-needed=off\n");
  options().set_enabled(true);
  options().set_start(v1::MachineOptions::START_PERSON);
  options().set_server_lost(v1::MachineOptions::SERVER_LOST_GO_ON);
  options().mutable_server_lost_after()->set_seconds(30);
  options().mutable_late_hold()->set_nanos(250'000'000);
  options().set_pace(v1::MachineOptions::PACE_FREE);
  options().mutable_lead();
  options().mutable_lead_max()->set_seconds(1);
  options().set_hold(v1::MachineOptions::DEVICE_HOLD_CLEAR);
  options().set_home(true);
  options().set_ticket_needed(true);
  const std::string shown =
      "start=person\nserver-lost=go-on\nserver-lost-after=30\nlate-hold=0.25\npace=free\nlead=0\n"
      "lead-max=1\nhold=clear\nhome=on\nunattended=off\nhalt-at-entry=off\nticket-needed=on\n";
  EXPECT_EQ(Say("options m").output, shown);
  Calls();
  // What was changed is what there is then; the rest stays.
  EXPECT_EQ(Say("options m home=off").output,
            std::string(shown).replace(shown.find("home=on"), 7, "home=off"));
  const Told told = Say("options m", true);
  EXPECT_EQ(told.exit_code, kGood);
  EXPECT_THAT(told.output, AllOf(StartsWith("{"), HasSubstr("START_PERSON")));
}

TEST_F(MachineOptionsTest, EachIsSet) {
  EXPECT_EQ(Set("start=queue"), "start: START_QUEUE ");
  EXPECT_EQ(Set("start=person"), "start: START_PERSON ");
  EXPECT_EQ(Set("server-lost=go-on"), "server_lost: SERVER_LOST_GO_ON ");
  EXPECT_EQ(Set("hold=now home=on"), "hold: DEVICE_HOLD_NOW home: true ");
  EXPECT_EQ(Set("home=off pace=model"), "pace: PACE_MODEL ");
  EXPECT_EQ(Set("late-hold=0"), "late_hold { } ");
  EXPECT_EQ(Set("lead=0.0015"), "lead { nanos: 2000000 } ");
  EXPECT_EQ(Set("lead-max=1000000"), "lead_max { seconds: 1000000 } ");
}

TEST_F(MachineOptionsTest, WhatIsNoneIsRefusedWithWhatThereIs) {
  for (const char* text :
       {"start", "start=", "start=unspecified", "start=START_QUEUE", "begin=queue", "home=yes",
        "enabled=on", "disabled=on", "lead=-0.001", "lead=1000000.001", "lead=nan", "lead=x"}) {
    const Told told = Say("options m home=on " + std::string(text));
    EXPECT_EQ(told.exit_code, kUsage) << text;
    EXPECT_EQ(told.output, "");
    EXPECT_EQ(told.errors, "rmlcell: '" + std::string(text) +
                               "' is none; there are\n"
                               "  start=queue, armed, person\n"
                               "  server-lost=hold, go-on, finish\n"
                               "  server-lost-after=seconds\n"
                               "  late-hold=seconds\n"
                               "  pace=model, flow, free\n"
                               "  lead=seconds\n"
                               "  lead-max=seconds\n"
                               "  hold=clear, now\n"
                               "  home=on, off\n"
                               "  unattended=on, off\n"
                               "  halt-at-entry=on, off\n"
                               "  ticket-needed=on, off\n");
    EXPECT_EQ(Calls(), "GetMachine name: \"machines/m\"\n");
  }
}

TEST_F(MachineOptionsTest, ARefusalIsTold) {
  machine_.refused["UpdateMachine"] = {grpc::StatusCode::ABORTED, "somebody else changed it"};
  const Told told = Say("options m home=on");
  EXPECT_EQ(told.exit_code, kConnection);
  EXPECT_EQ(told.errors, "rmlcell: somebody else changed it\n");
  EXPECT_EQ(told.output, "");
}

}  // namespace
}  // namespace rmlcell::cli
