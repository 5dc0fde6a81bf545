#include "server/host/start_desk.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "engine/core/number_text.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/machine_inputs.h"

namespace rmlcell::server {
namespace {

struct ConfirmedItem {
  std::string_view item;
  v1::Confirmation confirmation;
};
constexpr std::array<ConfirmedItem, 5> kConfirmedItems = {
    {{"clamps", v1::CONFIRMATION_CLAMPS},
     {"tool", v1::CONFIRMATION_TOOL},
     {"origin", v1::CONFIRMATION_ORIGIN_VALID},
     {"Z0", v1::CONFIRMATION_ORIGIN_VALID},
     {"table", v1::CONFIRMATION_TABLE_CLEAR}}};

v1::StartAction ToProto(machine::StartAction action) {
  switch (action) {
    case machine::StartAction::kSet:
      return v1::START_ACTION_SET;
    case machine::StartAction::kMove:
      return v1::START_ACTION_MOVE;
    case machine::StartAction::kSwitch:
      return v1::START_ACTION_SWITCH;
    case machine::StartAction::kAsk:
      return v1::START_ACTION_ASK;
    case machine::StartAction::kNone:
      break;
  }
  return v1::START_ACTION_NONE;
}

v1::StepPlace PlaceOf(const machine::StepTarget& target) {
  v1::StepPlace place;
  place.set_program(target.at.program);
  place.set_step(target.at.step);
  return place;
}

v1::Diagnostic DiagnosticOf(const Error& error) {
  return bridge::ToProto(Diagnostic{
      .code = error.code, .severity = Lookup(error.code).severity, .detail = error.detail});
}

v1::ApproachMotion ToProto(const machine::ApproachMotion& motion,
                           const machine::FamilyInfo& family) {
  v1::ApproachMotion made;
  made.set_path(std::string(motion.path));
  for (v1::AxisValue& axis : bridge::AxesOf(family.axes, motion.to))
    *made.add_to() = std::move(axis);
  made.set_feed_mm_s(motion.feed_mm_s);
  for (const machine::OutOfTravel& one : motion.beyond) {
    constexpr std::string_view kAxes = "XYZAB";
    *made.add_findings() = DiagnosticOf(
        {ErrorCode::kCellApproach,
         std::string(1, kAxes[static_cast<std::size_t>(one.axis)]) +
             (one.at_target ? " of its target leaves the travel" : " leaves the travel on the way"),
         {}});
  }
  if (motion.into_part_mm > 0.0)
    *made.add_findings() = DiagnosticOf(
        {ErrorCode::kCellApproach, FixedText(motion.into_part_mm, 3) + " mm into the part", {}});
  return made;
}

// Since a preview, where it has a name that people know: ": override 90 (was 100), ...".
std::string NewOf(const StartDesk::Basis& before, const StartDesk::Basis& now) {
  constexpr std::size_t kNamed = 5;
  std::map<std::string_view, std::pair<std::string_view, std::string_view>> values;
  for (const auto& one : before.named) values[one.name].first = one.value;
  for (const auto& one : now.named) values[one.name].second = one.value;
  std::string text;
  std::size_t count = 0;
  for (const auto& [name, value] : values) {
    if (value.first == value.second) continue;
    if (++count > kNamed) return text + ", and more";
    const auto or_none = [](std::string_view one) { return one.empty() ? "none" : one; };
    text += std::string(count == 1 ? ": " : ", ") + std::string(name) + " " +
            std::string(or_none(value.second)) + " (was " + std::string(or_none(value.first)) + ")";
  }
  return text;
}

}  // namespace

Result<machine::StartAtStep> StartOf(const v1::PreviewStartRequest& request,
                                     const machine::Machine& machine) {
  const auto invalid = [](std::string why) {
    return Error{ErrorCode::kCellInvalidArgument, std::move(why), {}};
  };
  machine::StartAtStep start;
  const int selected = machine.selected_program();
  start.program = request.program() != 0 ? request.program() : selected;
  if (start.program == 0) return invalid("program: none was started yet; name one");
  start.target.at = {
      .program = request.step().program() != 0 ? request.step().program() : start.program,
      .step = request.step().step()};
  if (start.target.at.step < 1) return invalid("step: steps count from 1");
  if (request.occurrence() < 0) return invalid("occurrence: it counts from 1");
  start.target.occurrence =
      static_cast<std::uint64_t>(std::max<std::int64_t>(1, request.occurrence()));
  if (request.approach() == v1::APPROACH_DIRECT) start.way = machine::ApproachWay::kDirect;
  start.off_until_work_on = request.off_until_work_on();
  return start;
}

v1::PreviewStartResponse ToProto(const machine::StartPreview& preview,
                                 const machine::FamilyInfo& family) {
  v1::PreviewStartResponse response;
  v1::RunState& there = *response.mutable_there();
  for (const machine::Place& place : preview.reach.run->stack())
    *there.add_stack() = bridge::ToProto(place);
  for (const machine::StateItem& item : preview.there) {
    v1::ModalValue& value = *there.add_values();
    value.set_name(item.name);
    value.set_value(bridge::Utf8(item.value));
  }
  for (const machine::StartDifference& one : preview.differences) {
    v1::StartDifference& made = *response.add_differences();
    made.set_item(one.item);
    made.set_there(bridge::Utf8(one.there));
    made.set_now(bridge::Utf8(one.now));
    made.set_action(ToProto(one.action));
    if (one.action != machine::StartAction::kAsk) continue;
    const auto* seen = std::ranges::find(kConfirmedItems, one.item, &ConfirmedItem::item);
    if (seen != kConfirmedItems.end()) made.set_confirmation(seen->confirmation);
  }
  for (const machine::ApproachMotion& motion : preview.approach)
    *response.add_approach() = ToProto(motion, family);
  for (const Error& refusal : preview.refusals) *response.add_refusals() = DiagnosticOf(refusal);
  if (preview.clean_before) *response.mutable_clean_before() = PlaceOf(*preview.clean_before);
  if (preview.clean_after) *response.mutable_clean_after() = PlaceOf(*preview.clean_after);
  response.set_run_time_ns(preview.run_time.count());
  response.set_missing_cut_mm(preview.missing_cut_mm);
  response.set_part_checked(preview.part_checked);
  return response;
}

std::string StartDesk::Keep(machine::StartAtStep start, Basis basis, const HostTime& now) {
  token_ = make_token_();
  start_ = std::move(start);
  basis_ = std::move(basis);
  until_ = now.steady + kLasts;
  return token_;
}

Result<machine::StartAtStep> StartDesk::Take(const v1::StartAtStepRequest& request,
                                             const Basis& basis, const HostTime& now) const {
  const auto stale = [](std::string why) {
    return Error{ErrorCode::kCellPreviewStale, std::move(why), {}};
  };
  if (token_.empty() || request.preview_token() != token_) return stale("it is not the newest one");
  if (now.steady >= until_) return stale("it is older than 120 s");
  if (basis.programs != basis_.programs) return stale("programs were changed");
  if (basis.schedules != basis_.schedules) return stale("laser schedules were changed");
  // Whoever pressed STOP has stopped what would have begun. LIVE-2.05
  if (basis.halts != basis_.halts)
    return Error{ErrorCode::kCellMachineState, "it was stopped before it began", {}};
  if (basis.state != basis_.state) return stale("the machine was changed" + NewOf(basis_, basis));
  machine::StartAtStep start = start_;
  if (request.has_halt_at_entry()) start.halt_at_entry = request.halt_at_entry();
  for (const ConfirmedItem& one : kConfirmedItems) {
    if (std::ranges::find(request.confirmations(), one.confirmation) !=
        request.confirmations().end())
      start.acknowledged.insert(std::string(one.item));
  }
  return start;
}

}  // namespace rmlcell::server
