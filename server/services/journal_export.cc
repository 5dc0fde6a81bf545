#include "server/services/journal_export.h"

#include <optional>
#include <string>
#include <utility>

#include "proto/recording/recording.h"
#include "server/base/names.h"
#include "server/machines/hosts.h"
#include "server/machines/recordings.h"

namespace rmlcell::server {
namespace {

class JournalExport final : public PullStream<v1::ExportJournalResponse> {
 public:
  JournalExport(const JournalExportNeeds& needs, const v1::ExportJournalRequest& request)
      : PullStream(needs.executor, needs.open), needs_(needs), request_(request) {}

 private:
  Next Make(v1::ExportJournalResponse& message, grpc::Status& status) override {
    if (!begun_) {
      begun_ = true;
      if (const Status begun = BeginFetch(); !begun) Have(begun.error());
    }
    std::optional<Result<std::string>> fetched;
    {
      const std::lock_guard lock(mutex_);
      fetched.swap(fetched_);
    }
    if (fetched) {
      Result<std::string> file = FromTime(*std::move(fetched));
      if (!file) {
        status = ToGrpcStatus(file.error());
        return Next::kEnd;
      }
      file_ = *std::move(file);
      here_ = true;
    }
    if (!here_) return Next::kNothing;
    if (sent_ >= file_.size()) return Next::kEnd;
    message.set_chunk(file_.substr(sent_, kChunkBytes));
    sent_ += message.chunk().size();
    return Next::kMessage;
  }

  Status BeginFetch() {
    const Result<std::string> machine = ParseMachineName(request_.machine());
    if (!machine) return machine.error();
    if (const auto known = needs_.store.GetMachine(*machine); !known) return known.error();
    if (!request_.job().empty()) {
      const Result<std::int64_t> job = ParseJobName(request_.job());
      if (!job) return job.error();
      const auto record = needs_.store.GetJob(*job);
      if (!record) return record.error();
      if (record->machine != *machine)
        return Error{ErrorCode::kCellNotFound, request_.job() + " is of another machine", {}};
      if (Result<std::string> kept = needs_.store.ReadArtifact(*job, kRecording)) {
        Have(std::move(kept));
        return {};
      }
    }
    if (needs_.hosts == nullptr || !needs_.hosts->IsHosted(*machine))
      return Error{ErrorCode::kCellNotLive, "the machine has no host: enable it", {}};
    FetchRecording(*needs_.hosts, *machine, request_.job(),
                   [self = shared_from_this(), this](Result<std::string> file) {
                     Have(std::move(file));
                     Wake();
                   });
    return {};
  }

  void Have(Result<std::string> file) {
    const std::lock_guard lock(mutex_);
    fetched_.emplace(std::move(file));
  }

  Result<std::string> FromTime(Result<std::string> file) const {
    if (!file || (request_.from_virtual_time_ns() == 0 && request_.fence() == 0)) return file;
    auto recording = recording::ReadFile(*file);
    if (!recording) return recording.error();
    if (request_.fence() != 0 && request_.fence() != recording->head.fence())
      return Error{ErrorCode::kCellNotFound,
                   "what is recorded is of fence " + std::to_string(recording->head.fence()),
                   {}};
    if (request_.from_virtual_time_ns() == 0) return file;
    return recording::FileOf(
        recording::From(*std::move(recording), SimTime(request_.from_virtual_time_ns())));
  }

  const JournalExportNeeds needs_;
  const v1::ExportJournalRequest request_;
  bool begun_ = false;
  bool here_ = false;
  std::string file_;
  std::size_t sent_ = 0;
  std::mutex mutex_;
  std::optional<Result<std::string>> fetched_;  // guarded by mutex_
};

}  // namespace

std::shared_ptr<PullStream<v1::ExportJournalResponse>> MakeJournalExport(
    const JournalExportNeeds& needs, const v1::ExportJournalRequest& request) {
  return std::make_shared<JournalExport>(needs, request);
}

}  // namespace rmlcell::server
