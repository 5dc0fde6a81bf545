// What a machine did, recorded by its host and played again (live.md 3, replay).
#include <algorithm>
#include <random>
#include <utility>

#include "proto/recording/replay.h"
#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using recording::Recording;
using recording::Replayed;
using testing::HasSubstr;

class RecordingTest : public HostMachineTest {
 protected:
  std::string File(const std::string& job = "") {
    static_cast<void>(host_->TakeEntries(now_, true));
    std::string file;
    for (;;) {
      v1::HostOrder order;
      order.mutable_recording()->set_job(job);
      order.mutable_recording()->set_offset(static_cast<std::int64_t>(file.size()));
      const v1::HostOrderAnswer answer = Do(order);
      file += answer.recording().chunk();
      if (answer.recording().chunk().empty() || !answer.has_recording()) return file;
    }
  }
  Recording Recorded(const std::string& job = "") {
    const auto read = recording::ReadFile(File(job));
    EXPECT_TRUE(read) << read.error().detail;
    return read ? *read : Recording();
  }
  static Replayed Play(const Recording& what) {
    const auto played = recording::Replay(what, {});
    EXPECT_TRUE(played) << played.error().detail;
    return played ? *played : Replayed();
  }
  static std::string DifferenceIn(const Replayed& played) {
    if (!played.difference) return "";
    return played.difference->field + ": " + played.difference->recorded + " is " +
           played.difference->played;
  }
  v1::HostOrder Override(double percent) {
    v1::HostOrder order;
    order.mutable_override()->set_override_percent(percent);
    order.mutable_override()->set_control_token(token_);
    return order;
  }
  static std::vector<const v1::JournalEntry*> Of(const Recording& what,
                                                 v1::JournalEntry::WhatCase kind) {
    std::vector<const v1::JournalEntry*> found;
    for (const v1::JournalEntry& entry : what.entries) {
      if (entry.what_case() == kind) found.push_back(&entry);
    }
    return found;
  }
  // A run with a stop on the way, at 80 % from then on.
  void RunWithAStop() {
    Make();
    host_->Begin({}, now_);
    Control(v1::ControlLease::ON_LOSS_GO_ON);
    Do(Start());
    Pass(7s, 30ms);
    static_cast<void>(host_->TakeEntries(now_));
    Do(Stop());
    Pass(2s);
    Do(Override(80.0));
    Do(Resume());
    for (int i = 0; i < 140; ++i) {
      Pass(1s, 50ms);
      static_cast<void>(host_->TakeEntries(now_));
    }
    ASSERT_EQ(State(), v1::MACHINE_STATE_IDLE);
  }
};

// LIVE-3.40
TEST_F(RecordingTest, WhatHappenedHappensAgain) {
  RunWithAStop();
  const Recording what = Recorded();
  EXPECT_EQ(what.head.machine(), "machines/mill-1");
  EXPECT_EQ(what.head.profile(), "srm-20");
  EXPECT_EQ(what.head.fence(), 7);
  ASSERT_TRUE(what.entries.front().has_mark());
  EXPECT_FALSE(what.entries.front().mark().state().empty());
  const Replayed played = Play(what);
  EXPECT_EQ(DifferenceIn(played), "");
  EXPECT_EQ(played.inputs, 4);  // START, STOP, override, RESUME
  // Begun, halted, resumed, over; and nothing of it was left out.
  EXPECT_EQ(played.events, 4);
  EXPECT_EQ(static_cast<std::size_t>(played.marks), Of(what, v1::JournalEntry::kMark).size());
  EXPECT_GT(played.marks, 60);  // one a second of motion
  EXPECT_EQ(played.until, SimTime(what.entries.back().virtual_time_ns()));
}

