#include <algorithm>
#include <optional>

#include "engine/simulation/material/height_tiles.h"
#include "proto/bridge/milling.h"
#include "server/jobs/running_heights.h"
#include "server/services/followed_job.h"

namespace rmlcell::server {
namespace {

constexpr const char* kProduct = "height.grid";

// What a mill leaves of its block: of a job that is followed as its worker tells it, else from the
// height grid that it left.
class HeightsStream final : public PullStream<v1::StreamJobHeightsResponse> {
 public:
  HeightsStream(const JobStreamNeeds& needs, const v1::StreamJobHeightsRequest& request)
      : PullStream(needs.executor, needs.open),
        needs_(needs),
        request_(request),
        followed_(needs.feed, needs.book, needs.running_heights) {}

 private:
  using Job = FollowedJob<RunningHeights>;

  Next Make(v1::StreamJobHeightsResponse& message, grpc::Status& status) override {
    const Result<Next> next = MakeNext(message);
    if (next) return *next;
    status = ToGrpcStatus(next.error());
    return Next::kEnd;
  }

  Result<Next> MakeNext(v1::StreamJobHeightsResponse& message) {
    if (tiles_) return MakeStored(message);
    if (followed_.running() != nullptr) return MakeRunning(message);
    if (const Status asked = Check(); !asked) return asked.error();
    if (request_.follow()) {
      const Result<Job::State> state = followed_.Look(
          request_.name(), "heights of a block",
          [](const v1::Job& job) {
            return job.kind() == v1::JOB_KIND_SIMULATE && job.simulation().has_milling();
          },
          [this] { Wake(); });
      if (!state) return state.error();
      if (*state == Job::State::kWaits) {
        WakeAt(std::chrono::steady_clock::now() + Job::kBegunLookedForAfter);
        return Next::kNothing;
      }
      if (*state == Job::State::kRuns) return MakeRunning(message);
    }
    return OpenStored(message);
  }

  Status Check() const {
    if (request_.follow() && (request_.has_level() || request_.has_area()))
      return InvalidArgument("follow goes without level and area");
    if (request_.level() < 0 || request_.level() > simulation::kHeightLevelMax)
      return InvalidArgument("level: allowed are 0 to " +
                             std::to_string(simulation::kHeightLevelMax));
    const v1::HeightArea& area = request_.area();
    if (request_.has_area() &&
        (area.column() < 0 || area.row() < 0 || area.columns() < 1 || area.rows() < 1))
      return InvalidArgument("area: it begins at 0 or later, and has a column and a row at least");
    return {};
  }

  Result<Next> MakeRunning(v1::StreamJobHeightsResponse& message) {
    RunningHeights::Part part = followed_.running()->Look(seen_);
    if (!grid_sent_ && part.grid) {
      grid_sent_ = true;
      *message.mutable_grid() = *std::move(part.grid);
      return Next::kMessage;
    }
    seen_ = part.seen;
    if (!part.tiles.empty()) {
      for (v1::HeightTile& tile : part.tiles)
        *message.mutable_tiles()->add_tiles() = std::move(tile);
      return Next::kMessage;
    }
    if (!part.ended) return Next::kNothing;
    if (!part.stored) return followed_.BeginsAnew();
    // Its run ended before the worker heard that it is looked at.
    if (!grid_sent_) return OpenStored(message);
    return Next::kEnd;
  }

  // The head is read here, the rest as it is sent.
  Result<Next> OpenStored(v1::StreamJobHeightsResponse& message) {
    const Result<std::int64_t> job = ParseJobName(request_.name());
    if (!job) return job.error();
    auto opened = needs_.book.OpenArtifact(*job, kProduct);
    if (!opened) return opened.error();
    reader_ = *std::move(opened);
    std::string bytes;
    while (bytes.size() < simulation::kHeightGridHeadBytes) {
      const Result<std::string> chunk = reader_->Next();
      if (!chunk) return chunk.error();
      if (chunk->empty()) break;
      bytes += *chunk;
    }
    const Result<simulation::HeightGridHead> head = simulation::ReadHeightGridHead(bytes);
    if (!head) return head.error();
    if (head->size.columns > simulation::HeightGridTiles::kColumnsMax) {
      return Error{ErrorCode::kCellTooLarge,
                   "the block has " + std::to_string(head->size.columns) +
                       " columns, tiles are made of up to 1,048,576; read height.grid itself",
                   {}};
    }
    const int level =
        request_.has_level() ? request_.level() : simulation::LevelForScreen(head->size);
    std::optional<simulation::HeightGridTiles::Area> area;
    if (request_.has_area()) {
      const v1::HeightArea& asked = request_.area();
      area = {.column = static_cast<std::size_t>(asked.column()),
              .row = static_cast<std::size_t>(asked.row()),
              .columns = static_cast<std::size_t>(asked.columns()),
              .rows = static_cast<std::size_t>(asked.rows())};
    }
    tiles_.emplace(*head, level, area);
    Keep(tiles_->Add(std::string_view(bytes).substr(simulation::kHeightGridHeadBytes)));
    *message.mutable_grid() = bridge::ToProto(*head, level);
    return Next::kMessage;
  }

  Result<Next> MakeStored(v1::StreamJobHeightsResponse& message) {
    while (next_ == ready_.size()) {
      // The end of all of it shows whether it is whole; of a part there is no need to go there.
      if (request_.has_area() && tiles_->done()) return Next::kEnd;
      const Result<std::string> chunk = reader_->Next();
      if (!chunk) return chunk.error();
      if (chunk->empty()) return Next::kEnd;
      Keep(tiles_->Add(*chunk));
    }
    const std::size_t end =
        std::min(ready_.size(), next_ + std::size_t{RunningHeights::kTilesAtOnce});
    for (; next_ < end; ++next_)
      *message.mutable_tiles()->add_tiles() = bridge::ToProto(std::move(ready_[next_]));
    return Next::kMessage;
  }

  void Keep(std::vector<simulation::HeightTile> tiles) {
    ready_ = std::move(tiles);
    next_ = 0;
  }

  void Closed() override { followed_.Leave(); }

  const JobStreamNeeds needs_;
  const v1::StreamJobHeightsRequest request_;
  Job followed_;
  std::uint64_t seen_ = 0;
  bool grid_sent_ = false;

  // Of a job that is over.
  std::unique_ptr<storage::BlobReader> reader_;
  std::optional<simulation::HeightGridTiles> tiles_;
  std::vector<simulation::HeightTile> ready_;
  std::size_t next_ = 0;  // of them, that goes out
};

}  // namespace

std::shared_ptr<PullStream<v1::StreamJobHeightsResponse>> MakeHeightsStream(
    const JobStreamNeeds& needs, const v1::StreamJobHeightsRequest& request) {
  return std::make_shared<HeightsStream>(needs, request);
}

}  // namespace rmlcell::server
