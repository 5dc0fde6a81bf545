#include "engine/simulation/toolpath/toolpath.h"

#include <cmath>
#include <limits>
#include <string>

#include "engine/core/check.h"
#include "engine/simulation/toolpath/varint.h"

// Layout: docs/toolpath.md.
namespace rmlcell::simulation {
namespace {

constexpr char kMagic = 'T';
constexpr unsigned kUseMask = 3;
constexpr unsigned kBeam = 4;
constexpr unsigned kJoined = 8;
constexpr unsigned kSameProgram = 16;
constexpr unsigned kNoPause = 32;
constexpr unsigned kOnePoint = 64;
constexpr unsigned kSameClass = 128;
// Of the second byte of flags.
constexpr unsigned kSamePower = 1;
constexpr unsigned kSameReached = 2;
constexpr unsigned kTurns = 4;
constexpr unsigned kTimes = 8;
constexpr unsigned kMoreMask = 15;

void PutPoint(std::string& bytes, const ToolpathPoint& from, const ToolpathPoint& to) {
  PutSigned(bytes, std::int64_t{to.x_um} - from.x_um);
  PutSigned(bytes, std::int64_t{to.y_um} - from.y_um);
  PutSigned(bytes, std::int64_t{to.z_um} - from.z_um);
}

void PutAngles(std::string& bytes, const ToolpathPoint& from, const ToolpathPoint& to) {
  PutSigned(bytes, std::int64_t{to.a_urad} - from.a_urad);
  PutSigned(bytes, std::int64_t{to.b_urad} - from.b_urad);
}

double WayBetween(const ToolpathPoint& a, const ToolpathPoint& b) {
  const double x = static_cast<double>(b.x_um) - a.x_um;
  const double y = static_cast<double>(b.y_um) - a.y_um;
  const double z = static_cast<double>(b.z_um) - a.z_um;
  return std::sqrt(x * x + y * y + z * z);
}

// Calls `take(k, us)` for each point of a run behind its first one with the time that is
// proportional to the way; where the tip stands, to the number of points.
template <class Take>
void ForEachEvenTime(const ToolpathBlock& block, const ToolpathRun& run, Take take) {
  const ToolpathPoint* points = &block.points[run.first_point];
  double whole = 0.0;
  for (std::uint32_t k = 1; k < run.point_count; ++k) whole += WayBetween(points[k - 1], points[k]);
  const auto duration = static_cast<double>(run.end_us - run.start_us);
  double done = 0.0;
  for (std::uint32_t k = 1; k < run.point_count; ++k) {
    done += WayBetween(points[k - 1], points[k]);
    const double share =
        whole > 0.0 ? done / whole : static_cast<double>(k) / (run.point_count - 1);
    const bool last = k + 1 == run.point_count;
    take(k, last ? run.end_us : run.start_us + std::llround(share * duration));
  }
}

bool NeedsTimes(const ToolpathBlock& block, const ToolpathRun& run) {
  if (run.point_count <= 2) return false;
  bool needs = false;
  ForEachEvenTime(block, run, [&](std::uint32_t k, std::int64_t even_us) {
    const std::int64_t off = block.reached_us[run.first_point + k] - even_us;
    needs = needs || off > kToolpathTimeTolerance_us || off < -kToolpathTimeTolerance_us;
  });
  return needs;
}

bool TurnsIn(const ToolpathBlock& block, const ToolpathRun& run, const ToolpathPoint& before) {
  for (std::uint32_t k = 0; k < run.point_count; ++k) {
    const ToolpathPoint& point = block.points[run.first_point + k];
    if (point.a_urad != before.a_urad || point.b_urad != before.b_urad) return true;
  }
  return false;
}

// The run begins at the point that the run before it ended with.
bool IsJoined(const ToolpathRun& run, const ToolpathRun* before) {
  return before == nullptr ? run.first_point == 0
                           : run.first_point == before->first_point + before->point_count - 1;
}

Error Corrupt(Detail detail) {
  return Error{ErrorCode::kCellToolpathCorrupt, std::move(detail), {}};
}

// Reads one block; every method is false when the bytes are none.
class BlockReader {
 public:
  explicit BlockReader(std::string_view bytes) : in_(bytes) {}

