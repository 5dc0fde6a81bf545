// Where in the log of the cell an event of a job stands, and how a program that is too large is
// told.
#include <gtest/gtest.h>

#include <future>

#include "server/base/config.h"
#include "server/jobs/job_book.h"
#include "server/records/program_memory.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

// One that notes which position is asked for, and how many events are read for it.
class AskedStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Result<bool> HasPosition(std::string_view log_id, std::int64_t position) override {
    asked = position;
    return store_.HasPosition(log_id, position);
  }
  Result<std::vector<storage::EventRecord>> JobEvents(std::int64_t job, std::int64_t after,
                                                      int limit) override {
    events_read = limit;
    return store_.JobEvents(job, after, limit);
  }
  std::int64_t asked = -1;
  int events_read = 0;
};

// It is that very event that is looked for in the other log, not one near it.
TEST(LogPositions, TheEventThatWasSeenLastIsLookedFor) {
  ServerBed bed;
  AskedStore store{bed.store()};
  Config config;
  JobBook book{store, config};
  bed.SubmitCheck();
  const std::int64_t job = bed.SubmitCheck();
  bed.Append(bed.Lease(), 1);
  bed.Append(bed.Lease(), 5);
  const auto events = Must(bed.store().JobEvents(job, 0, 99));
  ASSERT_GE(events.size(), 6U);
  for (const storage::EventRecord& event : events) {
    ASSERT_TRUE(book.CheckLog(job, event.sequence, bed.store().LogId()));
    EXPECT_EQ(store.asked, event.position) << event.sequence;
    EXPECT_EQ(store.events_read, 1) << event.sequence;
  }
  ASSERT_TRUE(book.CheckLog(job, events.back().sequence + 1, bed.store().LogId()));
  EXPECT_EQ(store.asked, 0) << "it is not there any more";
}

TEST(ProgramSizes, AreToldWithTheirLimit) {
  ServerBed bed;
  Config config;
  config.limit_program_bytes = 12;
  JobBook book{bed.store(), config};
  const auto detail = [&](std::size_t bytes) {
    v1::SubmitJobRequest request;
    request.mutable_job()->set_kind(v1::JOB_KIND_CHECK);
    request.mutable_job()->set_machine("machines/mill-1");
    request.mutable_job()->mutable_inline_program()->set_file_name("a.rml");
    request.mutable_job()->mutable_inline_program()->set_content(std::string(bytes, ';'));
    std::promise<Result<v1::Job>> answer;
    book.Submit(request, "anna", [&](Result<v1::Job> job) { answer.set_value(std::move(job)); });
    const auto made = answer.get_future().get();
    return made ? std::string() : std::string(made.error().detail);
  };
  EXPECT_EQ(detail(12), "");
  EXPECT_NE(detail(13).find("13 bytes; limits.program_bytes is 12"), std::string::npos)
      << detail(13);
}

// OPT-B.73: objects and executables share the memory; what is replaced is there no more.
TEST(ProgramRoom, ExecutablesTakeTheirShareOfIt) {
  ServerBed bed;
  storage::MachineRecord machine = Must(bed.store().GetMachine("optimo-1"));
  machine.parameters = {{"CMOS_SIZE", "1000"}};
  Must(bed.store().PutMachine(machine, storage::kAnyRevision));
  const std::string object = ObjectOf("STOP\n");
  const auto put = Must(bed.store().PutPrograms("optimo-1", {{.slot = 7, .object = object}}, {}));
  ASSERT_TRUE(Must(bed.store().PutExecutable("optimo-1", 7, put.front().revision,
                                             std::string(600, 'e'), "anna")));
  const std::size_t left = 1'000 - 600 - object.size();
  const auto fits = [&](int slot, std::size_t bytes) {
    const std::vector<storage::ProgramWrite> writes = {
        {.slot = slot, .object = std::string(bytes, 'o')}};
    return static_cast<bool>(CheckRoomFor(bed.store(), machine, writes));
  };
  EXPECT_TRUE(fits(8, left));
  EXPECT_FALSE(fits(8, left + 1));
  EXPECT_TRUE(fits(7, 1'000)) << "its executable goes with it";
  EXPECT_FALSE(fits(7, 1'001));
}

}  // namespace
}  // namespace rmlcell::server
