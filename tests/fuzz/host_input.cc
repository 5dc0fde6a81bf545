#include "tests/fuzz/host_input.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "engine/families/families.h"
#include "proto/recording/records.h"
#include "server/host/host_machine.h"
#include "server/host/journal.h"
#include "server/host/order_class.h"
#include "server/host/recovered.h"

namespace rmlcell::server {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMessagesMax = 60;
constexpr std::size_t kEntriesMax = 40;
constexpr const char* kStream =
    "PA;PA;VS10;!VZ5;!PZ-50,100;!MC0;PU1000,1000;PD3000,1000,3000,3000;PU0,0;";
constexpr const char* kProgram =
    "10 VI[3] = VI[3] + 1\nMOVE (1500., 500., -400., 0., 0.)\nOL[3] = ON\nDELAY 0.2\n"
    "MOVE (1600., 500., -400., 0., 0.)\nIF VI[3] < 4 THEN 10\n";

using Number = std::pair<std::int64_t, std::int64_t>;
Number NumberOf(const v1::JournalEntry& entry) { return {entry.fence(), entry.sequence()}; }

machine::MachineMemory MemoryOf(const machine::MachineFamily& family, const std::string& profile) {
  machine::StoredProgram program{.name = "p", .object = machine::Bytes::Of(kStream)};
  if (family.info().id == "optimo") {
    const auto made = family.Translate({.name = "5.S", .bytes = kProgram},
                                       *machine::MakeParameters(family, profile, {}), {});
    program.object = machine::Bytes::Of(made.object);
  }
  machine::MachineMemory memory;
  memory.programs[5] = program;
  return memory;
}

HostTime Start() { return {.steady = 1h, .wall = WallTime(std::chrono::hours(24 * 365 * 50))}; }

Result<std::unique_ptr<HostMachine>> MakeHost(bool mill, HostMachine::Setup setup) {
  setup.name = "machines/any";
  setup.host = "workshop/1";
  setup.fence = 9;
  setup.family = families::FindFamily(mill ? "rml1" : "optimo");
  setup.profile = std::string(setup.family->info().default_profile);
  setup.memory = MemoryOf(*setup.family, setup.profile);
  return HostMachine::Make(std::move(setup), Start(),
                           [tokens = 0]() mutable { return "token " + std::to_string(++tokens); });
}

bool Moves(v1::MachineState state) {
  return state == v1::MACHINE_STATE_JOGGING || state == v1::MACHINE_STATE_RUNNING ||
         state == v1::MACHINE_STATE_STOPPING;
}

// Whether what lies behind one mark and up to another is more than a job that has not moved.
bool LosesMoreThanABegin(const std::vector<v1::JournalEntry>& entries, const Number& from,
                         const Number& until) {
  bool begins = false;
  for (const v1::JournalEntry& entry : entries) {
    if (NumberOf(entry) <= from || NumberOf(entry) > until) continue;
    const v1::InputApplied& applied = entry.applied();
    const bool counts = !applied.input().has_start() && !applied.caller().empty();
    if (entry.has_run_over() || entry.has_answered() || counts) return true;
    begins = begins || !entry.run_begun().job().empty();
  }
  return !begins;
}

// The newest mark, and what was told before it, as these entries and the store have it.
std::string TryRecovery(const std::vector<v1::JournalEntry>& entries, bool mill) {
  v1::HostWelcome welcome;
  const bool has_stored = entries.size() % 3 == 1;
  if (has_stored) {
    welcome.mutable_mark()->set_fence(entries.front().fence());
    welcome.mutable_mark()->set_sequence(entries.front().sequence());
  }
  const Number stored(welcome.mark().fence(), welcome.mark().sequence());
  std::vector<Number> marks;
  if (has_stored) marks.push_back(stored);
  for (const v1::JournalEntry& entry : entries) {
    if (entry.has_mark() && NumberOf(entry) > stored) marks.push_back(NumberOf(entry));
  }
  const Recovered found = RecoveredFrom(welcome, entries);
  if (found.known == marks.empty()) return "a mark that is not there, or one that is unseen";
  if (marks.empty()) return found.untold.empty() ? "" : "it is told of what no mark covers";
  const Number taken(found.mark.fence(), found.mark.sequence());
  const Number newest = *std::ranges::max_element(marks);
  if (std::ranges::find(marks, taken) == marks.end()) return "a mark that is not there";
  if (taken != newest && LosesMoreThanABegin(entries, taken, newest))
    return "an older mark, though more than the begin of a job came behind it";
  const auto untold = std::ranges::count_if(entries, [&](const v1::JournalEntry& entry) {
    return entry.fence() == taken.first && NumberOf(entry) > stored && NumberOf(entry) <= taken &&
           !entry.has_answered();
  });
  if (std::cmp_not_equal(found.untold.size(), untold))
    return "what was told before the mark is not all there";
  const auto made = MakeHost(mill, SetupOf(found));
  if (!made) return made.error().detail.empty() ? "refused without a reason" : "";
  HostMachine& host = **made;
  HostTime now = Start();
  for (int i = 0; i < 20; ++i) {
    now.steady += 10ms;
    now.wall += 10ms;
    if (Moves(host.State())) return "it moves by itself behind a recovery";
    host.GoOn(now);
  }
  return Moves(host.State()) ? "it moves by itself behind a recovery" : "";
}

std::string TryRecords(std::string_view bytes) {
  const ReadRecords read = ReadJournal(bytes);
  if (read.entries.size() != read.ends.size()) return "entries without their ends";
  if (!std::ranges::is_sorted(read.ends)) return "ends that go back";
  const auto end = read.ends.empty() ? 0 : static_cast<std::size_t>(read.ends.back());
  if (end > bytes.size()) return "an end behind all";
  const ReadRecords again = ReadJournal(bytes.substr(0, end));
  if (again.ends != read.ends) return "another reading of the same records";
  return TryRecovery(read.entries, bytes.size() % 2 == 0);
}

// Of four bytes each: its number goes up, what it is and what it holds hang on the bytes.
std::vector<v1::JournalEntry> EntriesOf(std::string_view bytes) {
  std::vector<v1::JournalEntry> entries;
  Number last{1, 0};
  while (bytes.size() >= 4 && entries.size() < kEntriesMax) {
    const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(bytes[at]); };
    last = byte(0) < 16 ? Number(last.first + 1, 1) : Number(last.first, last.second + 1);
    v1::JournalEntry& entry = entries.emplace_back();
    entry.set_fence(last.first);
    entry.set_sequence(last.second);
    entry.set_virtual_time_ns(byte(1) * 1'000);
    switch (byte(2) % 6) {
      case 0:
        entry.mutable_mark()->set_fence(last.first);
        entry.mutable_mark()->set_sequence(last.second);
        entry.mutable_mark()->set_clean(byte(3) % 2 == 0);
        if (byte(3) % 5 == 0) entry.mutable_mark()->set_run_time_ns(byte(3));
        break;
      case 1:
        entry.mutable_run_begun()->set_run(byte(3));
        if (byte(3) % 2 == 0) entry.mutable_run_begun()->set_job("jobs/17");
        break;
      case 2:
        entry.mutable_run_over()->set_run(byte(3));
        break;
      case 3:
        entry.mutable_intent()->mutable_input()->mutable_start()->set_program(byte(3));
        if (byte(3) % 3 == 0)
          entry.mutable_intent()->mutable_input()->mutable_start()->set_job("jobs/17");
        break;
      case 4:
        entry.mutable_answered()->set_request_id(std::string(1U + byte(3) % 8U, 'r'));
        break;
      default:
        if (byte(3) % 2 == 0) {
          entry.mutable_applied()->mutable_input()->mutable_start()->set_job("jobs/17");
        } else {
          entry.mutable_applied()->mutable_input()->set_factor(byte(3));
          if (byte(3) % 3 != 0) entry.mutable_applied()->set_caller("anna");
        }
    }
    bytes.remove_prefix(4);
  }
  return entries;
}

// `where`, `with` and the entries: three bytes, and four each.
std::string TryDamage(std::string_view bytes) {
  if (bytes.size() < 7) return {};
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(bytes[at]); };
  const std::vector<v1::JournalEntry> entries = EntriesOf(bytes.substr(3));
  const std::string whole = RecordsOf(entries);
  std::string damaged = whole;
  const std::size_t at = (byte(0) * 256U + byte(1)) % whole.size();
  if (byte(2) == 0) {
    damaged.resize(at);
  } else {
    damaged[at] = static_cast<char>(static_cast<unsigned char>(damaged[at]) ^ byte(2));
  }
  const ReadRecords undamaged = ReadJournal(whole);
  if (undamaged.entries.size() != entries.size()) return "not all that was written is read";
  const auto before = static_cast<std::size_t>(std::ranges::count_if(
      undamaged.ends, [at](std::int64_t end) { return end <= static_cast<std::int64_t>(at); }));
  const ReadRecords read = ReadJournal(damaged);
  if (read.entries.size() < before) return "what lies before the damage is lost";
  if (read.entries.size() > before) return "what was damaged is taken for whole";
  for (std::size_t i = 0; i < before; ++i) {
    if (read.entries[i].SerializeAsString() != entries[i].SerializeAsString())
      return "an entry before the damage is another one";
  }
  return TryRecovery(read.entries, byte(0) % 2 == 0);
}

