// What must be there before a job moves anything (live.md 5.02 b): one that lacks it ends with the
// code of that, and no run begins.
#include <utility>

#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

class RunConditionsTest : public HostMachineTest {
 protected:
  void MakeLaser(const std::map<std::string, std::string>& parameters = {}) {
    auto made = HostMachine::Make({.name = "machines/optimo-1",
                                   .host = "workshop/1",
                                   .fence = 7,
                                   .family = families::FindFamily("optimo"),
                                   .profile = "standard",
                                   .parameters = parameters,
                                   .memory = {}},
                                  now_, [this] { return "token " + std::to_string(++tokens_); });
    ASSERT_TRUE(made) << made.error().detail;
    host_ = *std::move(made);
    parameters_ = parameters;
    host_->TakeEntries(now_, true);
  }
  std::string ObjectOf(const std::string& text) {
    const machine::MachineFamily& family = *families::FindFamily("optimo");
    const auto parameters = machine::MakeParameters(family, "standard", parameters_);
    machine::Translation translated =
        family.Translate({.name = "A.S", .bytes = text}, *parameters, {.advice = false});
    EXPECT_TRUE(translated.ok) << text;
    return std::move(translated.object);
  }
  void Store(int slot, const std::string& object) {
    v1::AssignedProgram& program = *memory_.add_programs();
    program.set_slot(slot);
    program.set_content(object);
  }
  // As it is handed to the host: what is stored by now.
  void Stored(const std::vector<std::pair<int, double>>& schedules = {}) {
    for (const auto& [number, power] : schedules) {
      v1::AssignedSchedule& schedule = *memory_.add_schedules();
      schedule.set_number(number);
      schedule.set_mode("CW");
      schedule.set_power_percent(power);
    }
    memory_.set_schedules_changed(true);
    host_->Change(std::exchange(memory_, {}), now_);
  }
  // The code that a job ends with before anything moves, and what is said of it; of one that
  // begins, how its run ends.
  std::pair<std::string, std::string> Ends(const v1::HostOrder& order) {
    host_->TakeEntries(now_, true);
    const v1::MachineStatus before = host_->StatusAt(now_);
    const v1::HostOrderAnswer answer = Do(order);
    if (answer.has_refusal()) {
      EXPECT_THAT(ToldOf({v1::JournalEntry::kRunBegun, v1::JournalEntry::kApplied}), IsEmpty());
      const v1::MachineStatus after = host_->StatusAt(now_);
      EXPECT_EQ(after.tip().SerializeAsString(), before.tip().SerializeAsString());
      EXPECT_EQ(after.state(), before.state());
      EXPECT_FALSE(after.has_run());
      return {answer.refusal().code(), answer.refusal().message()};
    }
    Pass(20s, 50ms);
    const auto over = ToldOf({v1::JournalEntry::kRunOver});
    if (over.empty()) return {"runs", {}};
    const v1::Outcome& outcome = over.front().run_over().outcome();
    return {"ran", v1::Outcome::Kind_Name(outcome.kind()) + " " + outcome.code()};
  }
  std::vector<v1::JournalEntry> ToldOf(const std::vector<v1::JournalEntry::WhatCase>& kinds) {
    std::vector<v1::JournalEntry> found;
    for (v1::JournalEntry& entry : host_->TakeEntries(now_, true)) {
      if (std::ranges::find(kinds, entry.what_case()) != kinds.end())
        found.push_back(std::move(entry));
    }
    return found;
  }

  std::map<std::string, std::string> parameters_;
  v1::HostMemory memory_;
};

const auto kCompleted = Pair("ran", "KIND_COMPLETED ");
std::string Selects(int schedule) {
  return "WORKDEF 2,0 (" + std::to_string(schedule) + ")\nWORK 2,0/ON\nWORK 2,0/OFF\n";
}

// OPT-3.44: one that is stored takes the place of its number alone; deleted, the default is back.
TEST_F(RunConditionsTest, AStoredScheduleLeavesTheOthers) {
  MakeLaser();
  EXPECT_THAT(Ends(JobOf(Selects(11))), kCompleted);
  Stored({{12, 40.0}});
  EXPECT_THAT(Ends(JobOf(Selects(11))), kCompleted);
  EXPECT_THAT(Ends(JobOf(Selects(12))), kCompleted);
  MakeLaser({{"SCHEDULES", "11"}});
  Stored({{12, 40.0}});
  EXPECT_THAT(Ends(JobOf(Selects(12))), kCompleted);
  Stored();
  EXPECT_THAT(Ends(JobOf(Selects(12))), Pair("OPT-E7404", HasSubstr("laser schedule 12")));
}

