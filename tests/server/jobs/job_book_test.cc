#include "server/jobs/job_book.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <future>

#include "engine/core/number_text.h"
#include "engine/families/families.h"
#include "proto/bridge/encoding.h"
#include "proto/bridge/sha256.h"
#include "server/base/config.h"
#include "server/base/names.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using storage::JobState;

class JobBookTest : public testing::Test {
 protected:
  // What is asked for in vain, how it is refused, and what makes it so.
  using Refusals =
      std::vector<std::tuple<std::string, ErrorCode, std::function<void(v1::SubmitJobRequest&)>>>;
  void RefusesEach(const Refusals& cases) {
    for (const auto& [what, code, change] : cases) {
      for (const bool validate_only : {false, true}) {
        v1::SubmitJobRequest request = Simulate();
        change(request);
        request.set_validate_only(validate_only);
        EXPECT_EQ(CodeOf(Submit(request)), code) << what;
      }
    }
    EXPECT_EQ(Jobs(), 0);
  }
  Result<v1::Job> Submit(const v1::SubmitJobRequest& request) {
    std::optional<Result<v1::Job>> answer;
    std::atomic<bool> done = false;
    book.Submit(request, "tester", [&](Result<v1::Job> job) {
      answer = std::move(job);
      done = true;
    });
    if (!Eventually([&] { return done.load(); })) throw std::runtime_error("no answer");
    return *std::move(answer);
  }
  v1::SubmitJobRequest Simulate(const std::string& source = "STOP\n") {
    v1::SubmitJobRequest request;
    request.mutable_job()->set_kind(v1::JOB_KIND_SIMULATE);
    request.mutable_job()->set_machine("machines/optimo-1");
    request.mutable_job()->mutable_inline_program()->set_file_name("part.S");
    request.mutable_job()->mutable_inline_program()->set_content(source);
    return request;
  }
  std::int64_t Number(const v1::Job& job) { return Must(ParseJobName(job.name())); }
  std::int64_t Jobs() {
    return static_cast<std::int64_t>(Must(bed.store().ListJobs({.limit = 1000})).size());
  }

  ServerBed bed;
  Config config;
  JobBook book{bed.store(), config};
};

TEST_F(JobBookTest, AnAcknowledgedJobIsDurableWithItsProgram) {
  const v1::Job job = Must(Submit(Simulate("DELAY 1.0\n")));
  EXPECT_EQ(job.state(), v1::Job::STATE_QUEUED);
  EXPECT_EQ(job.machine(), "machines/optimo-1");
  const storage::JobRecord record = Must(bed.store().GetJob(Number(job)));
  EXPECT_EQ(record.caller, "tester");
  EXPECT_EQ(record.attempts_max, 2);  // jobs.attempts
  EXPECT_EQ(Must(bed.store().ReadArtifact(Number(job), kMainAttachment)), "DELAY 1.0\n");
  EXPECT_EQ(record.specification.find("DELAY"), std::string::npos);  // the bytes are kept once
  EXPECT_EQ(Must(book.Get(job.name())).artifacts_size(), 1);
}

// Issue "Jobs": submit is idempotent by request_id.
TEST_F(JobBookTest, TheSameRequestIdIsTheSameJob) {
  v1::SubmitJobRequest request = Simulate();
  request.set_request_id("r-1");
  const v1::Job first = Must(Submit(request));
  EXPECT_EQ(Must(Submit(request)).name(), first.name());
  EXPECT_EQ(Jobs(), 1);
  request.mutable_job()->set_title("another");
  EXPECT_EQ(CodeOf(Submit(request)), ErrorCode::kCellRequestIdReused);
  request.set_request_id("r-2");
  EXPECT_NE(Must(Submit(request)).name(), first.name());
  EXPECT_EQ(Jobs(), 2);
}

