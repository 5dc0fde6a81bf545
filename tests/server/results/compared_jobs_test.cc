// What two jobs differ by, number by number (WEB-6.08).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/job_book.h"
#include "server/programs/memory_tools.h"
#include "server/programs/program_book.h"
#include "server/results/job_results.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;

class ComparedJobs : public testing::Test {
 protected:
  static v1::RunReport Report() {
    v1::RunReport report;
    report.set_family("optimo");
    return report;
  }
  static v1::Diagnostic& Find(v1::RunReport& report, const std::string& code, int program, int step,
                              int line) {
    v1::Diagnostic& finding = *report.add_diagnostics();
    finding.set_code(code);
    finding.mutable_place()->set_program(program);
    finding.mutable_place()->set_step(step);
    finding.mutable_place()->set_line(line);
    return finding;
  }
  // A simulation that has ended so.
  std::string Ended(const v1::RunReport& report) {
    v1::SubmitJobRequest request;
    v1::Job& job = *request.mutable_job();
    job.set_kind(v1::JOB_KIND_SIMULATE);
    job.set_machine("machines/optimo-1");
    job.mutable_inline_program()->set_file_name("part.S");
    job.mutable_inline_program()->set_content("STOP\n");
    std::promise<Result<v1::Job>> answer;
    book.Submit(request, "anna", [&](Result<v1::Job> made) { answer.set_value(std::move(made)); });
    const std::string name = Must(answer.get_future().get()).name();
    Must(bed.store().Finish(
        bed.Lease("SIMULATE"),
        {.artifacts = {{"report", "application/x-protobuf", report.SerializeAsString(), {}}}}));
    return name;
  }
  v1::CompareJobsResponse Compared(const std::string& before, const std::string& after) {
    v1::CompareJobsRequest request;
    request.set_before(before);
    request.set_after(after);
    return Must(results.Compare(request));
  }

  ServerBed bed;
  Config config;
  JobBook book{bed.store(), config};
  ProgramBook programs{bed.store(), config};
  MemoryTools tools{bed.store(), programs};
  JobResults results{bed.store(), book, tools};
};

// Each in its unit, with its value before and after; what is the same in both is left out.
TEST_F(ComparedJobs, FiguresHaveUnitsAndBothValues) {
  v1::RunReport one = Report();
  one.mutable_total()->mutable_times()->set_cycle_s(10.5);
  one.mutable_total()->set_cut_length_mm(5.25);
  one.mutable_total()->set_pierces(2);
  one.mutable_total()->set_energy_j_per_mm(3.5);
  v1::RunReport two = one;
  two.mutable_total()->mutable_times()->set_cycle_s(12.5);
  two.mutable_total()->set_cut_length_mm(7.25);
  two.mutable_total()->set_pierces(7);
  const auto compared = Compared(Ended(one), Ended(two));
  std::map<std::string, std::string> figures;
  for (const auto& figure : compared.figures()) {
    std::ostringstream told;
    told << figure.before() << " > " << figure.after() << " " << figure.unit();
    figures[figure.name()] = told.str();
  }
  EXPECT_EQ(figures, (std::map<std::string, std::string>{{"cycle_s", "10.5 > 12.5 s"},
                                                         {"cut_length_mm", "5.25 > 7.25 mm"},
                                                         {"pierces", "2 > 7 "}}));
}

// Findings are the same where code, program, step and line are.
TEST_F(ComparedJobs, AFindingIsKnownByItsCodeAndItsPlace) {
  v1::RunReport one = Report();
  Find(one, "OPT-E7304", 12, 3, 40).set_message("before");
  Find(one, "OPT-E7304", 12, 3, 40);  // twice at one place is one of them
  v1::RunReport two = Report();
  Find(two, "OPT-E7304", 12, 3, 40).set_message("after");
  EXPECT_EQ(Compared(Ended(one), Ended(two)).common(), 1);
  EXPECT_EQ(Compared(Ended(one), Ended(two)).gained_size(), 0);
  for (const int other : {0, 1, 2, 3}) {
    v1::RunReport changed = Report();
    Find(changed, other == 0 ? "OPT-E7301" : "OPT-E7304", other == 1 ? 13 : 12, other == 2 ? 4 : 3,
         other == 3 ? 41 : 40);
    const auto compared = Compared(Ended(one), Ended(changed));
    EXPECT_EQ(compared.common(), 0) << other;
    EXPECT_EQ(compared.gained_size(), 1) << other;
    EXPECT_EQ(compared.lost_size(), 2) << other;
  }
}

// Versions, profiles and kinds are inputs as well.
TEST_F(ComparedJobs, InputsAreTold) {
  v1::RunReport one = Report();
  one.set_engine_version("1.0");
  one.set_profile("pw-1993");
  (*one.mutable_parameters())["VMAX"] = "20";
  v1::RunReport two = one;
  two.set_engine_version("1.1");
  two.set_profile("");
  (*two.mutable_parameters())["VMAX"] = "30";
  std::vector<std::string> inputs;
  const auto compared = Compared(Ended(one), Ended(two));
  for (const auto& input : compared.inputs())
    inputs.push_back(input.name() + " " + input.before() + ">" + input.after());
  EXPECT_THAT(inputs,
              ElementsAre("engine_version 1.0>1.1", "parameters.VMAX 20>30", "profile pw-1993>"));
}

}  // namespace
}  // namespace rmlcell::server
