// Orders of every kind with any fields, at any time, with crashes between (live.md 10.01, 10.06).
#include <cmath>
#include <random>
#include <set>

#include "proto/recording/replay.h"
#include "server/host/order_class.h"
#include "server/host/recovered.h"
#include "tests/server/any_messages.h"
#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

constexpr const char* kTeaching =
    "VI[3] = 0\n10 VI[3] = VI[3] + 1\nMOVE (1500., 500., -400., 0., 0.)\nOL[3] = ON\nDELAY 0.2\n"
    "MOVE (1600., 500., -400., 0., 0.)\nOL[3] = OFF\nIF VI[3] < 4 THEN 10\n";

class RandomOrders : public HostMachineTest {
 protected:
  void MakeOf(const std::string& family, HostMachine::Setup setup = {}) {
    setup.name = "machines/any";
    setup.host = "workshop/1";
    setup.fence = ++fence_;
    setup.family = families::FindFamily(family);
    setup.profile = family == "rml1" ? "srm-20" : "";
    const auto parameters = machine::MakeParameters(*setup.family, setup.profile, {});
    machine::StoredProgram program{.name = "p", .object = machine::Bytes::Of(kSquare)};
    if (family != "rml1") {
      auto made = setup.family->Translate({.name = "5.S", .bytes = kTeaching}, *parameters,
                                          {.advice = false, .source = true});
      ASSERT_TRUE(made.ok);
      program.object = machine::Bytes::Of(made.object);
    }
    setup.memory.programs[5] = program;
    auto made = HostMachine::Make(std::move(setup), now_,
                                  [this] { return "token " + std::to_string(++tokens_); });
    ASSERT_TRUE(made) << made.error().detail;
    host_ = *std::move(made);
    host_->Begin({}, now_);
    last_time_ = sequence_told_ = input_at_ = 0;
  }
  // What a crash leaves: some of what was written.
  void Crash(const std::string& family, int keep) {
    disk_.resize(std::min(disk_.size(), static_cast<std::size_t>(keep)));
    MakeOf(family, SetupOf(RecoveredFrom(v1::HostWelcome(), disk_)));
  }
  static bool Moves(v1::MachineState state) {
    return state == v1::MACHINE_STATE_JOGGING || state == v1::MACHINE_STATE_RUNNING ||
           state == v1::MACHINE_STATE_STOPPING;
  }
  static std::vector<double> Axes(const v1::MachineStatus& status) {
    std::vector<double> axes;
    for (const v1::AxisValue& axis : status.axes()) axes.push_back(axis.value());
    return axes;
  }
  // A machine that stands stays where it stands, and time does not fall. LIVE-2.04
  void Look(const v1::MachineStatus& before) {
    const v1::MachineStatus now = host_->StatusAt(now_);
    ASSERT_GE(now.virtual_time_ns(), last_time_);
    last_time_ = now.virtual_time_ns();
    for (const v1::AxisValue& axis : now.axes()) ASSERT_TRUE(std::isfinite(axis.value()));
    if (!Moves(before.state()) && !Moves(now.state())) {
      ASSERT_EQ(Axes(before), Axes(now)) << now.ShortDebugString();
    }
  }
  // In order, by one host, and no instant before the one in front of it. LIVE-2.05
  void Keep(bool at_once) {
    for (v1::JournalEntry& entry : host_->TakeEntries(now_, at_once)) {
      ASSERT_EQ(entry.fence(), fence_);
      ASSERT_EQ(entry.sequence(), sequence_told_ + 1);
      sequence_told_ = entry.sequence();
      if (entry.applied().fence() == fence_) {  // not of the host before, told behind a crash
        ASSERT_GE(entry.virtual_time_ns(), input_at_) << entry.ShortDebugString();
        input_at_ = entry.virtual_time_ns();
      }
      disk_.push_back(std::move(entry));
    }
  }
  // What was recorded comes out the same, byte by byte, however it came to be. LIVE-3.40
  void Replay() {
    Keep(true);
    std::string file;
    for (;;) {
      v1::HostOrder order;
      order.mutable_recording()->set_offset(static_cast<std::int64_t>(file.size()));
      const v1::HostOrderAnswer answer = Do(order);
      if (answer.recording().chunk().empty()) break;
      file += answer.recording().chunk();
    }
    if (file.empty()) return;
    const auto recording = recording::ReadFile(file);
    ASSERT_TRUE(recording) << recording.error().detail;
    const auto played = recording::Replay(*recording, {});
    ASSERT_TRUE(played) << played.error().detail;
    ASSERT_FALSE(played->difference)
        << played->difference->field << ": " << played->difference->recorded << " is "
        << played->difference->played;
    if (played->inputs > 1) replayed_.insert(recording->entries.front().SerializeAsString());
  }
  void Play(const std::string& family, std::uint32_t seed, int orders) {
    AnyMessages any(seed);
    MakeOf(family);
    for (int i = 0; i < orders && !HasFatalFailure(); ++i) {
      if (i % 40 == 0) {
        any.token = Control(v1::ControlLease::ON_LOSS_GO_ON);
        v1::HostOrder open;
        open.mutable_create_session()->set_control_token(any.token);
        any.session = Do(open).session().name();
        any.next_key = 1;
      }
      any.now = now_.wall;
      const v1::MachineStatus before = host_->StatusAt(now_);
      v1::HostOrder order = any.Order();
      order.set_caller("anna");
      order.set_number(++number_);
      const bool waits = host_->WaitsForKeys(order, now_);
      if (!waits) static_cast<void>(host_->Do(order, now_));
      if (BeginsMotion(order) || waits) {
        Pass(10ms);
      } else {
        Look(before);
      }
      const v1::MachineStatus stands = host_->StatusAt(now_);
      Pass(std::chrono::milliseconds(10 * any.Below(30)));
      if (stands.state() == host_->StatusAt(now_).state() && !Moves(stands.state())) Look(stands);
      Keep(any.Below(2) == 0);
      if (i % 25 == 0) Replay();
      static_cast<void>(host_->TakeEdits());
      if (any.Below(200) == 0) Crash(family, static_cast<int>(disk_.size()) - any.Below(20));
      if (disk_.size() > 2'000) disk_.erase(disk_.begin(), disk_.end() - 1'000);
    }
  }
  std::vector<v1::JournalEntry> disk_;
  std::int64_t fence_ = 6;
  std::int64_t last_time_ = 0;
  std::int64_t sequence_told_ = 0;
  std::int64_t input_at_ = 0;
  std::set<std::string> replayed_;  // where those of several inputs begin
};

