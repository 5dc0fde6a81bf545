// Whichever call to the store fails in the middle of something, its error is what the caller hears.
#include <gtest/gtest.h>

#include <future>

#include "server/base/config.h"
#include "server/jobs/assignment.h"
#include "server/jobs/job_book.h"
#include "tests/server/failing_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

class BookFailures : public testing::Test {
 protected:
  v1::SubmitJobRequest Stored(const std::string& machine = "machines/optimo-1") {
    v1::SubmitJobRequest request;
    request.mutable_job()->set_kind(v1::JOB_KIND_SIMULATE);
    request.mutable_job()->set_machine(machine);
    request.mutable_job()->set_program(machine + "/programs/45");
    v1::SlotProgram& further = *request.mutable_job()->mutable_simulation()->add_programs();
    further.set_slot(46);
    further.mutable_program()->set_content("STOP\n");
    return request;
  }
  std::optional<ErrorCode> Submit(const v1::SubmitJobRequest& request) {
    std::promise<std::optional<ErrorCode>> answer;
    book.Submit(request, "tester",
                [&](const Result<v1::Job>& job) { answer.set_value(CodeOf(job)); });
    return answer.get_future().get();
  }
  void SetUp() override {
    Must(bed.store().PutPrograms("optimo-1", {{.slot = 45, .object = "object"}}, {}));
  }
  void Expect(const std::string& what, int calls,
              const std::function<std::optional<ErrorCode>()>& operation,
              std::optional<ErrorCode> last = std::nullopt) {
    ExpectFailuresHandedOn(store, what, calls, operation, last);
  }

  ServerBed bed;
  FailingStore store{bed.store()};
  Config config;
  JobBook book{store, config};
};

TEST_F(BookFailures, OfASubmission) {
  v1::SubmitJobRequest request = Stored();
  Expect("submitting", 3, [&] { return Submit(request); });
  request.set_request_id("once");
  request.set_validate_only(true);
  Expect("asking", 3, [&] { return Submit(request); });
  request.mutable_job()->set_machine("machines/none");
  request.set_validate_only(false);
  Expect(
      "submitting again what cannot be submitted now", 3, [&] { return Submit(request); },
      ErrorCode::kCellUnknownMachine);
  request = Stored();
  request.mutable_job()->set_program("machines/optimo-1/programs/44");
  EXPECT_EQ(Submit(request), ErrorCode::kProgramMissing);
}

TEST_F(BookFailures, OfALook) {
  ASSERT_EQ(Submit(Stored()), std::nullopt);
  Expect("getting", 2, [&] { return CodeOf(book.Get("jobs/1")); });
  Expect("listing", 2, [&] { return CodeOf(book.List({})); });
  Expect("finding an artifact", 1, [&] { return CodeOf(book.FindArtifact(1, kMainAttachment)); });
  Expect(
      "finding one that is not there yet", 2,
      [&] { return CodeOf(book.FindArtifact(1, "report")); }, ErrorCode::kCellPrecondition);
  Expect(
      "finding one of no job", 2, [&] { return CodeOf(book.FindArtifact(2, "report")); },
      ErrorCode::kCellNotFound);
  Expect("reading an artifact", 1, [&] { return CodeOf(book.ReadArtifact(1, kMainAttachment)); });
  Expect("the newest", 3, [&] { return CodeOf(book.Newest({})); });
}

TEST_F(BookFailures, OfAnAssignment) {
  ASSERT_EQ(Submit(Stored()), std::nullopt);
  const auto leased = *Must(bed.store().Acquire("w", {"SIMULATE"}, std::chrono::hours(1), {}));
  Expect("an assignment", 3, [&] { return CodeOf(MakeAssignment(store, config, leased)); });
}

// A store that a later version has written to may have machines of families unknown here.
TEST_F(BookFailures, AMachineThatThisServerDoesNotKnow) {
  Must(bed.store().PutMachine({.id = "odd", .family = "lathe"}, 0));
  Must(bed.store().PutMachine({.id = "strange", .family = "optimo", .parameters = {{"NONE", "1"}}},
                              0));
  Must(bed.store().PutPrograms("strange", {{.slot = 45, .object = "object"}}, {}));
  EXPECT_EQ(Submit(Stored("machines/odd")), ErrorCode::kCellUnknownFamily);
  EXPECT_NE(Submit(Stored("machines/strange")), std::nullopt);
}

}  // namespace
}  // namespace rmlcell::server
