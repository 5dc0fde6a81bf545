#include "clients/cli/milling.h"

#include <fstream>
#include <functional>

#include "engine/simulation/material/height_map.h"
#include "engine/simulation/material/milling_text.h"
#include "engine/simulation/material/relief.h"
#include "engine/simulation/material/stl.h"

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

}  // namespace

Result<simulation::Milling> MillingOf(const MillingOptions& options,
                                      const machine::MachineShape& shape) {
  if (!shape.has_work_origin)
    return InvalidArgument("--stock is for mills: this machine takes nothing off a block");
  Result<simulation::Stock> stock = simulation::ParseStock(options.stock);
  if (!stock) return stock.error();
  Result<simulation::MillTool> tool = simulation::ParseTool(options.tool);
  if (!tool) return tool.error();
  stock->cell = options.cell_mm;
  simulation::Milling milling{.stock = *stock, .tool = *tool};
  if (Status sound = simulation::CheckMilling(milling); !sound) return sound.error();
  return milling;
}

Status WriteMaterial(const simulation::HeightField& material, const MillingOptions& options) {
  struct Product {
    const std::string& file;
    std::function<bool(const Sink&)> write;
  };
  const Product products[] = {
      {options.stl,
       [&](const Sink& sink) {
         return simulation::WriteStl(material, options.stl_tolerance_mm, sink);
       }},
      {options.relief, [&](const Sink& sink) { return simulation::WriteRelief(material, sink); }},
      {options.height_map,
       [&](const Sink& sink) { return simulation::WriteHeightMap(material, sink); }},
  };
  for (const Product& product : products) {
    if (product.file.empty()) continue;
    if (Status written = WritePortions(product.file, product.write); !written) return written;
  }
  return {};
}

}  // namespace rmlcell::cli
