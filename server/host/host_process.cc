#include "server/host/host_process.h"

#include <google/protobuf/util/time_util.h>
#include <malloc.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "proto/bridge/findings.h"
#include "server/host/answers_due.h"
#include "server/host/background.h"
#include "server/host/further_lines.h"
#include "server/host/host_clock.h"
#include "server/host/host_inbox.h"
#include "server/host/host_line.h"
#include "server/host/host_machine.h"
#include "server/host/host_name.h"
#include "server/host/host_options.h"
#include "server/host/journal_writer.h"
#include "server/host/lease_clock.h"
#include "server/host/order_class.h"
#include "server/host/parked_orders.h"
#include "server/host/recovered.h"
#include "server/host/servers_in_turn.h"
#include "server/host/status_rhythm.h"
#include "server/host/unstored_entries.h"
#include "server/host/waiting_messages.h"

namespace rmlcell::server {
namespace {

using namespace std::chrono_literals;
using google::protobuf::util::TimeUtil;
using std::chrono::nanoseconds;

constexpr nanoseconds kStatusMoving = 51ms, kStatusStanding = 1s;  // LIVE-3.16
constexpr nanoseconds kTickHeld = 50ms, kTickJogging = 10ms;       // of a run that stands, of a jog
constexpr nanoseconds kEndsWithoutServer = 60s, kRejoin = 200ms;
constexpr double kPreviewTime_s = 60.0;  // LIVE-6.01

class HostProcess {
 public:
  HostProcess(const HostOptions& options, const std::atomic<bool>& stopping)
      : options_(options), stopping_(stopping), name_(NameOfHost()) {}

  ~HostProcess() {
    writer_.reset();
    if (connector_.joinable()) connector_.join();
    further_.Keep({}, {});
    line_.reset();
  }

  int Run() {
    without_server_since_ = Now().steady;
    while (!ended_) {
      KeepLine();
      TakeMessages();
      DoLater();
      if (machine_ != nullptr && !ended_) Turn();
      if (ended_) break;
      if (stopping_) End("it is told to stop");
      EndWithoutServer();
      Rest();
    }
    return exit_code_;
  }

 private:
  v1::HostHello Hello() { return HelloOf(options_, name_, fence_, had_job_); }

  // A line is looked for beside the machine, which goes on meanwhile.
  void KeepLine() {
    std::optional<HostInbox::Joined> joined = inbox_.TakeJoined();
    const nanoseconds now = Now().steady;
    const bool silent = line_ != nullptr && now - inbox_.heard_at() > patience_.silence;
    if (line_ != nullptr && (silent || inbox_.line_gone())) {
      spdlog::warn(silent ? "the server is silent" : "the line to the server is gone");
      if (silent) line_->Cut();
      line_.reset();
      // Of one that is silent it is not known whether it was stopped or is only late.
      without_server_since_ = silent ? now - patience_.silence : now;
      ForgetOrders();
    }
    if (joined) {
      connector_.join();
      Joined(*std::move(joined));
    }
    if (line_ == nullptr && !connector_.joinable() && !lost_until_ && Now().steady >= next_try_)
      Connect();
    if (line_ == nullptr && further_.IsHeard()) without_server_since_ = Now().steady;
    if (further_.TakeFresh()) ShowAnew();
  }

  // They cannot be answered any more. Nothing of them begins; what halts acts all the same.
  void ForgetOrders() {
    const WaitingMessages::Taken taken = inbox_.TakeMessages();
    // Those of the other servers have numbers of the host's own, below 0.
    parked_.ForgetLine();
    answers_due_.ForgetLine();
    std::erase_if(keys_waiting_, [](const Waiting& key) { return key.order.number() > 0; });
    ++lines_lost_;
    if (machine_ == nullptr) return;
    machine_->RefuseEdit(ErrorCode::kCellStoreUnavailable,
                         Now());  // perhaps it is stored: asked anew
    for (const v1::HostResponse& message : taken.messages) {
      if (message.has_entries_stored()) NoteStored(message.entries_stored().sequence());
      if (Halts(message)) static_cast<void>(machine_->Do(message.order(), Now()));
    }
    for (const v1::HostOrder& order : taken.stops) static_cast<void>(machine_->Do(order, Now()));
  }

