#include "engine/simulation/toolpath/toolpath_writer.h"

#include <utility>

#include "engine/core/check.h"

namespace rmlcell::simulation {
namespace {

// A run that was opened and then went nowhere: takes it back, with its point unless that is the
// last one of the run before.
void DropEmptyRun(ToolpathBlock& block) {
  if (block.runs.empty() || block.runs.back().point_count > 1) return;
  const std::uint32_t point = block.runs.back().first_point;
  block.runs.pop_back();
  const bool shared =
      !block.runs.empty() && block.runs.back().first_point + block.runs.back().point_count > point;
  if (shared) return;
  block.points.pop_back();
  block.reached_us.pop_back();
}

}  // namespace

ToolpathWriter::ToolpathWriter(std::uint64_t bytes_max, ToolpathSink sink)
    : bytes_max_(bytes_max), sink_(std::move(sink)) {
  RMLCELL_CHECK(sink_);
  block_.points.reserve(kToolpathBlockPoints);
  block_.reached_us.reserve(kToolpathBlockPoints);
}

std::string ToolpathWriter::OpenBlock() const {
  ToolpathBlock block = block_;
  DropEmptyRun(block);
  return block.runs.empty() ? std::string() : EncodeToolpathBlock(block);
}

void ToolpathWriter::Open(const ToolpathRun& run, const ToolpathPoint& first) {
  DropEmptyRun(block_);
  // A run needs two points: its first one and one more.
  if (block_.points.size() + 2 > kToolpathBlockPoints) Flush();
  const bool joined = !block_.points.empty() && block_.points.back() == first;
  if (!joined) {
    block_.points.push_back(first);
    block_.reached_us.push_back(run.start_us);
    ++points_;
  }
  block_.runs.push_back(run);
  ToolpathRun& opened = block_.runs.back();
  opened.end_us = run.start_us;
  opened.first_point = static_cast<std::uint32_t>(block_.points.size() - 1);
  opened.point_count = 1;
  open_ = true;
}

bool ToolpathWriter::Add(const ToolpathPoint& point, std::int64_t at_us) {
  block_.points.push_back(point);
  block_.reached_us.push_back(at_us);
  ++points_;
  ++block_.runs.back().point_count;
  if (block_.points.size() < kToolpathBlockPoints) return false;
  ToolpathRun rest = block_.runs.back();
  block_.runs.back().end_us = at_us;
  Flush();
  if (closed_) return false;
  rest.start_us = at_us;
  Open(rest, point);
  return true;
}

void ToolpathWriter::EndAt(std::int64_t at_us) {
  if (!open_) return;
  block_.runs.back().end_us = at_us;
  if (block_.runs.back().point_count > 1) block_.reached_us.back() = at_us;
}

void ToolpathWriter::Flush() {
  open_ = false;
  DropEmptyRun(block_);
  if (!block_.runs.empty()) {
    const std::string bytes = EncodeToolpathBlock(block_);
    if (bytes_ + bytes.size() > bytes_max_ || !sink_(bytes)) {
      closed_ = true;
    } else {
      bytes_ += bytes.size();
      ++blocks_;
    }
  }
  block_.points.clear();
  block_.reached_us.clear();
  block_.runs.clear();
}

void ToolpathWriter::Finish() {
  if (!closed_) Flush();
}

}  // namespace rmlcell::simulation