// What decides whether a submission is another job's repetition is SHA-256, of all that it asks
// for.
TEST_F(JobBookTest, ARequestIsKnownByItsSha256) {
  std::set<std::string> hashes;
  for (const std::string source : {"STOP\n", "STOP \n"}) {
    v1::SubmitJobRequest request = Simulate(source);
    request.set_request_id("of " + source);
    const std::string hash = Must(bed.store().GetJob(Number(Must(Submit(request))))).request_hash;
    EXPECT_EQ(hash, bridge::Sha256Hex(bridge::StableBytes(request.job())));
    EXPECT_EQ(hash.size(), 64U);
    hashes.insert(hash);
  }
  EXPECT_EQ(hashes.size(), 2U);
}

// Earlier versions kept a number of 64 bits: their jobs are read, and never taken for a new
// request's.
TEST_F(JobBookTest, AJobOfAnEarlierVersionIsReadAndItsRequestIdIsUsed) {
  v1::SubmitJobRequest request = Simulate();
  request.set_request_id("r");
  storage::NewJob earlier{.request_id = "r",
                          .request_hash = "14695981039346656037",
                          .machine = "optimo-1",
                          .kind = "SIMULATE",
                          .specification = request.job().SerializeAsString()};
  const std::int64_t id = Must(bed.store().SubmitAndWait(std::move(earlier))).job.id;
  EXPECT_EQ(Must(book.Get(JobName(id))).machine(), "machines/optimo-1");
  EXPECT_EQ(CodeOf(Submit(request)), ErrorCode::kCellRequestIdReused);
  EXPECT_EQ(Jobs(), 1);
}

// The entries of a map have no order: a repeated request is the same whatever order they come in.
TEST_F(JobBookTest, TheSameRequestIsRecognisedWithManyParameters) {
  std::vector<std::pair<std::string, std::string>> parameters;
  for (const machine::ParameterInfo& info : families::FindFamily("optimo")->parameters()) {
    if (info.choices.empty()) parameters.emplace_back(info.name, ShortestText(info.standard));
  }
  ASSERT_GE(parameters.size(), 8U);
  std::string name;
  for (int round = 0; round < 20; ++round) {
    v1::SubmitJobRequest request = Simulate();
    request.set_request_id("r");
    for (const auto& [key, value] : parameters) {
      (*request.mutable_job()->mutable_simulation()->mutable_parameters())[key] = value;
    }
    std::ranges::rotate(parameters, parameters.begin() + 3);
    v1::SubmitJobRequest received;  // as from the wire
    ASSERT_TRUE(received.ParseFromString(request.SerializeAsString()));
    const Result<v1::Job> job = Submit(received);
    ASSERT_TRUE(job) << round;
    if (name.empty()) name = job->name();
    EXPECT_EQ(job->name(), name);
  }
}