// LIVE-3.40: a run that takes no time is over before the mark of the same instant.
TEST_F(RecordingTest, ARunThatTakesNoTimeHappensAgain) {
  for (const char* text : {"STOP\n", "WORK 0,0/ON\nWORK 0,0/OFF\n", "VI[2] = 1\n"}) {
    MakeOptimo();
    Do(JobOf(text));
    // As a host takes them: before the run moves, and behind its end, before any time has gone by.
    static_cast<void>(host_->TakeEntries(now_));
    while (!host_->GoOn(now_)) continue;
    static_cast<void>(host_->TakeEntries(now_));
    Pass(3s, 30ms);
    const Recording what = Recorded("jobs/17");
    const auto ends = Of(what, v1::JournalEntry::kRunOver);
    ASSERT_EQ(ends.size(), 1U) << text;
    const auto marks = Of(what, v1::JournalEntry::kMark);
    const auto is_behind = [&](const v1::JournalEntry* mark) {
      return mark->sequence() > ends.front()->sequence() &&
             mark->virtual_time_ns() == ends.front()->virtual_time_ns();
    };
    EXPECT_TRUE(std::ranges::any_of(marks, is_behind)) << text;
    const Replayed played = Play(what);
    EXPECT_EQ(DifferenceIn(played), "") << text;
    EXPECT_EQ(static_cast<std::size_t>(played.marks), marks.size());
  }
}

// LIVE-3.40: the first difference, with entry, field and both values.
TEST_F(RecordingTest, WhatDidNotHappenIsFound) {
  RunWithAStop();
  const Recording what = Recorded();
  Recording changed = what;
  for (v1::JournalEntry& entry : changed.entries) {
    if (entry.has_applied() && entry.applied().input().has_override_percent())
      entry.mutable_applied()->mutable_input()->set_override_percent(81.0);
  }
  Replayed played = Play(changed);
  ASSERT_TRUE(played.difference);
  EXPECT_EQ(played.difference->field, "mark.state_sha256");
  EXPECT_NE(played.difference->recorded, played.difference->played);

  changed = what;
  v1::JournalEntry& over = *std::ranges::find_if(
      changed.entries, [](const v1::JournalEntry& entry) { return entry.has_run_over(); });
  over.mutable_run_over()->mutable_outcome()->set_cycle_time_ns(1);
  played = Play(changed);
  ASSERT_TRUE(played.difference);
  EXPECT_EQ(played.difference->field, "run_over");
  EXPECT_EQ(played.difference->sequence, over.sequence());
  EXPECT_THAT(played.difference->recorded, HasSubstr(R"("cycleTimeNs":"1")"));

  changed = what;
  std::erase_if(changed.entries, [](const v1::JournalEntry& entry) {
    return entry.has_applied() && entry.applied().input().has_stop();
  });
  played = Play(changed);
  ASSERT_TRUE(played.difference);
  // It would have gone on: the next mark says so, or the halt that never came.
  EXPECT_GT(played.inputs, 0);
}

// LIVE-3.40: up to a time, and from the newest mark that has a state.
TEST_F(RecordingTest, APartOfIt) {
  RunWithAStop();
  const Recording what = Recorded();
  const SimTime end(what.entries.back().virtual_time_ns());
  const auto played = recording::Replay(what, {.to = SimTime(3s)});
  ASSERT_TRUE(played);
  EXPECT_EQ(played->until, SimTime(3s));
  EXPECT_EQ(played->inputs, 1);
  // The run was under way at the marks but the last.
  const Recording whole = recording::From(what, end - SimTime(60s));
  EXPECT_EQ(whole.entries.size(), what.entries.size());
  const Recording last = recording::From(what, end);
  ASSERT_FALSE(last.entries.empty());
  EXPECT_LT(last.entries.size(), what.entries.size());
  EXPECT_TRUE(last.entries.front().mark().clean());
  EXPECT_EQ(DifferenceIn(Play(last)), "");
}

