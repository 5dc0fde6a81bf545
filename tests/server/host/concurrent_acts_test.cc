// Four acts at one machine in every order, and each of them at any moment (live.md 10.03).
#include <algorithm>
#include <array>

#include "server/host/recovered.h"
#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

enum class Deed { kStart, kStop, kTakeOver, kRelease, kDoor, kHostDies };
constexpr std::array kActs = {Deed::kStart,   Deed::kStop, Deed::kTakeOver,
                              Deed::kRelease, Deed::kDoor, Deed::kHostDies};

class ConcurrentActs : public HostMachineTest {
 protected:
  void Begin() {
    Make();
    host_->Begin({}, now_);
    disk_.clear();
    holder_ = "anna";
    token_.clear();
    door_open_ = may_move_ = holds_ = false;
    Control(v1::ControlLease::ON_LOSS_HOLD);
    own_token_ = token_;
  }
  v1::HostOrderAnswer By(const std::string& caller, v1::HostOrder order) {
    order.set_number(++number_);
    order.set_caller(caller);
    return host_->Do(order, now_);
  }
  void Keep() {
    for (v1::JournalEntry& entry : host_->TakeEntries(now_, true)) disk_.push_back(entry);
  }

  // By a plain model beside it: who has control, whether the door is open, and whether anything may
  // move.
  void Act(Deed act) {
    switch (act) {
      case Deed::kStart: {
        v1::HostOrder order = Start("start");
        order.mutable_start()->set_control_token(own_token_);
        const bool begins = holder_ == "anna" && !inspect_ && !door_open_;
        EXPECT_EQ(!By("anna", order).has_refusal(), begins);
        may_move_ = may_move_ || begins;
        break;
      }
      case Deed::kStop:
        EXPECT_FALSE(By("carl", Stop()).has_refusal());
        may_move_ = false;
        break;
      case Deed::kTakeOver: {
        v1::HostOrder order;
        v1::AcquireControlRequest& acquire = *order.mutable_acquire_control();
        acquire.set_take_over(true);
        acquire.set_reason("mine");
        acquire.mutable_ttl()->set_seconds(60);
        acquire.set_on_loss(v1::ControlLease::ON_LOSS_GO_ON);
        acquire.set_client("a test");
        EXPECT_FALSE(By("bert", order).has_refusal());
        holder_ = "bert";
        break;
      }
      case Deed::kRelease: {
        v1::HostOrder order;
        order.mutable_release_control()->set_control_token(own_token_);
        EXPECT_EQ(!By("anna", order).has_refusal(), holder_ == "anna");
        if (holder_ != "anna") break;
        holder_.clear();
        may_move_ = false;  // ON_LOSS_HOLD: after the present instruction
        holds_ = true;
        break;
      }
      case Deed::kDoor: {  // of a mill whose cover pauses (DEV-3.12)
        v1::HostOrder order;
        order.mutable_inputs()->set_control_token(own_token_);
        order.mutable_inputs()->add_inputs()->set_door_open(true);
        const bool opens = holder_ == "anna";
        EXPECT_EQ(!By("anna", order).has_refusal(), opens);
        if (!opens) break;
        door_open_ = true;
        may_move_ = false;
        break;
      }
      case Deed::kHostDies: {
        Keep();
        const bool open = host_->StatusAt(now_).has_run();
        HostMachine::Setup setup = SetupOf(RecoveredFrom(v1::HostWelcome(), disk_));
        setup.name = "machines/mill-1";
        setup.host = "workshop/2";
        setup.fence = 8;
        setup.family = families::FindFamily("rml1");
        setup.profile = "srm-20";
        setup.memory.programs[5] = {.name = "square", .object = machine::Bytes::Of(kSquare)};
        auto made = HostMachine::Make(std::move(setup), now_,
                                      [this] { return "token " + std::to_string(++tokens_); });
        ASSERT_TRUE(made);
        host_ = *std::move(made);
        host_->Begin({}, now_);
        holder_ = "nobody";  // no token of before counts
        may_move_ = false;
        inspect_ = inspect_ || open;
        break;
      }
    }
  }
  // Where it may not move it comes to rest, and stays there.
  void Look() {
    Pass(3s);
    if (holds_) Pass(25s, 50ms);  // a side of the square takes 20 s
    const v1::MachineState state = host_->StatusAt(now_).state();
    EXPECT_EQ(state == v1::MACHINE_STATE_RUNNING, may_move_) << state;
    if (may_move_) return;
    const auto stands = host_->StatusAt(now_);
    Pass(2s);
    const auto later = host_->StatusAt(now_);
    for (int axis = 0; axis < stands.axes_size(); ++axis)
      EXPECT_EQ(stands.axes(axis).value(), later.axes(axis).value());
  }

  std::vector<v1::JournalEntry> disk_;
  std::string holder_;
  std::string own_token_;
  bool door_open_ = false;
  bool may_move_ = false;
  bool holds_ = false;
  bool inspect_ = false;
};

// LIVE-10.03, LIVE-2.05: nothing moves but what a start with control began, and nothing that has
// stopped moves by itself.
TEST_F(ConcurrentActs, InEveryOrder) {
  int orders = 0;
  std::array<std::size_t, kActs.size()> pick = {0, 1, 2, 3, 4, 5};
  std::vector<std::array<std::size_t, 4>> seen;
  do {
    const std::array<std::size_t, 4> four = {pick[0], pick[1], pick[2], pick[3]};
    if (!seen.empty() && seen.back() == four) continue;
    seen.push_back(four);
    for (const std::chrono::milliseconds apart : {0ms, 30ms, 400ms}) {
      Begin();
      inspect_ = false;
      std::string told;
      for (const std::size_t one : four) {
        told += std::to_string(one) + " ";
        Act(kActs[one]);
        Pass(apart);
      }
      SCOPED_TRACE(told + std::to_string(apart.count()) + " ms");
      Look();
      ++orders;
      if (HasFailure()) return;
    }
  } while (std::ranges::next_permutation(pick).found);
  EXPECT_EQ(orders, 360 * 3);
}

}  // namespace
}  // namespace rmlcell::server