TEST_F(JobBookTest, ChecksWhatCanBeCheckedBeforeWorkBegins) {
  constexpr auto kInvalid = ErrorCode::kCellInvalidArgument;
  const Refusals cases = {
      {"no kind", kInvalid, [](auto& r) { r.mutable_job()->clear_kind(); }},
      {"unknown kind", kInvalid,
       [](auto& r) { r.mutable_job()->set_kind(static_cast<v1::JobKind>(99)); }},
      {"long request_id", kInvalid, [](auto& r) { r.set_request_id(std::string(65, 'r')); }},
      {"long title", kInvalid, [](auto& r) { r.mutable_job()->set_title(std::string(201, 't')); }},
      {"attempts -1", kInvalid, [](auto& r) { r.mutable_job()->set_attempts_max(-1); }},
      {"attempts 11", kInvalid, [](auto& r) { r.mutable_job()->set_attempts_max(11); }},
      {"steps -1", kInvalid, [](auto& r) { r.mutable_job()->mutable_budget()->set_steps(-1); }},
      {"time -1", kInvalid,
       [](auto& r) { r.mutable_job()->mutable_budget()->set_virtual_time_ns(-1); }},
      {"override 146", kInvalid,
       [](auto& r) { r.mutable_job()->mutable_simulation()->set_override_percent(146); }},
      {"breakpoint slot 100", ErrorCode::kProgramNumber,
       [](auto& r) {
         r.mutable_job()->mutable_simulation()->add_breakpoints()->mutable_step()->set_program(100);
         r.mutable_job()->mutable_simulation()->mutable_breakpoints(0)->mutable_step()->set_step(1);
       }},
      {"breakpoint step 0", kInvalid,
       [](auto& r) {
         r.mutable_job()->mutable_simulation()->add_breakpoints()->mutable_step()->set_program(1);
       }},
      {"mode MANUAL", kInvalid,
       [](auto& r) { r.mutable_job()->mutable_simulation()->set_mode(v1::OPERATING_MODE_MANUAL); }},
      {"open variable range", kInvalid,
       [](auto& r) { r.mutable_job()->mutable_simulation()->add_variables("VR[0..9"); }},
      {"open variable", kInvalid,
       [](auto& r) { r.mutable_job()->mutable_simulation()->add_variables("VR[0"); }},
      {"variable of no group", kInvalid,
       [](auto& r) { r.mutable_job()->mutable_simulation()->add_variables("ZZ[1]"); }},
      {"variable 100", kInvalid,
       [](auto& r) { r.mutable_job()->mutable_simulation()->add_variables("VR[95..100]"); }},
      {"register of a mill", kInvalid,
       [](auto& r) { r.mutable_job()->mutable_simulation()->add_variables("RPM"); }},
      {"input without kind", kInvalid,
       [](auto& r) { r.mutable_job()->mutable_simulation()->add_inputs(); }},
      {"no machine", kInvalid, [](auto& r) { r.mutable_job()->clear_machine(); }},
      {"unknown machine", ErrorCode::kCellUnknownMachine,
       [](auto& r) { r.mutable_job()->set_machine("machines/none"); }},
      {"no program", kInvalid, [](auto& r) { r.mutable_job()->clear_inline_program(); }},
      {"empty program", ErrorCode::kCellEmptyProgram,
       [](auto& r) { r.mutable_job()->mutable_inline_program()->clear_content(); }},
      {"program over the limit", ErrorCode::kCellTooLarge,
       [](auto& r) {
         r.mutable_job()->mutable_inline_program()->set_content(std::string(2049, ';'));
       }},
      {"inline slot 100", ErrorCode::kProgramNumber,
       [](auto& r) { r.mutable_job()->set_inline_slot(100); }},
      {"program of a mill", kInvalid,
       [](auto& r) { r.mutable_job()->mutable_inline_program()->set_file_name("a.rml"); }},
      {"further program of a mill", kInvalid,
       [](auto& r) {
         v1::SlotProgram& program = *r.mutable_job()->mutable_simulation()->add_programs();
         program.set_slot(4);
         program.mutable_program()->set_file_name("a.RML");
         program.mutable_program()->set_content("PU;");
       }},
      {"empty slot", ErrorCode::kProgramMissing,
       [](auto& r) { r.mutable_job()->set_program("machines/optimo-1/programs/45"); }},
      {"slot 0", ErrorCode::kProgramNumber,
       [](auto& r) { r.mutable_job()->set_program("machines/optimo-1/programs/0"); }},
      {"executable", ErrorCode::kProgramNumber,
       [](auto& r) { r.mutable_job()->set_program("machines/optimo-1/programs/145"); }},
      {"slot of another machine", kInvalid,
       [](auto& r) { r.mutable_job()->set_program("machines/mill-1/programs/1"); }},
      {"unknown parameter", ErrorCode::kCellUnknownParameter,
       [](auto& r) {
         (*r.mutable_job()->mutable_simulation()->mutable_parameters())["NOPE"] = "1";
       }},
      {"further program in slot 0", ErrorCode::kProgramNumber,
       [](auto& r) { r.mutable_job()->mutable_simulation()->add_programs(); }},
      {"further program without bytes", ErrorCode::kCellEmptyProgram,
       [](auto& r) { r.mutable_job()->mutable_simulation()->add_programs()->set_slot(4); }},
      {"further program over the limit", ErrorCode::kCellTooLarge,
       [](auto& r) {
         v1::SlotProgram& program = *r.mutable_job()->mutable_simulation()->add_programs();
         program.set_slot(4);
         program.mutable_program()->set_content(std::string(2049, ';'));
       }},
      {"further program twice", kInvalid,
       [](auto& r) {
         for (int i = 0; i < 2; ++i) {
           v1::SlotProgram& program = *r.mutable_job()->mutable_simulation()->add_programs();
           program.set_slot(4);
           program.mutable_program()->set_content("STOP\n");
         }
       }},
  };
  config.limit_program_bytes = 2048;
  RefusesEach(cases);
  EXPECT_TRUE(Submit(Simulate(std::string(2047, ';') + "\n")));
}