// LIVE-3.24, LIVE-3.40: a file that is damaged anywhere, or cut off, says so.
TEST_F(RecordingTest, ADamagedFileIsRefused) {
  RunWithAStop();
  const std::string file = File();
  std::mt19937 random(1);
  for (int round = 0; round < 200; ++round) {
    std::string damaged = file;
    const std::size_t place = random() % file.size();
    damaged[place] = static_cast<char>(damaged[place] ^ static_cast<char>(1U << (random() % 8)));
    const auto read = recording::ReadFile(damaged);
    ASSERT_FALSE(read) << place;
    EXPECT_EQ(read.error().code, ErrorCode::kCellBadText);
  }
  for (std::size_t end = 0; end < file.size(); end += 97) {
    const auto read = recording::ReadFile(std::string_view(file).substr(0, end));
    // Cut between two records it is shorter, and plays as far as it goes.
    if (read) {
      EXPECT_EQ(DifferenceIn(Play(*read)), "");
    }
  }
  EXPECT_THAT(recording::ReadFile("G1 X10\n").error().detail, HasSubstr("does not begin as one"));
}

// LIVE-3.41, LIVE-5.03: with the program that the job brought, also when another is stored since.
TEST_F(RecordingTest, TheRunOfAJob) {
  Make();
  host_->Begin({}, now_);
  ASSERT_EQ(Do(JobOf("PA;PA;VS10;PU200,0;PU0,0;", "there.rml")).status().state(),
            v1::MACHINE_STATE_RUNNING);
  v1::HostMemory memory;
  v1::AssignedProgram& stored = *memory.add_programs();
  stored.set_slot(5);
  stored.set_content("PA;PA;VS10;PU900,0;PU0,0;");
  host_->Change(memory, now_);
  Pass(3min, 50ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_IDLE);
  Recording what = Recorded("jobs/17");
  EXPECT_EQ(what.head.job(), "jobs/17");
  EXPECT_EQ(what.head.brought().content(), "PA;PA;VS10;PU200,0;PU0,0;");
  EXPECT_EQ(DifferenceIn(Play(what)), "");
  // A run later on is another recording; the first is there still.
  Control();
  Do(Start());
  EXPECT_EQ(Recorded().head.job(), "");
  EXPECT_EQ(Recorded("jobs/17").head.job(), "jobs/17");
  v1::HostOrder other;
  other.mutable_recording()->set_job("jobs/18");
  EXPECT_EQ(Do(other).refusal().code(), "CELL-E9004");
  // Another program would have gone elsewhere.
  what.head.mutable_brought()->set_content("PA;PA;VS10;PU201,0;PU0,0;");
  EXPECT_NE(DifferenceIn(Play(what)), "");
}

