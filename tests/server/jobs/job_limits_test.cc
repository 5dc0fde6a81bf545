// The bounds of a submission and of lists, each on both sides; values from
// proto/rmlcell/v1/job.proto.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <future>
#include <limits>

#include "rmlcell/v1/project.pb.h"
#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/job_book.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using storage::JobState;
constexpr auto kInvalid = ErrorCode::kCellInvalidArgument;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

class JobLimits : public testing::Test {
 protected:
  static v1::SubmitJobRequest Simulate() {
    v1::SubmitJobRequest request;
    request.mutable_job()->set_kind(v1::JOB_KIND_SIMULATE);
    request.mutable_job()->set_machine("machines/optimo-1");
    request.mutable_job()->mutable_inline_program()->set_file_name("part.S");
    request.mutable_job()->mutable_inline_program()->set_content("STOP\n");
    return request;
  }
  Result<v1::Job> Submit(const v1::SubmitJobRequest& request) {
    std::promise<Result<v1::Job>> answer;
    book.Submit(request, "tester", [&](Result<v1::Job> job) { answer.set_value(std::move(job)); });
    return answer.get_future().get();
  }
  // What the server says to a job with this change, asked only.
  std::optional<ErrorCode> Asked(const std::function<void(v1::Job&)>& change) {
    v1::SubmitJobRequest request = Simulate();
    change(*request.mutable_job());
    request.set_validate_only(true);
    return CodeOf(Submit(request));
  }
  storage::JobRecord Record(const v1::Job& job) {
    return Must(bed.store().GetJob(Must(ParseJobName(job.name()))));
  }
  // So many jobs without a program, in few commits.
  void Fill(int count) {
    std::atomic<int> done = 0;
    for (int i = 0; i < count; ++i) {
      bed.store().Submit({.machine = "optimo-1", .kind = "CHECK"},
                         [&done](const Result<storage::SubmittedJob>&) { ++done; });
    }
    ASSERT_TRUE(Eventually([&] { return done == count; }));
  }
  v1::ListJobsResponse Page(int size, const std::string& token = "") {
    v1::ListJobsRequest request;
    request.set_page_size(size);
    request.set_page_token(token);
    return Must(book.List(request));
  }

  ServerBed bed;
  Config config;
  JobBook book{bed.store(), config};
};

// ListJobsRequest.page_size: 0 is 50, at most 1000, below 0 is refused.
TEST_F(JobLimits, PagesHaveFiftyJobsOrSoManyAsWantedUpToAThousand) {
  Fill(1002);
  EXPECT_EQ(Page(0).jobs_size(), 50);
  EXPECT_EQ(Page(0).next_page_token(), "953,0,0,0,953");
  EXPECT_EQ(Page(1).jobs_size(), 1);
  EXPECT_EQ(Page(1).jobs(0).name(), "jobs/1002");
  EXPECT_EQ(Page(999).jobs_size(), 999);
  for (const int size : {1000, 1001, std::numeric_limits<int>::max()}) {
    const v1::ListJobsResponse page = Page(size);
    EXPECT_EQ(page.jobs_size(), 1000) << size;
    const v1::ListJobsResponse rest = Page(size, page.next_page_token());
    ASSERT_EQ(rest.jobs_size(), 2) << size;
    EXPECT_EQ(rest.jobs(0).name(), "jobs/2");
    EXPECT_EQ(rest.jobs(1).name(), "jobs/1");
    EXPECT_EQ(rest.next_page_token(), "");
  }
  for (const int size : {-1, std::numeric_limits<int>::min()}) {
    v1::ListJobsRequest request;
    request.set_page_size(size);
    EXPECT_EQ(CodeOf(book.List(request)), kInvalid) << size;
  }
}

// A page goes on behind the last job of the page before, whatever was submitted meanwhile.
TEST_F(JobLimits, PagesHaveEachJobOnce) {
  Fill(5);
  std::vector<std::string> names;
  std::string token;
  do {
    const v1::ListJobsResponse page = Page(2, token);
    for (const v1::Job& job : page.jobs()) names.push_back(job.name());
    token = page.next_page_token();
    Fill(1);
  } while (!token.empty());
  EXPECT_THAT(names, testing::ElementsAre("jobs/5", "jobs/4", "jobs/3", "jobs/2", "jobs/1"));
  EXPECT_EQ(Page(2, "1,0,0,0,1").jobs_size(), 0);
  EXPECT_EQ(Page(2, "1000000000000000,0,0,0,1").jobs_size(), 2);
}

