#include "server/worker/material_files.h"

#include <new>
#include <string_view>
#include <utility>

#include "engine/simulation/material/height_grid.h"
#include "engine/simulation/material/height_map.h"
#include "engine/simulation/material/relief.h"
#include "engine/simulation/material/stl.h"
#include "engine/simulation/material/target.h"
#include "proto/bridge/milling.h"
#include "rmlcell/v1/milling.pb.h"

namespace rmlcell::server {
namespace {

using Sink = std::function<bool(std::string_view)>;

// Collects the bytes of one file. Pictures come through libpng, through which nothing may be
// thrown: memory that is used up is noted, and told when it is over.
class Collector {
 public:
  Collector(std::size_t before, const std::function<bool(std::size_t)>& fits)
      : before_(before), fits_(fits) {}

  bool Take(std::string_view bytes) {
    try {
      if (!fits_(before_ + bytes_.size() + bytes.size())) return false;
      bytes_ += bytes;
      return true;
    } catch (const std::bad_alloc&) {
      out_of_memory_ = true;
      return false;
    }
  }

  std::string Bytes() {
    if (out_of_memory_) throw std::bad_alloc();
    return std::move(bytes_);
  }

 private:
  std::size_t before_;
  const std::function<bool(std::size_t)>& fits_;
  std::string bytes_;
  bool out_of_memory_ = false;
};

}  // namespace

std::optional<std::vector<ProductFile>> MaterialFiles(
    const simulation::HeightField& material, const simulation::Target* target,
    const v1::Milling& wanted, const std::function<bool(std::size_t)>& fits) {
  struct File {
    bool wanted;
    const char* name;
    const char* media_type;
    std::function<bool(const Sink&)> write;
  };
  const File files[] = {
      {wanted.relief(), "relief.png", "image/png",
       [&](const Sink& sink) { return simulation::WriteRelief(material, sink); }},
      {wanted.height_map(), "height.png", "image/png",
       [&](const Sink& sink) { return simulation::WriteHeightMap(material, sink); }},
      {wanted.height_grid(), "height.grid", "application/octet-stream",
       [&](const Sink& sink) { return simulation::WriteHeightGrid(material, sink); }},
      {wanted.stl(), "left.stl", "model/stl",
       [&](const Sink& sink) {
         return simulation::WriteStl(material, bridge::StlToleranceOf(wanted), sink);
       }},
      {target != nullptr && wanted.target().picture(), "target.png", "image/png",
       [&](const Sink& sink) { return simulation::WriteDifference(material, *target, sink); }},
  };
  std::vector<ProductFile> made;
  std::size_t together = 0;
  for (const File& file : files) {
    if (!file.wanted) continue;
    Collector collector(together, fits);
    const bool written =
        file.write([&collector](std::string_view bytes) { return collector.Take(bytes); });
    std::string bytes = collector.Bytes();
    if (!written) return std::nullopt;
    together += bytes.size();
    made.push_back({file.name, file.media_type, std::move(bytes)});
  }
  return made;
}

}  // namespace rmlcell::server