class RecordedSessionTest : public RecordingTest {
 protected:
  void MakeOptimo() {
    const machine::MachineFamily* family = families::FindFamily("optimo");
    const auto parameters = machine::MakeParameters(*family, "", {});
    ASSERT_TRUE(parameters);
    machine::Translation square = family->Translate({.name = "5.S", .bytes = R"(ZERO
COORD ABSOL
PATH LIN
SPEED 20
VI[3] = 0
10 VI[3] = VI[3] + 1
MOVE (100, 0, -10, 0, 0)
MOVE (100, 50, -20, 0, 0)
OL[3] = ON
DELAY 0.5
MOVE (0, 50, -10, 0, 0)
MOVE (0, 0, -10, 0, 0)
IF VI[3] < 4 THEN 10
WAIT IL[20]
)"},
                                                    *parameters, {});
    machine::MachineMemory memory;
    if (square.ok) {
      memory.programs[5] = {.name = "square",
                            .object = machine::Bytes::Of(std::move(square.object))};
    }
    ASSERT_TRUE(square.ok) << square.diagnostics.front().detail;
    auto made = HostMachine::Make({.name = "machines/optimo-1",
                                   .host = "workshop/1",
                                   .fence = 7,
                                   .family = family,
                                   .memory = std::move(memory)},
                                  now_, [this] { return "token " + std::to_string(++tokens_); });
    ASSERT_TRUE(made) << made.error().detail;
    host_ = *std::move(made);
    host_->Begin({}, now_);
    Control();
  }
  v1::HostOrder Input(const std::string& name, double value) {
    v1::HostOrder order;
    v1::Variable& variable = *order.mutable_inputs()->add_inputs()->mutable_input();
    variable.set_name(name);
    variable.mutable_value()->set_logical(value != 0.0);
    order.mutable_inputs()->set_control_token(token_);
    return order;
  }
  v1::HostOrder Door(bool open) {
    v1::HostOrder order;
    order.mutable_inputs()->add_inputs()->set_door_open(open);
    order.mutable_inputs()->set_control_token(token_);
    return order;
  }
  // One thing that a person or the world does, drawn.
  v1::HostOrder Draw(std::mt19937& random) {
    v1::HostOrder order;
    switch (random() % 12) {
      case 0:
        return Start();
      case 1:
        return Resume();
      case 2:
        return Stop();
      case 3:
        order.mutable_hold();
        return order;
      case 4:
        return Override(1.0 + static_cast<double>(random() % 100));
      case 5:
        return Input("IL[20]", static_cast<double>(random() % 2));
      case 6:
        return Door(random() % 2 == 0);
      case 7: {
        v1::Variable& variable = *order.mutable_write_variables()->add_variables();
        variable.set_name("VR[" + std::to_string(random() % 10) + "]");
        variable.mutable_value()->set_real(0.1 * static_cast<double>(random() % 100));
        order.mutable_write_variables()->set_control_token(token_);
        return order;
      }
      case 8:
        order.mutable_abort()->set_run(0);
        return order;
      case 9:
        order.mutable_zero()->set_control_token(token_);
        return order;
      case 10:
        order.mutable_factor()->set_factor(static_cast<double>(1 + random() % 20));
        order.mutable_factor()->set_control_token(token_);
        return order;
      default:
        order.mutable_simulation()->mutable_until()->set_program(5);
        order.mutable_simulation()->mutable_until()->set_step(static_cast<int>(random() % 9));
        order.mutable_simulation()->set_control_token(token_);
        return order;
    }
  }
};

// LIVE-3.13, LIVE-3.40, LIVE-10.01: whatever is done and however its time is divided.
TEST_F(RecordedSessionTest, AnySessionComesOutTheSame) {
  std::mt19937 random(20261127);
  std::int64_t inputs = 0;
  std::int64_t events = 0;
  for (int session = 0; session < 40; ++session) {
    MakeOptimo();
    const auto play = [&] {
      const Replayed played = Play(Recorded());
      EXPECT_EQ(DifferenceIn(played), "") << "session " << session;
      inputs += played.inputs;
      events += played.events;
    };
    for (int act = 0; act < 40 && !HasFailure(); ++act) {
      const bool stands = State() == v1::MACHINE_STATE_IDLE;
      if (stands) play();  // what comes next may begin another recording
      const bool held = State() == v1::MACHINE_STATE_HELD && random() % 2 == 0;
      if (held) Do(Door(false));
      Do(stands ? Start() : held ? Resume() : Draw(random));
      Pass(std::chrono::milliseconds(1 + random() % 1500),
           std::chrono::milliseconds(1 + random() % 90));
      if (random() % 4 == 0) static_cast<void>(host_->TakeEntries(now_));
      Control();
    }
    play();
  }
  EXPECT_GT(inputs, 500);
  EXPECT_GT(events, 200);
}

