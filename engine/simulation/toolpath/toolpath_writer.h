#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "engine/simulation/toolpath/toolpath.h"

namespace rmlcell::simulation {

// Takes one encoded block; the bytes are valid during the call. False: no more.
using ToolpathSink = std::function<bool(std::string_view block)>;

// Puts runs into blocks and hands each out when it is full, in memory of one block.
class ToolpathWriter {
 public:
  // Precondition: `sink` is not empty.
  ToolpathWriter(std::uint64_t bytes_max, ToolpathSink sink);

  // Begins a run with the attributes and the start of `run`, at `first`. One that gets no further
  // point leaves nothing behind.
  void Open(const ToolpathRun& run, const ToolpathPoint& first);

  // The next point of the present run, which is there at `at_us`. True: the block is full with it,
  // and the run goes on from there in the next one.
  bool Add(const ToolpathPoint& point, std::int64_t at_us);
  // Another point in the place of the last one.
  void MoveLast(const ToolpathPoint& point, std::int64_t at_us) {
    block_.points.back() = point;
    block_.reached_us.back() = at_us;
  }
  // The tip is as fast as this somewhere on the present run.
  void Reach(int reached_class) {
    int& most = block_.runs.back().reached_class;
    most = std::max(most, reached_class);
  }
  void EndAt(std::int64_t at_us);
  void Finish();  // hands out what is left

  // The block that is not full yet, encoded as if it were; empty when it has no run.
  std::string OpenBlock() const;

  bool open() const { return open_; }  // there is a present run
  const ToolpathRun& run() const { return block_.runs.back(); }
  const ToolpathPoint& last() const { return block_.points.back(); }

  std::uint64_t points() const { return points_; }
  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t blocks() const { return blocks_; }
  bool closed() const { return closed_; }  // the sink, or the budget, wants no more

 private:
  void Flush();

  std::uint64_t bytes_max_;
  ToolpathSink sink_;
  ToolpathBlock block_;
  bool open_ = false;
  std::uint64_t points_ = 0;
  std::uint64_t bytes_ = 0;
  std::uint64_t blocks_ = 0;
  bool closed_ = false;
};

}  // namespace rmlcell::simulation
