#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/server/forwarding_store.h"

namespace rmlcell::server {

// A store of which one call fails, the n-th from when it is told so; none with 0. For one thread.
class FailingStore : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;

  void FailAt(int call) {
    fails_at_ = call;
    calls_ = 0;
  }
  bool throws = false;  // instead: a mistake of ours

  bool failed() const { return fails_at_ > 0 && calls_ >= fails_at_; }

  Result<std::vector<storage::MachineRecord>> ListMachines() override {
    return Or([&] { return store_.ListMachines(); });
  }
  // As if one had always changed: what is in memory would fail at no call.
  std::uint64_t MachineChanges() const override { return ++looks_; }
  Result<storage::MachineRecord> GetMachine(std::string_view id) override {
    return Or([&] { return store_.GetMachine(id); });
  }
  Result<std::vector<storage::ProgramSummary>> ListPrograms(std::string_view machine, int after,
                                                            int limit) override {
    return Or([&] { return store_.ListPrograms(machine, after, limit); });
  }
  Result<storage::ProgramRecord> GetProgram(std::string_view machine, int slot) override {
    return Or([&] { return store_.GetProgram(machine, slot); });
  }
  Result<storage::ProgramSummary> GetProgramSummary(std::string_view machine, int slot) override {
    return Or([&] { return store_.GetProgramSummary(machine, slot); });
  }
  Result<storage::MachineMemory> GetMachineMemory(std::string_view machine,
                                                  const WantsPrograms& wants_programs) override {
    return Or([&] { return store_.GetMachineMemory(machine, wants_programs); });
  }
  Result<std::vector<storage::ProgramSummary>> PutPrograms(
      std::string_view machine, const std::vector<storage::ProgramWrite>& programs,
      const std::vector<storage::ScheduleRecord>& schedules, std::string_view caller) override {
    return Or([&] { return store_.PutPrograms(machine, programs, schedules, caller); });
  }
  Status DeleteProgram(std::string_view machine, int slot, storage::Revision expected,
                       std::string_view caller) override {
    return Or([&] { return store_.DeleteProgram(machine, slot, expected, caller); });
  }
  Result<bool> PutExecutable(std::string_view machine, int slot, storage::Revision object_revision,
                             std::string_view executable, std::string_view caller) override {
    return Or(
        [&] { return store_.PutExecutable(machine, slot, object_revision, executable, caller); });
  }
  Status DeleteExecutable(std::string_view machine, int slot, std::string_view caller) override {
    return Or([&] { return store_.DeleteExecutable(machine, slot, caller); });
  }
  Result<std::vector<storage::ScheduleRecord>> ListSchedules(std::string_view machine) override {
    return Or([&] { return store_.ListSchedules(machine); });
  }
  Result<std::vector<storage::ProjectRecord>> ListProjects(std::string_view after,
                                                           int limit) override {
    return Or([&] { return store_.ListProjects(after, limit); });
  }
  Result<storage::ProjectRecord> GetProject(std::string_view id) override {
    return Or([&] { return store_.GetProject(id); });
  }
  Result<storage::ProjectRecord> PutProject(const storage::ProjectRecord& project,
                                            storage::Revision expected,
                                            std::string_view caller) override {
    return Or([&] { return store_.PutProject(project, expected, caller); });
  }
  Status DeleteProject(std::string_view id, storage::Revision expected,
                       std::string_view caller) override {
    return Or([&] { return store_.DeleteProject(id, expected, caller); });
  }
  void Submit(storage::NewJob job,
              std::function<void(Result<storage::SubmittedJob>)> done) override {
    if (FailsNow()) return done(FullDisk());
    store_.Submit(std::move(job), std::move(done));
  }
  Result<std::optional<storage::JobRecord>> FindSubmitted(std::string_view id,
                                                          std::string_view hash) override {
    return Or([&] { return store_.FindSubmitted(id, hash); });
  }
  Result<storage::JobRecord> GetJob(std::int64_t id) override {
    return Or([&] { return store_.GetJob(id); });
  }
  Result<std::vector<storage::JobRecord>> ListJobs(const storage::JobQuery& query) override {
    return Or([&] { return store_.ListJobs(query); });
  }
  Result<std::int64_t> LastPosition() override {
    return Or([&] { return store_.LastPosition(); });
  }
  Result<std::vector<storage::ArtifactRecord>> ListArtifacts(std::int64_t job) override {
    return Or([&] { return store_.ListArtifacts(job); });
  }
  Result<storage::ArtifactRecord> GetArtifact(std::int64_t job, std::string_view name) override {
    return Or([&] { return store_.GetArtifact(job, name); });
  }
  Result<std::string> ReadArtifact(std::int64_t job, std::string_view name) override {
    return Or([&] { return store_.ReadArtifact(job, name); });
  }

 protected:
  template <class Call>
  auto Or(Call call) -> decltype(call()) {
    if (FailsNow()) {
      if (throws) throw std::runtime_error("a bug");
      return FullDisk();
    }
    return call();
  }

 private:
  static Error FullDisk() { return {ErrorCode::kCellStoreFailed, "the disk is full", {}}; }
  bool FailsNow() { return ++calls_ == fails_at_; }

  int fails_at_ = 0;
  int calls_ = 0;
  mutable std::uint64_t looks_ = 0;
};

// Lets the first call to the store fail, then the second, and so on until the operation comes
// through: each failure is what the operation ends with, and without one it ends with `last`.
inline void ExpectFailuresHandedOn(FailingStore& store, const std::string& what, int calls,
                                   const std::function<std::optional<ErrorCode>()>& operation,
                                   std::optional<ErrorCode> last = std::nullopt) {
  for (int call = 1; call <= calls; ++call) {
    store.FailAt(call);
    EXPECT_EQ(operation(), ErrorCode::kCellStoreFailed) << what << ", call " << call;
  }
  store.FailAt(calls + 1);
  EXPECT_EQ(operation(), last) << what;
  EXPECT_FALSE(store.failed()) << what << " makes more than " << calls << " calls";
  store.FailAt(0);
}

}  // namespace rmlcell::server
