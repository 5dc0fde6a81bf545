#include "storage/content.h"

#include <openssl/evp.h>
#include <zstd.h>

#include "engine/core/check.h"

namespace rmlcell::storage {
namespace {

// The default of zstd: about 300 MB/s on one core, and toolpaths shrink to a fifth. Higher levels
// gain little on numbers and cost several times as much.
constexpr int kLevel = 3;
// Below this a frame saves less room than the time is worth: rows lie in pages of 4 KiB anyway.
constexpr std::size_t kCompressedMin = 512;

// One for each thread: most chunks are small, and making its tables costs more than using them.
ZSTD_CCtx* CompressionOfThread() {
  struct Free {
    void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  };
  thread_local const std::unique_ptr<ZSTD_CCtx, Free> context(ZSTD_createCCtx());
  return context.get();
}

}  // namespace

struct Sha256Sum::State {
  struct Free {
    void operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }
  };
  std::unique_ptr<EVP_MD_CTX, Free> context{EVP_MD_CTX_new()};
};

Sha256Sum::Sha256Sum() : state_(std::make_unique<State>()) {
  RMLCELL_CHECK(EVP_DigestInit_ex(state_->context.get(), EVP_sha256(), nullptr) == 1);
}

Sha256Sum::~Sha256Sum() = default;

void Sha256Sum::Add(std::string_view bytes) {
  RMLCELL_CHECK(EVP_DigestUpdate(state_->context.get(), bytes.data(), bytes.size()) == 1);
}

std::string Sha256Sum::Take() {
  std::string digest(kSha256Bytes, '\0');
  unsigned int size = 0;
  const int done = EVP_DigestFinal_ex(
      state_->context.get(), reinterpret_cast<unsigned char*>(digest.data()), &size);  // NOLINT
  RMLCELL_CHECK(done == 1 && size == kSha256Bytes);
  return digest;
}

std::string Sha256(std::string_view content) {
  Sha256Sum sum;
  sum.Add(content);
  return sum.Take();
}

Result<std::string> Encode(std::string_view chunk) {
  if (chunk.size() < kCompressedMin) return std::string(chunk);
  std::string frame(ZSTD_compressBound(chunk.size()), '\0');
  ZSTD_CCtx* const context = CompressionOfThread();
  const std::size_t size = context == nullptr
                               ? 0
                               : ZSTD_compressCCtx(context, frame.data(), frame.size(),
                                                   chunk.data(), chunk.size(), kLevel);
  if (context == nullptr || ZSTD_isError(size) != 0) {
    return Error{ErrorCode::kCellStoreFailed, "not enough memory to compress", {}};
  }
  if (size >= chunk.size()) return std::string(chunk);
  frame.resize(size);
  frame.shrink_to_fit();
  return frame;
}

Status Decode(std::string_view encoded, std::size_t size, std::string& content) {
  if (encoded.size() == size) {
    content += encoded;
    return {};
  }
  const std::size_t before = content.size();
  content.resize(before + size);
  const std::size_t written =
      ZSTD_decompress(content.data() + before, size, encoded.data(), encoded.size());
  if (written == size) return {};
  content.resize(before);
  return Error{ErrorCode::kCellStoreCorrupt,
               ZSTD_isError(written) != 0 ? ZSTD_getErrorName(written) : "too short",
               {}};
}

}  // namespace rmlcell::storage
