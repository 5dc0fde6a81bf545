// What a person does with the keys of a machine, and what was taught with them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "clients/cli/messages.h"
#include "rmlcell/v1/handbox.grpc.pb.h"
#include "tests/clients/cli/fake_machine.h"

namespace rmlcell::cli {
namespace {

using testing::HasSubstr;
using testing::SizeIs;
using testing::StartsWith;

// Control for as long as keys are pressed: a minute, and longer where that is needed.
std::string WithKeysFor(const std::string& calls) {
  std::string all = WithControlFor(calls);
  const std::string head = "AcquireControl machine: \"machines/m\" ";
  return all.insert(head.size(), "ttl { seconds: 60 } ");
}

class PanelVerbTest : public MachineWords {
 protected:
  PanelVerbTest() {
    machine_.statuses[0].set_machine("machines/m");
    machine_.statuses[0].set_state(v1::MACHINE_STATE_IDLE);
  }
  static std::string Key(int sequence, const std::string& key, const std::string& action,
                         const std::string& more = {}) {
    return "PressPanelKey machine: \"machines/m\" control_token: \"t\" key: \"" + key +
           "\" action: KEY_ACTION_" + action + " sequence: " + std::to_string(sequence) + more;
  }
  const std::string look_ = "\nGetMachine name: \"machines/m\"";
};

// A step of one key is over before the next one; then it is looked whether it goes on by itself.
TEST_F(PanelVerbTest, KeysAreTappedOneAfterTheOther) {
  const Told told = Say("key m X+ PAUSE Y-");
  EXPECT_EQ(told.exit_code, kGood) << told.errors;
  EXPECT_EQ(told.output, "machines/m  IDLE; it does not live: rmlcell machine enable\n");
  EXPECT_EQ(Calls(), WithKeysFor(Key(1, "X+", "TAP") + look_ + "\n" + Key(2, "PAUSE", "TAP") +
                                 "\n" + Key(3, "Y-", "TAP") + look_));
  Say("key m X+ --fast");
  EXPECT_EQ(Calls(), WithKeysFor(Key(1, "X+", "TAP", " fast: true") + look_));
  EXPECT_THAT(machine_.beats, SizeIs(0));
}

TEST_F(PanelVerbTest, TheNextKeyWaitsUntilTheAxesStand) {
  v1::MachineStatus moves = machine_.statuses[0];
  v1::MachineStatus stops = moves;
  moves.set_state(v1::MACHINE_STATE_JOGGING);
  stops.set_state(v1::MACHINE_STATE_STOPPING);
  machine_.statuses = {moves, moves, stops, machine_.statuses[0]};
  Say("key m X+ PAUSE");
  EXPECT_EQ(Calls(), WithKeysFor(Key(1, "X+", "TAP") + look_ + look_ + look_ + "\n" +
                                 Key(2, "PAUSE", "TAP") + look_));
}

// LIVE-7.05: it says that it is held from the press on, each 50 ms.
TEST_F(PanelVerbTest, TheLastKeyIsHeld) {
  EXPECT_EQ(Say("key m PAUSE X+ --for 0.14").exit_code, kGood);
  EXPECT_EQ(Calls(), WithKeysFor(Key(1, "PAUSE", "TAP") + "\n" + Key(2, "X+", "PRESS") + "\n" +
                                 Key(3, "X+", "RELEASE") + look_ + look_));
  // At 0, 50 and 100 ms; one less where the computer was kept from going on.
  ASSERT_THAT(machine_.beats, SizeIs(testing::AllOf(testing::Ge(2), testing::Le(3))));
  std::int64_t number = 0;
  for (const v1::HeartbeatPanelRequest& beat : machine_.beats) {
    EXPECT_EQ(beat.machine(), "machines/m");
    EXPECT_EQ(beat.control_token(), "t");
    EXPECT_EQ(beat.number(), ++number);
    EXPECT_THAT(beat.keys_down(), testing::ElementsAre("X+"));
    EXPECT_GT(beat.sent().seconds(), 0);
    EXPECT_EQ(beat.has_round_trip(), number > 1);
  }
  machine_.refused["HeartbeatPanel"] = {grpc::StatusCode::ABORTED, "too late"};
  const Told told = Say("key m X+ --for 0.01");
  EXPECT_EQ(told.exit_code, kConnection);
  EXPECT_EQ(told.errors, "rmlcell: too late\n");
}

TEST_F(PanelVerbTest, ARefusedKeyEndsIt) {
  machine_.refused["PressPanelKey"] = {grpc::StatusCode::FAILED_PRECONDITION, "the door is open"};
  for (const char* line : {"key m X+ Y+", "key m X+ --for 1"}) {
    const Told told = Say(line);
    EXPECT_EQ(told.exit_code, kConnection);
    EXPECT_EQ(told.errors, "rmlcell: the door is open\n");
    EXPECT_EQ(told.output, "");
    EXPECT_THAT(Calls(), Not(HasSubstr("Y+")));
  }
  EXPECT_THAT(machine_.beats, SizeIs(0));
}

// What a key has begun goes on until it is over: given back before, control would stop it. A
// program that it has started does not need that.
TEST_F(PanelVerbTest, WhatAKeyBeganIsAwaited) {
  const v1::MachineStatus stands = machine_.statuses[0];
  v1::MachineStatus jogs = stands;
  jogs.set_state(v1::MACHINE_STATE_JOGGING);
  v1::MachineStatus by_hand = stands;
  by_hand.set_state(v1::MACHINE_STATE_RUNNING);
  v1::MachineStatus runs = by_hand;
  runs.mutable_run()->set_program(1);
  machine_.statuses = {stands, jogs, by_hand, runs, stands};
  Say("key m HOME");
  EXPECT_EQ(Calls(), WithKeysFor(Key(1, "HOME", "TAP") + look_ + look_ + look_));
}

TEST_F(PanelVerbTest, WrongUse) {
  for (const char* line : {"key m", "key m X+ --for 50.1", "key m X+ --for -1",
                           "key m X+ --for nan", "key m X+ --for x"}) {
    EXPECT_EQ(Say(line).exit_code, kUsage) << line;
    EXPECT_EQ(Calls(), "") << line;
  }
}

class FakeHandboxKeys final : public v1::HandboxService::Service {
 public:
  explicit FakeHandboxKeys(CallNotes& calls) : calls_(calls) {}