  void Connect() {
    inbox_.LineBegins();
    joining_since_ = SinceBoot();
    connector_ = std::thread([this, hello = Hello(), server = servers_.present()] {
      inbox_.HaveJoined(HostLine::Join(
          server, hello,
          [this](v1::HostResponse message) { inbox_.Hear(std::move(message), Now().steady); },
          [this] { inbox_.LineIsGone(); }, patience_.line));
    });
  }

  // A server that has come knows nothing yet.
  void ShowAnew() {
    handbox_shown_.clear();
    rhythm_.TellAt(Now().steady);
  }

  // To all but the one that stores what happens here. LIVE-3.06
  void KeepFurther() {
    if (fence_ != 0) further_.Keep(servers_.others(), Hello());
  }

  void Joined(Result<HostLine::Welcome> welcome) {
    const nanoseconds now = Now().steady;
    if (!welcome) {
      next_try_ = now + kRejoin;
      const ErrorCode code = welcome.error().code;
      servers_.Next();
      if (code == ErrorCode::kCellUnavailable) return;
      spdlog::error("{}", welcome.error().detail);
      if (code == ErrorCode::kCellMachineTaken) return LoseMachine("another host");
      // Behind an upgrade by more than one version: what it moves comes to rest. LIVE-3.07
      if (code == ErrorCode::kCellVersionMismatch && machine_ != nullptr && !IsHeard() &&
          ++refused_by_ > servers_.others().size())
        return End("its servers are of another version");
      return servers_.others().empty() ? Quit(69) : void();  // another server may take it
    }
    const v1::HostWelcome& message = welcome->message;
    if (fence_ != 0 && message.fence() != fence_) return LoseMachine("another host");
    fence_ = message.fence();
    lease_.Given(nanoseconds(TimeUtil::DurationToNanoseconds(message.lease())), joining_since_);
    inbox_.SetHeardAt(now);
    refused_by_ = 0;
    line_ = std::move(welcome->line);
    for (const std::string& server : message.servers()) servers_.Add(server);
    KeepFurther();
    if (machine_ == nullptr) {
      welcome_ = message;
    } else if (!unstored_.empty()) {
      SendEntries(unstored_.all());
    }
    ShowAnew();
  }

  void TakeMessages() {
    WaitingMessages::Taken taken = further_.TakeMessages();
    // A line may be heard before it is known to have joined: what it says waits for that.
    if (line_ != nullptr) taken.Append(inbox_.TakeMessages());
    for (const v1::HostOrder& order : StopFirst(taken.messages)) Refuse(order, StoppedBefore());
    if (!taken.stops.empty()) {
      for (const v1::HostOrder& order : taken.TakeMotions()) Refuse(order, StoppedBefore());
    }
    for (const v1::HostOrder& order : taken.stops) TakeOrder(order);
    for (v1::HostResponse& message : taken.messages) Take(message);
    for (const v1::HostOrder& order : taken.refused)
      Refuse(order, {ErrorCode::kCellUnavailable, "too many orders wait for it", {}});
  }

  void Take(v1::HostResponse& message) {
    switch (message.message_case()) {
      case v1::HostResponse::kMemory:
        TakeMemory(message.memory());
        break;
      case v1::HostResponse::kOrder:
        TakeOrder(message.order());
        break;
      case v1::HostResponse::kEntriesStored:
        NoteStored(message.entries_stored().sequence());
        break;
      case v1::HostResponse::kRenewed:
        lease_.Renewed();
        break;
      case v1::HostResponse::kLeaseLost:
        LoseMachine(message.lease_lost().holder());
        break;
      case v1::HostResponse::kEditAnswer:
        if (machine_ != nullptr) machine_->EditAnswered(message.edit_answer(), Now());
        break;
      case v1::HostResponse::kStop:
        End(message.stop().reason());
        break;
      default:
        break;
    }
  }

  void NoteStored(std::int64_t sequence) {
    had_job_.clear();
    unstored_.Stored(sequence);
    if (writer_ != nullptr) writer_->Stored(fence_, sequence);
    if (machine_ != nullptr) machine_->NoteStored(sequence);
  }

