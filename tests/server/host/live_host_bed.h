// A host of a machine that lives, with all its threads, against a server of the test.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <future>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/catalogue.h"
#include "server/host/host_process.h"
#include "tests/server/host/fake_host_server.h"

namespace rmlcell::server {

class LiveHost : public testing::Test {
 protected:
  // A square of 20 mm at 1 mm/s.
  static constexpr const char* kSlowSquare =
      "PA;PA;VS1;!VZ5;!PZ-50,100;!MC0;PU1000,1000;"
      "PD3000,1000,3000,3000,1000,3000,1000,1000;PU0,0;";

  LiveHost() : folder_(testing::TempDir() + "/live-host-" + std::to_string(::getpid())) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    server_ = std::make_unique<FakeHostServer>("unix:" + folder_ + "/a");
  }
  ~LiveHost() override {
    stopping_ = true;
    if (host_.valid()) host_.wait();
    server_.reset();
    std::filesystem::remove_all(folder_);
  }

  static v1::HostWelcome WelcomeTo(const std::string& family) {
    v1::HostWelcome welcome;
    welcome.set_fence(7);
    welcome.mutable_lease()->set_seconds(600);
    welcome.set_family(family);
    if (family == "rml1") welcome.set_profile("srm-20");
    // Else a machine whose computer is slow for a second is held. LIVE-3.14
    welcome.mutable_options()->mutable_late_hold()->set_seconds(60);
    return welcome;
  }
  std::string JournalPath() const { return folder_ + "/machine.journal"; }
  void Run(const v1::HostWelcome& welcome) {
    server_->Welcome(welcome);
    host_ = std::async(std::launch::async, [this] {
      return RunHost({.server = server_->address(),
                      .join_token = "let me in",
                      .machine = "machines/m",
                      .journal = JournalPath(),
                      .patience = patience_},
                     stopping_);
    });
  }
  // Until it tells where it stands; in slot 5 it has the square.
  void Live(const v1::HostWelcome& welcome = WelcomeTo("rml1")) {
    Run(welcome);
    v1::HostResponse memory;
    memory.mutable_memory()->set_whole(true);
    v1::AssignedProgram& program = *memory.mutable_memory()->add_programs();
    program.set_slot(5);
    program.set_content(kSlowSquare);
    program.set_object_revision(3);
    server_->Tell(memory);
    server_->Told(v1::HostRequest::kStatus, 1);
  }

  std::int64_t Send(v1::HostOrder order) {
    v1::HostResponse message;
    order.set_number(++number_);
    if (order.caller().empty()) order.set_caller("anna");
    *message.mutable_order() = std::move(order);
    server_->Tell(message);
    return number_;
  }
  // As soon as one of this kind is what is waited for.
  template <class Condition>
  v1::HostRequest Await(v1::HostRequest::MessageCase kind, Condition condition,
                        std::size_t behind = 0) {
    return AwaitAt(*server_, kind, condition, behind);
  }
  template <class Condition>
  static v1::HostRequest AwaitAt(FakeHostServer& server, v1::HostRequest::MessageCase kind,
                                 Condition condition, std::size_t behind = 0) {
    const auto patience = std::chrono::steady_clock::now() + kComesWithin;
    for (std::size_t count = behind + 1; std::chrono::steady_clock::now() < patience; ++count) {
      const std::vector<v1::HostRequest> told = server.Told(kind, count);
      const auto first = told.begin() + static_cast<std::ptrdiff_t>(std::min(behind, told.size()));
      const auto found = std::find_if(first, told.end(), condition);
      if (found != told.end()) return *found;
      count = std::max(count, told.size());
    }
    ADD_FAILURE() << "waited for in vain";
    return {};
  }
  v1::HostOrderAnswer AnswerTo(std::int64_t number) {
    return Await(v1::HostRequest::kAnswer,
                 [number](const v1::HostRequest& one) { return one.answer().number() == number; })
        .answer();
  }
  v1::HostOrderAnswer Ask(const v1::HostOrder& order) { return AnswerTo(Send(order)); }
  // So many of this kind were told.
  std::size_t Count(v1::HostRequest::MessageCase kind) { return server_->Told(kind, 0).size(); }
  template <class Condition>
  v1::MachineStatus AwaitStatus(Condition condition, std::size_t behind = 0) {
    return Await(
               v1::HostRequest::kStatus,
               [&](const v1::HostRequest& one) { return condition(one.status()); }, behind)
        .status();
  }
  v1::MachineStatus AwaitState(v1::MachineState state) {
    return AwaitStatus([state](const v1::MachineStatus& one) { return one.state() == state; });
  }
  // It answers whatever came before.
  v1::HostOrderAnswer AskWhereItIs() {
    v1::HostOrder order;
    order.mutable_run_state();
    return Ask(order);
  }
  std::vector<v1::JournalEntry> Entries() {
    std::vector<v1::JournalEntry> all;
    for (const v1::HostRequest& told : server_->Told(v1::HostRequest::kEntries, 0))
      all.insert(all.end(), told.entries().entries().begin(), told.entries().entries().end());
    return all;
  }
  template <class Condition>
  v1::JournalEntry AwaitEntry(Condition condition) {
    v1::JournalEntry entry;
    Await(v1::HostRequest::kEntries, [&](const v1::HostRequest& told) {
      const auto& entries = told.entries().entries();
      const auto found = std::ranges::find_if(entries, condition);
      if (found != entries.end()) entry = *found;
      return found != entries.end();
    });
    return entry;
  }
  // All that was told until now is in the store.
  void StoreAll() {
    v1::HostResponse stored;
    const std::vector<v1::JournalEntry> entries = Entries();
    stored.mutable_entries_stored()->set_sequence(entries.empty() ? 0 : entries.back().sequence());
    server_->Tell(stored);
  }

