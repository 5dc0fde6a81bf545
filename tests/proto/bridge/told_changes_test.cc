// What a person reads where a run is not that of its simulation.
#include <gtest/gtest.h>

#include "engine/core/hex.h"
#include "engine/families/families.h"
#include "engine/optimo/language/compiler.h"
#include "engine/simulation/run/version.h"
#include "proto/bridge/sha256.h"
#include "proto/bridge/ticket.h"

namespace rmlcell::bridge {
namespace {

// How a run of so many programs is refused whose ticket knows none of them.
std::string RefusedFor(int programs) {
  const machine::MachineFamily& family = *families::FindFamily("optimo");
  const machine::Parameters parameters = *machine::MakeParameters(family, "", {});
  const std::string object = optimo::Compile("DELAY 1\n", {}, {}).object;
  std::map<int, machine::StoredProgram> stored;
  for (int slot = 1; slot <= programs; ++slot)
    stored[slot] = {.name = "any", .object = machine::Bytes::Of(object)};
  v1::RunTicket ticket;
  ticket.set_job("jobs/17");
  ticket.set_family("optimo");
  ticket.set_main_program(1);
  ticket.set_engine_version(std::string(simulation::kEngineVersion));
  for (const auto& [name, value] : parameters.Changed())
    (*ticket.mutable_parameters())[name] = value;
  const Status may = CheckRun({.family = family,
                               .parameters = parameters,
                               .programs = stored,
                               .schedules = {},
                               .main_program = 1},
                              &ticket, true);
  return may ? std::string() : std::string(may.error().detail);
}

// LIVE-5.02: eight changes are named, of more their number.
TEST(TicketRefusal, EightChangesAreNamed) {
  std::string eight = "other than in jobs/17: ";
  for (int slot = 1; slot <= 8; ++slot)
    eight += (slot == 1 ? "programs/" : ", programs/") + std::to_string(slot);
  EXPECT_EQ(RefusedFor(1), "other than in jobs/17: programs/1");
  EXPECT_EQ(RefusedFor(8), eight);
  EXPECT_EQ(RefusedFor(9), eight + " and 1 more");
}

std::string DigestOfStream(const std::string& bytes) {
  const machine::MachineFamily& family = *families::FindFamily("rml1");
  const machine::Parameters parameters = *machine::MakeParameters(family, "", {});
  const std::map<int, machine::StoredProgram> stored = {
      {10, {.name = "any", .object = machine::Bytes::Of(bytes)}}};
  return DigestsOf({.family = family,
                    .parameters = parameters,
                    .programs = stored,
                    .schedules = {},
                    .main_program = 10})
      .at("program");
}

// LIVE-5.02: it is the digest of all its bytes, however long it is.
TEST(TicketDigest, IsOfEveryByte) {
  std::string bytes(2 * machine::kReleaseEvery + 5, ';');
  EXPECT_EQ(DigestOfStream(bytes), BytesOfHex(Sha256Hex(bytes)).value_or("none"));
  for (const std::size_t at : {std::size_t{0}, machine::kReleaseEvery - 1, machine::kReleaseEvery,
                               2 * machine::kReleaseEvery, bytes.size() - 1}) {
    const std::string before = DigestOfStream(bytes);
    bytes[at] = 'P';
    EXPECT_NE(DigestOfStream(bytes), before) << at;
  }
}

}  // namespace
}  // namespace rmlcell::bridge
