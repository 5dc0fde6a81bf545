// What should be left of the block of a job (MillTarget): how it is handed in, kept with the job,
// and given to a worker.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>

#include "rmlcell/v1/project.pb.h"
#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/assignment.h"
#include "server/jobs/job_book.h"
#include "server/jobs/job_milling.h"
#include "tests/server/failing_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kStl = "solid\nendsolid\n";

class JobTarget : public testing::Test {
 protected:
  static v1::Milling Block() {
    v1::Milling milling;
    milling.mutable_stock()->set_size_x_mm(60.0);
    milling.mutable_stock()->set_size_y_mm(30.0);
    milling.mutable_stock()->set_size_z_mm(5.0);
    milling.mutable_tool()->set_shape(v1::MillTool::SHAPE_FLAT);
    milling.mutable_tool()->set_diameter_mm(3.0);
    return milling;
  }
  JobTarget() {
    v1::Job& job = *request.mutable_job();
    job.set_kind(v1::JOB_KIND_SIMULATE);
    job.set_machine("machines/mill-1");
    job.mutable_inline_program()->set_file_name("part.rml");
    job.mutable_inline_program()->set_content("PA;");
    *job.mutable_simulation()->mutable_milling() = Block();
  }
  v1::MillTarget& Target() {
    return *request.mutable_job()->mutable_simulation()->mutable_milling()->mutable_target();
  }
  Result<v1::Job> Submit() {
    std::promise<Result<v1::Job>> answer;
    book.Submit(request, "tester", [&](Result<v1::Job> job) { answer.set_value(std::move(job)); });
    return answer.get_future().get();
  }
  // "CELL-E9003 what was said".
  std::string Refused() {
    request.set_validate_only(true);
    const Result<v1::Job> job = Submit();
    request.set_validate_only(false);
    return job ? "taken" : CodeText(job.error().code) + " " + job.error().detail;
  }
  AssignmentMessages Assigned() {
    const auto leased =
        Must(bed.store().Acquire("w", {"SIMULATE", "CHECK"}, std::chrono::hours(1), {}));
    return Must(MakeAssignment(bed.store(), config, *leased));
  }
  storage::ArtifactRecord Attachment(const v1::Job& job) {
    return Must(book.FindArtifact(Must(ParseJobName(job.name())), kTargetAttachment));
  }

  ServerBed bed;
  Config config;
  JobBook book{bed.store(), config};
  v1::SubmitJobRequest request;
};

TEST_F(JobTarget, AFileIsKeptBesideTheJob) {
  Target().mutable_file()->set_file_name("a.stl");
  Target().mutable_file()->set_content(kStl);
  Target().set_tolerance_mm(0.25);
  Target().set_picture(true);
  const v1::Job job = Must(book.Get(Must(Submit()).name()));
  const v1::MillTarget& kept = job.simulation().milling().target();
  EXPECT_EQ(kept.file().file_name(), "a.stl");
  EXPECT_EQ(kept.file().content(), "");
  EXPECT_EQ(kept.tolerance_mm(), 0.25);
  EXPECT_TRUE(kept.picture());
  EXPECT_EQ(Attachment(job).media_type, "model/stl");
  EXPECT_EQ(Attachment(job).name, "target");
  EXPECT_EQ(Must(bed.store().ReadArtifact(Attachment(job).job, "target")), kStl);
  const AssignmentMessages assigned = Assigned();
  const v1::AssignedProgram& target = assigned.first.assignment().target();
  EXPECT_EQ(target.content(), kStl);
  EXPECT_EQ(target.size(), 15);
  EXPECT_EQ(target.file_name(), "a.stl");
  EXPECT_FALSE(target.is_source());
  EXPECT_EQ(assigned.first.assignment().programs_size(), 1);
}

TEST_F(JobTarget, SoIsAProgram) {
  Target().mutable_inline_program()->set_file_name("old.rml");
  Target().mutable_inline_program()->set_content("PD;");
  const v1::Job job = Must(book.Get(Must(Submit()).name()));
  EXPECT_EQ(job.simulation().milling().target().inline_program().content(), "");
  EXPECT_EQ(Attachment(job).media_type, "application/octet-stream");
  const AssignmentMessages assigned = Assigned();
  const v1::AssignedProgram& target = assigned.first.assignment().target();
  EXPECT_EQ(target.content(), "PD;");
  EXPECT_EQ(target.file_name(), "old.rml");
  EXPECT_TRUE(target.is_source());
}

// The bytes at the time of submission count.
TEST_F(JobTarget, AStoredProgramIsThatOfTheSubmission) {
  Must(bed.store().PutPrograms("mill-1", {{.slot = 7, .name = "p", .object = "first"}}, {}));
  Target().set_slot(7);
  Must(Submit());
  Must(bed.store().PutPrograms("mill-1", {{.slot = 7, .name = "p", .object = "second"}}, {}));
  const AssignmentMessages assigned = Assigned();
  EXPECT_EQ(assigned.first.assignment().target().content(), "first");
  EXPECT_FALSE(assigned.first.assignment().target().is_source());
  Target().set_slot(8);
  EXPECT_THAT(Refused(), HasSubstr("machines/mill-1/programs/8"));
}