  Result<ToolpathBlock> Read() {
    const auto magic = in_.Byte();
    const auto version = in_.Byte();
    if (!magic || *magic != static_cast<std::uint8_t>(kMagic)) return Corrupt("not a block");
    if (!version || *version != kToolpathVersion) return Corrupt("another version");
    const auto runs = in_.Varint();
    const auto points = in_.Varint();
    if (!runs || !points || *points > kToolpathBlockPoints || *runs > *points) {
      return Corrupt("more points than a block has");
    }
    points_expected_ = *points;
    const auto start = in_.Varint();
    if (!start || *start > kTimeMax || !ReadPoint(last_) || !ReadAngles(last_))
      return Corrupt("no first point");
    run_.end_us = static_cast<std::int64_t>(*start);
    for (std::uint64_t k = 0; k < *runs; ++k) {
      if (!ReadRun(k == 0)) return Corrupt("run " + Told("run", k + 1) + " cannot be read");
    }
    if (block_.points.size() != points_expected_) return Corrupt("points missing");
    if (!in_.at_end()) return Corrupt("bytes after the last run");
    return std::move(block_);
  }

 private:
  static constexpr std::uint64_t kTimeMax = std::numeric_limits<std::int64_t>::max() / 1000 + 1;

  static bool Step(std::int32_t& value, std::int64_t by) {
    std::int64_t sum = 0;
    if (__builtin_add_overflow(std::int64_t{value}, by, &sum)) return false;
    if (sum < std::numeric_limits<std::int32_t>::min()) return false;
    if (sum > std::numeric_limits<std::int32_t>::max()) return false;
    value = static_cast<std::int32_t>(sum);
    return true;
  }

  bool ReadPoint(ToolpathPoint& point) {
    const auto x = in_.Signed();
    const auto y = in_.Signed();
    const auto z = in_.Signed();
    return x && y && z && Step(point.x_um, *x) && Step(point.y_um, *y) && Step(point.z_um, *z);
  }

  bool ReadAngles(ToolpathPoint& point) {
    const auto a = in_.Signed();
    const auto b = in_.Signed();
    return a && b && Step(point.a_urad, *a) && Step(point.b_urad, *b);
  }

  bool ReadClass(int most, int& value) {
    const auto read = in_.Byte();
    if (!read || *read > most) return false;
    value = *read;
    return true;
  }

  bool ReadInteger(int& value) {
    const auto by = in_.Signed();
    std::int32_t wide = value;
    if (!by || !Step(wide, *by)) return false;
    value = wide;
    return true;
  }

  bool ReadTime(std::int64_t& time) {
    const auto by = in_.Varint();
    if (!by || *by > kTimeMax || time > static_cast<std::int64_t>(kTimeMax - *by)) return false;
    time += static_cast<std::int64_t>(*by);
    return true;
  }

  bool ReadRun(bool first) {
    const auto flags = in_.Byte();
    const auto more = in_.Byte();
    if (!flags || !more || (*more & ~kMoreMask) != 0) return false;
    run_.use = static_cast<machine::MotionUse>(*flags & kUseMask);
    run_.beam_on = (*flags & kBeam) != 0;
    if ((*flags & kSameProgram) == 0 && !ReadInteger(run_.program)) return false;
    if (!ReadInteger(run_.step)) return false;
    if ((*flags & kSameClass) == 0 && !ReadClass(kSpeedClasses, run_.speed_class)) return false;
    if ((*more & kSamePower) == 0 && !ReadClass(kPowerClasses, run_.power_class)) return false;
    if ((*more & kSameReached) == 0 && !ReadClass(kSpeedClasses, run_.reached_class)) return false;
    run_.start_us = run_.end_us;
    if ((*flags & kNoPause) == 0 && !ReadTime(run_.start_us)) return false;
    run_.end_us = run_.start_us;
    if (!ReadTime(run_.end_us)) return false;
    std::uint64_t count = 1;
    if ((*flags & kOnePoint) == 0) {
      const auto given = in_.Varint();
      if (!given) return false;
      count = *given;
    }
    const bool joined = (*flags & kJoined) != 0;
    if (joined && first) AddPoint(run_.start_us);
    if (count < (joined ? 1u : 2u)) return false;
    if (count > points_expected_ || block_.points.size() + count > points_expected_) return false;
    run_.first_point = static_cast<std::uint32_t>(block_.points.size() - (joined ? 1 : 0));
    run_.point_count = static_cast<std::uint32_t>(count + (joined ? 1 : 0));
    if (!ReadPoints(count, joined, (*more & kTurns) != 0, (*more & kTimes) != 0)) return false;
    block_.runs.push_back(run_);
    return true;
  }

