// The verbs about jobs: what is sent with one, how one is watched to its end, and what is shown of
// it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "clients/cli/remote.h"
#include "tests/clients/cli/fake_jobs.h"

namespace rmlcell::cli {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

TEST_F(RemoteJobs, AJobOfAStoredProgramNamesItsSlot) {
  SubmitRequest wanted{.machine = "m", .file = {}, .slot = 44};
  wanted.title = "title";
  wanted.override_percent = 50.0;
  wanted.pace = 2.0;
  wanted.trace = true;
  wanted.milling_project = "p";
  wanted.request_id = "r";
  const v1::SubmitJobRequest request = Submitted(wanted);
  EXPECT_EQ(request.request_id(), "r");
  const v1::Job& job = request.job();
  EXPECT_EQ(job.kind(), v1::JOB_KIND_SIMULATE);
  EXPECT_EQ(job.machine(), "machines/m");
  EXPECT_EQ(job.program(), "machines/m/programs/44");
  EXPECT_EQ(job.title(), "title");
  EXPECT_EQ(job.simulation().override_percent(), 50.0);
  EXPECT_EQ(job.simulation().pace(), 2.0);
  EXPECT_TRUE(job.simulation().trace());
  EXPECT_EQ(job.simulation().milling_project(), "projects/p");
  EXPECT_FALSE(job.simulation().has_milling());
  wanted.kind = "check";
  wanted.request_id.clear();
  wanted.trace = false;
  wanted.milling_project.clear();
  const v1::SubmitJobRequest check = Submitted(wanted);
  EXPECT_EQ(check.job().kind(), v1::JOB_KIND_CHECK);
  EXPECT_EQ(check.job().simulation().milling_project(), "");
  EXPECT_FALSE(check.job().simulation().trace());
  EXPECT_NE(check.request_id(), "");
  wanted.kind = "run";
  const v1::SubmitJobRequest run = Submitted(wanted);
  EXPECT_EQ(run.job().kind(), v1::JOB_KIND_RUN);
  EXPECT_NE(run.request_id(), check.request_id());
}

// 3 MiB come with a job; more has to be stored first.
TEST_F(RemoteJobs, AJobOfAFileBringsItAlong) {
  SubmitRequest wanted{.machine = "m", .file = folder.Put("part.rml", "PU1,1;"), .slot = 7};
  v1::SubmitJobRequest request = Submitted(wanted);
  EXPECT_EQ(request.job().inline_program().file_name(), "part.rml");
  EXPECT_EQ(request.job().inline_program().content(), "PU1,1;");
  EXPECT_EQ(request.job().inline_slot(), 7);
  EXPECT_EQ(request.job().title(), "part.rml");
  wanted.title = "mine";
  EXPECT_EQ(Submitted(wanted).job().title(), "mine");
  const std::string most(std::size_t{3} << 20, ';');
  folder.Put("part.rml", most);
  EXPECT_EQ(Submitted(wanted).job().inline_program().content().size(), most.size());
  folder.Put("part.rml", most + ";");
  EXPECT_THAT(Refusal(wanted),
              AllOf(HasSubstr("CELL-E9007"), HasSubstr("has 3145729 bytes, a job takes 3145728")));
  wanted.file = folder.File("none.rml");
  EXPECT_THAT(Refusal(wanted), HasSubstr("CELL-E9022"));
}

TEST_F(RemoteJobs, InputsAreReadBeforeTheServerIsAsked) {
  SubmitRequest wanted{.machine = "m", .file = {}, .slot = 1};
  wanted.inputs_file = folder.Put("in.txt", "0.5 IL[20] = 1\n2.0 START\n");
  const v1::SubmitJobRequest request = Submitted(wanted);
  ASSERT_EQ(request.job().simulation().inputs_size(), 2);
  EXPECT_EQ(request.job().simulation().inputs(0).virtual_time_ns(), 500'000'000);
  wanted.inputs_file = folder.Put("bad.txt", "at noon START\n");
  EXPECT_THAT(Refusal(wanted), AllOf(HasSubstr("CELL-E9024"), HasSubstr("bad.txt")));
  wanted.inputs_file = folder.File("none.txt");
  EXPECT_THAT(Refusal(wanted), HasSubstr("CELL-E9022"));
}

TEST_F(RemoteJobs, TheBlockIsReadBeforeTheServerIsAsked) {
  SubmitRequest wanted{.machine = "m", .file = {}, .slot = 1};
  wanted.milling.block.stock = "100x80x10";
  wanted.milling.block.tool = "flat:2";
  wanted.milling.products = {"relief", "stl"};
  v1::SubmitJobRequest request = Submitted(wanted);
  const v1::Milling milling = request.job().simulation().milling();
  EXPECT_TRUE(milling.relief());
  EXPECT_TRUE(milling.stl());
  EXPECT_FALSE(milling.height_map());
  EXPECT_FALSE(milling.has_target());
  EXPECT_EQ(milling.cell_mm(), 0.0);  // as the tool wants it
  EXPECT_EQ(milling.stl_tolerance_mm(), wanted.milling.stl_tolerance_mm);
  wanted.milling.products = {"height-map", "target"};
  EXPECT_THAT(Refusal(wanted),
              AllOf(HasSubstr("CELL-E9026"), HasSubstr("--products target needs --target")));
  wanted.milling.products = {"height-map"};
  wanted.milling.block.target_tolerance_mm = 0.5;
  EXPECT_THAT(Refusal(wanted),
              AllOf(HasSubstr("CELL-E9026"), HasSubstr("--target-tolerance needs --target")));
  wanted.milling.target_slot = 9;
  wanted.milling.products = {"target"};
  request = Submitted(wanted);
  const v1::MillTarget& target = request.job().simulation().milling().target();
  EXPECT_EQ(target.slot(), 9);
  EXPECT_EQ(target.tolerance_mm(), 0.5);
  EXPECT_TRUE(target.picture());
  EXPECT_FALSE(request.job().simulation().milling().height_map());
  wanted.milling.block.target = folder.File("none.stl");
  EXPECT_THAT(Refusal(wanted), HasSubstr("CELL-E9022"));
  wanted.milling.block.target = folder.Put("other.rml", "PU1,1;");
  const v1::SubmitJobRequest other = Submitted(wanted);
  EXPECT_EQ(other.job().simulation().milling().target().inline_program().file_name(), "other.rml");
  wanted.milling.block.stock = "100x80";
  EXPECT_NE(Refusal(wanted), "");
}

// A server that is away is asked three times; one that answers, once.
TEST_F(RemoteJobs, ASubmissionIsRepeatedWithTheSameId) {
  const SubmitRequest wanted{.machine = "m", .file = {}, .slot = 1};
  jobs.job.set_name("jobs/17");
  jobs.refusal = {grpc::StatusCode::UNAVAILABLE, "restarting"};
  jobs.refusals = 2;
  Told told = Hear([&] { return SubmitJob(server.remote(), wanted); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output, "jobs/17\n");
  ASSERT_EQ(jobs.submitted.size(), 3U);
  EXPECT_EQ(jobs.submitted[0].request_id(), jobs.submitted[2].request_id());
  jobs.submitted.clear();
  jobs.refusals = 3;
  EXPECT_EQ(Hear([&] { return SubmitJob(server.remote(), wanted); }).exit_code, 3);
  EXPECT_EQ(jobs.submitted.size(), 3U);
  jobs.submitted.clear();
  jobs.refusal = {grpc::StatusCode::INVALID_ARGUMENT, "slot is 0"};
  told = Hear([&] { return SubmitJob(server.remote(), wanted); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_EQ(told.output, "");
  EXPECT_EQ(jobs.submitted.size(), 1U);
}

TEST_F(RemoteJobs, ASubmissionMayBeWatched) {
  SubmitRequest wanted{.machine = "m", .file = {}, .slot = 1};
  wanted.watch = true;
  jobs.job.set_name("jobs/17");
  jobs.connections = {{{End(1, v1::Outcome::KIND_FAILED, v1::VERDICT_BAD)}, {}}};
  const Told told = Hear([&] { return SubmitJob(server.remote(), wanted); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.output, StartsWith("jobs/17\n"));
  ASSERT_EQ(jobs.watches.size(), 1U);
  EXPECT_EQ(jobs.watches[0].name(), "jobs/17");
  EXPECT_EQ(jobs.watches[0].after_sequence(), 0);
}

TEST_F(RemoteJobs, AWatchEndsWithTheJob) {
  jobs.connections = {{{EventOf(4, "hello"), End(5, v1::Outcome::KIND_COMPLETED)}, {}}};
  Told told = Watch(false, 3);
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_THAT(told.output, HasSubstr("hello\n"));
  EXPECT_EQ(jobs.watches[0].name(), "jobs/17");
  EXPECT_EQ(jobs.watches[0].after_sequence(), 3);
  jobs.connections = {{{End(5, v1::Outcome::KIND_COMPLETED, v1::VERDICT_DOUBTFUL)}, {}}};
  EXPECT_EQ(Watch(false).exit_code, 0);
  EXPECT_EQ(Watch(true).exit_code, 1);
  told = Watch(false, 0, true);
  EXPECT_THAT(told.output, StartsWith("{"));
}

// One that ended before: its last event was seen, and the snapshot says how it ended.
TEST_F(RemoteJobs, AWatchOfAJobThatIsOverEndsWithItsSnapshot) {
  v1::WatchJobResponse snapshot;
  v1::Job& job = *snapshot.mutable_snapshot();
  job.mutable_end_time()->set_seconds(1);
  job.set_last_sequence(5);
  job.mutable_outcome()->set_kind(v1::Outcome::KIND_FAILED);
  jobs.connections = {{{snapshot}, {}}};
  Told told = Watch(false, 5);
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(Watch(false, 5, true).output, StartsWith("{"));
  // Of one whose events are still to come the snapshot is not the end.
  jobs.connections = {{{snapshot, End(6, v1::Outcome::KIND_COMPLETED)}, {}}};
  EXPECT_EQ(Watch(false, 4).exit_code, 0);
  job.clear_end_time();
  jobs.connections = {{{snapshot, End(6, v1::Outcome::KIND_COMPLETED)}, {}}};
  EXPECT_EQ(Watch(false, 5).exit_code, 0);
}

// A server that restarts is waited for: nothing is missed, and nothing told twice.
TEST_F(RemoteJobs, AWatchGoesOnWhereItWas) {
  for (const auto code :
       {grpc::StatusCode::UNAVAILABLE, grpc::StatusCode::CANCELLED, grpc::StatusCode::OK}) {
    jobs.connections = {{{EventOf(7, "before")}, {code, "away"}},
                        {{End(8, v1::Outcome::KIND_COMPLETED)}, {}}};
    const Told told = Watch();
    EXPECT_EQ(told.exit_code, 0);
    ASSERT_EQ(jobs.watches.size(), 2U);
    EXPECT_EQ(jobs.watches[1].after_sequence(), 7);
    EXPECT_THAT(told.errors, HasSubstr("the server is away; watching again when it is back"));
  }
  jobs.connections = {{{EventOf(7, "before")}, {grpc::StatusCode::NOT_FOUND, "no job 17"}}};
  const Told told = Watch();
  EXPECT_EQ(told.exit_code, 3);
  EXPECT_EQ(jobs.watches.size(), 1U);
  EXPECT_THAT(told.errors, AllOf(HasSubstr("no job 17"), Not(HasSubstr("away"))));
}

TEST_F(RemoteJobs, JobsAreATable) {
  jobs.job.set_name("jobs/17");
  jobs.job.set_state(v1::Job::STATE_FAILED);
  jobs.job.set_kind(v1::JOB_KIND_CHECK);
  jobs.job.set_machine("machines/mill-1");
  jobs.job.set_program("machines/mill-1/programs/3");
  jobs.job.mutable_outcome()->set_code("OPT-E348");
  Told told = Hear([&] { return Jobs(server.remote(), "state = FAILED", "queue", 5); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(jobs.listed.filter(), "state = FAILED");
  EXPECT_EQ(jobs.listed.page_size(), 5);
  EXPECT_EQ(jobs.listed.order_by(), "queue");
  EXPECT_THAT(told.output,
              MatchesRegex("JOB +STATE +VERDICT +KIND +MACHINE +TITLE +SUBMITTED +CODE *\n"
                           "17 +failed .*CHECK +mill-1 +machines/mill-1/programs/3 "
                           "+[0-9]+-[0-9]+-[0-9]+ [0-9:]+ +OPT-E348 *\n"));
  jobs.job.set_title("mine");
  told = Hear([&] { return Jobs(server.remote(), "", "newest", 0); });
  EXPECT_THAT(told.output, AllOf(HasSubstr(" mine "), Not(HasSubstr("programs/3"))));
  EXPECT_THAT(Hear([&] { return Jobs(server.remote(true), "", "oldest", 0); }).output,
              StartsWith("{"));
  EXPECT_EQ(jobs.listed.order_by(), "create_time");
}

TEST_F(RemoteJobs, AJobThatWaitsSaysForWhat) {
  jobs.job.set_name("jobs/17");
  jobs.job.set_state(v1::Job::STATE_QUEUED);
  jobs.job.set_waits_for("jobs/12");
  jobs.job.mutable_not_before_time()->set_seconds(1'795'600'800);
  const auto told = [&](v1::WaitReason reason) {
    jobs.job.set_wait_reason(reason);
    return Hear([&] { return Jobs(server.remote(), "", "queue", 0); }).output;
  };
  EXPECT_THAT(told(v1::WAIT_REASON_HELD), HasSubstr(" held"));
  EXPECT_THAT(told(v1::WAIT_REASON_NOT_BEFORE), HasSubstr(" not before 2026-11-2"));
  EXPECT_THAT(told(v1::WAIT_REASON_AFTER_JOB), HasSubstr(" after 12"));
  EXPECT_THAT(told(v1::WAIT_REASON_AFTER_JOB_FAILED),
              HasSubstr(" after 12, which did not succeed"));
  EXPECT_THAT(told(v1::WAIT_REASON_MACHINE_BUSY), HasSubstr(" its machine runs 12"));
  EXPECT_THAT(told(v1::WAIT_REASON_WORKER), Not(HasSubstr("12")));
}

TEST_F(RemoteJobs, AJobIsShownWithItsProducts) {
  jobs.job.set_name("jobs/17");
  jobs.job.set_state(v1::Job::STATE_RUNNING);
  jobs.job.set_machine("machines/m");
  jobs.job.set_title("mine");
  const auto show = [&] { return Hear([&] { return ShowJob(server.remote(), "17"); }); };
  EXPECT_EQ(show().output, "jobs/17  running  machines/m  mine\n");
  EXPECT_EQ(jobs.asked, "jobs/17");
  jobs.job.mutable_outcome()->set_kind(v1::Outcome::KIND_COMPLETED);
  v1::Artifact& artifact = *jobs.job.add_artifacts();
  artifact.set_name("report");
  artifact.set_size(2500);
  artifact.set_url_path("/v1/jobs/17/artifacts/report");
  EXPECT_THAT(show().output, AllOf(HasSubstr("\noutcome   "), Not(HasSubstr("\nverdict ")),
                                   HasSubstr("\nproduct   report  2.5 kB  "
                                             "/v1/jobs/17/artifacts/report\n")));
  jobs.job.mutable_outcome()->set_verdict(v1::VERDICT_GOOD);
  EXPECT_THAT(show().output, HasSubstr("\nverdict   GOOD"));
  EXPECT_THAT(Hear([&] { return ShowJob(server.remote(true), "jobs/17"); }).output,
              StartsWith("{"));
  EXPECT_EQ(Hear([&] { return CancelJob(server.remote(), "17"); }).output, "jobs/17 running\n");
  EXPECT_THAT(Hear([&] { return CancelJob(server.remote(true), "17"); }).output, StartsWith("{"));
}

TEST_F(RemoteJobs, TheQueueIsOrdered) {
  jobs.job.set_name("jobs/17");
  jobs.job.set_state(v1::Job::STATE_QUEUED);
  EXPECT_EQ(Hear([&] { return HoldJob(server.remote(), "17"); }).output, "jobs/17 queued\n");
  EXPECT_EQ(jobs.asked, "hold jobs/17");
  EXPECT_EQ(Hear([&] { return ResumeJob(server.remote(), "jobs/17"); }).output, "jobs/17 queued\n");
  EXPECT_EQ(jobs.asked, "resume jobs/17");
  EXPECT_EQ(Hear([&] { return MoveJob(server.remote(), "17", "12", 5); }).output,
            "jobs/17 queued\n");
  EXPECT_EQ(jobs.moved.name(), "jobs/17");
  EXPECT_EQ(jobs.moved.before(), "jobs/12");
  EXPECT_EQ(jobs.moved.priority(), 5);
  EXPECT_THAT(Hear([&] { return MoveJob(server.remote(true), "17", "", {}); }).output,
              StartsWith("{"));
  EXPECT_EQ(jobs.moved.before(), "");
  EXPECT_FALSE(jobs.moved.has_priority());
}

// What decides when a job starts goes along with it; a time that is none goes nowhere.
TEST_F(RemoteJobs, AJobIsSubmittedWithItsPlace) {
  SubmitRequest wanted{.machine = "mill-1", .slot = 7};
  wanted.priority = -3;
  wanted.hold = true;
  wanted.not_before = "2026-11-25T10:00:00Z";
  wanted.after = {"4", "jobs/5"};
  EXPECT_EQ(Hear([&] { return SubmitJob(server.remote(), wanted); }).exit_code, 0);
  ASSERT_FALSE(jobs.submitted.empty());
  const v1::Job& job = jobs.submitted.back().job();
  EXPECT_EQ(job.priority(), -3);
  EXPECT_TRUE(job.held());
  EXPECT_EQ(job.not_before_time().seconds(), 1'795'600'800);
  EXPECT_THAT(job.after_jobs(), testing::ElementsAre("jobs/4", "jobs/5"));
  const std::size_t before = jobs.submitted.size();
  wanted.not_before = "tomorrow";
  const Told told = Hear([&] { return SubmitJob(server.remote(), wanted); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.errors, HasSubstr("--not-before tomorrow is no time"));
  EXPECT_EQ(jobs.submitted.size(), before);
}

TEST_F(RemoteJobs, ProductsGoWhereTheyAreWanted) {
  const auto artifact = [&](const std::string& output) {
    return Hear([&] { return JobArtifact(server.remote(), "17", "report", output); });
  };
  EXPECT_EQ(artifact("").output, "one two");
  EXPECT_EQ(jobs.asked, "jobs/17 report");
  EXPECT_EQ(artifact("-").output, "one two");
  EXPECT_EQ(artifact(folder.File("a")).output, "");
  EXPECT_EQ(folder.Read("a"), "one two");
  EXPECT_EQ(artifact(folder.File("none/a")).exit_code, 2);
  const auto picture = [&](const std::string& output) {
    return Hear([&] { return JobPicture(server.remote(), "17", output); });
  };
  EXPECT_EQ(picture("").output, "<svg/>");
  EXPECT_EQ(jobs.asked, "jobs/17");
  EXPECT_EQ(picture("-").output, "<svg/>");
  EXPECT_EQ(picture(folder.File("b")).output, "");
  EXPECT_EQ(folder.Read("b"), "<svg/>");
  EXPECT_EQ(picture(folder.File("none/b")).exit_code, 2);
}

TEST_F(RemoteJobs, ARefusalIsToldByEach) {
  jobs.refusal = {grpc::StatusCode::NOT_FOUND, "there is none"};
  const Remote remote = server.remote();
  for (const auto& verb : std::vector<std::function<int()>>{
           [&] { return Jobs(remote, "", "newest", 0); }, [&] { return ShowJob(remote, "1"); },
           [&] { return CancelJob(remote, "1"); }, [&] { return HoldJob(remote, "1"); },
           [&] { return ResumeJob(remote, "1"); }, [&] { return MoveJob(remote, "1", "", {}); },
           [&] { return JobPicture(remote, "1", folder.File("out")); },
           [&] { return JobArtifact(remote, "1", "a", folder.File("out")); }}) {
    const Told told = Hear(verb);
    EXPECT_EQ(told.exit_code, 3);
    EXPECT_EQ(told.output, "");
    EXPECT_THAT(told.errors, HasSubstr("there is none"));
  }
  EXPECT_EQ(folder.Read("out"), "");
}

}  // namespace
}  // namespace rmlcell::cli