// LIVE-10.01, LIVE-10.06, LIVE-2.04
TEST_F(RandomOrders, AMillTakesWhateverComes) {
  for (std::uint32_t seed = 1; seed <= 3 && !HasFatalFailure(); ++seed) Play("rml1", seed, 1'500);
  EXPECT_GT(replayed_.size(), 10U);
}

// LIVE-10.01, LIVE-10.06, LIVE-2.04
TEST_F(RandomOrders, AnOptimoTakesWhateverComes) {
  for (std::uint32_t seed = 1; seed <= 3 && !HasFatalFailure(); ++seed) Play("optimo", seed, 1'500);
  EXPECT_GT(replayed_.size(), 10U);
}

// LIVE-10.06: whatever bytes a journal has, what can be read of it is read.
TEST(RandomJournals, AnyBytesAreRead) {
  std::mt19937 random(7);
  std::vector<v1::JournalEntry> entries(20);
  for (int i = 0; i < 20; ++i) {
    entries[static_cast<std::size_t>(i)].set_sequence(i + 1);
    entries[static_cast<std::size_t>(i)].mutable_mark()->set_state(std::string(100, 'x'));
  }
  const std::string whole = RecordsOf(entries);
  for (int round = 0; round < 2'000; ++round) {
    std::string bytes = whole;
    const int changes = 1 + static_cast<int>(random() % 5);
    for (int i = 0; i < changes; ++i) bytes[random() % bytes.size()] = static_cast<char>(random());
    bytes.resize(random() % (bytes.size() + 1));
    const ReadRecords read = ReadJournal(bytes);
    ASSERT_EQ(read.entries.size(), read.ends.size());
    for (std::size_t i = 0; i < read.entries.size(); ++i) {
      ASSERT_EQ(read.entries[i].sequence(), static_cast<std::int64_t>(i + 1));
      ASSERT_LE(read.ends[i], static_cast<std::int64_t>(bytes.size()));
    }
    static_cast<void>(SetupOf(RecoveredFrom(v1::HostWelcome(), read.entries)));
  }
}

}  // namespace
}  // namespace rmlcell::server
