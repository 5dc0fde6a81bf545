// The verbs about jobs: what is sent with one, how one is watched to its end, and what is shown of
// it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "clients/cli/remote.h"
#include "rmlcell/v1/job.grpc.pb.h"
#include "tests/clients/cli/fake_services.h"

namespace rmlcell::cli {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

// One connection of a watch: what it tells, and how it ends.
struct Watched {
  std::vector<v1::WatchJobResponse> messages;
  grpc::Status end;
};

struct FakeJobs final : v1::JobService::Service {
  grpc::Status SubmitJob(grpc::ServerContext*, const v1::SubmitJobRequest* request,
                         v1::Job* response) override {
    submitted.push_back(*request);
    *response = job;
    if (submitted.size() <= refusals) return refusal;
    return {};
  }
  grpc::Status WatchJob(grpc::ServerContext*, const v1::WatchJobRequest* request,
                        grpc::ServerWriter<v1::WatchJobResponse>* writer) override {
    watches.push_back(*request);
    if (watches.size() > connections.size()) return {grpc::StatusCode::NOT_FOUND, "no more"};
    const Watched& connection = connections[watches.size() - 1];
    for (const v1::WatchJobResponse& message : connection.messages) writer->Write(message);
    return connection.end;
  }
  grpc::Status ListJobs(grpc::ServerContext*, const v1::ListJobsRequest* request,
                        v1::ListJobsResponse* response) override {
    listed = *request;
    *response->add_jobs() = job;
    return refusal;
  }
  grpc::Status GetJob(grpc::ServerContext*, const v1::GetJobRequest* request,
                      v1::Job* response) override {
    asked = request->name();
    *response = job;
    return refusal;
  }
  grpc::Status CancelJob(grpc::ServerContext*, const v1::CancelJobRequest* request,
                         v1::Job* response) override {
    asked = request->name();
    *response = job;
    return refusal;
  }
  grpc::Status HoldJob(grpc::ServerContext*, const v1::HoldJobRequest* request,
                       v1::HaltJobResponse* response) override {
    asked = "hold " + request->name();
    *response->mutable_job() = job;
    return refusal;
  }
  grpc::Status ResumeJob(grpc::ServerContext*, const v1::ResumeJobRequest* request,
                         v1::Job* response) override {
    asked = "resume " + request->name();
    *response = job;
    return refusal;
  }
  grpc::Status MoveJob(grpc::ServerContext*, const v1::MoveJobRequest* request,
                       v1::Job* response) override {
    moved = *request;
    *response = job;
    return refusal;
  }
  grpc::Status GetJobPicture(grpc::ServerContext*, const v1::GetJobPictureRequest* request,
                             v1::GetJobPictureResponse* response) override {
    asked = request->name();
    response->set_content("<svg/>");
    return refusal;
  }
  grpc::Status StreamJobArtifact(
      grpc::ServerContext*, const v1::StreamJobArtifactRequest* request,
      grpc::ServerWriter<v1::StreamJobArtifactResponse>* writer) override {
    asked = request->name() + " " + request->artifact();
    v1::StreamJobArtifactResponse part;
    for (const char* chunk : {"one ", "two"}) {
      part.set_chunk(chunk);
      writer->Write(part);
    }
    return refusal;
  }

