#include "clients/cli/milling.h"

#include <fstream>

#include "engine/simulation/material/milling_text.h"
#include "engine/simulation/material/stl.h"

namespace rmlcell::cli {

Result<simulation::Milling> MillingOf(const SimulateOptions& options,
                                      const machine::MachineShape& shape) {
  if (!shape.has_work_origin)
    return InvalidArgument("--stock is for mills: this machine removes no material");
  Result<simulation::Stock> stock = simulation::ParseStock(options.stock);
  if (!stock) return stock.error();
  Result<simulation::MillTool> tool = simulation::ParseTool(options.tool);
  if (!tool) return tool.error();
  stock->cell = options.cell_mm;
  simulation::Milling milling{.stock = *stock, .tool = *tool};
  if (Status sound = simulation::CheckMilling(milling); !sound) return sound.error();
  return milling;
}

Status WriteMaterial(const simulation::HeightField& material, const std::string& file) {
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  const bool written = simulation::WriteStl(material, [&stream](std::string_view bytes) {
    return static_cast<bool>(
        stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size())));
  });
  stream.close();
  if (!written || !stream)
    return Error{ErrorCode::kCellFileUnwritable, file + ": cannot be written", {}};
  return {};
}

}  // namespace rmlcell::cli
