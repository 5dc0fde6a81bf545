#include "engine/machine/bytes.h"

namespace rmlcell::machine {
namespace {

class InMemory final : public BytesKeeper {
 public:
  explicit InMemory(std::string bytes) : bytes_(std::move(bytes)) {}
  std::string_view bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace

Bytes Bytes::Of(std::string bytes) {
  auto keeper = std::make_shared<const InMemory>(std::move(bytes));
  const std::string_view view = keeper->bytes();
  return {std::move(keeper), view};
}

}  // namespace rmlcell::machine