TEST_F(JobLimits, OfTextsAndAttempts) {
  v1::SubmitJobRequest request = Simulate();
  request.set_request_id(std::string(64, 'r'));
  request.mutable_job()->set_title(std::string(200, 't'));
  request.mutable_job()->set_attempts_max(10);
  const storage::JobRecord record = Record(Must(Submit(request)));
  EXPECT_EQ(record.request_id, std::string(64, 'r'));
  EXPECT_EQ(record.title, std::string(200, 't'));
  EXPECT_EQ(record.attempts_max, 10);
  for (const int attempts : {0, 1, 10}) {
    EXPECT_EQ(Asked([&](v1::Job& job) { job.set_attempts_max(attempts); }), std::nullopt);
  }
  request.set_request_id(std::string(65, 'r'));
  EXPECT_EQ(CodeOf(Submit(request)), kInvalid);
  // Characters count, not bytes.
  std::string umlauts;
  for (int i = 0; i < 200; ++i) umlauts += "\xC3\xA4";
  EXPECT_EQ(Asked([&](v1::Job& job) { job.set_title(umlauts); }), std::nullopt);
  EXPECT_EQ(Asked([&](v1::Job& job) { job.set_title(umlauts + "a"); }), kInvalid);
  // Without a wish that of the configuration.
  config.jobs_attempts = 3;
  v1::SubmitJobRequest plain = Simulate();
  EXPECT_EQ(Record(Must(Submit(plain))).attempts_max, 3);
  plain.mutable_job()->set_attempts_max(1);
  EXPECT_EQ(Record(Must(Submit(plain))).attempts_max, 1);
}

TEST_F(JobLimits, OfBudgets) {
  const auto asked = [&](const std::function<void(v1::Budget&)>& change) {
    return Asked([&](v1::Job& job) { change(*job.mutable_budget()); });
  };
  for (const std::int64_t wanted : {0, 1}) {
    EXPECT_EQ(asked([&](v1::Budget& budget) {
                budget.set_steps(wanted);
                budget.set_memory_bytes(wanted);
                budget.set_output_bytes(wanted);
                budget.set_virtual_time_ns(wanted);
                budget.set_processor_ns(wanted);
              }),
              std::nullopt);
  }
  EXPECT_EQ(asked([](v1::Budget& budget) { budget.set_steps(-1); }), kInvalid);
  EXPECT_EQ(asked([](v1::Budget& budget) { budget.set_memory_bytes(-1); }), kInvalid);
  EXPECT_EQ(asked([](v1::Budget& budget) { budget.set_output_bytes(-1); }), kInvalid);
  EXPECT_EQ(asked([](v1::Budget& budget) { budget.set_virtual_time_ns(-1); }), kInvalid);
  EXPECT_EQ(asked([](v1::Budget& budget) { budget.set_processor_ns(-1); }), kInvalid);
}

TEST_F(JobLimits, OfSimulations) {
  const auto asked = [&](const std::function<void(v1::SimulationOptions&)>& change) {
    return Asked([&](v1::Job& job) { change(*job.mutable_simulation()); });
  };
  using Options = v1::SimulationOptions;
  struct Range {
    const char* what;
    std::function<void(Options&, double)> set;
    double max;
    double above;
  };
  const std::vector<Range> ranges = {
      {"override", [](Options& o, double v) { o.set_override_percent(v); }, 145.0, 145.001},
      {"tolerance", [](Options& o, double v) { o.set_toolpath_tolerance_mm(v); }, 100.0, 100.001},
      {"pace", [](Options& o, double v) { o.set_pace(v); }, 1000.0, 1000.001}};
  for (const Range& range : ranges) {
    for (const double good : {0.0, 0.001, range.max}) {
      EXPECT_EQ(asked([&](Options& o) { range.set(o, good); }), std::nullopt) << range.what << good;
    }
    for (const double bad : {-0.001, range.above, std::nan(""), kInfinite}) {
      EXPECT_EQ(asked([&](Options& o) { range.set(o, bad); }), kInvalid) << range.what << bad;
    }
  }
  for (const auto mode :
       {v1::OPERATING_MODE_UNSPECIFIED, v1::OPERATING_MODE_REMOTE, v1::OPERATING_MODE_CYCLE,
        v1::OPERATING_MODE_SINGLE, v1::OPERATING_MODE_REPEAT}) {
    EXPECT_EQ(asked([&](Options& o) { o.set_mode(mode); }), std::nullopt) << mode;
  }
  EXPECT_EQ(asked([](Options& o) { o.set_mode(static_cast<v1::OperatingMode>(99)); }), kInvalid);
}

