#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "engine/families/families.h"
#include "proto/recording/recording.h"
#include "server/host/host_machine.h"

namespace rmlcell::server {

using namespace std::chrono_literals;

// A square of 20 mm at 1 mm/s: 80 s, with the way there.
inline constexpr const char* kSquare =
    "PA;PA;VS1;!VZ5;!PZ-50,100;!MC0;PU1000,1000;"
    "PD3000,1000,3000,3000,1000,3000,1000,1000;PU0,0;";

class HostMachineTest : public testing::Test {
 protected:
  void Make(std::string state = {}, bool cut_off = false,
            std::optional<v1::MachineMark> open_run = {}) {
    machine::MachineMemory memory;
    memory.programs[5] = {.name = "square", .object = machine::Bytes::Of(kSquare)};
    auto made = HostMachine::Make({.name = "machines/mill-1",
                                   .host = "workshop/1",
                                   .fence = 7,
                                   .family = families::FindFamily("rml1"),
                                   .profile = "srm-20",
                                   .options = options_,
                                   .memory = std::move(memory),
                                   .state = std::move(state),
                                   .cut_off = cut_off,
                                   .open_run = std::move(open_run),
                                   .inspect_job = inspect_job_,
                                   .cut_off_base = cut_off_base_,
                                   .control_lease = control_lease_,
                                   .recording = recording_},
                                  now_, [this] { return "token " + std::to_string(++tokens_); });
    ASSERT_TRUE(made) << made.error().detail;
    host_ = *std::move(made);
  }
  // An Optimo that lives, with nothing in it.
  void MakeOptimo() {
    auto made = HostMachine::Make({.name = "machines/optimo-1",
                                   .host = "workshop/1",
                                   .fence = 7,
                                   .family = families::FindFamily("optimo")},
                                  now_, [this] { return "token " + std::to_string(++tokens_); });
    ASSERT_TRUE(made) << made.error().detail;
    host_ = *std::move(made);
    host_->Begin({}, now_);
  }
  // Time goes by, in steps as a host takes them.
  void Pass(std::chrono::milliseconds time, std::chrono::milliseconds step = 10ms) {
    for (std::chrono::milliseconds gone{0}; gone < time; gone += step) {
      now_.steady += step;
      now_.wall += step;
      while (!host_->GoOn(now_)) continue;
    }
  }
  v1::HostOrderAnswer Do(const v1::HostOrder& order) {
    v1::HostOrder numbered = order;
    numbered.set_number(++number_);
    numbered.set_caller("anna");
    const v1::HostOrderAnswer answer = host_->Do(numbered, now_);
    EXPECT_EQ(answer.number(), number_);
    if (stores_) host_->NoteStored(std::numeric_limits<std::int64_t>::max());
    return answer;
  }
  std::string Control(v1::ControlLease::OnLoss on_loss = v1::ControlLease::ON_LOSS_HOLD) {
    v1::HostOrder order;
    v1::AcquireControlRequest& acquire = *order.mutable_acquire_control();
    acquire.mutable_ttl()->set_seconds(60);
    acquire.set_on_loss(on_loss);
    acquire.set_client("a test");
    return token_ = Do(order).control().control_token();
  }
  // The mill with its square, in the hands of whoever tests it; its run goes on without him.
  void MakeAndTake(v1::ControlLease::OnLoss on_loss = v1::ControlLease::ON_LOSS_GO_ON) {
    Make();
    host_->Begin({}, now_);
    Control(on_loss);
  }
  void MakeAndTakeOptimo() {
    MakeOptimo();
    Control(v1::ControlLease::ON_LOSS_GO_ON);
  }
  v1::HostOrder Start(const std::string& id = "", int program = 5) {
    v1::HostOrder order;
    order.mutable_start()->set_program(program);
    order.mutable_start()->set_control_token(token_);
    order.mutable_start()->set_request_id(id);
    return order;
  }
  // A job that brings its source.
  static v1::HostOrder JobOf(const std::string& text, const std::string& file_name = "A.S") {
    v1::HostOrder order;
    v1::WorkerAssignment& assignment = *order.mutable_run_job();
    assignment.mutable_job()->set_name("jobs/17");
    assignment.set_main_program(5);
    v1::AssignedProgram& program = *assignment.add_programs();
    program.set_slot(5);
    program.set_file_name(file_name);
    program.set_is_source(true);
    program.set_content(text);
    return order;
  }
  v1::HostOrder Resume() {
    v1::HostOrder order;
    order.mutable_resume()->set_control_token(token_);
    return order;
  }
  static v1::HostOrder Stop() {
    v1::HostOrder order;
    order.mutable_stop();
    return order;
  }
  // The next key of a handbox.
  v1::HostOrder KeyOf(const std::string& session, const std::string& key,
                      v1::KeyAction action = v1::KEY_ACTION_TAP) {
    v1::HostOrder order;
    v1::PressKeyRequest& pressed = *order.mutable_key();
    pressed.set_session(session);
    pressed.set_control_token(token_);
    pressed.set_key(key);
    pressed.set_action(action);
    pressed.set_sequence(++keys_pressed_);
    return order;
  }
  // The edit that these keys of a handbox make, one tapped after the other.
  v1::HostEdit Taught(const std::string& session, const std::string& keys) {
    std::istringstream all(keys);
    for (std::string name; all >> name;) EXPECT_TRUE(Do(KeyOf(session, name)).has_key()) << name;
    const std::vector<v1::HostEdit> edits = host_->TakeEdits();
    EXPECT_EQ(edits.size(), 1U);
    return edits.empty() ? v1::HostEdit() : edits.back();
  }
  v1::MachineState State() { return host_->StatusAt(now_).state(); }
  // What the recording of the newest run says of what the machine was and did.
  v1::MachineRecording RecordingHead() {
    v1::HostOrder order;
    order.mutable_recording();
    const auto recording = recording::ReadFile(Do(order).recording().chunk());
    EXPECT_TRUE(recording) << recording.error().detail;
    return recording ? recording->head : v1::MachineRecording();
  }
  // What was told since the last look, a word each.
  std::vector<std::string> Told() {
    std::vector<std::string> told;
    for (const v1::JournalEntry& entry : host_->TakeEntries(now_)) {
      EXPECT_EQ(entry.sequence(), ++sequence_);
      EXPECT_EQ(entry.fence(), 7);
      switch (entry.what_case()) {
        case v1::JournalEntry::kApplied:
          told.push_back("input " + std::to_string(entry.applied().input().input_case()));
          break;
        case v1::JournalEntry::kMark:
          mark_ = entry.mark();
          told.push_back(entry.mark().clean() ? "clean mark" : "mark");
          break;
        case v1::JournalEntry::kRunBegun:
          told.push_back("begun");
          break;
        case v1::JournalEntry::kRunOver:
          told.push_back("over " + v1::Outcome::Kind_Name(entry.run_over().outcome().kind()));
          break;
        case v1::JournalEntry::kEvent:
          told.push_back(entry.event().has_halted()    ? "halted"
                         : entry.event().has_resumed() ? "resumed"
                                                       : "event");
          break;
        default:
          told.push_back("other");
      }
    }
    return told;
  }
  static std::string Input(v1::AppliedInput::InputCase which) {
    return "input " + std::to_string(which);
  }

  HostTime now_{.steady = 1h, .wall = WallTime(std::chrono::hours(24 * 365 * 50))};
  std::unique_ptr<HostMachine> host_;
  std::string token_;
  v1::MachineMark mark_;
  int tokens_ = 0;
  std::int64_t number_ = 0;
  std::int64_t sequence_ = 0;
  std::int64_t keys_pressed_ = 0;
  bool stores_ = true;  // what happens is in the store at once

  // Of the next host that is made.
  v1::MachineOptions options_;
  std::string inspect_job_;
  std::optional<v1::RunBase> cut_off_base_;
  std::int64_t control_lease_ = 0;
  std::optional<MachineRecorder::OfJob> recording_;
};

}  // namespace rmlcell::server