// LIVE-5.01, LIVE-5.02: a RUN has what moves a machine and nothing else, and is attempted once.
TEST_F(JobBookTest, ARunAsksForNothingOfASimulation) {
  constexpr auto kInvalid = ErrorCode::kCellInvalidArgument;
  const Refusals cases = {
      {"RUN options of a check", kInvalid, [](auto& r) { r.mutable_job()->mutable_run(); }},
      {"RUN with what simulates", kInvalid,
       [](auto& r) {
         r.mutable_job()->set_kind(v1::JOB_KIND_RUN);
         r.mutable_job()->mutable_simulation()->set_override_percent(50);
       }},
      {"RUN with a budget", kInvalid,
       [](auto& r) {
         r.mutable_job()->set_kind(v1::JOB_KIND_RUN);
         r.mutable_job()->clear_simulation();
         r.mutable_job()->mutable_budget()->set_steps(50);
       }},
      {"RUN twice", kInvalid,
       [](auto& r) {
         r.mutable_job()->set_kind(v1::JOB_KIND_RUN);
         r.mutable_job()->clear_simulation();
         r.mutable_job()->set_attempts_max(2);
       }},
      {"RUN from no step", kInvalid, [](auto& r) {
         r.mutable_job()->set_kind(v1::JOB_KIND_RUN);
         r.mutable_job()->clear_simulation();
         r.mutable_job()->mutable_run()->mutable_step()->set_step(0);
       }}};
  RefusesEach(cases);
}

// RML1-5A.01, OPT-B.08: the parameters of a job go over those of its machine, and must fit together
// with them.
TEST_F(JobBookTest, ParametersOfAJobMustFitThoseOfItsMachine) {
  Must(bed.store().PutMachine(
      {.id = "narrow", .family = "rml1", .parameters = {{"X_MIN", "300"}, {"X_MAX", "400"}}}, 0));
  const auto code = [&](const std::string& machine, const std::string& name,
                        const std::string& value) {
    v1::SubmitJobRequest request = Simulate();
    request.mutable_job()->set_machine("machines/" + machine);
    if (machine != "optimo-1")
      request.mutable_job()->mutable_inline_program()->set_file_name("a.rml");
    (*request.mutable_job()->mutable_simulation()->mutable_parameters())[name] = value;
    return CodeOf(Submit(request));
  };
  constexpr auto kRange = ErrorCode::kCellParameterRange;
  EXPECT_EQ(code("mill-1", "X_MIN", "500"), kRange);  // X_MAX is 200
  EXPECT_EQ(code("mill-1", "X_MAX", "250"), std::nullopt);
  EXPECT_EQ(code("narrow", "X_MAX", "250"), kRange);
  EXPECT_EQ(code("narrow", "X_MIN", "350"), std::nullopt);
  EXPECT_EQ(code("optimo-1", "TRAVEL_X_MIN", "3601"), kRange);
  EXPECT_EQ(code("optimo-1", "TRAVEL_X_MIN", "3600"), std::nullopt);
}

