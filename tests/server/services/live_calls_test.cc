// What clients ask of machines that live, where it takes the store as well as the host, or may not
// be asked at all.
#include "proto/bridge/milling.h"
#include "server/machines/teach_book.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/fake_link.h"
#include "tests/server/services/live_machines_bed.h"

namespace rmlcell::server {
namespace {

class LiveCalls : public LiveMachines {
 protected:
  // A RUN that brought its program, proved by a simulation of this block.
  std::string RunOfBlock(const std::string& stock, const std::string& tool) {
    v1::Job simulation;
    Must(bridge::SetBlockAndTool(stock, tool, *simulation.mutable_simulation()->mutable_milling()));
    const std::int64_t proof =
        Must(store().SubmitAndWait({.machine = "optimo-1",
                                    .kind = "SIMULATE",
                                    .specification = simulation.SerializeAsString()}))
            .job.id;
    v1::Job run;
    run.mutable_run()->set_ticket(JobName(proof));
    run.mutable_inline_program()->set_file_name("a.S");
    storage::NewJob made{.machine = "optimo-1",
                         .kind = "RUN",
                         .specification = run.SerializeAsString(),
                         .attachments = {{.name = std::string(kMainAttachment),
                                          .media_type = "application/octet-stream",
                                          .bytes = "STOP\n"}}};
    return JobName(Must(store().SubmitAndWait(std::move(made))).job.id);
  }
  // The host says that this job was cut off.
  void CutOff(const std::string& job) {
    v1::HostRequest told;
    told.mutable_status()->set_machine(kLaser);
    told.mutable_status()->set_state(v1::MACHINE_STATE_IDLE);
    told.mutable_status()->set_host("hall/1");
    told.mutable_status()->set_cut_off_job(job);
    hosts.Receive(*host, std::move(told));
  }
};

// LIVE-5.10: the program that the job brought, and the block of its simulation unless another one
// is asked for.
TEST_F(LiveCalls, APreviewOfWhatWasCutOffBringsItsProgram) {
  v1::PreviewStartRequest request;
  request.set_machine(kLaser);
  request.set_request_id("p");
  request.mutable_step()->set_step(3);
  const auto preview = [&] {
    Call(machines, &v1::MachineService::Stub::PreviewStart, request);
    const auto orders = host->TakeOrders();
    return orders.size() == 1 ? orders[0] : v1::HostOrder();
  };
  CutOff(RunOfBlock("60x30x5", "flat:3"));
  const v1::HostOrder order = preview();
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(order.brought().content(), "STOP\n");
  EXPECT_EQ(order.brought().file_name(), "a.S");
  EXPECT_TRUE(order.brought().is_source());
  EXPECT_EQ(order.preview_start().step().step(), 3);
  EXPECT_EQ(order.preview_start().milling().tool().diameter_mm(), 3.0);
  Must(bridge::SetBlockAndTool("10x10x5", "flat:2", *request.mutable_milling()));
  EXPECT_EQ(preview().preview_start().milling().tool().diameter_mm(), 2.0);
  CutOff("jobs/99");
  preview();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND) << status.error_message();
  CutOff("no job");
  preview();
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9003");
}

// machine.proto ExportJournal: of a run whose recording is not stored it is what the host has.
TEST_F(LiveCalls, ARecordingComesFromTheHost) {
  const auto link = std::make_shared<FakeLink>();
  v1::HostHello hello;
  hello.set_join_token("secret");
  hello.set_machine("machines/mill-1");
  hello.set_host("hall/2");
  hello.set_computer("hall");
  hello.set_protocol(1);
  ASSERT_TRUE(hosts.Join(link, hello));
  const std::int64_t run = Must(store().SubmitAndWait({.machine = "mill-1", .kind = "RUN"})).job.id;
  v1::ExportJournalRequest request;
  request.set_machine("machines/mill-1");
  request.set_job(JobName(run));
  const auto context = Context();
  const auto reader = machines->ExportJournal(context.get(), request);
  const auto asked = link->Newest(v1::HostResponse::kOrder);
  ASSERT_TRUE(asked);
  EXPECT_EQ(asked->order().recording().job(), JobName(run));
  const std::string recorded = "what was recorded";
  v1::HostRequest answer;
  answer.mutable_answer()->set_number(asked->order().number());
  answer.mutable_answer()->mutable_recording()->set_chunk(recorded);
  answer.mutable_answer()->mutable_recording()->set_total(
      static_cast<std::int64_t>(recorded.size()));
  hosts.Receive(*link, std::move(answer));
  v1::ExportJournalResponse part;
  ASSERT_TRUE(reader->Read(&part));
  EXPECT_EQ(part.chunk(), recorded);
  EXPECT_FALSE(reader->Read(&part));
  EXPECT_TRUE(reader->Finish().ok());
}

// LIVE-7.09: listed with all that was taught; taken back when the host lets it be.
TEST_F(LiveCalls, WhatWasTaughtIsTakenBackByACall) {
  refusing.Refuse("AllEvents");  // nobody reads the log: the host has it from the call
  const auto put = [&](const std::string& text, storage::Revision from) {
    const auto written = Must(store().PutPrograms(
        "optimo-1", {{.slot = 45, .object = ObjectOf(text), .expected = from}}, {}));
    return written.front().revision;
  };
  const storage::Revision before = put("DELAY 9.0\n", 0);
  const storage::Revision after = put("DELAY 1.0\nDELAY 9.0\n", before);
  v1::TeachEntry entry;
  entry.mutable_step()->set_program(45);
  entry.mutable_step()->set_step(1);
  entry.set_act(v1::TeachEntry::ACT_INSERT);
  entry.set_after("DELAY 1.0");
  Must(TeachBook(store()).Add("optimo-1", entry, before, after));
  v1::UndoTeachEntriesRequest undo;
  undo.set_program("machines/optimo-1/programs/45");
  undo.set_down_to(1);
  undo.set_request_id("u");
  const auto undone = Call(handbox, &v1::HandboxService::Stub::UndoTeachEntries, undo).entry();
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(undone.act(), v1::TeachEntry::ACT_UNDO);
  EXPECT_EQ(undone.undone_down_to(), 1);
  EXPECT_EQ(undone.caller(), "local");
  EXPECT_EQ(Must(store().GetProgram("optimo-1", 45)).object, ObjectOf("DELAY 9.0\n"));
  ASSERT_EQ(host->memory().programs_size(), 1);
  EXPECT_EQ(host->memory().programs(0).content(), ObjectOf("DELAY 9.0\n"));
  v1::ListTeachEntriesRequest list;
  list.set_machine(kLaser);
  const auto listed = Call(handbox, &v1::HandboxService::Stub::ListTeachEntries, list);
  ASSERT_EQ(listed.entries_size(), 2);
  EXPECT_EQ(listed.entries(0).act(), v1::TeachEntry::ACT_UNDO);
  EXPECT_EQ(listed.entries(1).after(), "DELAY 1.0");
  list.set_program(-1);
  Call(handbox, &v1::HandboxService::Stub::ListTeachEntries, list);
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9003");
}

// Whoever may only look is refused by each call that acts, and no host hears of it.
TEST_F(LiveCalls, WhoMayOnlyLookOrdersNothing) {
  Tell(*host, v1::MACHINE_STATE_RUNNING, "jobs/7");
  gate.SetLocal(ViewerPermissions());
  const auto refused = [&](const auto& stub, auto method, auto request) {
    request.set_request_id("r");
    Call(stub, method, request);
    ExpectRefused(grpc::StatusCode::PERMISSION_DENIED, "CELL-E9012");
  };
  v1::StartMachineRequest start;
  start.set_machine(kLaser);
  start.set_job("jobs/7");
  refused(machines, &v1::MachineService::Stub::StartMachine, start);
  v1::ZeroMachineRequest zero;
  zero.set_machine(kLaser);
  refused(machines, &v1::MachineService::Stub::ZeroMachine, zero);
  using Jobs = v1::JobService::Stub;
  v1::HoldJobRequest hold;
  hold.set_name("jobs/7");
  refused(jobs, &Jobs::HoldJob, hold);
  v1::ResumeJobRequest resume;
  resume.set_name("jobs/7");
  refused(jobs, &Jobs::ResumeJob, resume);
  v1::DecideInterruptedRequest decide;
  decide.set_name("jobs/7");
  refused(jobs, &Jobs::DecideInterrupted, decide);
  v1::UndoTeachEntriesRequest undo;
  undo.set_program("machines/optimo-1/programs/45");
  refused(handbox, &v1::HandboxService::Stub::UndoTeachEntries, undo);
  const auto context = Context();
  const auto stream = handbox->HandboxStream(context.get());
  v1::HandboxStreamResponse nothing;
  EXPECT_FALSE(stream->Read(&nothing)) << nothing.ShortDebugString();
  EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_THAT(host->TakeOrders(), testing::IsEmpty());
}

// limits.message_bytes is for the messages of a stream as well, and refuses one of them alone.
TEST_F(LiveCalls, AMessageOfAStreamHasSoManyBytes) {
  const auto context = Context();
  const auto stream = handbox->HandboxStream(context.get());
  v1::HandboxStreamRequest key;
  key.mutable_key()->set_session(std::string(std::size_t{8} << 20, 's'));
  v1::HandboxStreamResponse response;
  ASSERT_TRUE(stream->Write(key) && stream->Read(&response));
  EXPECT_EQ(response.refusal().code(), CodeText(ErrorCode::kCellTooLarge));
  stream->WritesDone();
  EXPECT_FALSE(stream->Read(&response));
  EXPECT_TRUE(stream->Finish().ok());
}

// machines.hosts_max: one more is not enabled, and who asked is told why.
TEST_F(LiveCalls, SoManyMachinesLive) {
  const auto most = HostProcesses::Options{}.most;
  for (std::size_t i = 0; i < most; ++i) ASSERT_TRUE(processes.Enable("m" + std::to_string(i)));
  v1::EnableMachineRequest request;
  request.set_machine("machines/mill-1");
  request.set_request_id("r");
  Call(machines, &v1::MachineService::Stub::EnableMachine, request);
  ExpectRefused(grpc::StatusCode::RESOURCE_EXHAUSTED,
                std::to_string(most) + " machines live, as many as machines.hosts_max allows");
  EXPECT_FALSE(processes.IsEnabled("mill-1"));
}

}  // namespace
}  // namespace rmlcell::server
