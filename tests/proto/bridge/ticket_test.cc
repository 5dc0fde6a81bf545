// A run is that of its simulation (live.md 5.02): what a ticket is held against.
#include "proto/bridge/ticket.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/families/families.h"
#include "engine/simulation/run/version.h"
#include "proto/bridge/sha256.h"

namespace rmlcell::bridge {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

struct Memory {
  explicit Memory(const std::string& family_id)
      : family(*families::FindFamily(family_id)), parameters(ParametersOf(family)) {}
  static machine::Parameters ParametersOf(const machine::MachineFamily& family) {
    auto made = machine::MakeParameters(family, "", {});
    EXPECT_TRUE(made);
    return *std::move(made);
  }
  Memory& Put(int slot, std::string bytes) {
    programs[slot] = {.name = "any", .object = machine::Bytes::Of(std::move(bytes))};
    return *this;
  }
  RunDependencies Run() const {
    return {.family = family,
            .parameters = parameters,
            .programs = programs,
            .schedules = schedules,
            .main_program = main_program};
  }
  v1::RunTicket Ticket() const {
    v1::RunTicket ticket;
    ticket.set_job("jobs/17");
    ticket.set_family(std::string(family.info().id));
    ticket.set_main_program(main_program);
    ticket.set_engine_version(std::string(simulation::kEngineVersion));
    for (const auto& [name, value] : parameters.Changed())
      (*ticket.mutable_parameters())[name] = value;
    for (const auto& [name, digest] : DigestsOf(Run())) (*ticket.mutable_inputs())[name] = digest;
    return ticket;
  }