  void TakeMemory(const v1::HostMemory& memory) {
    const HostTime now = Now();
    if (machine_ != nullptr) return machine_->Change(memory, now);
    if (!memory.whole() || !welcome_) return;
    auto opened = OpenMachine(*welcome_, options_, name_, now);
    if (!opened) {
      spdlog::error("{}: {}", options_.machine, bridge::ErrorText(opened.error()));
      return Quit(69);
    }
    machine_ = std::move(opened->machine);
    writer_ = std::make_unique<JournalWriter>(std::move(opened->journal));
    durable_at_ = now.steady;
    machine_->Begin(memory, now);
    ::malloc_trim(0);  // what was read of the journal were many small pieces
    spdlog::info("{} lives, fence {}", options_.machine, fence_);
  }

  // `until`: of a key, how long it waits for those before it.
  void TakeOrder(const v1::HostOrder& order, std::optional<nanoseconds> until = std::nullopt) {
    if (machine_ == nullptr)
      return Refuse(order, {ErrorCode::kCellNotLive, "the machine is starting", {}});
    if (order.has_preview_start()) return Preview(order);
    const OrderClass kind = machine_->SlowsDown(order) ? OrderClass::kLetsGo : ClassOf(order);
    if (machine_->WaitsForKeys(order, Now())) {
      keys_waiting_.push_back(
          {.order = order, .until = until.value_or(Now().steady + patience_.keys)});
      return;
    }
    if ((ending_at_ || lost_until_) && kind != OrderClass::kActsFirst &&
        kind != OrderClass::kLetsGo && kind != OrderClass::kAsks)
      return Refuse(order, {ErrorCode::kCellNotLive, "its host ends", {}});
    switch (kind) {
      case OrderClass::kActsFirst:
        // Whoever stops the machine stops what has not begun yet, too.
        return StopWhatBegins(order);
      case OrderClass::kLetsGo:
        return SendAnswer(CarryOut(order));
      case OrderClass::kAsks:
        if (IsParked(order.for_job()))
          return Refuse(order, {ErrorCode::kCellNotLive, "it is about to begin", {}});
        return SendAnswer(CarryOut(order));
      case OrderClass::kWrittenFirst:
        return WriteFirst(order);
      case OrderClass::kWrittenBehind:
        return AnswerWhenDurable(CarryOut(order), order);
    }
  }

  // Beside the machine, which goes on. LIVE-6.01
  void Preview(const v1::HostOrder& order) {
    auto prepared = machine_->PreparePreview(order, Now());
    if (!prepared) return Refuse(order, prepared.error());
    auto task = std::make_shared<HostMachine::PreviewTask>(*std::move(prepared));
    const bool begun =
        background_.Do([this, order, task, line = lines_lost_](const std::stop_token& stop) {
          const double until = ThreadTime_s() + kPreviewTime_s;
          auto made = std::make_shared<Result<machine::StartPreview>>(task->run(
              task->start,
              {.go_on = [&] { return !stop.stop_requested() && ThreadTime_s() < until; }}));
          inbox_.Later([this, order, task, made, line] {
            background_.Done();
            looked_at_for_.clear();
            v1::HostOrderAnswer answer =
                machine_->Previewed(order, std::move(*task), std::move(*made), Now());
            if (order.number() < 0 || line == lines_lost_) SendAnswer(std::move(answer));
          });
        });
    if (!begun)
      return Refuse(order, {ErrorCode::kCellUnavailable, "another start is looked at", {}});
    looked_at_for_ = order.for_job();
  }

  // What was taught goes to the store; without a server it cannot. LIVE-7.08
  void SendEdits(const HostTime& now) {
    for (v1::HostEdit& edit : machine_->TakeEdits()) {
      if (line_ == nullptr) return machine_->RefuseEdit(ErrorCode::kCellStoreUnavailable, now);
      v1::HostRequest request;
      *request.mutable_edit() = std::move(edit);
      line_->Send(std::move(request));
    }
  }

  // At most 20 times a second, and when it has changed. LIVE-7.02
  void ShowHandbox(nanoseconds now) {
    if (!IsHeard()) return void(handbox_due_ = false);
    std::optional<v1::HandboxPanel> panel = machine_->Handbox();
    if (!panel) return;
    std::string bytes = panel->SerializeAsString();
    handbox_due_ = bytes != handbox_shown_;
    if (!handbox_due_ || now - handbox_shown_at_ < kStatusMoving) return;
    handbox_due_ = false;
    handbox_shown_ = std::move(bytes);
    handbox_shown_at_ = now;
    further_.SendPanel(*panel);
    if (line_ == nullptr) return;
    v1::HostRequest request;
    *request.mutable_panel() = *std::move(panel);
    line_->Send(std::move(request));
  }

