#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "engine/machine/family.h"

namespace rmlcell::simulation {

// Everything a run depends on, in short: same description, same result.
struct InputDescription {
  std::string family;
  std::string title;             // name of the main program
  machine::MachineUsed machine;  // its values count, not its names
  std::string hash;              // FingerprintOf; empty: of what still comes nobody knows it yet
  std::map<std::string, std::string> changed_parameters;
  std::vector<SimTime> input_times;  // when scripted inputs act, in order
};

InputDescription DescribeInputs(const machine::MachineFamily& family,
                                const machine::RunSetup& setup);

// FNV-1a with 128 bits over family, engine version and every field of the setup, each with its
// length: 32 hexadecimal digits. Not what is known of the text of a program beside its object
// (SourceNotes): by that lines are named. Of a RUN the setup is what it began with; what acted on
// it meanwhile is in its recording. A fingerprint to tell runs apart, not a protection against
// forgery: the engine has no cryptography, and who needs proof of the bytes has the SHA-256 of the
// store.
std::string FingerprintOf(const machine::MachineFamily& family, const machine::RunSetup& setup);

// Its programs are there; else more of one comes while it runs (Bytes::ReadOn).
bool IsWhole(const machine::RunSetup& setup);

// FNV-1a, 128 bits, as 32 lower-case hexadecimal digits.
std::string Fnv1a128(std::string_view bytes);

}  // namespace rmlcell::simulation