  v1::PressKeyResponse pressed{};
  std::vector<v1::HeartbeatHandboxRequest> beats{};
  std::vector<v1::ListTeachEntriesResponse> pages{};
  v1::TeachEntry undone{};
  grpc::Status refusal{};

  grpc::Status CreateHandboxSession(grpc::ServerContext*,
                                    const v1::CreateHandboxSessionRequest* request,
                                    v1::HandboxSession* response) override {
    calls_.Add("CreateHandboxSession", *request);
    response->set_name("s");
    return {};
  }
  grpc::Status PressKey(grpc::ServerContext*, const v1::PressKeyRequest* request,
                        v1::PressKeyResponse* response) override {
    calls_.Add("PressKey", *request);
    *response = pressed;
    return {};
  }
  grpc::Status HeartbeatHandbox(grpc::ServerContext*, const v1::HeartbeatHandboxRequest* request,
                                v1::HeartbeatResponse*) override {
    beats.push_back(*request);
    return {};
  }
  grpc::Status DeleteHandboxSession(grpc::ServerContext*,
                                    const v1::DeleteHandboxSessionRequest* request,
                                    google::protobuf::Empty*) override {
    calls_.Add("DeleteHandboxSession", *request);
    return {};
  }
  grpc::Status ListTeachEntries(grpc::ServerContext*, const v1::ListTeachEntriesRequest* request,
                                v1::ListTeachEntriesResponse* response) override {
    calls_.Add("ListTeachEntries", *request);
    if (!pages.empty()) *response = pages[request->page_token().empty() ? 0 : 1];
    return refusal;
  }
  grpc::Status UndoTeachEntries(grpc::ServerContext*, const v1::UndoTeachEntriesRequest* request,
                                v1::UndoTeachEntriesResponse* response) override {
    calls_.Add("UndoTeachEntries", *request);
    *response->mutable_entry() = undone;
    return refusal;
  }

