// Contents piece by piece, and those that no record names yet.
#include <gmock/gmock.h>

#include <future>

#include "engine/core/hex.h"
#include "storage/content.h"
#include "tests/storage/store_conformance.h"

namespace rmlcell::storage {
namespace {

// SHA-256 of "abc", FIPS 180-4.
constexpr const char* kAbc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";

std::string HexName(std::string_view content) { return HexOf(Sha256(content)); }

std::string Pattern(std::size_t size) {
  std::string text(size, '\0');
  std::uint32_t state = 7;
  for (char& c : text) {
    state = state * 1'664'525 + 1'013'904'223;
    c = static_cast<char>(state >> 24);
  }
  return text;
}

Result<WallTime> Upload(Store& store, const std::string& name, std::string_view content,
                        std::size_t piece, std::chrono::milliseconds kept) {
  auto writer = store.WriteBlob(name, content.size());
  if (!writer) return writer.error();
  for (std::size_t at = 0; at < content.size(); at += piece) {
    if (const Status added = (*writer)->Append(content.substr(at, piece)); !added)
      return added.error();
  }
  return (*writer)->Finish(kept);
}

std::string ReadAll(Store& store, const std::string& name) {
  const auto reader = Must(store.OpenBlob(name));
  std::string content;
  for (;;) {
    const std::string part = Must(reader->Next());
    if (part.empty()) break;
    EXPECT_LE(part.size(), kChunkBytes);
    content += part;
  }
  EXPECT_EQ(reader->size(), content.size());
  EXPECT_EQ(Must(reader->Next()), "");
  return content;
}

TEST_P(StoreConformance, ContentsGoInAndOutPieceByPiece) {
  for (const std::size_t size : {std::size_t{1}, std::size_t{700}, kChunkBytes - 1, kChunkBytes,
                                 kChunkBytes + 1, 3 * kChunkBytes, 3 * kChunkBytes + 12345}) {
    const std::string content = Pattern(size);
    const std::string name = HexName(content);
    Must(Upload(store(), name, content, 300'000, std::chrono::hours(1)));
    EXPECT_TRUE(Must(store().ReadBlob(name)) == content) << size;
    EXPECT_TRUE(ReadAll(store(), name) == content) << size;
  }
  Reopen();
  EXPECT_TRUE(ReadAll(store(), HexName(Pattern(3 * kChunkBytes))) == Pattern(3 * kChunkBytes));
}

TEST_P(StoreConformance, AnUploadIsKeptForItsTimeAndWithTheJobThatNamesIt) {
  const std::string other = Pattern(2 * kChunkBytes);
  const WallTime now = clock().Now();
  EXPECT_EQ(Must(Upload(store(), kAbc, "abc", 3, std::chrono::hours(1))),
            now + std::chrono::hours(1));
  // Sent again the later of the two times counts.
  EXPECT_EQ(Must(Upload(store(), kAbc, "abc", 1, std::chrono::minutes(1))),
            now + std::chrono::hours(1));
  Must(Upload(store(), HexName(other), other, kChunkBytes, std::chrono::hours(1)));
  const JobRecord job =
      Must(store().SubmitAndWait(
               {.machine = "m",
                .kind = "CHECK",
                .attachments = {{.name = "program", .bytes = {}, .existing_sha256 = kAbc}}}))
          .job;
  EXPECT_EQ(Must(store().GetArtifact(job.id, "program")).sha256, kAbc);
  clock().Advance(std::chrono::hours(1) - std::chrono::milliseconds(1));
  Must(store().Expire({.outcome = {.state = JobState::kFailed}}));
  EXPECT_TRUE(Must(store().ReadBlob(HexName(other))) == other);
  clock().Advance(std::chrono::milliseconds(1));
  Must(store().Expire({.outcome = {.state = JobState::kFailed}}));
  EXPECT_TRUE(Eventually(
      [&] { return CodeOf(store().ReadBlob(HexName(other))) == ErrorCode::kCellNotFound; }));
  EXPECT_EQ(Must(store().ReadBlob(kAbc)), "abc");
  EXPECT_EQ(CodeOf(store().OpenBlob(HexName(other))), ErrorCode::kCellNotFound);
}

TEST_P(StoreConformance, AnUploadThatIsNotWhatItSaysIsRefused) {
  EXPECT_EQ(CodeOf(Upload(store(), kAbc, "abd", 3, std::chrono::hours(1))),
            ErrorCode::kCellChecksum);
  {
    const auto writer = Must(store().WriteBlob(kAbc, 3));
    EXPECT_EQ(CodeOf(writer->Append("abcd")), ErrorCode::kCellTooLarge);
  }
  {
    const auto writer = Must(store().WriteBlob(kAbc, 3));
    EXPECT_TRUE(writer->Append("ab"));
    EXPECT_EQ(CodeOf(writer->Finish(std::chrono::hours(1))), ErrorCode::kCellChecksum);
  }
  const std::string large = Pattern(2 * kChunkBytes + 1);
  {
    const auto writer = Must(store().WriteBlob(HexName(large), large.size()));
    EXPECT_TRUE(writer->Append(large));  // and never finished
  }
  EXPECT_EQ(CodeOf(Upload(store(), HexName(large), std::string(large.size(), 'x'), kChunkBytes,
                          std::chrono::hours(1))),
            ErrorCode::kCellChecksum);
  EXPECT_EQ(CodeOf(store().ReadBlob(kAbc)), ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(store().ReadBlob(HexName(large))), ErrorCode::kCellNotFound);
  for (const std::string& name : {std::string("ab"), std::string(64, 'g'), std::string(66, 'a')})
    EXPECT_EQ(CodeOf(store().WriteBlob(name, 1)), ErrorCode::kCellInvalidArgument) << name;
  EXPECT_EQ(CodeOf(store().WriteBlob(kAbc, kProgramBytesMax + 1)), ErrorCode::kCellTooLarge);
  EXPECT_TRUE(store().WriteBlob(kAbc, kProgramBytesMax));
  EXPECT_EQ(CodeOf(store().OpenBlob(kAbc)), ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(store().OpenBlob("xyz")), ErrorCode::kCellNotFound);
}

// A content that is removed while somebody reads it is told as gone, never cut short.
TEST_P(StoreConformance, AContentThatIsRemovedWhileItIsReadIsGone) {
  const std::string content = Pattern(3 * kChunkBytes);
  Must(Upload(store(), HexName(content), content, kChunkBytes, std::chrono::minutes(1)));
  const auto reader = Must(store().OpenBlob(HexName(content)));
  EXPECT_EQ(Must(reader->Next()).size(), kChunkBytes);
  clock().Advance(std::chrono::minutes(2));
  Must(Upload(store(), HexName("x"), "x", 1, std::chrono::hours(1)));
  ASSERT_TRUE(Eventually(
      [&] { return CodeOf(store().OpenBlob(HexName(content))) == ErrorCode::kCellNotFound; }));
  EXPECT_EQ(CodeOf(reader->Next()), ErrorCode::kCellNotFound);
}

// What a call gives the Done<T> that it is called with.
template <class T, class Call>
Result<T> Answered(Call call) {
  std::promise<Result<T>> promise;
  std::future<Result<T>> future = promise.get_future();
  call([&](Result<T> result) { promise.set_value(std::move(result)); });
  return future.get();
}

std::int64_t SubmitOne(Store& store) {
  return Must(store.SubmitAndWait({.machine = "m",
                                   .kind = "CHECK",
                                   .specification = "what to do",
                                   .attempts_max = 3}))
      .job.id;
}
std::vector<LeasedJob> AcquireAll(Store& store) {
  return Must(Answered<std::vector<LeasedJob>>([&](auto done) {
    store.Withdraw(store.AwaitJobs(
        {.worker = "w", .server = "s", .kinds = {"CHECK"}, .duration = std::chrono::seconds(10)},
        done));
  }));
}
Result<JobRecord> Renewed(Store& store, const Lease& lease) {
  return Answered<JobRecord>(
      [&](auto done) { store.SendRenew(lease, std::chrono::seconds(20), done); });
}

// store.h Done: what does not wait gives the same as what does.
TEST_P(StoreConformance, CallsOfALeaseThatDoNotWait) {
  const std::int64_t job = SubmitOne(store());
  std::vector<LeasedJob> leased = AcquireAll(store());
  ASSERT_EQ(leased.size(), 1U);
  EXPECT_EQ(leased[0].job.id, job);
  EXPECT_EQ(leased[0].job.specification, "what to do");
  EXPECT_TRUE(AcquireAll(store()).empty());
  EXPECT_EQ(Must(Renewed(store(), leased[0].lease)).state, JobState::kRunning);
  const auto handed_back =
      Answered<JobRecord>([&](auto done) { store().SendHandBack(leased[0].lease, {}, done); });
  EXPECT_EQ(Must(handed_back).state, JobState::kQueued);
  EXPECT_EQ(CodeOf(Renewed(store(), leased[0].lease)), ErrorCode::kCellLeaseLost);
  leased = AcquireAll(store());
  ASSERT_EQ(leased.size(), 1U);
  const LossPolicy policy{.outcome = {.state = JobState::kFailed}};
  const auto abandoned =
      Answered<JobRecord>([&](auto done) { store().SendAbandon(leased[0].lease, policy, done); });
  EXPECT_EQ(Must(abandoned).state, JobState::kQueued);
}

// records.h: a job has its specification, also one whose request is known.
TEST_P(StoreConformance, ASubmissionThatDoesNotWaitGivesTheWholeJob) {
  for (const bool again : {false, true}) {
    const SubmittedJob submitted = Must(Answered<SubmittedJob>([&](auto done) {
      store().Submit({.request_id = "r", .kind = "CHECK", .specification = "what to do"}, done);
    }));
    EXPECT_EQ(submitted.already_there, again);
    EXPECT_EQ(submitted.job.kind, "CHECK");
    EXPECT_EQ(submitted.job.specification, "what to do");
  }
}

TEST_P(StoreConformance, EndsAndCancelsThatDoNotWait) {
  const std::int64_t job = SubmitOne(store());
  const std::vector<LeasedJob> leased = AcquireAll(store());
  ASSERT_EQ(leased.size(), 1U);
  const auto cancelled =
      Answered<JobRecord>([&](auto done) { store().SendRequestCancel(job, {}, done); });
  EXPECT_TRUE(Must(cancelled).cancel_requested);
  const auto end = std::make_shared<const JobEnd>(
      JobEnd{.outcome = {.state = JobState::kSucceeded},
             .artifacts = {{.name = "report", .bytes = "the report"}}});
  const auto finish = [&] {
    return Answered<FinishedJob>(
        [&](auto done) { store().SendFinish(leased[0].lease, end, {}, done); });
  };
  EXPECT_EQ(Must(finish()).job.state, JobState::kSucceeded);
  EXPECT_EQ(CodeOf(finish()), ErrorCode::kCellLeaseLost);
  EXPECT_EQ(Must(store().ReadArtifact(job, "report")), "the report");
}

// records.h NewArtifact: what names a content that there is none of is stored by no call.
TEST_P(StoreConformance, WhatNamesNoContentIsNotStored) {
  const std::vector<NewArtifact> nameless = {{.name = "a", .existing_sha256 = "no hash"}};
  const auto submitted = Answered<SubmittedJob>(
      [&](auto done) { store().Submit({.kind = "CHECK", .attachments = nameless}, done); });
  EXPECT_EQ(CodeOf(submitted), ErrorCode::kCellNotFound);
  EXPECT_EQ(Must(store().CountJobs()).queued, 0);
  const std::int64_t job = SubmitOne(store());
  const Lease lease = AcquireAll(store()).at(0).lease;
  const auto send = [&](const std::vector<NewArtifact>& artifacts) {
    const auto end = std::make_shared<const JobEnd>(JobEnd{.artifacts = artifacts});
    return CodeOf(
        Answered<FinishedJob>([&](auto done) { store().SendFinish(lease, end, {}, done); }));
  };
  EXPECT_EQ(CodeOf(store().Finish(lease, {.artifacts = nameless})), ErrorCode::kCellNotFound);
  EXPECT_EQ(send(nameless), ErrorCode::kCellNotFound);
  // One that goes ahead in parts changes nothing of that.
  EXPECT_EQ(send({{.name = "large", .bytes = Pattern(kChunkBytes + 1)}, nameless[0]}),
            ErrorCode::kCellNotFound);
  EXPECT_EQ(Must(store().GetJob(job)).state, JobState::kRunning);
  Must(store().Finish(lease, {}));
  EXPECT_EQ(CodeOf(store().AddProducts(job, {.artifacts = nameless})), ErrorCode::kCellNotFound);
  EXPECT_TRUE(Must(store().ListArtifacts(job)).empty());
}

// store.h Done: an end that is refused is answered once, and the job is still its holder's.
TEST_P(StoreConformance, AnEndThatNamesAnUnknownContentIsAnswered) {
  const std::int64_t job = SubmitOne(store());
  const Lease lease = AcquireAll(store()).at(0).lease;
  const auto end = std::make_shared<const JobEnd>(
      JobEnd{.artifacts = {{.name = "a", .existing_sha256 = std::string(64, 'a')}}});
  const auto code = std::make_shared<std::promise<std::optional<ErrorCode>>>();
  store().SendFinish(lease, end, {},
                     [code](const Result<FinishedJob>& ended) { code->set_value(CodeOf(ended)); });
  auto answer = code->get_future();
  ASSERT_EQ(answer.wait_for(kPatience), std::future_status::ready);
  EXPECT_EQ(answer.get(), ErrorCode::kCellNotFound);
  EXPECT_EQ(Must(store().GetJob(job)).state, JobState::kRunning);
}

// A worker that is done is given the next job with the same commit: what follows the end of one,
// and nothing with an end that is not stored.
TEST_P(StoreConformance, AnEndBringsTheNextJob) {
  const std::int64_t first = SubmitOne(store());
  const Lease lease = AcquireAll(store()).at(0).lease;
  const auto follower = Must(store().SubmitAndWait({.kind = "CHECK", .after = {first}})).job.id;
  const std::int64_t last = SubmitOne(store());
  const JobRequest next{.worker = "w",
                        .server = "s",
                        .kinds = {"CHECK"},
                        .duration = std::chrono::seconds(10),
                        .events = {{.kind = "runs"}}};
  const auto finish = [&](const Lease& of) {
    const auto end = std::make_shared<const JobEnd>(
        JobEnd{.outcome = {.state = JobState::kSucceeded}, .events = {{.kind = "over"}}});
    return Answered<FinishedJob>([&](auto done) { store().SendFinish(of, end, next, done); });
  };
  const FinishedJob one = Must(finish(lease));
  EXPECT_EQ(one.job.state, JobState::kSucceeded);
  ASSERT_EQ(one.next.size(), 1U);
  EXPECT_EQ(one.next[0].job.id, follower);  // it has waited for this end
  EXPECT_EQ(Must(store().GetJob(follower)).state, JobState::kRunning);
  EXPECT_EQ(CodeOf(finish(lease)), ErrorCode::kCellLeaseLost);
  EXPECT_EQ(Must(store().GetJob(last)).state, JobState::kQueued);
  const FinishedJob two = Must(finish(one.next[0].lease));
  ASSERT_EQ(two.next.size(), 1U);
  EXPECT_EQ(two.next[0].job.id, last);
  EXPECT_EQ(two.next[0].job.specification, "what to do");
  EXPECT_TRUE(Must(finish(two.next[0].lease)).next.empty());
  std::vector<std::string> told;
  for (const EventRecord& event : Must(store().AllEvents(0, 100))) {
    if (event.job > 0) told.push_back(std::to_string(event.job) + " " + event.kind);
  }
  const auto of = [](std::int64_t job) { return std::to_string(job) + " "; };
  EXPECT_THAT(told,
              testing::ElementsAre(of(first) + "over", of(follower) + "runs", of(follower) + "over",
                                   of(last) + "runs", of(last) + "over"));
}

}  // namespace
}  // namespace rmlcell::storage
