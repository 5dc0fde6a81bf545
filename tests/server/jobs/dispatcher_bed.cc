#include "tests/server/jobs/dispatcher_bed.h"

#include <algorithm>
#include <latch>

namespace rmlcell::server {

void FakeLine::Send(v1::WorkResponse message) {
  const std::lock_guard lock(mutex_);
  messages_.push_back(std::move(message));
  changed_.notify_all();
}

void FakeLine::SendProgram(int slot, std::shared_ptr<const std::string> bytes) {
  const std::lock_guard lock(mutex_);
  programs_[slot] = *bytes;
}

v1::WorkResponse FakeLine::Next(v1::WorkResponse::MessageCase kind,
                                std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  const auto until = std::chrono::steady_clock::now() + patience;
  for (;;) {
    while (!messages_.empty()) {
      v1::WorkResponse message = std::move(messages_.front());
      messages_.pop_front();
      if (message.message_case() == kind) return message;
    }
    if (!changed_.wait_until(lock, until, [&] { return !messages_.empty(); })) return {};
  }
}

bool FakeLine::Has(v1::WorkResponse::MessageCase kind) {
  const std::lock_guard lock(mutex_);
  return std::ranges::any_of(messages_,
                             [&](const auto& message) { return message.message_case() == kind; });
}

std::map<int, std::string> FakeLine::programs() {
  const std::lock_guard lock(mutex_);
  return programs_;
}

v1::WorkerHello Hello(const std::string& name) {
  v1::WorkerHello hello;
  hello.set_join_token(std::string(kToken));
  hello.set_worker(name);
  hello.set_version(std::string(kVersion));
  hello.add_kinds(v1::JOB_KIND_CHECK);
  hello.add_kinds(v1::JOB_KIND_SIMULATE);
  return hello;
}

FakeWorker::FakeWorker(Dispatcher& dispatcher, const v1::WorkerHello& hello)
    : dispatcher_(dispatcher) {
  id_ = Must(dispatcher_.Join(line_, hello));
}

bool FakeWorker::Take(std::chrono::milliseconds patience) {
  v1::WorkResponse message = line_->Next(v1::WorkResponse::kAssignment, patience);
  if (!message.has_assignment()) return false;
  assignment_ = std::move(*message.mutable_assignment());
  return true;
}

void FakeWorker::Heartbeat() {
  v1::WorkRequest message;
  *message.mutable_heartbeat()->mutable_lease() = assignment_.lease();
  Send(std::move(message));
}

void FakeWorker::Position(std::int64_t time_ns) {
  v1::WorkRequest message;
  *message.mutable_heartbeat()->mutable_lease() = assignment_.lease();
  message.mutable_heartbeat()->mutable_progress()->set_virtual_time_ns(time_ns);
  Send(std::move(message));
}

void FakeWorker::Events(int count, const std::string& text) {
  v1::WorkRequest message;
  *message.mutable_events()->mutable_lease() = assignment_.lease();
  for (int i = 0; i < count; ++i)
    message.mutable_events()->add_events()->mutable_message()->set_text(text);
  Send(std::move(message));
}

void FakeWorker::Artifact(const std::string& name, const std::string& bytes) {
  v1::WorkRequest message;
  *message.mutable_artifact()->mutable_lease() = assignment_.lease();
  message.mutable_artifact()->set_name(name);
  message.mutable_artifact()->set_media_type("text/plain");
  message.mutable_artifact()->set_chunk(bytes);
  Send(std::move(message));
}

void FakeWorker::Toolpath(const std::string& frames, const std::string& open_block) {
  v1::WorkRequest message;
  *message.mutable_toolpath()->mutable_lease() = assignment_.lease();
  message.mutable_toolpath()->set_frames(frames);
  message.mutable_toolpath()->set_open_block(open_block);
  Send(std::move(message));
}

void FakeWorker::Heights(const v1::WorkerHeights& heights) {
  v1::WorkRequest message;
  *message.mutable_heights() = heights;
  *message.mutable_heights()->mutable_lease() = assignment_.lease();
  Send(std::move(message));
}

void FakeWorker::Finish(v1::Outcome::Kind kind, const std::map<int, std::string>& executables,
                        const std::vector<std::string>& last_told) {
  v1::WorkRequest message;
  for (const std::string& text : last_told)
    message.mutable_finish()->add_events()->mutable_message()->set_text(text);
  *message.mutable_finish()->mutable_lease() = assignment_.lease();
  message.mutable_finish()->mutable_outcome()->set_kind(kind);
  for (const v1::AssignedProgram& program : assignment_.programs()) {
    const auto made = executables.find(program.slot());
    if (made == executables.end()) continue;
    v1::LinkedExecutable& linked = *message.mutable_finish()->add_executables();
    linked.set_slot(made->first);
    linked.set_object_revision(program.object_revision());
    linked.set_content(made->second);
  }
  message.mutable_finish()->mutable_artifacts()->Swap(small_.mutable_artifacts());
  Send(std::move(message));
}

void FakeWorker::SmallArtifact(const std::string& name, const std::string& bytes) {
  v1::WorkerArtifact& artifact = *small_.add_artifacts();
  *artifact.mutable_lease() = assignment_.lease();
  artifact.set_name(name);
  artifact.set_media_type("text/plain");
  artifact.set_chunk(bytes);
}

void FakeWorker::HandBack() {
  v1::WorkRequest message;
  *message.mutable_hand_back()->mutable_lease() = assignment_.lease();
  Send(std::move(message));
}

std::optional<bool> FakeWorker::Released() {
  const v1::WorkResponse message = line_->Next(v1::WorkResponse::kRelease);
  if (!message.has_release() || message.release().lease().fence() != assignment_.lease().fence())
    return std::nullopt;
  return message.release().stored();
}

v1::WorkerControl FakeWorker::Ordered() {
  return line_->Next(v1::WorkResponse::kControl).control();
}

Dispatcher& DispatcherBed::dispatcher() {
  if (dispatcher_ == nullptr) {
    executor_ = std::make_unique<Executor>(kThreads);
    feed_ = std::make_unique<EventFeed>(hooks);
    dispatcher_ = std::make_unique<Dispatcher>(hooks, *feed_, config, *executor_,
                                               std::string(kToken), steady_.clock());
  }
  return *dispatcher_;
}

EventFeed& DispatcherBed::feed() {
  dispatcher();
  return *feed_;
}

void DispatcherBed::Advance(std::chrono::milliseconds by) {
  server.clock().Advance(by);
  steady_.Advance(by);
}

// The executor takes work in order: when all its threads meet here, all before is done.
void DispatcherBed::Settle() { dispatcher().Settle(); }

std::shared_ptr<void> DispatcherBed::Occupy() {
  dispatcher();
  const auto busy = std::make_shared<std::latch>(kThreads + 1);
  const auto over = std::make_shared<std::latch>(1);
  for (int i = 0; i < kThreads; ++i) {
    executor_->Post([busy, over] {
      busy->arrive_and_wait();
      over->wait();
    });
  }
  busy->arrive_and_wait();
  return {nullptr, [over](void*) { over->count_down(); }};
}

// The store writes in order: what was asked of it before this write of nothing is done.
void DispatcherBed::LookAgain() {
  Settle();
  Must(server.store().ActOn({}, storage::QueueAct::kHold, {}));
  Settle();
}

bool DispatcherBed::Swept() {
  const int before = hooks.sweeps;  // the next to return may have begun before
  return Eventually([&] { return hooks.sweeps >= before + 2; });
}

void DispatcherBed::End() {
  if (dispatcher_ == nullptr) return;
  dispatcher_->Drain(std::chrono::milliseconds(0));
  dispatcher_->Settle();
  executor_.reset();
  dispatcher_.reset();
  feed_.reset();
}

std::vector<v1::JobEvent> DispatcherBed::Events(std::int64_t id) {
  std::vector<v1::JobEvent> events;
  for (const storage::EventRecord& record : Must(server.store().JobEvents(id, 0, 1000))) {
    events.push_back(ToProto(record));
  }
  return events;
}

}  // namespace rmlcell::server