  // Again and again, where a disk is to answer first. The same request each time, which acts once.
  v1::HostOrderAnswer AskUntilItActs(const v1::HostOrder& order) {
    const auto until = std::chrono::steady_clock::now() + kComesWithin;
    v1::HostOrderAnswer answer = Ask(order);
    while (answer.has_refusal() && std::chrono::steady_clock::now() < until) answer = Ask(order);
    EXPECT_FALSE(answer.has_refusal()) << answer.refusal().message();
    return answer;
  }
  void TakeControl(v1::ControlLease::OnLoss on_loss = v1::ControlLease::ON_LOSS_GO_ON) {
    v1::HostOrder order;
    v1::AcquireControlRequest& acquire = *order.mutable_acquire_control();
    acquire.mutable_ttl()->set_seconds(60);
    acquire.set_on_loss(on_loss);
    acquire.set_request_id("control " + std::to_string(number_));
    token_ = AskUntilItActs(order).control().control_token();
  }
  v1::HostOrder ReleaseOfControl() {
    v1::HostOrder order;
    order.mutable_release_control()->set_control_token(token_);
    return order;
  }
  v1::HostOrder StartOf(int program = 5) {
    v1::HostOrder order;
    order.mutable_start()->set_program(program);
    order.mutable_start()->set_control_token(token_);
    order.mutable_start()->set_request_id("start " + std::to_string(number_));
    return order;
  }
  v1::HostOrder OverrideOf(double percent) {
    v1::HostOrder order;
    order.mutable_override()->set_override_percent(percent);
    order.mutable_override()->set_control_token(token_);
    return order;
  }
  v1::HostOrder PanelKey(const std::string& key, std::int64_t sequence) {
    v1::HostOrder order;
    v1::PressPanelKeyRequest& pressed = *order.mutable_panel_key();
    pressed.set_key(key);
    pressed.set_action(v1::KEY_ACTION_TAP);
    pressed.set_control_token(token_);
    pressed.set_sequence(sequence);
    return order;
  }
  static v1::HostOrder JobOrder(const std::string& job, const std::string& text = kSlowSquare) {
    v1::HostOrder order;
    v1::WorkerAssignment& assignment = *order.mutable_run_job();
    assignment.mutable_job()->set_name(job);
    assignment.set_main_program(5);
    v1::AssignedProgram& program = *assignment.add_programs();
    program.set_slot(5);
    program.set_file_name("square.rml");
    program.set_is_source(true);
    program.set_content(text);
    return order;
  }
  static v1::HostOrder PreviewOf(int program, int step) {
    v1::HostOrder order;
    order.mutable_preview_start()->set_program(program);
    order.mutable_preview_start()->mutable_step()->set_step(step);
    return order;
  }
  v1::HostOrder HandboxKey(const std::string& session, const std::string& key,
                           std::int64_t sequence) {
    v1::HostOrder order;
    v1::PressKeyRequest& pressed = *order.mutable_key();
    pressed.set_session(session);
    pressed.set_control_token(token_);
    pressed.set_key(key);
    pressed.set_action(v1::KEY_ACTION_TAP);
    pressed.set_sequence(sequence);
    return order;
  }
  // Whether this job has begun, and where it is.
  static v1::HostOrder WhereIs(const std::string& job) {
    v1::HostOrder order;
    order.mutable_run_state();
    order.set_for_job(job);
    return order;
  }
  static v1::HostOrder StopOrder() {
    v1::HostOrder order;
    order.mutable_stop();
    return order;
  }
  static bool IsBlockedBy(const v1::MachineStatus& status, ErrorCode code) {
    return std::ranges::any_of(status.start_blockers(), [code](const v1::StartBlocker& one) {
      return one.code() == CodeText(code);
    });
  }

  const std::string folder_;
  HostPatience patience_ = PatientHost();  // set before it lives
  std::unique_ptr<FakeHostServer> server_;
  std::atomic<bool> stopping_ = false;
  std::future<int> host_;
  std::int64_t number_ = 0;
  std::string token_;
};

}  // namespace rmlcell::server