 private:
  CallNotes& calls_;
};

class HandboxVerbTest : public MachineWords {
 protected:
  HandboxVerbTest() {
    server_.reset();
    server_ =
        std::make_unique<FakeServer>(folder_, std::vector<grpc::Service*>{&machine_, &handbox_});
  }
  ~HandboxVerbTest() override { server_.reset(); }  // before handbox_
  static std::string Key(int sequence, const std::string& key, const std::string& action) {
    return "PressKey session: \"s\" control_token: \"t\" key: \"" + key + "\" action: KEY_ACTION_" +
           action + " sequence: " + std::to_string(sequence);
  }
  static std::string InSession(const std::string& calls) {
    return WithKeysFor("CreateHandboxSession machine: \"machines/m\" control_token: \"t\"\n" +
                       calls +
                       "\nGetMachine name: \"machines/m\"\nDeleteHandboxSession name: \"s\"");
  }
  FakeHandboxKeys handbox_{calls_};
};

TEST_F(HandboxVerbTest, KeysOfAHandboxShowItsDisplay) {
  v1::HandboxPanel& panel = *handbox_.pressed.mutable_panel();
  panel.set_display("P=45\t");
  Told told = Say("key m JOB 4");
  EXPECT_EQ(told.exit_code, kGood) << told.errors;
  EXPECT_EQ(told.output, "[P=45\\x09]\n");
  EXPECT_EQ(Calls(), InSession(Key(1, "JOB", "TAP") + "\n" + Key(2, "4", "TAP")));
  panel.set_flashing(true);
  panel.add_lamps("MANUAL");
  panel.add_lamps("ROB");
  handbox_.pressed.mutable_message()->set_code("OPT-E7601");
  handbox_.pressed.mutable_message()->set_message("not enabled");
  told = Say("key m REC");
  EXPECT_EQ(told.exit_code, kProgramErrors);
  EXPECT_EQ(told.output, "[P=45\\x09] flashing MANUAL ROB\n");
  EXPECT_EQ(told.errors, "rmlcell: OPT-E7601: not enabled\n");
  EXPECT_THAT(Say("key m REC", true).output, StartsWith("{"));
}

TEST_F(HandboxVerbTest, AKeyOfAHandboxIsHeld) {
  EXPECT_EQ(Say("key m X+ --for 0.01").exit_code, kGood);
  EXPECT_EQ(Calls(), InSession(Key(1, "X+", "PRESS") + "\n" + Key(2, "X+", "RELEASE") +
                               "\nGetMachine name: \"machines/m\""));
  ASSERT_THAT(handbox_.beats, SizeIs(1));
  EXPECT_EQ(handbox_.beats[0].session(), "s");
  EXPECT_EQ(handbox_.beats[0].control_token(), "t");
  EXPECT_THAT(handbox_.beats[0].keys_down(), testing::ElementsAre("X+"));
}

class TaughtTest : public HandboxVerbTest {
 protected:
  TaughtTest() {
    handbox_.pages.resize(2);
    handbox_.pages[0].set_next_page_token("2");
    Add(0, 12, v1::TeachEntry::ACT_UNDO, 45, 0).set_undone_down_to(10);
    v1::TeachEntry& insert = Add(0, 11, v1::TeachEntry::ACT_INSERT, 45, 1);
    insert.set_after("MOVE");
    for (const auto& [name, value] : {std::pair{"COORD", "ABSOL"}, std::pair{"TCP", "2"}}) {
      insert.add_values()->set_name(name);
      insert.mutable_values()->rbegin()->set_value(value);
    }
    Add(1, 10, v1::TeachEntry::ACT_DELETE, 45, 3).set_before("DELAY");
    Add(1, 9, v1::TeachEntry::ACT_CREATE, 45, 0);
    Add(1, 8, v1::TeachEntry::ACT_REMOVE, 44, 0);
  }
  v1::TeachEntry& Add(std::size_t page, int number, v1::TeachEntry::Act act, int program,
                      int step) {
    v1::TeachEntry& made = *handbox_.pages[page].add_entries();
    made.set_number(number);
    made.set_act(act);
    made.set_caller("anna");
    made.mutable_step()->set_program(program);
    made.mutable_step()->set_step(step);
    return made;
  }
  const std::string listed_ =
      "ListTeachEntries machine: \"machines/m\" page_size: 1000\n"
      "ListTeachEntries machine: \"machines/m\" page_size: 1000 page_token: \"2\"\n";
  const std::string who_ = "  " + When({}) + "  anna  ";
};

// LIVE-7.09: the oldest first.
TEST_F(TaughtTest, WhatWasTaughtIsShown) {
  const Told told = Say("taught m");
  EXPECT_EQ(told.exit_code, kGood) << told.errors;
  EXPECT_EQ(told.output, "8" + who_ + "44  remove\n" +                                     //
                             "9" + who_ + "45  create\n" +                                 //
                             "10" + who_ + "45/3  delete  DELAY\n" +                       //
                             "11" + who_ + "45/1  insert  MOVE  (COORD ABSOL, TCP 2)\n" +  //
                             "12" + who_ + "45  undo    down to 10\n");
  EXPECT_EQ(Calls(), listed_);
  Say("taught m --slot 99");
  EXPECT_THAT(Calls(), HasSubstr(" program: 99 page_size: 1000\n"));
  const std::string lines = Say("taught m", true).output;
  EXPECT_EQ(std::ranges::count(lines, '\n'), 5);
  EXPECT_THAT(lines, StartsWith("{"));
}

TEST_F(TaughtTest, WhatWasTaughtIsTakenBack) {
  handbox_.undone = handbox_.pages[0].entries(0);
  Calls();
  Told told = Say("taught m --undo 10");
  EXPECT_EQ(told.exit_code, kGood) << told.errors;
  EXPECT_EQ(told.output, "12" + who_ + "45  undo    down to 10\n");
  EXPECT_EQ(Calls(),
            listed_ + WithControlFor("UndoTeachEntries program: \"machines/m/programs/45\" "
                                     "down_to: 10 control_token: \"t\""));
  told = Say("taught m --undo 13");
  EXPECT_EQ(told.exit_code, kUsage);
  EXPECT_EQ(told.errors, "rmlcell: there is no entry 13: see `rmlcell machine taught m`\n");
  EXPECT_EQ(Calls(), listed_);
  for (const char* line : {"taught m --undo 0", "taught m --slot 0", "taught m --slot 100"})
    EXPECT_EQ(Say(line).exit_code, kUsage) << line;
  handbox_.refusal = {grpc::StatusCode::INVALID_ARGUMENT, "no"};
  told = Say("taught m");
  EXPECT_EQ(told.exit_code, kUsage);
  EXPECT_EQ(told.errors, "rmlcell: no\n");
}

// Whoever never stands is waited for 3 s: a hundred looks, 30 ms apart; then the next key comes.
TEST_F(PanelVerbTest, TheNextKeyDoesNotWaitForEver) {
  v1::MachineStatus moves = machine_.statuses[0];
  moves.set_state(v1::MACHINE_STATE_JOGGING);
  // The answer to the first key, and a hundred looks.
  machine_.statuses.insert(machine_.statuses.begin(), 101, moves);
  Say("key m X+ PAUSE");
  const std::string calls = Calls();
  std::size_t looks = 0;
  for (std::size_t at = calls.find("GetMachine"); at != std::string::npos;
       at = calls.find("GetMachine", at + 1))
    ++looks;
  EXPECT_EQ(looks, 101U);  // the last one is behind the last key
}

}  // namespace
}  // namespace rmlcell::cli