  // Keys that came before one that is missing. LIVE-7.04
  void LookAtKeys() {
    // One that is on its way to the disk is not missing.
    const bool parked = parked_.HasKey();
    for (Waiting& key : std::exchange(keys_waiting_, {})) {
      const HostTime now = Now();
      // Their patience begins behind what they wait for.
      if (parked || machine_->Settles()) key.until = now.steady + patience_.keys;
      const bool missing = now.steady >= key.until && machine_->WaitsForKeys(key.order, now);
      if (!missing) TakeOrder(key.order, key.until);
      if (missing)
        Refuse(key.order, {ErrorCode::kCellKeySequence, "keys before it are missing", {}});
    }
  }

  bool IsParked(const std::string& job) const {
    return !job.empty() && (job == looked_at_for_ || parked_.HasJob(job));
  }

  // Whoever stops the machine stops what has not begun yet, too; of an order for a job that one.
  void StopWhatBegins(v1::HostOrder order) {
    const std::string job = order.for_job();
    if (IsParked(job)) order.clear_for_job();  // it stops nothing else: the machine stands
    for (const v1::HostOrder& taken : parked_.TakeMotions(job)) Refuse(taken, StoppedBefore());
    for (const Waiting& key : std::exchange(keys_waiting_, {})) Refuse(key.order, StoppedBefore());
    SendAnswer(CarryOut(order));
  }

  v1::HostOrderAnswer CarryOut(const v1::HostOrder& order) {
    rhythm_.TellAt(Now().steady);
    return machine_->Do(order, Now());
  }

  // By a server, whichever.
  bool IsHeard() const { return line_ != nullptr || further_.IsHeard(); }

  // As soon as it is due.
  void TellStatus(const HostTime& now) {
    if (machine_ == nullptr || !IsHeard() || !rhythm_.IsDue(now.steady)) return;
    const v1::MachineStatus status = machine_->StatusAt(now);
    state_told_ = machine_->State();
    rhythm_.Told(now.steady, machine_->moves() ? kStatusMoving : kStatusStanding);
    further_.SendStatus(status);
    if (line_ != nullptr) line_->SendStatus(status);
  }

  // Behind how the machine stands with it: who has an answer and looks sees what came of it.
  void SendAnswer(v1::HostOrderAnswer answer) {
    TellStatus(Now());
    if (further_.Answer(answer) || line_ == nullptr) return;
    v1::HostRequest request;
    *request.mutable_answer() = std::move(answer);
    line_->Send(std::move(request));
  }

  void Refuse(const v1::HostOrder& order, const Error& error) {
    v1::HostOrderAnswer answer;
    answer.set_number(order.number());
    *answer.mutable_refusal() = bridge::ToErrorDetail(error);
    if (machine_ != nullptr) machine_->PassKey(order, answer, Now());
    SendAnswer(std::move(answer));
  }

  // That it is about to act is on the disk before it does. LIVE-3.21
  void WriteFirst(const v1::HostOrder& order) {
    if (const auto trouble = writer_->trouble()) return Refuse(order, *trouble);
    const HostTime now = Now();
    Write(now, true);
    const auto parked = parked_.Add(order, now.steady + patience_.intent);
    writer_->Write({machine_->IntentOf(order, now)}, {}, [this, parked] {
      inbox_.Later([this, parked] {
        const bool begins = !std::exchange(parked->over, true);
        if (begins && further_.IsAskedFor(parked->order.number()))
          AnswerWhenDurable(CarryOut(parked->order), parked->order);
      });
    });
  }

  void AnswerWhenDurable(v1::HostOrderAnswer answer, const v1::HostOrder& order) {
    answers_due_.Add(std::move(answer), AssignmentOf(order) != nullptr);
    Write(Now(), true);
  }

  // What happened goes to the disk, and from there to the server.
  void Write(const HostTime& now, bool at_once) {
    std::vector<v1::JournalEntry> entries = machine_->TakeEntries(now, at_once);
    if (entries.empty()) return;
    auto copy = std::make_shared<const std::vector<v1::JournalEntry>>(entries);
    if (writes_under_way_++ == 0) durable_at_ = now.steady;
    const auto due = answers_due_.Begin(now.steady);
    writer_->Write(std::move(entries), machine_->TakeRecorded(), [this, copy, due] {
      inbox_.Later([this, copy, due] {
        --writes_under_way_;
        durable_at_ = Now().steady;
        unstored_.Add(*copy);
        SendEntries(*copy);
        answers_due_.End(due);
        for (const auto* answers : {&due->answers, &due->of_jobs})
          std::ranges::for_each(*answers, [this](const auto& answer) { SendAnswer(answer); });
      });
    });
  }