// OPT-7.96 to 7.101 for the laser; of a mill only what its profile has.
TEST_F(JobBookTest, AJobMayAskForTheVariablesOfItsMachine) {
  v1::SubmitJobRequest request = Simulate();
  for (const std::string name :
       {"VR[0..99]", "vi[99]", "VL[0]", "IL[1]", "OL[2]", "IA[0]", "OA[3]"}) {
    request.mutable_job()->mutable_simulation()->add_variables(name);
  }
  EXPECT_TRUE(Submit(request));
  request.mutable_job()->set_machine("machines/mill-1");
  request.mutable_job()->mutable_inline_program()->set_file_name("a.rml");
  EXPECT_EQ(CodeOf(Submit(request)), ErrorCode::kCellInvalidArgument);
  request.mutable_job()->mutable_simulation()->clear_variables();
  request.mutable_job()->mutable_simulation()->add_variables("ESC.M");
  EXPECT_TRUE(Submit(request));
  request.mutable_job()->mutable_simulation()->add_variables("ASTEPS");
  EXPECT_EQ(CodeOf(Submit(request)), ErrorCode::kCellInvalidArgument);
  (*request.mutable_job()->mutable_simulation()->mutable_parameters())["AXES"] = "XYZA";
  EXPECT_TRUE(Submit(request));
}

TEST_F(JobBookTest, AskingOnlyStoresNothing) {
  v1::SubmitJobRequest request = Simulate();
  request.set_validate_only(true);
  EXPECT_EQ(Must(Submit(request)).name(), "");
  EXPECT_EQ(Jobs(), 0);
}

// AIP-163: asking gives what doing would, of a request id that is known as well.
TEST_F(JobBookTest, AskingLooksAtTheRequestId) {
  v1::SubmitJobRequest request = Simulate();
  request.set_request_id("r");
  Must(Submit(request));
  request.set_validate_only(true);
  EXPECT_EQ(Must(Submit(request)).name(), "");
  request.mutable_job()->set_title("another");
  EXPECT_EQ(CodeOf(Submit(request)), ErrorCode::kCellRequestIdReused);
  request.mutable_job()->set_machine("machines/none");  // the same, whatever else is wrong
  EXPECT_EQ(CodeOf(Submit(request)), ErrorCode::kCellRequestIdReused);
  EXPECT_EQ(Jobs(), 1);
}

TEST_F(JobBookTest, SoManyJobsMayWaitAndNoMore) {
  config.jobs_queued_max = 3;
  v1::SubmitJobRequest again = Simulate();
  again.set_request_id("again");
  const v1::Job first = Must(Submit(again));
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(Submit(Simulate()));
  EXPECT_EQ(CodeOf(Submit(Simulate())), ErrorCode::kCellResourceExhausted);
  // Who saw no answer and repeats has his job, however full the queue is by now.
  EXPECT_EQ(Must(Submit(again)).name(), first.name());
  Must(bed.store().Acquire("w", {"SIMULATE"}, std::chrono::hours(1), {}));
  EXPECT_TRUE(Submit(Simulate()));
}

TEST_F(JobBookTest, ListsPagesNewestFirst) {
  for (int i = 0; i < 7; ++i) Must(Submit(Simulate()));
  v1::ListJobsRequest request;
  request.set_page_size(3);
  std::vector<std::int64_t> ids;
  std::vector<int> sizes;
  for (;;) {
    const v1::ListJobsResponse page = Must(book.List(request));
    sizes.push_back(page.jobs_size());
    for (const v1::Job& job : page.jobs()) ids.push_back(Number(job));
    if (page.next_page_token().empty()) break;
    request.set_page_token(page.next_page_token());
  }
  EXPECT_THAT(sizes, testing::ElementsAre(3, 3, 1));
  ASSERT_EQ(ids.size(), 7U);
  EXPECT_TRUE(std::ranges::is_sorted(ids, std::greater<>()));
  request.clear_page_token();
  request.set_page_size(7);  // exactly all: there is no next page
  EXPECT_EQ(Must(book.List(request)).next_page_token(), "");
  for (const std::string token :
       {"x", "0", "-1", "1 ", "1", "1,0,0,0", "1,0,0,0,1,", "1,0,0,0,1,1", "0,0,0,0,1", "1,6,0,0,1",
        "1,0,2,0,1", "1,0,0,1001,1", "1.5,0,0,0,1", "1,0,0,0,x", "1e16,0,0,0,1", "1,0,0,0,inf"}) {
    request.set_page_token(token);
    EXPECT_EQ(CodeOf(book.List(request)), ErrorCode::kCellBadPageToken) << token;
  }
  request.clear_page_token();
  request.set_page_size(-1);
  EXPECT_EQ(CodeOf(book.List(request)), ErrorCode::kCellInvalidArgument);
  request.set_page_size(0);
  request.set_filter("kind = CHECK");
  EXPECT_EQ(Must(book.List(request)).jobs_size(), 0);
  request.set_filter("state = queued AND machine = machines/optimo-1 AND caller = tester");
  EXPECT_EQ(Must(book.List(request)).jobs_size(), 7);
  request.set_filter("nothing");
  EXPECT_EQ(CodeOf(book.List(request)), ErrorCode::kCellBadFilter);
}

