#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "tests/server/forwarding_store.h"

namespace rmlcell::server {

// A store that refuses calls by their names: "LastPosition", and "Next" for the parts of a product.
// Thread-safe.
class RefusingStore : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;

  // From now on, behind so many that it still carries out.
  void Refuse(const std::string& call, ErrorCode code = ErrorCode::kCellStoreFailed, int good = 0) {
    const std::lock_guard lock(mutex_);
    refused_[call] = {.code = code, .good = good};
  }
  void Heal() {
    const std::lock_guard lock(mutex_);
    refused_.clear();
  }

  Result<std::vector<storage::MachineRecord>> ListMachines() override {
    return Or("ListMachines", [&] { return store_.ListMachines(); });
  }
  Result<storage::MachineRecord> GetMachine(std::string_view id) override {
    return Or("GetMachine", [&] { return store_.GetMachine(id); });
  }
  Result<storage::MachineRecord> PutMachine(const storage::MachineRecord& machine,
                                            storage::Revision expected,
                                            std::string_view caller) override {
    return Or("PutMachine", [&] { return store_.PutMachine(machine, expected, caller); });
  }
  Result<std::vector<storage::ProjectRecord>> ListProjects(std::string_view after,
                                                           int limit) override {
    return Or("ListProjects", [&] { return store_.ListProjects(after, limit); });
  }
  Result<storage::JobRecord> GetJob(std::int64_t id) override {
    return Or("GetJob", [&] { return store_.GetJob(id); });
  }
  Result<std::vector<storage::JobRecord>> ListJobs(const storage::JobQuery& query) override {
    return Or("ListJobs", [&] { return store_.ListJobs(query); });
  }
  Result<storage::JobCounts> CountJobs() override {
    return Or("CountJobs", [&] { return store_.CountJobs(); });
  }
  Result<std::vector<storage::JobStateCount>> CountByState(
      const storage::JobQuery& query) override {
    return Or("CountByState", [&] { return store_.CountByState(query); });
  }
  Result<std::vector<storage::MachineJobs>> UnfinishedJobs() override {
    return Or("UnfinishedJobs", [&] { return store_.UnfinishedJobs(); });
  }
  Result<std::vector<storage::EventRecord>> AllEvents(std::int64_t after, int limit) override {
    return Or("AllEvents", [&] { return store_.AllEvents(after, limit); });
  }
  Result<std::int64_t> LastPosition() override {
    return Or("LastPosition", [&] { return store_.LastPosition(); });
  }
  Result<std::int64_t> EventsGoneUntil() override {
    return Or("EventsGoneUntil", [&] { return store_.EventsGoneUntil(); });
  }
  Result<bool> HasPosition(std::string_view log_id, std::int64_t position) override {
    return Or("HasPosition", [&] { return store_.HasPosition(log_id, position); });
  }
  Result<std::unique_ptr<storage::BlobReader>> OpenArtifact(std::int64_t job,
                                                            std::string_view name) override {
    auto opened = store_.OpenArtifact(job, name);
    if (!opened) return opened.error();
    return std::unique_ptr<storage::BlobReader>(
        std::make_unique<RefusingReader>(*this, *std::move(opened)));
  }

 private:
  struct Refusal {
    ErrorCode code{};
    int good = 0;
  };

  class RefusingReader final : public storage::BlobReader {
   public:
    RefusingReader(RefusingStore& store, std::unique_ptr<storage::BlobReader> reader)
        : store_(store), reader_(std::move(reader)) {}
    std::size_t size() const override { return reader_->size(); }
    Result<std::string> Next() override {
      return store_.Or("Next", [&] { return reader_->Next(); });
    }

   private:
    RefusingStore& store_;
    std::unique_ptr<storage::BlobReader> reader_;
  };

  template <class Call>
  auto Or(const std::string& name, Call call) -> decltype(call()) {
    {
      const std::lock_guard lock(mutex_);
      const auto found = refused_.find(name);
      if (found != refused_.end() && --found->second.good < 0)
        return Error{found->second.code, "the disk is full", {}};
    }
    return call();
  }

  std::mutex mutex_;
  std::map<std::string, Refusal> refused_;  // guarded by mutex_
};

}  // namespace rmlcell::server