  // One that has not begun yet, too. What moves is brought to rest before, and a run that is held
  // waits for a person, as long as there is somewhere to keep it. LIVE-3.31
  void EndWithoutServer() {
    const bool waits = machine_ != nullptr && (machine_->moves() || machine_->run_open());
    if (IsHeard() || (waits && std::filesystem::exists(options_.journal))) return;
    if (Now().steady - without_server_since_ <= kEndsWithoutServer) return;
    spdlog::warn("no server for {} s", kEndsWithoutServer / 1s);
    Quit(0);
  }

  void DoLater() {
    std::ranges::for_each(inbox_.TakeWork(), [](const auto& one) { one(); });
  }

  // A disk that does not answer: nothing begins, and what moves is held. LIVE-3.21
  void LookAtDisk(nanoseconds now) {
    for (const v1::HostOrder& order : parked_.TakeLate(now))
      Refuse(order, {ErrorCode::kCellJournal, "the disk does not answer", {}});
    const bool late = writes_under_way_ > 0 && now - durable_at_ > patience_.durable;
    machine_->NoteDisk(late);
    for (v1::HostOrderAnswer& answer : answers_due_.TakeLate(now, patience_.durable))
      SendAnswer(std::move(answer));
    if (machine_->moves() && late) machine_->Hold(v1::HOLD_REASON_LATE, Now());
  }

  // The machine goes on, and what happened is told.
  void Turn() {
    const HostTime now = Now();
    behind_ = !machine_->GoOn(now);
    if (!IsHeard() && machine_->moves() &&
        now.steady - without_server_since_ > GoesOnWithoutServer(welcome_->options()))
      machine_->Hold(v1::HOLD_REASON_SERVER_LOST, now);
    // Another one may take the machine when the lease ends: it rests before. LIVE-3.04
    if (machine_->moves() && lease_.MustStop(SinceBoot()))
      machine_->Hold(v1::HOLD_REASON_MACHINE_LEASE, now);
    LookAtDisk(now.steady);
    LookAtKeys();
    SendEdits(now);
    Write(now, false);
    ShowHandbox(now.steady);
    if (machine_->State() != state_told_) rhythm_.TellAt(now.steady);
    TellStatus(now);
    if (line_ != nullptr && lease_.RenewalDue(SinceBoot())) {
      lease_.Renews(SinceBoot());
      v1::HostRequest renew;
      renew.mutable_renew()->set_fence(fence_);
      line_->Send(std::move(renew));
    }
    if (ending_at_) machine_->Hold(v1::HOLD_REASON_STOP, now);  // whatever began meanwhile
    if (lost_until_) machine_->Hold(v1::HOLD_REASON_MACHINE_LEASE, now);
    if (lost_until_ && (!machine_->moves() || now.steady >= *lost_until_)) return GiveUp(now);
    const bool rests = !machine_->moves() && !machine_->waits_for_store();
    if (ending_at_ && (rests || now.steady >= *ending_at_)) HandBack(now);
  }

  // Another host has the machine: this one brakes, and touches nothing any more. LIVE-3.05
  void LoseMachine(const std::string& holder) {
    if (lost_until_) return;
    spdlog::error("{}", bridge::ErrorText(Error{
                            ErrorCode::kCellMachineTaken, holder + " has the machine now", {}}));
    if (machine_ == nullptr) return Quit(3);
    parked_.ForgetAll();
    lost_until_ = Now().steady + patience_.rest;  // it is held from the next turn on
  }

  // What the store does not take from it is kept for people to look at.
  void GiveUp(const HostTime& now) {
    Write(now, true);
    writer_.reset();
    DoLater();
    const Result<std::string> orphan = unstored_.KeepAsOrphan(options_.journal);
    if (!orphan) spdlog::error("{}", bridge::ErrorText(orphan.error()));
    if (orphan && !orphan->empty())
      spdlog::error("{}", bridge::ErrorText(Error{
                              ErrorCode::kCellMachineTaken,
                              "what happened here and is not in the log is kept in " + *orphan,
                              {}}));
    Quit(3);
  }