  v1::Job job;
  std::vector<v1::SubmitJobRequest> submitted;
  std::size_t refusals = 0;  // how many submissions are refused
  grpc::Status refusal;
  std::vector<v1::WatchJobRequest> watches;
  std::vector<Watched> connections;
  v1::ListJobsRequest listed;
  v1::MoveJobRequest moved;
  std::string asked;
};

v1::WatchJobResponse Event(std::int64_t sequence, const std::string& text) {
  v1::WatchJobResponse message;
  message.set_sequence(sequence);
  message.mutable_event()->mutable_message()->set_text(text);
  return message;
}
v1::WatchJobResponse End(std::int64_t sequence, v1::Outcome::Kind kind,
                         v1::Verdict verdict = v1::VERDICT_GOOD) {
  v1::WatchJobResponse message;
  message.set_sequence(sequence);
  message.mutable_event()->mutable_ended()->set_kind(kind);
  message.mutable_event()->mutable_ended()->set_verdict(verdict);
  return message;
}

class RemoteJobs : public testing::Test {
 protected:
  Told Watch(bool strict = false, std::int64_t after = 0, bool as_json = false) {
    jobs.watches.clear();
    return Hear([&] { return WatchJob(server.remote(as_json), "17", after, strict); });
  }
  // The one request that a submission makes.
  v1::SubmitJobRequest Submitted(const SubmitRequest& wanted) {
    jobs.submitted.clear();
    const Told told = Hear([&] { return SubmitJob(server.remote(), wanted); });
    EXPECT_EQ(told.exit_code, 0) << told.errors;
    EXPECT_THAT(jobs.submitted, SizeIs(1));
    return jobs.submitted.empty() ? v1::SubmitJobRequest() : jobs.submitted[0];
  }
  // What is told before any server is asked.
  std::string Refusal(const SubmitRequest& wanted) {
    jobs.submitted.clear();
    const Told told = Hear([&] { return SubmitJob(server.remote(), wanted); });
    EXPECT_EQ(told.exit_code, 2);
    EXPECT_TRUE(jobs.submitted.empty());
    return told.errors;
  }

  CliFolder folder;
  FakeJobs jobs;
  FakeServer server{folder, {&jobs}};
};

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
  jobs.connections = {{{Event(4, "hello"), End(5, v1::Outcome::KIND_COMPLETED)}, {}}};
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
    jobs.connections = {{{Event(7, "before")}, {code, "away"}},
                        {{End(8, v1::Outcome::KIND_COMPLETED)}, {}}};
    const Told told = Watch();
    EXPECT_EQ(told.exit_code, 0);
    ASSERT_EQ(jobs.watches.size(), 2U);
    EXPECT_EQ(jobs.watches[1].after_sequence(), 7);
    EXPECT_THAT(told.errors, HasSubstr("the server is away; watching again when it is back"));
  }
  jobs.connections = {{{Event(7, "before")}, {grpc::StatusCode::NOT_FOUND, "no job 17"}}};
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

// What `act` draws on standard error while that is a terminal. It must be less than a terminal
// keeps, 4 KiB.
std::string DrawnOnErrors(const std::function<void()>& act) {
  termios raw{};
  ::cfmakeraw(&raw);
  int outside = -1;
  int inside = -1;
  EXPECT_EQ(::openpty(&outside, &inside, nullptr, &raw, nullptr), 0);
  std::fflush(stderr);
  const int kept = ::dup(STDERR_FILENO);
  ::dup2(inside, STDERR_FILENO);
  act();
  std::fflush(stderr);
  ::dup2(kept, STDERR_FILENO);
  ::close(kept);
  ::close(inside);
  std::string drawn;
  char room[4096];
  for (ssize_t size = 0; (size = ::read(outside, room, sizeof room)) > 0;)
    drawn.append(room, static_cast<std::size_t>(size));
  ::close(outside);
  return drawn;
}

