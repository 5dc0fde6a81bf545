// A start at a step (live.md 6): what it would do, and the start.
#include <algorithm>
#include <memory>
#include <utility>

#include "engine/core/number_text.h"
#include "engine/machine/machine_note.h"
#include "engine/machine/shape.h"
#include "engine/simulation/material/milled_part.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/machine_inputs.h"
#include "proto/bridge/milling.h"
#include "proto/recording/recording.h"
#include "server/host/host_machine.h"

namespace rmlcell::server {
namespace {

// Block and tool; what is to be left of it does not count here.
Result<std::optional<simulation::Milling>> PartOf(const v1::PreviewStartRequest& request,
                                                  const machine::MachineShape& shape) {
  if (!request.has_milling()) return std::optional<simulation::Milling>();
  const auto invalid = [](const std::string& why) {
    return Error{ErrorCode::kCellInvalidArgument, "milling" + why, {}};
  };
  if (!shape.has_work_origin) return invalid(": this machine removes no material");
  v1::Milling wanted = request.milling();
  wanted.clear_target();
  auto milling = bridge::FromProto(wanted);
  if (!milling) return invalid("." + milling.error().detail);
  // A tool that falls between two cells would cut nothing and meet nothing.
  if (milling->stock.cell > milling->tool.radius_mm)
    return invalid(
        ".cell_mm: the tool is thinner than two cells of the block; give a smaller block, or cells of " +
        ShortestText(milling->tool.radius_mm) + " mm");
  return std::optional(*std::move(milling));
}

std::string TextOf(const machine::ProgramStep& at) {
  return std::to_string(at.program) + "/" + std::to_string(at.step);
}

// What is not among the values that a program has.
std::vector<StartDesk::Named> NamedIn(const machine::MachineNote& note, bool door_open) {
  std::vector<StartDesk::Named> named{{"mode", std::string(machine::Name(note.mode))},
                                      {"override", ShortestText(note.override_percent)},
                                      {"cover", note.cover_open ? "open" : "closed"},
                                      {"door", door_open ? "open" : "closed"},
                                      {"emergency stop", note.emergency ? "down" : "released"},
                                      {"last run", std::to_string(note.last_run)},
                                      {"last alarm", std::to_string(note.last_alarm)}};
  if (note.simulation) named.push_back({"SIMUL", TextOf(*note.simulation)});
  for (const machine::Breakpoint& one : note.breakpoints)
    named.push_back({"BREAK " + TextOf(one.at), "set"});
  return named;
}

}  // namespace

// Its time goes on while it stands, and changes nothing.
StartDesk::Basis HostMachine::Basis() const {
  StartDesk::Basis basis{
      .programs = program_changes_, .schedules = schedule_changes_, .halts = halts_};
  Result<machine::MachineNote> note = machine::ReadMachineNote(machine().Save());
  if (!note) return basis;
  note->time = SimTime(0);
  basis.state = machine::WriteMachineNote(*note);
  basis.named = NamedIn(*note, machine().status().run.door_open);
  if (const auto standing = setup_.family->NewStanding(*parameters_, note->family)) {
    for (machine::StateItem& item : (*standing)->items())
      basis.named.push_back({std::move(item.name), std::move(item.value)});
  }
  return basis;
}

// Of a run that was cut off: there it has the values that it had. LIVE-6.01
Result<HostMachine::PreviewTask> HostMachine::PreparePreview(const v1::HostOrder& order,
                                                             const HostTime& now) {
  GoOnTo(now);
  v1::PreviewStartRequest request = order.preview_start();
  const bool behind_it = inspect_due_ && cut_off_base_ &&
                         (request.program() == 0 || request.program() == cut_off_base_->program());
  if (behind_it) request.set_program(cut_off_base_->program());
  if (behind_it && request.step().step() == 0) {
    request.mutable_step()->set_program(cut_off_base_->place().program());
    request.mutable_step()->set_step(std::max(1, cut_off_base_->place().step()));
  }
  const bool again = behind_it && !cut_off_base_->incomplete();
  // The wrong pass of a loop would leave out a part of the work, or cut it twice.
  if (behind_it && !again && request.occurrence() == 0 && cut_off_base_->place().step() > 0 &&
      setup_.family->info().steps_come_again)
    return Error{ErrorCode::kCellStepUnreachable,
                 "name the occurrence: in which pass the run was is not known, since it was moved "
                 "in a hold or more came to it than is kept; variables are as the machine has them",
                 {}};
  auto start = StartOf(request, machine());
  if (!start) return start.error();
  auto part = PartOf(request, setup_.family->Shape(*parameters_));
  if (!part) return part.error();
  if (!v1::PartSoFar_IsValid(request.part_so_far()))
    return InvalidArgument("part_so_far is none that there is");
  machine::PartSoFar so_far{.untouched = request.part_so_far() == v1::PART_SO_FAR_UNTOUCHED};
  if (again && request.part_so_far() == v1::PART_SO_FAR_UNSPECIFIED)
    so_far.cut_until = SimTime(cut_off_base_->until_ns());
  PreviewTask task{.start = *std::move(start), .basis = Basis()};
  std::optional<SimTime> occurrence_at;
  if (behind_it && !again) task.start.base = machine().BaseOfNow();
  if (again) {
    auto base = bridge::FromProto(*cut_off_base_);
    if (!base) return base.error();
    task.start.base = *std::move(base);
    // The pass that it was in.
    if (request.occurrence() == 0) occurrence_at = SimTime(cut_off_base_->until_ns());
  }
  // Of a job: what it brings is run, and not what is stored.
  if (order.has_brought() && (again || order.brought().slot() == task.start.program)) {
    auto brought = recording::ProgramOf(order.brought(), *setup_.family, *parameters_);
    if (!brought) return brought.error();
    const auto stored = machine().memory().programs.find(task.start.program);
    const bool same =
        stored != machine().memory().programs.end() && *stored->second.object == *brought->object;
    if (!same) task.start.brought = *std::move(brought);
  }
  if (const Status may = machine().MayBegin(task.start); !may) return may.error();
  task.run = [&family = *setup_.family, parameters = *parameters_, memory = machine().memory(),
              state = machine().Save(), occurrence_at, milling = *std::move(part),
              so_far](machine::StartAtStep& asked,
                      const machine::ReachLimits& limits) -> Result<machine::StartPreview> {
    machine::RunObserver nobody;
    auto copy = machine::Machine::Make(family, parameters, memory, state, nobody);
    if (!copy) return copy.error();
    if (occurrence_at) {
      const auto in = (*copy)->OccurrenceAt(asked, *occurrence_at, limits);
      if (!in) return in.error();
      asked.target.occurrence = std::max<std::uint64_t>(1, *in);
    }
    std::optional<simulation::MilledPart> on_table;
    if (milling) on_table.emplace(*milling);
    return (*copy)->Preview(asked, limits, on_table ? &*on_table : nullptr, so_far);
  };
  return task;
}

std::optional<v1::RunBase> HostMachine::BaseNow() const {
  const machine::MachineStatus status = machine().status();
  if (!status.open || status.open->by_hand) return std::nullopt;
  v1::RunBase base;
  if (machine().base()) {
    base = bridge::ToProto(*machine().base(), status.open->program);
    base.set_until_ns(machine().base_time().count());
  } else {
    base.set_program(status.open->program);
    base.set_incomplete(true);
  }
  *base.mutable_place() = bridge::ToProto(status.run.place);
  return base;
}

v1::HostOrderAnswer HostMachine::Previewed(const v1::HostOrder& order, PreviewTask task,
                                           Result<machine::StartPreview> made,
                                           const HostTime& now) {
  GoOnTo(now);
  v1::HostOrderAnswer answer;
  if (!made) {
    answer = Refuse(made.error());
  } else {
    v1::PreviewStartResponse& preview = *answer.mutable_preview();
    preview = ToProto(*made, setup_.family->info());
    preview.mutable_there()->set_fence(setup_.fence);
    if (made->may_begin()) {
      task.start.prepared = std::make_shared<const machine::StartPreview>(*std::move(made));
      preview.set_preview_token(starts_.Keep(std::move(task.start), std::move(task.basis), now));
      *preview.mutable_expire_time() = Stamp(now.wall + StartDesk::kLasts);
    }
  }
  answer.set_number(order.number());
  *answer.mutable_acted_at() = Stamp(now.wall);
  return answer;
}

Status HostMachine::StartAt(const v1::HostOrder& order, const HostTime& now) {
  const v1::StartAtStepRequest& request = order.start_at_step();
  auto start = starts_.Take(request, Basis(), now);
  if (!start) return start.error();
  // Behind a run of nobody's job that was cut off: whoever has looked may go on.
  const bool decides = inspect_due_ && inspect_job_.empty() &&
                       std::ranges::find(request.confirmations(), v1::CONFIRMATION_INSPECTED) !=
                           request.confirmations().end();
  if (decides) inspect_due_ = false;
  if (!request.has_halt_at_entry())
    start->halt_at_entry = decides || setup_.options.halt_at_entry();
  const std::size_t told = entries_.size();
  Status begun = MayApply(*start);
  if (begun) begun = Apply(*start, &order);
  inspect_due_ = inspect_due_ || (decides && !begun);
  if (!begun) return begun.error();
  if (decides) SettleInspection(order, told);
  if (start->halt_at_entry) held_for_ = v1::HOLD_REASON_ENTRY;
  return {};
}

}  // namespace rmlcell::server