// OPT-3.44, OPT-E.7404: the schedules that it names, and those that what it calls names.
TEST_F(RunConditionsTest, SchedulesThatItNamesAreStored) {
  MakeLaser({{"SCHEDULES", "11"}});
  EXPECT_THAT(Ends(JobOf(Selects(11))), kCompleted);
  const auto missing = Pair("OPT-E7404", HasSubstr("laser schedule 12"));
  EXPECT_THAT(Ends(JobOf("DELAY 1\n" + Selects(12))), missing);
  EXPECT_THAT(Ends(JobOf("WORKDEF 1,0 (8.,75.,0.,50.,12)\n")), missing);
  Store(45, ObjectOf(Selects(12)));
  Stored();
  EXPECT_THAT(Ends(JobOf("CALL 45\n")), Pair("OPT-E7404", HasSubstr("of program 45, step 1")));
  Stored({{12, 40.0}});
  EXPECT_THAT(Ends(JobOf("CALL 45\n")), kCompleted);
}

// OPT-E.7102, OPT-E.7103
TEST_F(RunConditionsTest, WhatItCallsIsStored) {
  MakeLaser();
  EXPECT_THAT(Ends(JobOf("DELAY 1\nCALL 45\n")), Pair("OPT-E7102", HasSubstr("program 45")));
  EXPECT_THAT(Ends(JobOf("DELAY 1\nFUNCTION 45\n")), Pair("OPT-E7103", HasSubstr("FUNCTION 45")));
  Store(45, ObjectOf("DELAY 1\n"));
  Stored();
  EXPECT_THAT(Ends(JobOf("CALL 45\nFUNCTION 45\n")), kCompleted);
}

// OPT-E.7034
TEST_F(RunConditionsTest, WhatItCallsCanBeRead) {
  MakeLaser();
  Store(45, "no object");
  Stored();
  EXPECT_THAT(Ends(JobOf("DELAY 1\nCALL 45\n")), Pair("OPT-E7034", HasSubstr("")));
  v1::HostOrder damaged = JobOf("no object");
  damaged.mutable_run_job()->mutable_programs(0)->set_is_source(false);
  EXPECT_THAT(Ends(damaged), Pair("OPT-E7034", HasSubstr("")));
}

// OPT-E.7109, OPT-B.73
TEST_F(RunConditionsTest, ThereIsRoomForItsExecutables) {
  MakeLaser({{"CMOS_SIZE", "1000"}});
  EXPECT_THAT(Ends(JobOf("DELAY 1\n")), kCompleted);
  std::string much = "DELAY 1\n";
  while (ObjectOf(much).size() < 600) much += "DELAY 1\n";
  EXPECT_THAT(Ends(JobOf(much)), Pair("OPT-E7109", HasSubstr("no room for executable 105")));
}

// OPT-E.7030
TEST_F(RunConditionsTest, ItIsNotInInches) {
  MakeLaser();
  EXPECT_THAT(Ends(JobOf("DELAY 1\n", "A.SI")), Pair("OPT-E7030", HasSubstr("")));
  EXPECT_THAT(Ends(JobOf("DELAY 1\n", "A.S")), kCompleted);
}

// Of a mill: what is no program of its profile, brought or stored.
TEST_F(RunConditionsTest, ItsProfileFitsTheStream) {
  Make();
  const std::string foreign(4000, '?');
  EXPECT_THAT(Ends(JobOf(foreign, "a.rml")), Pair("RML1-E8007", HasSubstr("% of the bytes")));
  Store(5, foreign);
  Stored();
  v1::HostOrder stored = JobOf(foreign, "a.rml");
  stored.mutable_run_job()->mutable_programs(0)->set_is_source(false);
  EXPECT_THAT(Ends(stored), Pair("RML1-E8007", HasSubstr("% of the bytes")));
  EXPECT_THAT(Ends(JobOf(kSquare, "a.rml")), Pair("runs", ""));
}

}  // namespace
}  // namespace rmlcell::server