  bool ReadPoints(std::uint64_t count, bool joined, bool turns, bool times) {
    std::int64_t at_us = run_.start_us;
    for (std::uint64_t k = 0; k < count; ++k) {
      if (!ReadPoint(last_) || (turns && !ReadAngles(last_))) return false;
      const bool begins = k == 0 && !joined;  // it is there when the run begins
      if (times && !begins && !ReadTime(at_us)) return false;
      if (at_us > run_.end_us) return false;
      AddPoint(at_us);
    }
    if (times) return at_us == run_.end_us;
    ForEachEvenTime(block_, run_, [this](std::uint32_t k, std::int64_t even_us) {
      block_.reached_us[run_.first_point + k] = even_us;
    });
    return true;
  }

  void AddPoint(std::int64_t at_us) {
    block_.points.push_back(last_);
    block_.reached_us.push_back(at_us);
  }

  VarintReader in_;
  ToolpathBlock block_;
  ToolpathRun run_;  // the run before, while one is read
  ToolpathPoint last_;
  std::uint64_t points_expected_ = 0;
};

}  // namespace

Result<ToolpathBlock> DecodeToolpathBlock(std::string_view bytes) {
  return BlockReader(bytes).Read();
}

std::string EncodeToolpathBlock(const ToolpathBlock& block) {
  RMLCELL_CHECK(!block.runs.empty() && block.points.size() <= kToolpathBlockPoints);
  std::string bytes{kMagic, static_cast<char>(kToolpathVersion)};
  PutVarint(bytes, block.runs.size());
  PutVarint(bytes, block.points.size());
  PutVarint(bytes, static_cast<std::uint64_t>(block.runs.front().start_us));
  ToolpathPoint last = block.points.front();
  PutPoint(bytes, {}, last);
  PutAngles(bytes, {}, last);

  ToolpathRun before;
  before.end_us = block.runs.front().start_us;
  for (std::size_t k = 0; k < block.runs.size(); ++k) {
    const ToolpathRun& run = block.runs[k];
    const bool joined = IsJoined(run, k == 0 ? nullptr : &before);
    const std::uint32_t count = run.point_count - (joined ? 1u : 0u);
    unsigned flags = static_cast<unsigned>(run.use) & kUseMask;
    if (run.beam_on) flags |= kBeam;
    if (joined) flags |= kJoined;
    if (run.program == before.program) flags |= kSameProgram;
    if (run.start_us == before.end_us) flags |= kNoPause;
    if (count == 1) flags |= kOnePoint;
    if (run.speed_class == before.speed_class) flags |= kSameClass;
    const bool turns = TurnsIn(block, run, last);
    const bool times = NeedsTimes(block, run);
    unsigned more = 0;
    if (run.power_class == before.power_class) more |= kSamePower;
    if (run.reached_class == before.reached_class) more |= kSameReached;
    if (turns) more |= kTurns;
    if (times) more |= kTimes;
    bytes += static_cast<char>(static_cast<unsigned char>(flags));
    bytes += static_cast<char>(static_cast<unsigned char>(more));
    if ((flags & kSameProgram) == 0) PutSigned(bytes, std::int64_t{run.program} - before.program);
    PutSigned(bytes, std::int64_t{run.step} - before.step);
    if ((flags & kSameClass) == 0) bytes += static_cast<char>(run.speed_class);
    if ((more & kSamePower) == 0) bytes += static_cast<char>(run.power_class);
    if ((more & kSameReached) == 0) bytes += static_cast<char>(run.reached_class);
    if ((flags & kNoPause) == 0) {
      PutVarint(bytes, static_cast<std::uint64_t>(run.start_us - before.end_us));
    }
    PutVarint(bytes, static_cast<std::uint64_t>(run.end_us - run.start_us));
    if ((flags & kOnePoint) == 0) PutVarint(bytes, count);
    for (std::uint32_t i = run.point_count - count; i < run.point_count; ++i) {
      const ToolpathPoint& point = block.points[run.first_point + i];
      PutPoint(bytes, last, point);
      if (turns) PutAngles(bytes, last, point);
      if (times && i > 0) {
        const std::int64_t since = TimeOf(block, run, i) - TimeOf(block, run, i - 1);
        PutVarint(bytes, static_cast<std::uint64_t>(since));
      }
      last = point;
    }
    before = run;
  }
  return bytes;
}

}  // namespace rmlcell::simulation