// A host that hears these messages, as its process hands them over (host_process.cc).
class Hearer {
 public:
  explicit Hearer(bool mill) : host_(*MakeHost(mill, {})) { host_->Begin({}, now_); }

  std::string Hear(const v1::HostResponse& message) {
    switch (message.message_case()) {
      case v1::HostResponse::kOrder:
        return Order(message.order());
      case v1::HostResponse::kMemory:
        host_->Change(message.memory(), now_);
        return {};
      case v1::HostResponse::kEditAnswer:
        host_->EditAnswered(message.edit_answer(), now_);
        return {};
      case v1::HostResponse::kLeaseLost:
        host_->Hold(v1::HOLD_REASON_MACHINE_LEASE, now_);
        return {};
      default:
        return {};
    }
  }

  // Time goes by.
  std::string Wait(std::chrono::milliseconds time) {
    const v1::MachineStatus before = host_->StatusAt(now_);
    now_.steady += time;
    now_.wall += time;
    for (int i = 0; i < 200 && !host_->GoOn(now_); ++i) continue;
    const v1::MachineStatus behind = host_->StatusAt(now_);
    if (behind.virtual_time_ns() < before.virtual_time_ns()) return "time falls";
    for (const v1::AxisValue& axis : behind.axes()) {
      if (!std::isfinite(axis.value())) return "an axis is nowhere";
    }
    if (!Moves(before.state()) && Moves(behind.state())) return "it begins to move by itself";
    if (!Moves(before.state()) && !SameAxes(before, behind)) return "it stands and goes elsewhere";
    static_cast<void>(host_->TakeEdits());
    return Tell(false);
  }