// LIVE-2.10, LIVE-3.40, OPT-4.49: ZERO of a held run begins no other one: why it is held and how
// long it takes stays, and what was recorded is played again.
TEST_F(RecordedSessionTest, ZeroInAHold) {
  MakeOptimo();
  const auto renew = [this] {
    v1::HostOrder order;
    order.mutable_renew_control()->set_control_token(token_);
    EXPECT_FALSE(Do(order).has_refusal());
  };
  Do(Start());
  Pass(50s, 50ms);  // behind the ZERO of the program
  renew();
  v1::HostOrder hold;
  hold.mutable_hold();
  Do(hold);
  Pass(5s, 50ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_HELD);
  const std::int64_t run = host_->StatusAt(now_).run().run();
  const auto mode = [this](v1::OperatingMode to) {
    v1::HostOrder order;
    order.mutable_mode()->set_mode(to);
    order.mutable_mode()->set_control_token(token_);
    const v1::HostOrderAnswer answer = Do(order);
    EXPECT_FALSE(answer.has_refusal()) << answer.refusal().code() << answer.refusal().message();
  };
  mode(v1::OPERATING_MODE_MANUAL);
  v1::HostOrder zero;
  zero.mutable_zero()->set_control_token(token_);
  EXPECT_EQ(Do(zero).status().state(), v1::MACHINE_STATE_JOGGING);
  Pass(30s, 50ms);
  renew();
  const v1::MachineStatus held = host_->StatusAt(now_);
  EXPECT_EQ(held.state(), v1::MACHINE_STATE_HELD);
  EXPECT_EQ(held.hold_reason(), v1::HOLD_REASON_HOLD);
  EXPECT_EQ(held.run().run(), run);
  mode(v1::OPERATING_MODE_REMOTE);
  v1::HostOrder resume = Resume();
  EXPECT_EQ(Do(resume).refusal().code(), "CELL-E9425");
  resume.mutable_resume()->set_accept_displaced(true);
  EXPECT_EQ(Do(resume).status().state(), v1::MACHINE_STATE_RUNNING);
  for (int n = 0; n < 2; ++n) {
    Pass(50s, 50ms);
    renew();
  }
  const Recording what = Recorded();
  const Replayed played = Play(what);
  EXPECT_EQ(DifferenceIn(played), "");
  EXPECT_EQ(played.inputs, 6);  // START, HOLD, mode, ZERO, mode, RESUME
  EXPECT_EQ(Of(what, v1::JournalEntry::kRunBegun).size(), 1U);
  for (const v1::JournalEntry& entry : what.entries)
    EXPECT_LE(entry.virtual_time_ns(), played.until.count()) << "events count from its begin";
  const auto marks = Of(what, v1::JournalEntry::kMark);
  EXPECT_EQ(std::ranges::count_if(
                marks, [](const v1::JournalEntry* entry) { return entry->mark().clean(); }),
            1);  // before it began
}

// LIVE-3.40: family and parameters are those of the head; an input is one that there is.
TEST_F(RecordingTest, WhatIsNoRecordingOfAMachineIsRefused) {
  RunWithAStop();
  const Recording what = Recorded();
  const auto refused = [](const Recording& wrong) {
    const auto played = recording::Replay(wrong, {});
    return played ? std::string("played")
                  : CodeText(played.error().code) + " " + std::string(played.error().detail);
  };
  Recording wrong = what;
  wrong.head.set_family("lathe");
  EXPECT_EQ(refused(wrong), "CELL-E9008 'lathe'; there are optimo rml1");
  EXPECT_EQ(recording::MachineOf(wrong.head).error().code, ErrorCode::kCellUnknownFamily);
  wrong = what;
  wrong.head.set_profile("none");
  EXPECT_THAT(refused(wrong), HasSubstr("no profile 'none'"));
  wrong = what;
  const auto is_start = [](const v1::JournalEntry& entry) {
    return entry.applied().input().has_start();
  };
  v1::JournalEntry& start = *std::ranges::find_if(wrong.entries, is_start);
  start.mutable_applied()->mutable_input()->mutable_start()->clear_source();
  EXPECT_EQ(refused(wrong),
            "CELL-E9024 entry " + std::to_string(start.sequence()) + ": a start without a source");
}

