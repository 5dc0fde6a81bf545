#include "engine/simulation/run/joint_check.h"

#include <map>
#include <set>
#include <utility>
#include <vector>

namespace rmlcell::simulation {
namespace {

using Owners = std::map<int, JointProgram*>;  // by slot

// Who stands where in the one memory. Those that are left over want a slot that is taken, or found
// no free one.
struct Seating {
  Owners seated{};
  std::vector<JointProgram*> left_over{};
};

Seating Seat(std::span<JointProgram> programs) {
  Seating seating;
  std::vector<JointProgram*> anywhere;
  for (JointProgram& one : programs) {
    if (one.program.slot == 0) {
      anywhere.push_back(&one);
    } else if (!seating.seated.emplace(one.program.slot, &one).second) {
      seating.left_over.push_back(&one);
    }
  }
  int free_slot = kSlotMin;
  for (JointProgram* one : anywhere) {
    while (seating.seated.contains(free_slot)) ++free_slot;
    if (IsSlot(free_slot)) {
      one->program.slot = free_slot;
      seating.seated.emplace(free_slot, one);
    } else {
      one->program.slot = kSlotMin;
      seating.left_over.push_back(one);
    }
  }
  return seating;
}

// Each finding goes to the program that it is in; those past the thousandth, which are counted by
// their kind, to the one that the first of their kind is in.
void Deal(const MotionCheck& check, const Owners& owners) {
  const auto of = [&owners](int slot) {
    const auto owner = owners.find(slot);
    return owner != owners.end() ? &owner->second->motion : nullptr;
  };
  for (const Diagnostic& finding : check.findings) {
    if (MotionCheck* own = of(finding.program)) own->findings.push_back(finding);
  }
  for (const auto& [code, kind] : check.findings_dropped.kinds()) {
    if (MotionCheck* own = of(kind.first.program)) own->findings_dropped.Add(kind);
  }
  for (const machine::Reason& reason : check.reasons) {
    if (MotionCheck* own = of(reason.first.program)) own->reasons.push_back(reason);
  }
  for (const auto& [slot, why] : check.cut_short) {
    if (MotionCheck* own = of(slot)) own->cut_short[slot] = why;
  }
}

}  // namespace

Status CheckTogether(const machine::MachineFamily& family, const machine::Parameters& parameters,
                     std::span<JointProgram> programs, const machine::InputScript& inputs) {
  const Seating seating = Seat(programs);
  ProgramMemory memory{.family = &family};
  std::set<int> slots;
  for (const auto& [slot, one] : seating.seated) {
    memory.programs.push_back(one->program);
    slots.insert(slot);
  }
  const auto check = CheckMotionOf(memory, parameters, slots, inputs);
  if (!check) return check.error();
  Deal(*check, seating.seated);
  for (JointProgram* one : seating.left_over) {
    const int slot = one->program.slot;
    ProgramMemory in_its_place = memory;
    in_its_place.programs.push_back(one->program);  // of one slot the later one counts
    const auto own = CheckMotionOf(in_its_place, parameters, {slot}, inputs);
    if (!own) return own.error();
    Deal(*own, {{slot, one}});
  }
  return {};
}

}  // namespace rmlcell::simulation