// Issue "Watch": a snapshot first; with the events after its sequence nothing is missing.
TEST_F(JobBookTest, ASnapshotAndTheEventsAfterItAreComplete) {
  Must(Submit(Simulate()));
  std::atomic<bool> stop = false;
  std::jthread client([&] {
    while (!stop)
      Must(bed.store().SubmitAndWait(
          {.machine = "optimo-1", .kind = "CHECK", .events = {{.kind = "state"}}}));
  });
  for (int round = 0; round < 20; ++round) {
    const std::int64_t position = Must(bed.store().LastPosition());
    std::set<std::int64_t> known;
    for (const v1::Job& job : Must(book.Newest({}))) known.insert(Number(job));
    for (const auto& event : Must(bed.store().AllEvents(position, 10'000))) known.insert(event.job);
    const std::int64_t newest = *known.rbegin();
    // Unfinished jobs beyond the snapshot's size are the older ones.
    for (std::int64_t id = std::max<std::int64_t>(1, newest - 100); id <= newest; ++id) {
      EXPECT_TRUE(known.contains(id)) << id;
    }
  }
  stop = true;
}

TEST_F(JobBookTest, ASnapshotHasWhatIsUnfinishedFirst) {
  const std::int64_t running = Number(Must(Submit(Simulate())));
  Must(bed.store().Acquire("w", {"SIMULATE"}, std::chrono::hours(1), {}));
  for (int i = 0; i < 210; ++i) {
    Must(Submit(Simulate()));
    const auto leased = Must(bed.store().Acquire("w", {"SIMULATE"}, std::chrono::hours(1), {}));
    Must(bed.store().Finish(leased->lease, {.outcome = {.state = JobState::kSucceeded}}));
  }
  const std::vector<v1::Job> newest = Must(book.Newest({}));
  EXPECT_EQ(newest.size(), 200U);
  EXPECT_EQ(Number(newest.back()), running);
  for (std::size_t i = 1; i < newest.size(); ++i)
    EXPECT_GT(Number(newest[i - 1]), Number(newest[i]));
}

TEST_F(JobBookTest, AProductThatIsNotThereSaysWhy) {
  const std::int64_t job = Number(Must(Submit(Simulate())));
  EXPECT_EQ(CodeOf(book.ReadArtifact(job, "report")), ErrorCode::kCellPrecondition);  // not yet
  const auto leased = Must(bed.store().Acquire("w", {"SIMULATE"}, std::chrono::hours(1), {}));
  Must(bed.store().Finish(
      leased->lease,
      {.outcome = {.state = JobState::kSucceeded},
       .artifacts = {{.name = "report", .media_type = "m", .bytes = "the report"}}}));
  EXPECT_EQ(Must(book.ReadArtifact(job, "report")), "the report");
  EXPECT_EQ(CodeOf(book.ReadArtifact(job, "trace")), ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(book.ReadArtifact(job + 1, "report")), ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(book.Get(JobName(job + 1))), ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(book.Get("jobs/x")), ErrorCode::kCellInvalidArgument);
}

// LIVE-5.10: what is decided of a job that was cut off, and why.
TEST_F(JobBookTest, ADecisionSaysWhatAndWhy) {
  using Request = v1::DecideInterruptedRequest;
  v1::SubmitJobRequest submitted = Simulate();
  submitted.mutable_job()->set_kind(v1::JOB_KIND_RUN);
  const v1::Job job = Must(Submit(submitted));
  Request request;
  request.set_name(job.name());
  request.set_reason("it burnt");
  const auto refused = [&] { return CodeOf(book.MachineToDecide(request)); };
  EXPECT_EQ(refused(), ErrorCode::kCellInvalidArgument);  // nothing is decided
  request.set_decision(Request::DECISION_RESTART);
  EXPECT_EQ(refused(), ErrorCode::kCellPrecondition);  // it was not cut off
  Must(bed.store().Finish(bed.Lease("RUN"), {.outcome = {.state = JobState::kInterrupted}}));
  EXPECT_EQ(Must(book.MachineToDecide(request)), "optimo-1");
  request.set_decision(Request::DECISION_ABANDON);
  EXPECT_EQ(Must(book.MachineToDecide(request)), "optimo-1");
  request.set_decision(Request::DECISION_RESUME_AT_STEP);
  EXPECT_EQ(refused(), ErrorCode::kCellInvalidArgument);  // no preview says where
  request.set_preview_token("a token");
  request.set_reason(std::string(200, 'x'));
  EXPECT_EQ(Must(book.MachineToDecide(request)), "optimo-1");
  for (const std::size_t size : {0U, 201U}) {
    request.set_reason(std::string(size, 'x'));
    EXPECT_EQ(refused(), ErrorCode::kCellInvalidArgument) << size;
  }
  std::string umlauts;
  for (int i = 0; i < 200; ++i) umlauts += "ü";
  request.set_reason(umlauts);
  EXPECT_EQ(Must(book.MachineToDecide(request)), "optimo-1");
  request.set_reason("it burnt");
  request.set_name("7");
  EXPECT_EQ(refused(), ErrorCode::kCellInvalidArgument);
  request.set_name("jobs/99");
  EXPECT_EQ(refused(), ErrorCode::kCellNotFound);
}

// LIVE-5.10: the same job once more, under another number; where it goes on a preview has said.
TEST_F(JobBookTest, AJobIsHandedInAgain) {
  v1::SubmitJobRequest request = Simulate("DELAY 1\nDELAY 2\n");
  v1::Job& asked = *request.mutable_job();
  asked.set_kind(v1::JOB_KIND_RUN);
  asked.set_title("lid");
  asked.add_labels("order-1");
  asked.set_priority(3);
  asked.set_inline_slot(7);
  asked.mutable_run()->mutable_step()->set_step(2);
  asked.mutable_run()->set_occurrence(1);
  asked.mutable_run()->add_confirmations(v1::CONFIRMATION_TOOL);
  asked.mutable_run()->set_on_loss(v1::ControlLease::ON_LOSS_GO_ON);
  const v1::Job first = Must(Submit(request));
  const auto again = [&](const std::string& name, const std::string& id, bool continues) {
    std::promise<Result<v1::Job>> answer;
    book.Again(name, "bert", id, continues,
               [&](Result<v1::Job> job) { answer.set_value(std::move(job)); });
    return answer.get_future().get();
  };
  const v1::Job anew = Must(again(first.name(), "r", false));
  EXPECT_NE(anew.name(), first.name());
  EXPECT_EQ(anew.caller(), "bert");
  EXPECT_EQ(anew.kind(), v1::JOB_KIND_RUN);
  EXPECT_EQ(anew.machine(), "machines/optimo-1");
  EXPECT_EQ(anew.title(), "lid");
  EXPECT_THAT(anew.labels(), testing::ElementsAre("order-1"));
  EXPECT_EQ(anew.priority(), 3);
  EXPECT_EQ(anew.inline_slot(), 7);
  EXPECT_EQ(anew.inline_program().file_name(), "part.S");
  EXPECT_EQ(anew.continues(), "");
  EXPECT_EQ(anew.run().SerializeAsString(), asked.run().SerializeAsString());
  EXPECT_EQ(Must(bed.store().ReadArtifact(Number(anew), kMainAttachment)), "DELAY 1\nDELAY 2\n");
  EXPECT_EQ(Must(again(first.name(), "r", false)).name(), anew.name());
  const v1::Job continued = Must(again(first.name(), "s", true));
  EXPECT_EQ(continued.continues(), first.name());
  EXPECT_FALSE(continued.run().has_step());
  EXPECT_EQ(continued.run().confirmations_size(), 0);
  EXPECT_EQ(continued.run().occurrence(), 0);
  EXPECT_EQ(continued.run().on_loss(), v1::ControlLease::ON_LOSS_GO_ON);
  EXPECT_EQ(CodeOf(again("7", "t", false)), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(again("jobs/99", "t", false)), ErrorCode::kCellNotFound);
}

TEST_F(JobBookTest, JobsAreCountedByTheirState) {
  for (int i = 0; i < 3; ++i) Must(Submit(Simulate()));
  const auto leased = Must(bed.store().Acquire("w", {"SIMULATE"}, std::chrono::hours(1), {}));
  Must(bed.store().Finish(leased->lease, {.outcome = {.state = JobState::kFailed}}));
  const auto counted = [&](const storage::JobQuery& query) {
    std::vector<std::string> told;
    for (const v1::JobCount& count : Must(book.Count(query)))
      told.push_back(v1::Job::State_Name(count.state()) + " " + std::to_string(count.jobs()));
    return told;
  };
  using testing::UnorderedElementsAre;
  EXPECT_THAT(counted({}), UnorderedElementsAre("STATE_QUEUED 2", "STATE_FAILED 1"));
  EXPECT_THAT(counted({.state = JobState::kQueued}), UnorderedElementsAre("STATE_QUEUED 2"));
  EXPECT_THAT(counted({.state = JobState::kFailed}), UnorderedElementsAre("STATE_FAILED 1"));
  EXPECT_THAT(counted({.finished = true}), UnorderedElementsAre("STATE_FAILED 1"));
  EXPECT_THAT(counted({.finished = false}), UnorderedElementsAre("STATE_QUEUED 2"));
}

// job_book.h CheckLog: a number of another log says nothing here; who has seen none begins anew.
TEST_F(JobBookTest, ANumberIsOfItsLog) {
  const std::int64_t job = Number(Must(Submit(Simulate())));
  const std::string log = bed.store().LogId();
  EXPECT_FALSE(CodeOf(book.CheckLog(job, 1, log)));
  EXPECT_FALSE(CodeOf(book.CheckLog(job, 1, "")));
  EXPECT_FALSE(CodeOf(book.CheckLog(job, 0, "another log")));
  EXPECT_EQ(CodeOf(book.CheckLog(job, 1, "another log")), ErrorCode::kCellInvalidArgument);
}

TEST_F(JobBookTest, AProductThatIsOpenedIsThere) {
  const std::int64_t job = Number(Must(Submit(Simulate())));
  EXPECT_EQ(CodeOf(book.OpenArtifact(job, "report")), ErrorCode::kCellPrecondition);
  const auto leased = Must(bed.store().Acquire("w", {"SIMULATE"}, std::chrono::hours(1), {}));
  Must(bed.store().Finish(leased->lease, {.outcome = {.state = JobState::kSucceeded},
                                          .artifacts = {{.name = "report", .bytes = "r"}}}));
  EXPECT_EQ(Must(Must(book.OpenArtifact(job, "report"))->Next()), "r");
  EXPECT_EQ(CodeOf(book.OpenArtifact(job, "trace")), ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(book.OpenArtifact(job + 1, "report")), ErrorCode::kCellNotFound);
}

}  // namespace
}  // namespace rmlcell::server
