#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/result.h"

// Contents as they lie in the store: named by their SHA-256, cut into chunks of kChunkBytes, each
// chunk encoded for itself.
namespace rmlcell::storage {

// One row of the database holds one chunk. Large enough that rows are few, small enough that
// neither reader nor writer has to hold or write a whole program of 256 MiB at once.
inline constexpr std::size_t kChunkBytes = std::size_t{1} << 20;

// An encoded content up to this size lies in the row that names it: a page of the database holds
// it, and rows of its own would be one more page to write with each job.
inline constexpr std::size_t kContentInRowMax = std::size_t{2} << 10;

// The same of what a job made: with its names the row of an artifact still fits on its page.
inline constexpr std::size_t kProductInRowMax = std::size_t{7} << 9;

// A specification, state or body up to this size is kept in its record, not shared and not
// compressed.
inline constexpr std::size_t kContentInRecordMax = std::size_t{16} << 10;

inline std::size_t ChunkCount(std::size_t bytes) { return (bytes + kChunkBytes - 1) / kChunkBytes; }
inline std::string_view Chunk(std::string_view content, std::size_t number) {
  return content.substr(number * kChunkBytes, kChunkBytes);
}

inline constexpr std::size_t kSha256Bytes = 32;
std::string Sha256(std::string_view content);

// The same of a content that comes piece by piece.
class Sha256Sum {
 public:
  Sha256Sum();
  ~Sha256Sum();
  Sha256Sum(const Sha256Sum&) = delete;
  Sha256Sum& operator=(const Sha256Sum&) = delete;

  void Add(std::string_view bytes);
  std::string Take();  // once

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// One chunk as a zstd frame, or as it is where that is not smaller or would not pay. So what has
// the size of the chunk is the chunk. Errors: CellStoreFailed, out of memory.
Result<std::string> Encode(std::string_view chunk);

// Appends a chunk of `size` bytes. CellStoreCorrupt when `encoded` is not one; then `content` is as
// before.
Status Decode(std::string_view encoded, std::size_t size, std::string& content);

}  // namespace rmlcell::storage
