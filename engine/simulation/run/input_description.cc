#include "engine/simulation/run/input_description.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "engine/core/hex.h"
#include "engine/simulation/run/version.h"

namespace rmlcell::simulation {
namespace {

__extension__ using Wide = unsigned __int128;

// The published constants of FNV-1a with 128 bits.
constexpr Wide kOffset = (Wide{0x6c62272e07bb0142} << 64) | 0x62b821756295c58d;
// The prime is 2^88 + 0x13B.
constexpr std::uint64_t kPrimeLow = 0x13B;
constexpr int kPrimeShift = 88 - 64;

class Fnv1a {
 public:
  void Raw(std::string_view bytes) {
    // In halves: the upper half of the prime is a single bit, a shift in place of a product.
    auto low = static_cast<std::uint64_t>(hash_);
    auto high = static_cast<std::uint64_t>(hash_ >> 64);
    for (const char c : bytes) {
      low ^= static_cast<unsigned char>(c);
      const Wide product = Wide{low} * kPrimeLow;
      high = high * kPrimeLow + static_cast<std::uint64_t>(product >> 64) + (low << kPrimeShift);
      low = static_cast<std::uint64_t>(product);
    }
    hash_ = (Wide{high} << 64) | low;
  }
  // Every field goes in with its length or at fixed width: no two setups have the same bytes.
  void Text(std::string_view text) {
    Number(text.size());
    Raw(text);
  }
  void Number(std::uint64_t value) {
    for (int shift = 0; shift < 64; shift += 8) {
      const char byte = static_cast<char>(static_cast<unsigned char>(value >> shift));
      Raw({&byte, 1});
    }
  }
  void Integer(std::int64_t value) { Number(static_cast<std::uint64_t>(value)); }
  void Real(double value) { Number(std::bit_cast<std::uint64_t>(value)); }

  std::string Digits() const {
    std::string digits;
    for (int shift = 124; shift >= 0; shift -= 4) {
      digits += HexDigit(static_cast<unsigned>(hash_ >> shift));
    }
    return digits;
  }

 private:
  Wide hash_ = kOffset;
};

void Add(Fnv1a& hash, const machine::Bytes& bytes) {
  hash.Number(bytes ? 1 : 0);
  if (!bytes) return;
  hash.Number(bytes->size());
  for (std::size_t at = 0; at < bytes->size(); at += machine::kReleaseEvery) {
    hash.Raw(bytes->substr(at, machine::kReleaseEvery));
    bytes.Release();
  }
}

void Add(Fnv1a& hash, const std::optional<machine::ProgramStep>& step) {
  hash.Number(step ? 1 : 0);
  if (!step) return;
  hash.Integer(step->program);
  hash.Integer(step->step);
}

void AddPrograms(Fnv1a& hash, const machine::RunSetup& setup) {
  hash.Number(setup.programs.size());
  for (const auto& [slot, program] : setup.programs) {
    hash.Integer(slot);
    hash.Text(program.name);
    Add(hash, program.object);
    Add(hash, program.executable);
  }
  hash.Number(setup.deleted_programs.size());
  for (const int slot : setup.deleted_programs) hash.Integer(slot);
  hash.Integer(setup.main_program);
}

void AddSchedules(Fnv1a& hash, const machine::RunSetup& setup) {
  hash.Number(setup.schedules.empty() ? 0 : 1);
  if (setup.schedules.empty()) return;
  hash.Number(setup.schedules.size());
  for (const machine::LaserSchedule& schedule : setup.schedules) {
    hash.Integer(schedule.number);
    hash.Text(schedule.name);
    hash.Text(schedule.mode);
    hash.Real(schedule.power_percent);
  }
}

}  // namespace

std::string Fnv1a128(std::string_view bytes) {
  Fnv1a hash;
  hash.Raw(bytes);
  return hash.Digits();
}

bool IsWhole(const machine::RunSetup& setup) {
  return std::ranges::all_of(setup.programs,
                             [](const auto& one) { return one.second.object.whole(); });
}

InputDescription DescribeInputs(const machine::MachineFamily& family,
                                const machine::RunSetup& setup) {
  InputDescription description;
  description.family = family.info().id;
  const auto main = setup.programs.find(setup.main_program);
  if (main != setup.programs.end()) description.title = main->second.name;
  description.changed_parameters = setup.parameters.Changed();
  description.machine = setup.parameters.Used();
  for (const machine::InputChange& input : setup.inputs)
    description.input_times.push_back(input.at);
  if (IsWhole(setup)) description.hash = FingerprintOf(family, setup);
  return description;
}

std::string FingerprintOf(const machine::MachineFamily& family, const machine::RunSetup& setup) {
  Fnv1a hash;
  hash.Text(family.info().id);
  hash.Text(kEngineVersion);
  const auto changed = setup.parameters.Changed();
  hash.Number(changed.size());
  for (const auto& [name, value] : changed) {
    hash.Text(name);
    hash.Text(value);
  }
  AddPrograms(hash, setup);
  AddSchedules(hash, setup);
  hash.Text(setup.machine_state);
  hash.Number(static_cast<std::uint64_t>(setup.mode));
  hash.Real(setup.override_percent);
  Add(hash, setup.breakpoint);
  Add(hash, setup.simul);
  // Where there are none the count of inputs stands here, which is never as large.
  if (!setup.breakpoints.empty()) hash.Number(~std::uint64_t{setup.breakpoints.size()});
  for (const machine::Breakpoint& breakpoint : setup.breakpoints) {
    Add(hash, breakpoint.at);
    hash.Text(breakpoint.condition);
    hash.Number(breakpoint.from_pass);
  }
  hash.Number(setup.inputs.size());
  for (const machine::InputChange& input : setup.inputs) {
    hash.Integer(input.at.count());
    hash.Number(static_cast<std::uint64_t>(input.kind));
    hash.Integer(input.index);
    hash.Real(input.value);
    if (input.kind == machine::InputKind::kVariable) hash.Text(input.name);
  }
  hash.Number(setup.forecast ? 1 : 0);
  hash.Number(setup.budget.steps);
  hash.Integer(setup.budget.virtual_time.count());
  if (setup.budget.steps_at_one_instant != 0) hash.Number(setup.budget.steps_at_one_instant);
  return hash.Digits();
}

}  // namespace rmlcell::simulation
