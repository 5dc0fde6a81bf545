// What would end a RUN before anything moves, told as it is handed in (live.md 5.02 b).
#include "server/runs/run_advice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rmlcell/v1/report.pb.h"
#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/job_book.h"
#include "server/records/job_messages.h"
#include "server/records/machine_options.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/failing_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

class RunAdviceTest : public testing::Test {
 protected:
  std::int64_t Submit(const std::string& machine, const std::string& file, const std::string& text,
                      const std::string& ticket = "",
                      v1::ProgramForm form = v1::PROGRAM_FORM_UNSPECIFIED) {
    v1::SubmitJobRequest request;
    v1::Job& job = *request.mutable_job();
    job.set_kind(v1::JOB_KIND_RUN);
    job.set_machine("machines/" + machine);
    job.mutable_inline_program()->set_file_name(file);
    job.mutable_inline_program()->set_content(text);
    job.mutable_inline_program()->set_form(form);
    job.set_inline_slot(7);
    job.mutable_run()->set_ticket(ticket);
    std::int64_t id = 0;
    std::string refused;
    book_.Submit(request, "anna", [&](const Result<v1::Job>& made) {
      if (made) id = *ParseJobName(made->name());
      if (!made) refused = made.error().detail;
    });
    EXPECT_TRUE(Eventually([&] { return id != 0 || !refused.empty(); }));
    EXPECT_EQ(refused, "");
    return id;
  }
  std::string Advice(std::int64_t job) {
    const auto why = WhyItWouldFail(bed_.store(), config_, job);
    return why ? CodeText(why->code) : "";
  }
  // Stores an object in slot 7, and what a first run made of it.
  void PutMade(const std::string& object, const std::string& executable) {
    const auto put =
        Must(bed_.store().PutPrograms("optimo-1", {{.slot = 7, .object = object}}, {}));
    ASSERT_TRUE(Must(bed_.store().PutExecutable("optimo-1", 7, put.front().revision, executable)));
  }

  ServerBed bed_;
  Config config_;
  JobBook book_{bed_.store(), config_};
};

// LIVE-5.02: by the memory that the machine has now.
TEST_F(RunAdviceTest, ProgramsThatAreCalledAreLookedFor) {
  const std::int64_t job = Submit("optimo-1", "a.S", "CALL 44\nDELAY 1\n");
  EXPECT_EQ(Advice(job), "OPT-E7102");
  EXPECT_EQ(Advice(Submit("optimo-1", "a.S", "DELAY 1\n")), "");
}

// LIVE-5.02: of a program of up to 1 MiB: more takes too long.
TEST_F(RunAdviceTest, LargeProgramsAreNotLookedAt) {
  const auto advice = [&](std::size_t bytes) {
    std::string text = "CALL 44\nDELAY 1\n;";
    text.resize(bytes - 1, 'x');
    return Advice(Submit("optimo-1", "a.S", text + "\n"));
  };
  EXPECT_EQ(advice(1 << 20), "OPT-E7102");
  EXPECT_EQ(advice((1 << 20) + 1), "");
}

// LIVE-5.02: a schedule that no machine has.
TEST_F(RunAdviceTest, SchedulesAreLookedFor) {
  EXPECT_EQ(Advice(Submit("optimo-1", "a.S", "WORKDEF 2,1 (64)\n")), "OPT-E7403");
  EXPECT_EQ(Advice(Submit("optimo-1", "a.S", "WORKDEF 2,1 (63)\n")), "");
}

// OPT-3.44: beside those that a machine has from the beginning, those that were stored are there.
TEST_F(RunAdviceTest, SchedulesThatAreStoredAreThere) {
  Must(bed_.store().PutMachine(
      {.id = "optimo-1", .family = "optimo", .parameters = {{"SCHEDULES", "0"}}},
      storage::kAnyRevision));
  const std::int64_t job = Submit("optimo-1", "a.S", "WORKDEF 2,1 (7)\n");
  EXPECT_EQ(Advice(job), "OPT-E7404");
  Must(bed_.store().PutSchedule({.machine = "optimo-1", .number = 7, .name = "thin", .mode = "CW"},
                                0));
  EXPECT_EQ(Advice(job), "");
}

// LIVE-5.02: a ticket that proves nothing; one that is still worked out is waited for.
TEST_F(RunAdviceTest, ATicketIsLookedAt) {
  EXPECT_EQ(Advice(Submit("mill-1", "a.rml", "PA;PU100,0;")), "");
  const std::int64_t check = bed_.SubmitCheck();
  const std::int64_t run = Submit("mill-1", "a.rml", "PA;PU100,0;", JobName(check));
  EXPECT_EQ(Advice(run), "");
  const storage::Lease lease = bed_.Lease();
  Must(bed_.store().Finish(lease, {.outcome = {.state = storage::JobState::kSucceeded}}));
  EXPECT_EQ(Advice(run), "CELL-E9407");  // a check proves nothing
}