// The share where it is known, how long it takes where that is planned, the instruction and the
// tip; a job that ended well leaves a full bar.
TEST_F(RemoteJobs, ATerminalShowsHowFarAJobIs) {
  v1::WatchJobResponse planned;
  v1::JobProgress& at = *planned.mutable_progress();
  at.set_virtual_time_ns(234'000'000'000);
  at.set_planned_time_ns(868'000'000'000);
  at.set_progress(0.5);
  at.set_instruction("MOVE");
  at.mutable_position()->mutable_tip()->set_x(1.0);
  at.mutable_position()->mutable_tip()->set_y(-2.5);
  at.mutable_position()->mutable_tip()->set_z(3.25);
  v1::WatchJobResponse unplanned = planned;
  unplanned.mutable_progress()->clear_planned_time_ns();
  unplanned.mutable_progress()->clear_progress();
  const auto drawn = [&](const v1::WatchJobResponse& end) {
    jobs.connections = {{{planned, unplanned, end}, {}}};
    jobs.watches.clear();
    testing::internal::CaptureStdout();
    const std::string text = DrawnOnErrors([&] { WatchJob(server.remote(), "17", 0, false); });
    testing::internal::GetCapturedStdout();
    return text;
  };
  const auto cells = [](const char* cell, int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += cell;
    return text;
  };
  const std::string good = drawn(End(1, v1::Outcome::KIND_COMPLETED));
  EXPECT_THAT(good, HasSubstr(cells("█", 14) + cells("░", 14) +
                              " 50 %  234.0 of 868.0 s  MOVE  X 1.00 Y -2.50 Z 3.25"));
  EXPECT_THAT(good, HasSubstr("█" + cells("░", 27) + "  234.0 s  MOVE  X 1.00 Y -2.50 Z 3.25"));
  EXPECT_THAT(good, testing::EndsWith(cells("█", 28) + " 100 %  jobs/17\n"));
  const std::string bad = drawn(End(1, v1::Outcome::KIND_FAILED, v1::VERDICT_BAD));
  EXPECT_THAT(bad, Not(HasSubstr("100 %")));
  // As messages, for scripts.
  jobs.connections = {{{planned, End(1, v1::Outcome::KIND_COMPLETED)}, {}}};
  EXPECT_THAT(Watch(false, 0, true).output, HasSubstr("\"234000000000\""));
}

// That the server is away is told when it goes, not at each try; and again when it came back in
// between.
TEST_F(RemoteJobs, ThatTheServerIsAwayIsToldOnce) {
  const grpc::Status away{grpc::StatusCode::UNAVAILABLE, "away"};
  jobs.connections = {{{Event(7, "before")}, away},
                      {{}, away},
                      {{Event(8, "between")}, away},
                      {{End(9, v1::Outcome::KIND_COMPLETED)}, {}}};
  const Told told = Watch();
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(jobs.watches.size(), 4U);
  const std::string line = "rmlcell: the server is away; watching again when it is back\n";
  EXPECT_EQ(told.errors, line + line);
}

// Where a run begins, and what stands for it; nothing of a simulation where nothing was asked.
TEST_F(RemoteJobs, ARunIsSubmittedWithItsBeginning) {
  SubmitRequest wanted{.machine = "m", .file = {}, .slot = 7};
  wanted.kind = "run";
  wanted.unzeroed = true;
  wanted.ticket = "17";
  wanted.step = "45/10";
  wanted.occurrence = 2;
  wanted.off_until_work_on = true;
  wanted.seen = {"clamps", "origin-valid"};
  wanted.labels = {"order-1", "urgent"};
  const v1::Job job = Submitted(wanted).job();
  EXPECT_EQ(job.kind(), v1::JOB_KIND_RUN);
  EXPECT_TRUE(job.run().unzeroed());
  EXPECT_EQ(job.run().ticket(), "jobs/17");
  EXPECT_EQ(job.run().step().program(), 45);
  EXPECT_EQ(job.run().step().step(), 10);
  EXPECT_EQ(job.run().occurrence(), 2);
  EXPECT_TRUE(job.run().off_until_work_on());
  ASSERT_EQ(job.run().confirmations_size(), 2);
  EXPECT_EQ(job.run().confirmations(0), v1::CONFIRMATION_CLAMPS);
  EXPECT_EQ(job.run().confirmations(1), v1::CONFIRMATION_ORIGIN_VALID);
  EXPECT_THAT(job.labels(), ElementsAre("order-1", "urgent"));
  EXPECT_FALSE(job.has_simulation());
  wanted.override_percent = 50.0;
  EXPECT_TRUE(Submitted(wanted).job().has_simulation());
  // One that begins at its beginning says nothing of all that.
  const v1::Job plain = Submitted({.machine = "m", .file = {}, .slot = 7}).job();
  EXPECT_FALSE(plain.has_run());
  EXPECT_EQ(plain.labels_size(), 0);
  wanted.seen = {"clamp"};
  EXPECT_THAT(Refusal(wanted), AllOf(HasSubstr("CELL-E9003"),
                                     HasSubstr("'clamp' is nothing to look at: clamps, tool")));
  wanted.step = "45/";
  EXPECT_THAT(Refusal(wanted), AllOf(HasSubstr("CELL-E9003"), HasSubstr("'45/' is no step")));
}

// A time that is none is a wrong use of the command.
TEST_F(RemoteJobs, ATimeThatIsNoneIsWrongUse) {
  SubmitRequest wanted{.machine = "m", .file = {}, .slot = 7};
  wanted.not_before = "tomorrow";
  EXPECT_THAT(Refusal(wanted), AllOf(HasSubstr("CELL-E9026"), HasSubstr("--not-before tomorrow")));
}

TEST_F(RemoteJobs, TheBlockGoesAlongAsItWasGiven) {
  SubmitRequest wanted{.machine = "m", .file = {}, .slot = 1};
  wanted.milling.block.stock = "100x80x10";
  wanted.milling.block.tool = "flat:2:flutes=2";
  wanted.milling.block.cell_mm = 0.25;
  wanted.milling.block.material = "wax";
  wanted.milling.block.rpm = 8000.0;
  wanted.milling.stl_tolerance_mm = 0.5;
  wanted.milling.products = {"height-grid"};
  const v1::SubmitJobRequest request = Submitted(wanted);
  const v1::Milling& milling = request.job().simulation().milling();
  EXPECT_EQ(milling.cell_mm(), 0.25);
  EXPECT_EQ(milling.material(), "wax");
  EXPECT_EQ(milling.rpm(), 8000.0);
  EXPECT_EQ(milling.stl_tolerance_mm(), 0.5);
  EXPECT_TRUE(milling.height_grid());
  EXPECT_FALSE(milling.relief() || milling.height_map() || milling.stl());
  // No server takes a target of more than 64 MiB, however it is set up.
  wanted.milling.block.target = folder.Put("large.stl", "solid");
  std::filesystem::resize_file(wanted.milling.block.target, (std::uintmax_t{64} << 20) + 1);
  EXPECT_THAT(Refusal(wanted),
              AllOf(HasSubstr("CELL-E9007"), HasSubstr("larger than 67108864 bytes")));
}

TEST_F(RemoteJobs, AJobThatIsShownSaysForWhatItWaitsAndWhyItIsNotGood) {
  jobs.job.set_name("jobs/17");
  jobs.job.set_state(v1::Job::STATE_QUEUED);
  jobs.job.set_waits_for("anna\tat the page");
  const auto show = [&] { return Hear([&] { return ShowJob(server.remote(), "17"); }).output; };
  EXPECT_THAT(show(), Not(HasSubstr("waits")));  // nothing but its turn
  jobs.job.set_wait_reason(v1::WAIT_REASON_CONTROL);
  EXPECT_THAT(show(), HasSubstr("\nwaits     anna\\x09at the page\n"));
  jobs.job.set_wait_reason(v1::WAIT_REASON_MACHINE_NOT_READY);
  EXPECT_THAT(show(), HasSubstr("\nwaits     its machine cannot start: rmlcell machine status\n"));
  v1::Outcome& outcome = *jobs.job.mutable_outcome();
  outcome.set_kind(v1::Outcome::KIND_COMPLETED);
  outcome.set_verdict(v1::VERDICT_BAD);
  v1::VerdictReason& reason = *outcome.add_reasons();
  reason.set_message("too deep");
  reason.set_code("RML1-E8002");
  EXPECT_THAT(show(), HasSubstr("\nverdict   BAD\n          too deep (RML1-E8002)\n"));
}

}  // namespace
}  // namespace rmlcell::cli