// LIVE-3.40: what acted then and is refused now, and what one side alone has.
TEST_F(RecordingTest, WhatOneSideAloneHasIsFound) {
  RunWithAStop();
  const Recording what = Recorded();
  const auto is_over = [](const v1::JournalEntry& entry) { return entry.has_run_over(); };
  const auto is_event = [](const v1::JournalEntry& entry) { return entry.has_event(); };
  Recording changed = what;
  for (v1::JournalEntry& entry : changed.entries) {
    if (entry.applied().input().has_override_percent())
      entry.mutable_applied()->mutable_input()->set_override_percent(10'000.0);
  }
  Replayed played = Play(changed);
  ASSERT_TRUE(played.difference);
  EXPECT_EQ(played.difference->field, "applied");
  EXPECT_THAT(played.difference->recorded, HasSubstr("overridePercent"));
  EXPECT_THAT(played.difference->played, HasSubstr("CELL-E"));

  // The end of its run was not recorded, or twice.
  changed = what;
  std::erase_if(changed.entries, is_over);
  EXPECT_THAT(DifferenceIn(Play(changed)), HasSubstr("run_over: no end of a run is {"));
  changed = what;
  changed.entries.push_back(*std::ranges::find_if(what.entries, is_over));
  played = Play(changed);
  EXPECT_THAT(DifferenceIn(played), HasSubstr("} is no end of a run"));
  EXPECT_EQ(played.difference->sequence, changed.entries.back().sequence());

  // The same of what it told.
  changed = what;
  std::erase_if(changed.entries, is_event);
  EXPECT_THAT(DifferenceIn(Play(changed)), HasSubstr("event: no event is {"));
  changed = what;
  changed.entries.push_back(*std::ranges::find_if(what.entries, is_event));
  EXPECT_THAT(DifferenceIn(Play(changed)), HasSubstr("} is no event"));
}

// replay.h ReplayOptions: who is told what, and when; who has what he wanted is told no more.
TEST_F(RecordingTest, WhoPlaysItIsToldWhereItStands) {
  RunWithAStop();
  const Recording what = Recorded();
  std::vector<std::string> told;
  SimTime stands{0};
  recording::ReplayOptions options{
      .begun = [&](const machine::Run&) { told.emplace_back("begun"); },
      .over = [&](const machine::RunOver&) { told.emplace_back("over"); },
      .stands =
          [&](const machine::Machine& machine) {
            told.emplace_back("stands");
            stands = machine.time();
          }};
  ASSERT_TRUE(recording::Replay(what, options));
  EXPECT_THAT(told, testing::ElementsAre("begun", "over", "stands"));
  EXPECT_EQ(stands, SimTime(what.entries.back().virtual_time_ns()));
  told.clear();
  options.to = SimTime(3s);
  ASSERT_TRUE(recording::Replay(what, options));
  EXPECT_THAT(told, testing::ElementsAre("begun", "stands"));
  EXPECT_EQ(stands, SimTime(3s));
  told.clear();
  options.to = SimTime::max();
  options.goes_on = [](SimTime time) { return time < SimTime(3s); };
  const auto part = recording::Replay(what, options);
  ASSERT_TRUE(part);
  EXPECT_THAT(told, testing::ElementsAre("begun"));
  EXPECT_FALSE(part->difference);
  EXPECT_EQ(part->inputs, 1);
  EXPECT_LT(part->until, SimTime(what.entries.back().virtual_time_ns()));
}

// LIVE-3.40: it begins where its machine stood then, and when.
TEST_F(RecordingTest, ItBeginsWhereItsMachineStood) {
  MakeAndTake();
  Pass(3s, 50ms);
  ASSERT_FALSE(Do(Start()).has_refusal());
  const Recording what = Recorded();
  ASSERT_FALSE(what.entries.empty());
  const v1::JournalEntry& begin = what.entries.front();
  EXPECT_EQ(begin.fence(), 7);
  EXPECT_EQ(begin.virtual_time_ns(), 3'000'000'000);
  EXPECT_EQ(begin.mark().virtual_time_ns(), 3'000'000'000);
}

}  // namespace
}  // namespace rmlcell::server
