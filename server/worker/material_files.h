#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rmlcell::simulation {
class HeightField;
struct Target;
}  // namespace rmlcell::simulation
namespace rmlcell::v1 {
class Milling;
}  // namespace rmlcell::v1

namespace rmlcell::server {

// A product of a job as it is sent.
struct ProductFile {
  std::string name;        // "relief.png"
  std::string media_type;  // "image/png"
  std::string bytes;
};

// What a job wants of what is left of its block: the relief, then the heights, the body, and the
// picture of what differs from `target`, which is null where there is none. `fits` is asked before
// any bytes are kept, with how many that makes of all files together, and some times a second while
// there are none; nothing is returned as soon as it says no. Throws std::bad_alloc beyond the
// memory of the job.
std::optional<std::vector<ProductFile>> MaterialFiles(const simulation::HeightField& material,
                                                      const simulation::Target* target,
                                                      const v1::Milling& wanted,
                                                      const std::function<bool(std::size_t)>& fits);

}  // namespace rmlcell::server