TEST_F(JobLimits, OfPlacesWhereARunHalts) {
  const auto asked = [&](bool simul, int program, int step) {
    return Asked([&](v1::Job& job) {
      v1::SimulationOptions& options = *job.mutable_simulation();
      v1::StepPlace& place =
          simul ? *options.mutable_simul() : *options.add_breakpoints()->mutable_step();
      place.set_program(program);
      place.set_step(step);
    });
  };
  for (const bool simul : {false, true}) {
    for (const int program : {0, 1, 99}) EXPECT_EQ(asked(simul, program, 1), std::nullopt);
    for (const int program : {-1, 100}) {
      EXPECT_EQ(asked(simul, program, 1), ErrorCode::kProgramNumber) << program;
    }
    for (const int step : {0, -1}) EXPECT_EQ(asked(simul, 1, step), kInvalid) << step;
  }
}

// What the contract has and this version does not do is said, not left out in silence.
TEST_F(JobLimits, OfWhatComesLater) {
  constexpr ErrorCode kLater = ErrorCode::kCellUnimplemented;
  const auto run = [&](const std::function<void(v1::RunOptions&)>& change) {
    return Asked([&](v1::Job& job) {
      job.clear_simulation();
      job.set_kind(v1::JOB_KIND_RUN);
      change(*job.mutable_run());
    });
  };
  EXPECT_EQ(run([](v1::RunOptions&) {}), std::nullopt);
  EXPECT_EQ(run([](v1::RunOptions& how) { how.set_ticket("t"); }), kInvalid);
  // LIVE-5.01: it is attempted once, whether that is said or not.
  for (const int attempts : {1, 2}) {
    EXPECT_EQ(Asked([attempts](v1::Job& job) {
                job.clear_simulation();
                job.set_kind(v1::JOB_KIND_RUN);
                job.set_attempts_max(attempts);
              }),
              attempts == 1 ? std::nullopt : std::optional(kInvalid));
  }
  EXPECT_EQ(run([](v1::RunOptions& how) { how.set_ticket("jobs/99"); }), ErrorCode::kCellNotFound);
  // LIVE-6.03: where it begins at a step, and only there, somebody has seen to something.
  const auto at = [&](int program, int step, const std::function<void(v1::RunOptions&)>& change) {
    return run([&](v1::RunOptions& how) {
      how.mutable_step()->set_program(program);
      how.mutable_step()->set_step(step);
      change(how);
    });
  };
  const auto nothing = [](v1::RunOptions&) {};
  for (const int program : {0, 1, 99}) EXPECT_EQ(at(program, 1, nothing), std::nullopt);
  for (const int program : {-1, 100}) EXPECT_EQ(at(program, 1, nothing), kInvalid);
  for (const int step : {0, -1}) EXPECT_EQ(at(1, step, nothing), kInvalid);
  const auto seen = [](v1::RunOptions& how) { how.add_confirmations(v1::CONFIRMATION_TOOL); };
  EXPECT_EQ(at(1, 1, seen), std::nullopt);
  EXPECT_EQ(run(seen), kInvalid);
  const auto seen_so_often = [&](int count) {
    return at(1, 1, [count](v1::RunOptions& how) {
      for (int i = 0; i < count; ++i) how.add_confirmations(v1::CONFIRMATION_TOOL);
    });
  };
  EXPECT_EQ(seen_so_often(16), std::nullopt);
  EXPECT_EQ(seen_so_often(17), kInvalid);
  EXPECT_EQ(at(1, 1, [](v1::RunOptions& how) { how.set_unzeroed(true); }), kInvalid);
  // LIVE-6.01, LIVE-6.04: in which pass, and without the beam up to the next WORK.
  const auto pass = [](v1::RunOptions& how) { how.set_occurrence(3); };
  const auto dark = [](v1::RunOptions& how) { how.set_off_until_work_on(true); };
  EXPECT_EQ(at(1, 1, pass), std::nullopt);
  EXPECT_EQ(at(1, 1, dark), std::nullopt);
  EXPECT_EQ(run(pass), kInvalid);
  EXPECT_EQ(run(dark), kInvalid);
  EXPECT_EQ(at(1, 1, [](v1::RunOptions& how) { how.set_occurrence(-1); }), kInvalid);
  EXPECT_EQ(Asked([](v1::Job& job) { job.set_continues("jobs/1"); }), kLater);
}

