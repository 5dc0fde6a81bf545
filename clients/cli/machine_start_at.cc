// A start at a step of a machine that lives, or of a run that was cut off.
#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clients/cli/machine_call.h"
#include "clients/cli/messages.h"
#include "clients/cli/start_words.h"
#include "clients/cli/terminal.h"
#include "engine/core/number_text.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/milling.h"
#include "rmlcell/v1/job.grpc.pb.h"

namespace rmlcell::cli {
namespace {

std::string PlaceText(const v1::StepPlace& place) {
  return std::to_string(place.program()) + "/" + std::to_string(place.step());
}

// What is different there, how the machine goes there, and why it may not. `in_program_units`: the
// values of this machine are those of its language.
void PrintPreview(const v1::PreviewStartResponse& preview, bool in_program_units) {
  std::vector<std::vector<std::string>> rows = {{"ITEM", "THERE", "NOW", "DONE ABOUT IT"}};
  for (const v1::StartDifference& one : preview.differences()) {
    rows.push_back({one.item(), Visible(one.there()), Visible(one.now()),
                    Short(v1::StartAction_Name(one.action()), "START_ACTION_")});
  }
  if (rows.size() > 1) PrintRaw(Table(rows));
  if (rows.size() > 1 && in_program_units) Print("          places in units of the program");
  for (const v1::ApproachMotion& motion : preview.approach()) {
    std::string to;
    for (const v1::AxisValue& axis : motion.to()) to += "  " + AxisText(axis);
    Print("approach  " + motion.path() + to);
  }
  for (const v1::ApproachMotion& motion : preview.approach()) {
    for (const v1::Diagnostic& finding : motion.findings())
      Complain(motion.path() + ": " + Visible(finding.message()));
  }
  if (!preview.approach().empty())
    Print(preview.part_checked() ? "          checked against the part"
                                 : "          not checked against the part");
  if (preview.missing_cut_mm() > 0.0)
    Print("left out  " + Fixed(preview.missing_cut_mm(), 3) + " mm of cut");
  for (const v1::Diagnostic& refusal : preview.refusals())
    Complain(refusal.code() + ": " + Visible(refusal.message()));
  if (preview.refusals().empty()) return;
  if (preview.has_clean_before()) Print("clean before: " + PlaceText(preview.clean_before()));
  if (preview.has_clean_after()) Print("clean behind: " + PlaceText(preview.clean_after()));
}

// Of what a person must see to, that which was not said; empty: all of it was.
std::vector<std::string> Unseen(const v1::PreviewStartResponse& preview,
                                const std::vector<std::string>& seen,
                                v1::StartAtStepRequest& request) {
  std::vector<std::string> unseen;
  for (const v1::StartDifference& one : preview.differences()) {
    if (one.action() != v1::START_ACTION_ASK) continue;
    const std::string name = SeenName(one.confirmation());
    if (std::ranges::find(seen, name) != seen.end()) {
      request.add_confirmations(one.confirmation());
    } else if (std::ranges::find(unseen, name) == unseen.end()) {
      unseen.push_back(name);
    }
  }
  return unseen;
}

// The run that goes on is that of a new job. LIVE-5.10
int GoOnWithJob(const Remote& remote, const MachineAct& act, const std::string& job,
                const v1::StartAtStepRequest& start) {
  const Control control(remote, act);
  if (!control.status().ok()) return Refused(control.status(), remote);
  v1::DecideInterruptedRequest request;
  request.set_name(job);
  request.set_control_token(control.token());
  request.set_request_id(start.request_id());
  request.set_decision(v1::DecideInterruptedRequest::DECISION_RESUME_AT_STEP);
  request.set_reason(act.reason.empty() ? "resumed at a step" : act.reason);
  request.set_preview_token(start.preview_token());
  *request.mutable_confirmations() = start.confirmations();
  if (act.halt || act.goes_on) request.set_halt_at_entry(act.halt);
  const auto stub = v1::JobService::NewStub(Connect(remote));
  grpc::ClientContext context;
  Prepare(context);
  v1::DecideInterruptedResponse response;
  const grpc::Status status = stub->DecideInterrupted(&context, request, &response);
  if (!status.ok()) return Refused(status, remote);
  Print(remote.json ? Json(response) : response.job() + " goes on with " + job);
  return kGood;
}

}  // namespace

int StartAtStep(const Remote& remote, const MachineAct& act) {
  const auto step = act.step.empty() ? std::optional(v1::StepPlace()) : StepOf(act.step);
  if (!step) {
    Complain("'" + Visible(act.step) + "' is no step: PROGRAM/STEP, such as 45/10, or a step");
    return kUsage;
  }
  for (const std::string& seen : act.seen) {
    if (ConfirmationOf(seen)) continue;
    Complain("--seen '" + Visible(seen) + "': nothing is called so; see --help");
    return kUsage;
  }
  v1::GetMachineRequest which;
  which.set_name(FullName("machines", act.machine));
  v1::Machine machine;
  if (const grpc::Status found = Call(remote, &Service::Stub::GetMachine, which, machine);
      !found.ok())
    return Refused(found, remote);
  const bool inspect = machine.status().state() == v1::MACHINE_STATE_INSPECT;
  if (act.step.empty() && !inspect) {
    Complain("name a step: PROGRAM/STEP, such as 45/10; no run was cut off here");
    return kUsage;
  }
  auto asked = For<v1::PreviewStartRequest>(act);
  *asked.mutable_step() = *step;
  asked.set_program(act.program);
  asked.set_occurrence(act.occurrence);
  asked.set_approach(act.direct ? v1::APPROACH_DIRECT : v1::APPROACH_SAFE);
  asked.set_off_until_work_on(act.off_until_work_on);
  if (!act.stock.empty()) {
    const Status described = bridge::SetBlockAndTool(act.stock, act.tool, *asked.mutable_milling());
    if (!described) {
      Complain(bridge::ErrorText(described.error()));
      return kUsage;
    }
    if (act.untouched) asked.set_part_so_far(v1::PART_SO_FAR_UNTOUCHED);
  }
  const auto stub = Service::NewStub(Connect(remote));
  grpc::ClientContext context;  // it takes as long as the way there does
  v1::PreviewStartResponse preview;
  const grpc::Status status = stub->PreviewStart(&context, asked, &preview);
  if (!status.ok()) return Refused(status, remote);
  if (remote.json) {
    Print(Json(preview));
  } else {
    PrintPreview(preview, machine.family() == "rml1");
  }
  if (preview.preview_token().empty()) return kProgramErrors;
  auto request = For<v1::StartAtStepRequest>(act);
  std::vector<std::string> unseen = Unseen(preview, act.seen, request);
  if (inspect) {
    const std::string inspected = SeenName(v1::CONFIRMATION_INSPECTED);
    if (std::ranges::find(act.seen, inspected) == act.seen.end()) unseen.push_back(inspected);
    request.add_confirmations(v1::CONFIRMATION_INSPECTED);
  }
  if (act.look) return kGood;
  if (!unseen.empty()) {
    std::string names;
    for (const std::string& name : unseen) names += (names.empty() ? "" : ",") + name;
    Complain("look at " + names + " and say so: --seen " + names);
    return kProgramErrors;
  }
  request.set_preview_token(preview.preview_token());
  if (act.halt || act.goes_on) request.set_halt_at_entry(act.halt);
  if (inspect && !machine.status().cut_off_job().empty())
    return GoOnWithJob(remote, act, machine.status().cut_off_job(), request);
  return ShowWithControl(remote, act, &Service::Stub::StartAtStep, std::move(request));
}

}  // namespace rmlcell::cli