 private:
  std::string Order(const v1::HostOrder& order) {
    if (order.has_preview_start()) {
      static_cast<void>(host_->PreparePreview(order, now_));
      return {};
    }
    if (host_->WaitsForKeys(order, now_)) return {};
    if (BeginsMotion(order)) {
      if (std::string wrong = Tell(true); !wrong.empty()) return wrong;
      if (host_->IntentOf(order, now_).sequence() != ++told_)
        return "what it is about to do does not count up";
    }
    const v1::HostOrderAnswer answer = host_->Do(order, now_);
    if (answer.number() != order.number()) return "an answer to another order";
    if (answer.result_case() == v1::HostOrderAnswer::RESULT_NOT_SET)
      return "an answer with nothing";
    return {};
  }
  std::string Tell(bool at_once) {
    for (const v1::JournalEntry& entry : host_->TakeEntries(now_, at_once)) {
      if (entry.sequence() != ++told_) return "what it tells does not count up";
      if (entry.fence() != 9) return "it tells by another fence";
    }
    return {};
  }
  static bool SameAxes(const v1::MachineStatus& one, const v1::MachineStatus& other) {
    return std::ranges::equal(one.axes(), other.axes(), {}, &v1::AxisValue::value,
                              &v1::AxisValue::value);
  }

  HostTime now_ = Start();
  std::unique_ptr<HostMachine> host_;
  std::int64_t told_ = 0;
};

}  // namespace

std::string TryJournal(std::string_view bytes) {
  if (bytes.empty()) return {};
  return bytes.front() == 'd' ? TryDamage(bytes.substr(1)) : TryRecords(bytes.substr(1));
}

std::string TryHostMessages(std::string_view bytes) {
  if (bytes.empty()) return {};
  Hearer hearer(bytes.front() % 2 != 0);
  bytes.remove_prefix(1);
  for (std::size_t count = 0; bytes.size() >= 2 && count < kMessagesMax; ++count) {
    const auto high = static_cast<unsigned char>(bytes[0]);
    const auto low = static_cast<unsigned char>(bytes[1]);
    const std::string_view one = bytes.substr(2, high % 16U * 256U + low);
    v1::HostResponse message;
    if (message.ParseFromArray(one.data(), static_cast<int>(one.size()))) {
      if (std::string wrong = hearer.Hear(message); !wrong.empty()) return wrong;
    }
    const auto time = std::chrono::milliseconds(1 + 40 * (high / 16));
    if (std::string wrong = hearer.Wait(time); !wrong.empty()) return wrong;
    bytes.remove_prefix(2 + one.size());
  }
  return {};
}

}  // namespace rmlcell::server