  void SendEntries(const std::vector<v1::JournalEntry>& entries) {
    if (entries.empty() || line_ == nullptr || lost_until_) return;
    for (v1::HostRequest& request : EntriesInParts(entries, fence_))
      line_->Send(std::move(request));
  }

  // In order: it comes to rest first. LIVE-5.09
  void End(const std::string& why) {
    if (ending_at_) return;
    spdlog::info("{} ends: {}", options_.machine, why);
    if (machine_ == nullptr) return Quit(0);
    const HostTime now = Now();
    machine_->Hold(v1::HOLD_REASON_STOP, now);
    ending_at_ = now.steady + patience_.rest;
  }

  void HandBack(const HostTime& now) {
    parked_.ForgetAll();
    machine_->EndRun(now);
    Write(now, true);
    writer_.reset();  // it writes what waits
    DoLater();
    if (line_ != nullptr) {
      v1::HostRequest request;
      request.mutable_hand_back()->set_fence(fence_);
      line_->Send(std::move(request));
    }
    Quit(0);
  }

  void Quit(int code) { ended_ = true, exit_code_ = code; }

  void Rest() {
    if (behind_) return;
    nanoseconds longest = line_ != nullptr ? kStatusStanding : kRejoin;
    if (machine_ != nullptr) {
      const nanoseconds now = Now().steady;
      if (IsHeard()) longest = std::min(longest, rhythm_.due() - now);
      if (line_ != nullptr) longest = std::min(longest, lease_.next_renewal() - SinceBoot());
      if (machine_->run_open()) longest = std::min(longest, kTickHeld);
      const bool jogs = machine_->State() == v1::MACHINE_STATE_JOGGING;
      if (machine_->moves())
        longest = std::min(longest, jogs ? kTickJogging : machine::VirtualDriver::kTurn);
      if (const auto look = machine_->next_look()) longest = std::min(longest, *look - now);
      for (const Waiting& key : keys_waiting_) longest = std::min(longest, key.until - now);
      if (handbox_due_) longest = std::min(longest, handbox_shown_at_ + kStatusMoving - now);
    }
    inbox_.Wait(longest, line_ != nullptr);
  }

  const HostOptions& options_;
  const HostPatience& patience_ = options_.patience;
  const std::atomic<bool>& stopping_;
  const std::string name_;
  HostInbox inbox_;
  std::thread connector_;
  std::unique_ptr<HostLine> line_;
  ServersInTurn servers_{options_.server};
  std::optional<v1::HostWelcome> welcome_;
  std::unique_ptr<HostMachine> machine_;
  struct Waiting {
    v1::HostOrder order{};
    nanoseconds until{0};
  };
  std::vector<Waiting> keys_waiting_;
  ParkedOrders parked_;
  AnswersDue answers_due_;
  std::string looked_at_for_;  // the job whose start at a step is worked out; empty: none
  int writes_under_way_ = 0;
  nanoseconds durable_at_{0};  // what was written last; where nothing is under way, what begins
  int lines_lost_ = 0;
  std::size_t refused_by_ = 0;  // servers of another version, one after the other
  UnstoredEntries unstored_;
  std::int64_t fence_ = 0;
  LeaseClock lease_;
  nanoseconds joining_since_{0};  // by SinceBoot
  nanoseconds next_try_{0}, without_server_since_{0}, handbox_shown_at_{0};
  StatusRhythm rhythm_;
  std::optional<nanoseconds> ending_at_;
  std::optional<nanoseconds> lost_until_;  // another host has the machine; so long this one brakes
  std::string handbox_shown_, had_job_;    // `had_job_`: by the host before, until the server knows
  bool handbox_due_ = false;               // it has changed since
  v1::MachineState state_told_ = v1::MACHINE_STATE_UNSPECIFIED;
  std::unique_ptr<JournalWriter> writer_;
  Background background_;  // behind what its work uses
  FurtherLines further_{[this] { inbox_.Later([] {}); }, patience_.silence};
  bool behind_ = false, ended_ = false;
  int exit_code_ = 0;
};

}  // namespace

int RunHost(const HostOptions& options, const std::atomic<bool>& stopping) {
  return HostProcess(options, stopping).Run();
}

}  // namespace rmlcell::server