  const machine::MachineFamily& family;
  machine::Parameters parameters;
  std::map<int, machine::StoredProgram> programs{};
  std::vector<machine::LaserSchedule> schedules{};
  int main_program = 10;
};

std::vector<std::string> Names(const RunDependencies& run) {
  std::vector<std::string> names;
  for (const auto& [name, digest] : DigestsOf(run)) {
    names.push_back(name);
    EXPECT_EQ(digest.size(), 32u);
  }
  return names;
}

// LIVE-5.02
TEST(Ticket, BindsTheWholeMemoryWhereProgramsCallEachOther) {
  Memory memory("optimo");
  memory.Put(10, "main").Put(44, "called");
  memory.schedules = {{.number = 3, .power_percent = 80.0}};
  EXPECT_THAT(Names(memory.Run()),
              UnorderedElementsAre("programs/10", "programs/44", "schedules/3"));
  const v1::RunTicket ticket = memory.Ticket();
  EXPECT_THAT(ChangedSince(ticket, memory.Run()), IsEmpty());

  // A name is for people.
  memory.programs[44].name = "another";
  memory.schedules.front().name = "steel";
  EXPECT_THAT(ChangedSince(ticket, memory.Run()), IsEmpty());

  memory.Put(44, "called too");
  EXPECT_THAT(ChangedSince(ticket, memory.Run()), ElementsAre("programs/44"));
  memory.Put(44, "called").Put(45, "new");
  EXPECT_THAT(ChangedSince(ticket, memory.Run()), ElementsAre("programs/45"));
  memory.programs.erase(45);
  memory.programs.erase(44);
  EXPECT_THAT(ChangedSince(ticket, memory.Run()), ElementsAre("programs/44"));
  memory.Put(44, "called");
  memory.schedules.front().power_percent = 81.0;
  EXPECT_THAT(ChangedSince(ticket, memory.Run()), ElementsAre("schedules/3"));
  memory.schedules.front().power_percent = 80.0;
  memory.schedules.front().mode = "PULSE";
  EXPECT_THAT(ChangedSince(ticket, memory.Run()), ElementsAre("schedules/3"));
  memory.schedules.front().mode = "CW";
  memory.schedules.front().number = 4;
  EXPECT_THAT(ChangedSince(ticket, memory.Run()), ElementsAre("schedules/3", "schedules/4"));
  memory.schedules.front().number = 3;
  memory.main_program = 44;
  EXPECT_THAT(ChangedSince(ticket, memory.Run()), ElementsAre("program 44 instead of 10"));
}

// LIVE-5.02
TEST(Ticket, OfAMillItIsTheProgramAloneWhateverItsSlot) {
  Memory memory("rml1");
  memory.Put(10, "PA;PU0,0;").Put(11, "PR;");
  EXPECT_THAT(Names(memory.Run()), ElementsAre("program"));
  EXPECT_EQ(DigestsOf(memory.Run()).at("program").substr(0, 1),
            std::string(
                1, static_cast<char>(std::stoi(Sha256Hex("PA;PU0,0;").substr(0, 2), nullptr, 16))));
  const v1::RunTicket ticket = memory.Ticket();
  memory.Put(11, "PA;").Put(3, "PA;PU0,0;");
  memory.main_program = 3;
  EXPECT_THAT(ChangedSince(ticket, memory.Run()), IsEmpty());
  memory.main_program = 11;
  EXPECT_THAT(ChangedSince(ticket, memory.Run()), ElementsAre("program"));
}

// LIVE-5.02
TEST(Ticket, ARunWithoutTheRightOneIsRefused) {
  Memory memory("rml1");
  memory.Put(10, "PA;PU0,0;");
  const auto said = [&](const v1::RunTicket* ticket, bool needed) {
    const Status may = CheckRun(memory.Run(), ticket, needed);
    return may ? std::string() : CodeText(may.error().code) + " " + std::string(may.error().detail);
  };
  const std::string code = CodeText(ErrorCode::kCellTicket) + " ";
  EXPECT_EQ(said(nullptr, false), "");
  EXPECT_EQ(said(nullptr, true), code + "jobs need one here");
  const v1::RunTicket ticket = memory.Ticket();
  EXPECT_EQ(said(&ticket, true), "");
  memory.Put(10, "PA;PU1,0;");
  EXPECT_EQ(said(&ticket, false), code + "other than in jobs/17: program");
}

// What the run needs is missing, whatever its ticket says.
TEST(Ticket, ARunWithoutItsProgramIsRefused) {
  Memory memory("rml1");
  memory.Put(10, "PA;PU0,0;");
  const v1::RunTicket ticket = memory.Ticket();
  const v1::RunTicket* const none = nullptr;
  memory.main_program = 11;
  for (const v1::RunTicket* const one : {none, &ticket}) {
    const Status may = CheckRun(memory.Run(), one, one == nullptr);
    ASSERT_FALSE(may);
    EXPECT_EQ(may.error().code, memory.family.info().empty_slot);
  }
}

// LIVE-5.02
TEST(Ticket, BindsParametersFamilyAndEngine) {
  Memory memory("rml1");
  memory.Put(10, "PA;PU0,0;");
  v1::RunTicket ticket = memory.Ticket();
  const Memory optimo("optimo");
  EXPECT_THAT(ChangedSince(ticket, optimo.Run()), ElementsAre("family optimo"));
  ticket.set_engine_version("0.0.9");
  EXPECT_THAT(ChangedSince(ticket, memory.Run()),
              ElementsAre("engine " + std::string(simulation::kEngineVersion)));
  ticket = memory.Ticket();
  auto other = machine::MakeParameters(memory.family, "mdx-40a", {});
  ASSERT_TRUE(other);
  memory.parameters = *other;
  const std::vector<std::string> changed = ChangedSince(ticket, memory.Run());
  ASSERT_FALSE(changed.empty());
  for (const std::string& one : changed) EXPECT_TRUE(one.starts_with("parameter ")) << one;
  EXPECT_EQ(changed.size(), [&] {
    std::size_t count = other->Changed().size();
    for (const auto& [name, value] : ticket.parameters()) {
      const auto now = other->Changed();
      if (!now.contains(name)) ++count;
      if (now.contains(name) && now.at(name) == value) --count;
    }
    return count;
  }());
}

}  // namespace
}  // namespace rmlcell::bridge
