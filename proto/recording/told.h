#pragma once

#include "engine/machine/machine.h"
#include "rmlcell/v1/run_event.pb.h"

// What a machine that lives tells, as messages: the same for its host and for a replay.
namespace rmlcell::recording {

// So many messages and findings of one run are told: a program without an end says as much as it
// likes, and the report of a job has the rest.
inline constexpr int kToldOfRunMax = 1'000;

v1::RunBegun BegunOf(const machine::RunNote& run);
// Without its job. Power is no end of a program: the machine was taken away from it. LIVE-2.10 a1
v1::RunOver OverOf(const machine::RunOver& run);
v1::Halted HaltedOf(const machine::Halt& halt);
v1::Resumed ResumedOf(const machine::Place& place);
v1::RunMessage MessageOf(const machine::Place& place, std::string_view text);

}  // namespace rmlcell::recording
