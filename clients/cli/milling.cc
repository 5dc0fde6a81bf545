#include "clients/cli/milling.h"

#include <fstream>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "clients/cli/program_files.h"
#include "engine/simulation/material/height_map.h"
#include "engine/simulation/material/milling_text.h"
#include "engine/simulation/material/relief.h"
#include "engine/simulation/material/standard_cell.h"
#include "engine/simulation/material/stl.h"
#include "engine/simulation/material/target_files.h"
#include "engine/simulation/run/milled_target.h"
#include "proto/bridge/files.h"
#include "proto/bridge/milling.h"

namespace rmlcell::cli {
namespace {

using Sink = std::function<bool(std::string_view)>;

// Lets `write` hand the bytes of a file over in portions.
Status WritePortions(const std::string& file, const std::function<bool(const Sink&)>& write) {
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  const bool written = write([&stream](std::string_view bytes) {
    return static_cast<bool>(
        stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size())));
  });
  stream.close();
  if (!written || !stream)
    return Error{ErrorCode::kCellFileUnwritable, file + ": cannot be written", {}};
  return {};
}

Error WithFile(const std::string& file, Error error) {
  error.detail = "--target " + file + ": " + error.detail;
  return error;
}

// What another program leaves of the same block.
Result<std::vector<float>> MilledBy(const std::string& file,
                                    const simulation::ProgramMemory& machine,
                                    const simulation::Milling& milling) {
  const Result<LoadedFiles> loaded =
      LoadFiles({file}, {}, 0, std::string(machine.family->info().id));
  if (!loaded) return loaded.error();
  simulation::ProgramMemory memory = machine;
  memory.programs = loaded->programs;
  memory.machine_state.clear();
  return simulation::MilledTarget(
      memory, {.main_program = loaded->main_slot, .mode = machine::Mode::kCycle}, milling);
}

// A height map, a body, or what another program leaves.
Result<simulation::Target> TargetOf(const MillingOptions& options,
                                    const simulation::ProgramMemory& machine,
                                    const simulation::Milling& milling) {
  constexpr std::uint64_t kTargetBytesMax = 1u << 30;
  const Result<std::string> bytes = bridge::ReadFile(options.block.target, kTargetBytesMax);
  if (!bytes) return bytes.error();
  const bool read = simulation::IsTargetFile(*bytes, options.block.target);
  Result<std::vector<float>> heights = read ? simulation::ReadTarget(*bytes, milling.stock)
                                            : MilledBy(options.block.target, machine, milling);
  if (!heights) return WithFile(options.block.target, heights.error());
  return simulation::Target{
      .heights = std::make_shared<const std::vector<float>>(*std::move(heights)),
      .tolerance_mm =
          options.block.target_tolerance_mm.value_or(bridge::kTargetToleranceStandard_mm)};
}

}  // namespace

Result<simulation::Milling> MillingOf(const MillingOptions& options,
                                      const machine::MachineShape& shape,
                                      const simulation::ProgramMemory& machine) {
  if (!shape.has_work_origin)
    return InvalidArgument("--stock is for mills: this machine removes no material");
  Result<simulation::Stock> stock = simulation::ParseStock(options.block.stock);
  if (!stock) return stock.error();
  Result<simulation::MillTool> tool = simulation::ParseTool(options.block.tool);
  if (!tool) return tool.error();
  stock->cell = options.block.cell_mm.value_or(simulation::StandardCell(*stock, *tool));
  simulation::Milling milling{.stock = *stock, .tool = *tool, .rpm = options.block.rpm};
  if (!options.block.material.empty()) {
    const auto chips = simulation::ChipsOf(options.block.material, 2.0 * tool->radius_mm);
    if (!chips) return chips.error();
    milling.chips = *chips;
  }
  if (const Status sound = simulation::CheckMilling(milling); !sound) return sound.error();
  if (options.block.target.empty()) return milling;
  Result<simulation::Target> target = TargetOf(options, machine, milling);
  if (!target) return target.error();
  milling.target = *std::move(target);
  if (const Status sound = simulation::CheckMilling(milling); !sound) return sound.error();
  return milling;
}

Status WriteMaterial(const simulation::HeightField& material,
                     const std::optional<simulation::Target>& target, const MillingOptions& options,
                     simulation::ParallelFor& parallel) {
  struct Product {
    const std::string& file;
    std::function<bool(const Sink&)> write;
  };
  const std::string none;
  const Product products[] = {
      {options.stl,
       [&](const Sink& sink) {
         return simulation::WriteStl(material, options.stl_tolerance_mm, sink, &parallel);
       }},
      {options.relief, [&](const Sink& sink) { return simulation::WriteRelief(material, sink); }},
      {options.height_map,
       [&](const Sink& sink) { return simulation::WriteHeightMap(material, sink); }},
      {target ? options.target_png : none,
       [&](const Sink& sink) { return simulation::WriteDifference(material, *target, sink); }},
  };
  for (const Product& product : products) {
    if (product.file.empty()) continue;
    if (const Status written = WritePortions(product.file, product.write); !written)
      return written.error();
  }
  return {};
}

}  // namespace rmlcell::cli