// What does not go into the message of an assignment follows in parts, as that of no slot.
TEST_F(JobTarget, ALargeOneFollowsTheAssignment) {
  const std::string large = "solid" + std::string(100'000, '\n');
  Target().mutable_file()->set_content(large);
  Must(Submit());
  const AssignmentMessages assigned = Assigned();
  EXPECT_EQ(assigned.first.assignment().target().content(), "");
  EXPECT_EQ(assigned.first.assignment().target().size(), 100'005);
  ASSERT_EQ(assigned.programs.size(), 1U);
  EXPECT_EQ(assigned.programs[0].first, 0);
  EXPECT_EQ(*assigned.programs[0].second, large);
}

TEST_F(JobTarget, ACheckComparesNothing) {
  Target().mutable_file()->set_content(kStl);
  request.mutable_job()->set_kind(v1::JOB_KIND_CHECK);
  Must(Submit());
  EXPECT_FALSE(Assigned().first.assignment().has_target());
}

// limits.target_bytes, on both sides of it, of whatever is handed in.
TEST_F(JobTarget, HasALimitOfItsOwn) {
  config.limit_target_bytes = 15;
  Target().mutable_file()->set_content(kStl);
  EXPECT_EQ(Refused(), "taken");
  Target().mutable_file()->set_content(std::string(kStl) + " ");
  EXPECT_EQ(Refused(),
            "CELL-E9007 job.simulation.milling.target has 16 bytes; limits.target_bytes is 15");
  Target().mutable_inline_program()->set_content(std::string(15, ';'));
  EXPECT_EQ(Refused(), "taken");
  Target().mutable_inline_program()->set_content(std::string(16, ';'));
  EXPECT_THAT(Refused(), StartsWith("CELL-E9007 job.simulation.milling.target has 16 bytes"));
}

TEST_F(JobTarget, RefusalsSayWhere) {
  Target();
  EXPECT_THAT(Refused(), StartsWith("CELL-E9003 job.simulation.milling.target is missing"));
  Target().mutable_file()->set_content("PA;");
  EXPECT_THAT(Refused(), StartsWith("CELL-E9024 job.simulation.milling.target.file: no STL"));
  Target().mutable_inline_program()->set_content("");
  EXPECT_EQ(Refused(), "CELL-E9017 job.simulation.milling.target.inline_program");
  Target().mutable_inline_program()->set_content("STOP");
  Target().mutable_inline_program()->set_file_name("part.S");
  EXPECT_THAT(Refused(), HasSubstr("part.S is a program for"));
}

// A project keeps the bytes; a job that takes them has them as an attachment of its own.
TEST_F(JobTarget, OfAProjectGoesIntoTheJob) {
  v1::Project project;
  v1::ProjectProgram& program = *project.add_programs();
  program.set_slot(7);
  *program.mutable_milling() = Block();
  program.mutable_milling()->mutable_target()->mutable_file()->set_content(kStl);
  Must(bed.store().PutProject({.id = "coaster", .body = project.SerializeAsString()}, 0));
  v1::Job& wanted = *request.mutable_job();
  wanted.set_inline_slot(7);
  wanted.mutable_simulation()->clear_milling();
  wanted.mutable_simulation()->set_milling_project("projects/coaster");
  const v1::Job job = Must(book.Get(Must(Submit()).name()));
  EXPECT_TRUE(job.simulation().milling().target().has_file());
  EXPECT_EQ(job.simulation().milling().target().file().content(), "");
  Must(bed.store().DeleteProject("coaster", storage::kAnyRevision));
  EXPECT_EQ(Assigned().first.assignment().target().content(), kStl);
}

// As it is handed in, and as a worker is given it with the program of its job.
TEST_F(JobTarget, WhatTheStoreSaysOfItIsHandedOn) {
  FailingStore store(bed.store());
  JobBook failing(store, config);
  Must(bed.store().PutPrograms("mill-1", {{.slot = 7, .name = "p", .object = "PU;"}}, {}));
  Target().set_slot(7);
  ExpectFailuresHandedOn(store, "handing it in", 3, [&] {
    std::promise<std::optional<ErrorCode>> answer;
    failing.Submit(request, "tester",
                   [&](const Result<v1::Job>& job) { answer.set_value(CodeOf(job)); });
    return answer.get_future().get();
  });
  const auto leased = Must(bed.store().Acquire("w", {"SIMULATE"}, std::chrono::hours(1), {}));
  ASSERT_TRUE(leased);
  ExpectFailuresHandedOn(store, "giving it out", 3,
                         [&] { return CodeOf(MakeAssignment(store, config, *leased)); });
  ExpectFailuresHandedOn(store, "reading the program", 2,
                         [&] { return CodeOf(ProgramOfJob(store, leased->job.id)); });
}

}  // namespace
}  // namespace rmlcell::server