TEST_F(JobLimits, OfBreakpoints) {
  const auto breakpoint = [&](const std::function<void(v1::Breakpoint&)>& change) {
    return Asked([&](v1::Job& job) {
      v1::Breakpoint& one = *job.mutable_simulation()->add_breakpoints();
      one.mutable_step()->set_step(1);
      change(one);
    });
  };
  EXPECT_EQ(breakpoint([](v1::Breakpoint&) {}), std::nullopt);
  EXPECT_EQ(breakpoint([](v1::Breakpoint& one) { one.set_condition("VI[1] > 2"); }), std::nullopt);
  EXPECT_EQ(breakpoint([](v1::Breakpoint& one) { one.set_condition("VI[1] >"); }), kInvalid);
  EXPECT_EQ(breakpoint([](v1::Breakpoint& one) { one.set_passes(1'000'000); }), std::nullopt);
  EXPECT_EQ(breakpoint([](v1::Breakpoint& one) { one.set_passes(-1); }), kInvalid);
  const auto many = [&](int count) {
    return Asked([&](v1::Job& job) {
      for (int i = 0; i < count; ++i)
        job.mutable_simulation()->add_breakpoints()->mutable_step()->set_step(1);
    });
  };
  EXPECT_EQ(many(1000), std::nullopt);
  EXPECT_EQ(many(1001), kInvalid);
}

