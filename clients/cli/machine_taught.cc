// What was taught at a machine with a handbox, and its taking back. LIVE-7.09
#include <memory>
#include <string>
#include <vector>

#include "clients/cli/machine_call.h"
#include "clients/cli/messages.h"
#include "clients/cli/terminal.h"
#include "rmlcell/v1/handbox.grpc.pb.h"

namespace rmlcell::cli {
namespace {

using Handbox = v1::HandboxService;

constexpr int kPage = 1'000;

// "45/3".
std::string PlaceOf(const v1::TeachEntry& entry) {
  const std::string program = std::to_string(entry.step().program());
  return entry.step().step() > 0 ? program + "/" + std::to_string(entry.step().step()) : program;
}

std::string WhatOf(const v1::TeachEntry& entry) {
  const std::string before = Visible(entry.before());
  const std::string after = Visible(entry.after());
  switch (entry.act()) {
    case v1::TeachEntry::ACT_INSERT:
      return "insert  " + after;
    case v1::TeachEntry::ACT_DELETE:
      return "delete  " + before;
    case v1::TeachEntry::ACT_CREATE:
      return "create";
    case v1::TeachEntry::ACT_REMOVE:
      return "remove";
    case v1::TeachEntry::ACT_UNDO:
      return "undo    down to " + std::to_string(entry.undone_down_to());
    default:
      return "";
  }
}

// In which frame it was taken: "COORD ABSOL, TCP 2".
std::string FrameOf(const v1::TeachEntry& entry) {
  std::string frame;
  for (const v1::ModalValue& value : entry.values())
    frame += (frame.empty() ? "" : ", ") + Visible(value.name()) + " " + Visible(value.value());
  return frame.empty() ? "" : "  (" + frame + ")";
}

void Tell(const Remote& remote, const v1::TeachEntry& entry) {
  if (remote.json) return Print(Json(entry));
  Print(std::to_string(entry.number()) + "  " + When(entry.time()) + "  " +
        Visible(entry.caller()) + "  " + PlaceOf(entry) + "  " + WhatOf(entry) + FrameOf(entry));
}

// Newest first.
grpc::Status EntriesOf(const Remote& remote, const MachineAct& act,
                       std::vector<v1::TeachEntry>& entries) {
  const auto stub = Handbox::NewStub(Connect(remote));
  v1::ListTeachEntriesRequest request;
  request.set_machine(FullName("machines", act.machine));
  request.set_program(act.program);
  request.set_page_size(kPage);
  do {
    grpc::ClientContext context;
    Prepare(context);
    v1::ListTeachEntriesResponse page;
    const grpc::Status listed = stub->ListTeachEntries(&context, request, &page);
    if (!listed.ok()) return listed;
    entries.insert(entries.end(), page.entries().begin(), page.entries().end());
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty());
  return grpc::Status::OK;
}

int UndoDownTo(const Remote& remote, const MachineAct& act, const v1::TeachEntry& last) {
  const Control control(remote, act);
  if (!control.status().ok()) return Refused(control.status(), remote);
  v1::UndoTeachEntriesRequest request;
  request.set_program(FullName("machines", act.machine) + "/programs/" +
                      std::to_string(last.step().program()));
  request.set_down_to(last.number());
  request.set_request_id(NewRequestId());
  request.set_control_token(control.token());
  const auto stub = Handbox::NewStub(Connect(remote));
  grpc::ClientContext context;
  Prepare(context);
  v1::UndoTeachEntriesResponse undone;
  const grpc::Status done = stub->UndoTeachEntries(&context, request, &undone);
  if (!done.ok()) return Refused(done, remote);
  Tell(remote, undone.entry());
  return kGood;
}

}  // namespace

int ShowTaught(const Remote& remote, const MachineAct& act) {
  std::vector<v1::TeachEntry> entries;
  if (const grpc::Status listed = EntriesOf(remote, act, entries); !listed.ok())
    return Refused(listed, remote);
  if (act.undo == 0) {
    for (auto entry = entries.rbegin(); entry != entries.rend(); ++entry) Tell(remote, *entry);
    return kGood;
  }
  for (const v1::TeachEntry& entry : entries) {
    if (entry.number() == act.undo) return UndoDownTo(remote, act, entry);
  }
  Complain("there is no entry " + std::to_string(act.undo) + ": see `rmlcell machine taught " +
           act.machine + "`");
  return kUsage;
}

}  // namespace rmlcell::cli