// LIVE-5.02: what was simulated was another program.
TEST_F(RunAdviceTest, ATicketOfAnotherProgramIsNamed) {
  v1::Job asked;
  asked.set_kind(v1::JOB_KIND_SIMULATE);
  const std::int64_t simulation =
      Must(bed_.store().SubmitAndWait({.machine = "mill-1",
                                       .kind = "SIMULATE",
                                       .specification = asked.SerializeAsString()}))
          .job.id;
  v1::Outcome good;
  good.set_kind(v1::Outcome::KIND_COMPLETED);
  good.set_verdict(v1::VERDICT_GOOD);
  v1::RunReport report;
  report.set_family("rml1");
  (*report.mutable_inputs())["program"] = std::string(32, 'x');
  storage::JobEnd end{.outcome = OutcomeOf(good)};
  end.artifacts.push_back({.name = "report",
                           .media_type = "application/x-protobuf",
                           .bytes = report.SerializeAsString()});
  Must(bed_.store().Finish(bed_.Lease("SIMULATE"), end));
  const std::int64_t run = Submit("mill-1", "a.rml", "PA;PU100,0;", JobName(simulation));
  EXPECT_EQ(Advice(run), "CELL-E9407");
}

// LIVE-5.02: a program that cannot be translated ends its job, too.
TEST_F(RunAdviceTest, AProgramWithErrorsIsNamed) {
  EXPECT_THAT(Advice(Submit("optimo-1", "a.S", "STOP\nNONSENSE\n")), testing::StartsWith("OPT-E"));
}

// OPT-1.15: an object that is brought runs with what was made of the same one before, whatever
// became of its parts; another object does not, nor a text.
TEST_F(RunAdviceTest, WhatWasMadeOfTheSameObjectRuns) {
  const std::string text = "CALL 44\nDELAY 1\n";
  const std::string object = ObjectOf(text);
  const std::string made = ExecutableOf(7, "DELAY 1\n");
  const std::int64_t job = Submit("optimo-1", "a.O", object, "", v1::PROGRAM_FORM_OBJECT);
  EXPECT_EQ(Advice(job), "OPT-E7102") << "the slot is empty";
  PutMade(object, made);
  EXPECT_EQ(Advice(job), "");
  PutMade(ObjectOf("CALL 45\nDELAY 1\n"), made);
  EXPECT_EQ(Advice(job), "OPT-E7102") << "it is of another object";
  PutMade(text, made);
  EXPECT_EQ(Advice(Submit("optimo-1", "a.S", text)), "OPT-E7102") << "a text is translated";
}

// What a server of another version made a machine of speaks against no job here.
TEST_F(RunAdviceTest, OfAMachineOfAnotherVersionNothingIsKnown) {
  const std::int64_t job = Submit("optimo-1", "a.S", "CALL 44\nDELAY 1\n");
  ASSERT_EQ(Advice(job), "OPT-E7102");
  Must(bed_.store().PutMachine({.id = "optimo-1", .family = "lathe"}, storage::kAnyRevision));
  EXPECT_EQ(Advice(job), "");
}

TEST_F(RunAdviceTest, ParametersThatNoMachineHasAreNamed) {
  const std::int64_t job = Submit("optimo-1", "a.S", "DELAY 1\n");
  Must(bed_.store().PutMachine(
      {.id = "optimo-1", .family = "optimo", .parameters = {{"NO_SUCH_ONE", "1"}}},
      storage::kAnyRevision));
  EXPECT_EQ(Advice(job), CodeText(ErrorCode::kCellUnknownParameter));
}

// LIVE-5.02: a machine that asks for a ticket waits for one that is still worked out.
TEST_F(RunAdviceTest, ATicketThatIsNeededIsWaitedFor) {
  v1::MachineOptions options;
  options.set_ticket_needed(true);
  Must(bed_.store().PutMachine({.id = "mill-1", .family = "rml1", .options = BytesOf(options)},
                               storage::kAnyRevision));
  const std::int64_t check = bed_.SubmitCheck();
  EXPECT_EQ(Advice(Submit("mill-1", "a.rml", "PA;PU100,0;")), "CELL-E9407");
  EXPECT_EQ(Advice(Submit("mill-1", "a.rml", "PA;PU100,0;", JobName(check))), "");
}

// What the store does not say speaks against no job.
TEST_F(RunAdviceTest, TroubleOfTheStoreIsNoReason) {
  const std::int64_t check = bed_.SubmitCheck();
  const std::int64_t good = Submit("mill-1", "a.rml", "PA;PU100,0;");
  const std::int64_t bad = Submit("mill-1", "a.rml", "PA;PU100,0;", JobName(check));
  Must(bed_.store().Finish(bed_.Lease(), {.outcome = {.state = storage::JobState::kSucceeded}}));
  FailingStore store(bed_.store());
  for (const std::int64_t job : {good, bad}) {
    int call = 0;
    do {
      store.FailAt(++call);
      const auto why = WhyItWouldFail(store, config_, job);
      EXPECT_TRUE(!why || (job == bad && why->code == ErrorCode::kCellTicket)) << call;
    } while (store.failed());
    EXPECT_GT(call, 3);
  }
}

}  // namespace
}  // namespace rmlcell::server