TEST_F(JobLimits, OfThePlaceInTheQueue) {
  for (const int priority : {-100, 0, 100})
    EXPECT_EQ(Asked([&](v1::Job& job) { job.set_priority(priority); }), std::nullopt);
  for (const int priority : {-101, 101})
    EXPECT_EQ(Asked([&](v1::Job& job) { job.set_priority(priority); }), kInvalid);
  const auto at = [&](std::int64_t seconds, int nanos) {
    return Asked([&](v1::Job& job) {
      job.mutable_not_before_time()->set_seconds(seconds);
      job.mutable_not_before_time()->set_nanos(nanos);
    });
  };
  EXPECT_EQ(at(0, 0), std::nullopt);
  EXPECT_EQ(at(253'402'300'799, 999'999'999), std::nullopt);
  EXPECT_EQ(at(-62'135'596'800, 0), std::nullopt);
  EXPECT_EQ(at(253'402'300'800, 0), kInvalid);
  EXPECT_EQ(at(-62'135'596'801, 0), kInvalid);
  EXPECT_EQ(at(0, 1'000'000'000), kInvalid);
  EXPECT_EQ(at(0, -1), kInvalid);
  Fill(1);
  const auto after = [&](int count) {
    return Asked([&](v1::Job& job) {
      for (int i = 0; i < count; ++i) job.add_after_jobs("jobs/1");
    });
  };
  EXPECT_EQ(after(100), std::nullopt);
  EXPECT_EQ(after(101), kInvalid);
  EXPECT_EQ(Asked([](v1::Job& job) { job.add_after_jobs("machines/mill-1"); }), kInvalid);
}

TEST_F(JobLimits, OfFileNames) {
  const auto named = [&](std::size_t size) {
    return Asked([&](v1::Job& job) {
      job.mutable_inline_program()->set_file_name(std::string(size - 2, 'x') + ".S");
    });
  };
  EXPECT_EQ(named(255), std::nullopt);
  EXPECT_EQ(named(256), kInvalid);
}

TEST_F(JobLimits, OfLabels) {
  const auto labelled = [&](const std::vector<std::string>& labels) {
    return Asked([&](v1::Job& job) { *job.mutable_labels() = {labels.begin(), labels.end()}; });
  };
  EXPECT_EQ(labelled({"order-4711", "A_b.9:/", std::string(63, 'x')}), std::nullopt);
  for (const std::string& none : {std::string(), std::string("a b"), std::string("a=b"),
                                  std::string("\xc3\xa4"), std::string(64, 'x')})
    EXPECT_EQ(labelled({none}), kInvalid) << none;
  EXPECT_EQ(labelled({"a", "b", "a"}), kInvalid);
  std::vector<std::string> many;
  for (int i = 0; i < 16; ++i) many.push_back(std::to_string(i));
  EXPECT_EQ(labelled(many), std::nullopt);
  many.push_back("16");
  EXPECT_EQ(labelled(many), kInvalid);
}

TEST_F(JobLimits, OfInputsOverTime) {
  const auto asked = [&](std::int64_t at_ns, const std::string& name) {
    return Asked([&](v1::Job& job) {
      v1::ScriptedInput& input = *job.mutable_simulation()->add_inputs();
      input.set_virtual_time_ns(at_ns);
      v1::Variable& variable = *input.mutable_input()->mutable_from_outside()->mutable_input();
      variable.set_name(name);
      variable.mutable_value()->set_logical(true);
    });
  };
  for (const char* name : {"IL[0]", "IL[1]", "IL[99]"}) EXPECT_EQ(asked(0, name), std::nullopt);
  for (const char* name : {"IL[-1]", "IL[100]"}) EXPECT_EQ(asked(0, name), kInvalid) << name;
  EXPECT_EQ(asked(-1, "IL[1]"), kInvalid);
  EXPECT_EQ(Asked([](v1::Job& job) { job.mutable_simulation()->add_inputs(); }), kInvalid);
}

// Job.inline_slot: 1 to 99, 0 is 1. SlotProgram.slot: 1 to 99, no slot twice, nor that of the
// inline program.
TEST_F(JobLimits, OfSlots) {
  const auto asked = [&](int inline_slot, const std::vector<int>& further) {
    return Asked([&](v1::Job& job) {
      job.set_inline_slot(inline_slot);
      for (const int slot : further) {
        v1::SlotProgram& program = *job.mutable_simulation()->add_programs();
        program.set_slot(slot);
        program.mutable_program()->set_content("STOP\n");
      }
    });
  };
  for (const int slot : {0, 1, 99}) EXPECT_EQ(asked(slot, {}), std::nullopt) << slot;
  for (const int slot : {-1, 100}) EXPECT_EQ(asked(slot, {}), ErrorCode::kProgramNumber) << slot;
  EXPECT_EQ(asked(0, {2, 99}), std::nullopt);
  EXPECT_EQ(asked(5, {1, 4}), std::nullopt);
  EXPECT_EQ(asked(0, {1}), kInvalid);
  EXPECT_EQ(asked(5, {5}), kInvalid);
  EXPECT_EQ(asked(0, {4, 4}), kInvalid);
  for (const int slot : {-1, 0, 100})
    EXPECT_EQ(asked(0, {slot}), ErrorCode::kProgramNumber) << slot;
}

// milling.proto: each message says which field is wrong.
TEST_F(JobLimits, OfMillings) {
  const auto asked = [&](const std::string& machine,
                         const std::function<void(v1::Milling&)>& change) -> std::string {
    v1::SubmitJobRequest request = Simulate();
    request.mutable_job()->set_machine(machine);
    request.mutable_job()->mutable_inline_program()->set_file_name("part");
    request.mutable_job()->mutable_inline_program()->set_content("PA;");
    v1::Milling& milling = *request.mutable_job()->mutable_simulation()->mutable_milling();
    milling.mutable_stock()->set_size_x_mm(60.0);
    milling.mutable_stock()->set_size_y_mm(30.0);
    milling.mutable_stock()->set_size_z_mm(5.0);
    milling.mutable_tool()->set_shape(v1::MillTool::SHAPE_FLAT);
    milling.mutable_tool()->set_diameter_mm(3.0);
    change(milling);
    request.set_validate_only(true);
    const Result<v1::Job> job = Submit(request);
    if (job) return std::string();
    EXPECT_EQ(job.error().code, kInvalid);
    return job.error().detail;
  };
  using testing::StartsWith;
  const std::string mill = "machines/mill-1";
  EXPECT_EQ(asked(mill, [](v1::Milling&) {}), "");
  EXPECT_THAT(asked("machines/optimo-1", [](v1::Milling&) {}),
              StartsWith("job.simulation.milling is for mills"));
  EXPECT_THAT(asked(mill, [](v1::Milling& m) { m.mutable_tool()->set_diameter_mm(0.0); }),
              StartsWith("job.simulation.milling.tool: the radius"));
  EXPECT_THAT(asked(mill, [](v1::Milling& m) { m.clear_stock(); }),
              StartsWith("job.simulation.milling.stock is missing"));
  // 6000 by 3000 cells of 0.01 mm are 18 million; of 0.005 mm 72 million, more than 67,108,864.
  EXPECT_EQ(asked(mill, [](v1::Milling& m) { m.set_cell_mm(0.01); }), "");
  EXPECT_THAT(asked(mill, [](v1::Milling& m) { m.set_cell_mm(0.005); }),
              testing::AllOf(StartsWith("job.simulation.milling.stock: "),
                             testing::HasSubstr("make the cells larger")));
}

// SimulationOptions.milling_project: block and tool of the program of the same slot, as they are
// now; those of the job itself come first.
TEST_F(JobLimits, AProjectHasBlockAndToolOfItsPrograms) {
  v1::Project project;
  for (const int slot : {7, 8}) {
    v1::ProjectProgram& program = *project.add_programs();
    program.set_slot(slot);
    if (slot == 8) continue;
    v1::Milling& milling = *program.mutable_milling();
    milling.mutable_stock()->set_size_x_mm(60.0);
    milling.mutable_stock()->set_size_y_mm(30.0);
    milling.mutable_stock()->set_size_z_mm(5.0);
    milling.mutable_tool()->set_shape(v1::MillTool::SHAPE_BALL);
    milling.mutable_tool()->set_diameter_mm(3.0);
    milling.set_relief(true);
  }
  Must(bed.store().PutProject({.id = "coaster", .body = project.SerializeAsString()}, 0));
  v1::SubmitJobRequest request = Simulate();
  v1::Job& job = *request.mutable_job();
  job.set_machine("machines/mill-1");
  job.mutable_inline_program()->set_file_name("part");
  job.mutable_inline_program()->set_content("PA;");
  job.set_inline_slot(7);
  job.mutable_simulation()->set_milling_project("projects/coaster");
  const v1::Job made = Must(book.Get(Must(Submit(request)).name()));
  EXPECT_EQ(made.simulation().milling().SerializeAsString(),
            project.programs(0).milling().SerializeAsString());
  job.set_inline_slot(8);  // its program has none
  EXPECT_EQ(CodeOf(Submit(request)), ErrorCode::kCellNotFound);
  job.set_inline_slot(9);  // there is no such program
  EXPECT_EQ(CodeOf(Submit(request)), ErrorCode::kCellNotFound);
  *job.mutable_simulation()->mutable_milling() = project.programs(0).milling();
  job.mutable_simulation()->mutable_milling()->set_cell_mm(0.5);
  EXPECT_EQ(Must(book.Get(Must(Submit(request)).name())).simulation().milling().cell_mm(), 0.5);
  job.mutable_simulation()->clear_milling();
  job.set_inline_slot(7);
  for (const auto& [name, code] :
       {std::pair("projects/other", ErrorCode::kCellNotFound), std::pair("coaster", kInvalid)}) {
    job.mutable_simulation()->set_milling_project(name);
    EXPECT_EQ(CodeOf(Submit(request)), code) << name;
  }
  job.set_machine("machines/optimo-1");
  job.mutable_simulation()->set_milling_project("projects/coaster");
  EXPECT_EQ(CodeOf(Submit(request)), kInvalid);  // removes no material
}

// limits.program_bytes for the program and for each further one.
TEST_F(JobLimits, OfProgramBytes) {
  config.limit_program_bytes = 100;
  const auto asked = [&](std::size_t main, std::size_t further) {
    return Asked([&](v1::Job& job) {
      job.mutable_inline_program()->set_content(std::string(main, ';'));
      v1::SlotProgram& program = *job.mutable_simulation()->add_programs();
      program.set_slot(4);
      program.mutable_program()->set_content(std::string(further, ';'));
    });
  };
  EXPECT_EQ(asked(100, 100), std::nullopt);
  EXPECT_EQ(asked(101, 1), ErrorCode::kCellTooLarge);
  EXPECT_EQ(asked(1, 101), ErrorCode::kCellTooLarge);
  EXPECT_EQ(asked(0, 1), ErrorCode::kCellEmptyProgram);
  EXPECT_EQ(asked(1, 0), ErrorCode::kCellEmptyProgram);
}

// What is kept of a job: its wishes as they were, its bytes once, beside them.
TEST_F(JobLimits, ASubmissionIsKeptAsItWas) {
  v1::SubmitJobRequest request = Simulate();
  EXPECT_FALSE(Must(book.Get(Must(Submit(request)).name())).has_simulation());
  v1::Job& wanted = *request.mutable_job();
  wanted.set_inline_slot(7);
  wanted.mutable_budget()->set_steps(55);
  v1::SlotProgram& further = *wanted.mutable_simulation()->add_programs();
  further.set_slot(8);
  further.mutable_program()->set_file_name("8.S");
  further.mutable_program()->set_content("RESUME\n");
  const v1::Job job = Must(book.Get(Must(Submit(request)).name()));
  EXPECT_EQ(job.kind(), v1::JOB_KIND_SIMULATE);
  EXPECT_EQ(job.inline_slot(), 7);
  EXPECT_EQ(job.budget().steps(), 55);
  EXPECT_EQ(job.inline_program().file_name(), "part.S");
  EXPECT_EQ(job.inline_program().content(), "");
  ASSERT_EQ(job.simulation().programs_size(), 1);
  EXPECT_EQ(job.simulation().programs(0).slot(), 8);
  EXPECT_EQ(job.simulation().programs(0).program().content(), "");
  ASSERT_EQ(job.artifacts_size(), 2);
  const std::int64_t id = Must(ParseJobName(job.name()));
  EXPECT_EQ(Must(book.ReadArtifact(id, kMainAttachment)), "STOP\n");
  EXPECT_EQ(Must(book.ReadArtifact(id, AttachmentName(8))), "RESUME\n");
  EXPECT_EQ(Must(book.FindArtifact(id, AttachmentName(8))).media_type, "application/octet-stream");
  const auto events = Must(bed.store().JobEvents(id, 0, 10));
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].kind, "state");
}

// SubmitJobRequest.validate_only: the answer has no name, whatever the client wrote there.
TEST_F(JobLimits, AskingOnlyNamesNothing) {
  v1::SubmitJobRequest request = Simulate();
  request.mutable_job()->set_name("jobs/5");
  request.set_validate_only(true);
  const v1::Job job = Must(Submit(request));
  EXPECT_EQ(job.name(), "");
  EXPECT_EQ(job.inline_program().file_name(), "part.S");
}

// A stored program by its name: the bytes at the time of submission.
TEST_F(JobLimits, AStoredProgramIsAttached) {
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 45, .object = "object 45"}}, {}));
  v1::SubmitJobRequest request = Simulate();
  request.mutable_job()->set_program("machines/optimo-1/programs/45");
  const std::int64_t id = Must(ParseJobName(Must(Submit(request)).name()));
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 45, .object = "another"}}, {}));
  EXPECT_EQ(Must(book.ReadArtifact(id, kMainAttachment)), "object 45");
  EXPECT_EQ(Asked([](v1::Job& job) { job.set_program("machines/optimo-1/programs/x"); }), kInvalid);
  EXPECT_EQ(Asked([](v1::Job& job) { job.set_program("machines/optimo-1/programs/100"); }),
            ErrorCode::kProgramNumber);
}

// Snapshots have at most 200 jobs: those that have not ended first, then the newest that have.
TEST_F(JobLimits, ASnapshotHasTwoHundredJobs) {
  Fill(3);
  for (int i = 0; i < 3; ++i) {
    Must(bed.store().Finish(bed.Lease("CHECK"), {.outcome = {.state = JobState::kSucceeded}}));
  }
  Fill(198);
  std::vector<v1::Job> newest = Must(book.Newest({}));
  ASSERT_EQ(newest.size(), 200U);
  EXPECT_EQ(newest[0].name(), "jobs/201");
  EXPECT_EQ(newest[199].name(), "jobs/2");
  EXPECT_EQ(newest[199].state(), v1::Job::STATE_SUCCEEDED);
  Fill(2);
  newest = Must(book.Newest({}));
  EXPECT_EQ(newest.size(), 200U);
  EXPECT_EQ(newest[199].name(), "jobs/4");
  Fill(1);
  newest = Must(book.Newest({}));
  EXPECT_EQ(newest.size(), 200U);
  EXPECT_EQ(newest[199].name(), "jobs/5");
}

}  // namespace
}  // namespace rmlcell::server
