#include "server/machines/recordings.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "proto/bridge/findings.h"
#include "server/machines/hosts.h"

namespace rmlcell::server {
namespace {

// A part after the other, until what there was when the first was asked for is here.
class Fetch : public std::enable_shared_from_this<Fetch> {
 public:
  Fetch(Hosts& hosts, std::string machine, std::string job, RecordingFetched done)
      : hosts_(hosts), machine_(std::move(machine)), job_(std::move(job)), done_(std::move(done)) {}

  void Ask() {
    v1::HostOrder order;
    order.mutable_recording()->set_job(job_);
    order.mutable_recording()->set_offset(static_cast<std::int64_t>(bytes_.size()));
    hosts_.Ask(machine_, std::move(order),
               [self = shared_from_this()](Result<v1::HostOrderAnswer> answer) {
                 self->Take(std::move(answer));
               });
  }

 private:
  void Take(Result<v1::HostOrderAnswer> answer) {
    if (!answer) return done_(answer.error());
    if (answer->has_refusal()) {
      const bool none = answer->refusal().code() == CodeText(ErrorCode::kCellNotFound);
      return done_(Error{none ? ErrorCode::kCellNotFound : ErrorCode::kCellNotLive,
                         answer->refusal().message(),
                         {}});
    }
    const v1::HostRecordingPart& part = answer->recording();
    if (total_ == 0) total_ = part.total();
    bytes_ += part.chunk();
    if (part.chunk().empty() || static_cast<std::int64_t>(bytes_.size()) >= total_) {
      // It has grown meanwhile, perhaps by half an entry.
      bytes_.resize(std::min(bytes_.size(), static_cast<std::size_t>(total_)));
      return done_(std::move(bytes_));
    }
    Ask();
  }

  Hosts& hosts_;
  const std::string machine_;
  const std::string job_;
  RecordingFetched done_;
  std::string bytes_;
  std::int64_t total_ = 0;
};

}  // namespace

void FetchRecording(Hosts& hosts, const std::string& machine, const std::string& job,
                    RecordingFetched done) {
  std::make_shared<Fetch>(hosts, machine, job, std::move(done))->Ask();
}

}  // namespace rmlcell::server
