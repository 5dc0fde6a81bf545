#include "server/records/toolpath_levels.h"

#include "engine/simulation/toolpath/toolpath_level.h"
#include "proto/bridge/framing.h"
#include "server/base/names.h"

namespace rmlcell::server {

Status CheckToolpathLevel(int level) {
  if (level >= 0 && level <= simulation::kToolpathLevelMax) return {};
  return InvalidArgument("level is " + std::to_string(level) + ", allowed are 0 to " +
                         std::to_string(simulation::kToolpathLevelMax));
}

std::string ToolpathAtLevel(std::string_view frames, double stored_mm, int level) {
  if (level == 0) return std::string(frames);
  std::string coarse;
  simulation::ToolpathLevel made(simulation::LevelTolerance(stored_mm, level) - stored_mm,
                                 [&](std::string_view block) {
                                   bridge::AddFrame(block, coarse);
                                   return true;
                                 });
  while (const auto frame = bridge::TakeFrame(frames)) {
    const Result<simulation::ToolpathBlock> block = simulation::DecodeToolpathBlock(*frame);
    if (!block) break;
    made.Take(*block);
  }
  made.Finish();
  return coarse;
}

void SetLevel(double stored_mm, int level, std::size_t bytes, v1::ToolpathHeader& header) {
  header.set_level(level);
  header.set_level_max(simulation::kToolpathLevelMax);
  header.set_tolerance_mm(simulation::LevelTolerance(stored_mm, level));
  header.set_bytes(static_cast<std::int64_t>(bytes));
}

void AddLevels(std::string_view frames, double stored_mm, v1::ToolpathHeader& header) {
  for (int level = 0; level <= simulation::kToolpathLevelMax; ++level) {
    v1::ToolpathLevel& one = *header.add_levels();
    one.set_level(level);
    one.set_tolerance_mm(simulation::LevelTolerance(stored_mm, level));
    const std::size_t bytes =
        level == 0 ? frames.size() : ToolpathAtLevel(frames, stored_mm, level).size();
    one.set_bytes(static_cast<std::int64_t>(bytes));
  }
}

}  // namespace rmlcell::server
