#pragma once

#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "engine/core/result.h"

namespace google::protobuf {
class Descriptor;
}

namespace rmlcell::web {

// Messages of streams as server-sent events; those of what happens in the cell are made once for
// all who are told the same. One that tells of several events (rmlcell.v1.CellEvents) becomes
// several. Thread-safe.
class EventTexts {
 public:
  static constexpr std::size_t kBytesMax = std::size_t{8} << 20;   // messages and texts, kept
  static constexpr std::size_t kKeptMax = std::size_t{256} << 10;  // of one

  using Text = std::shared_ptr<const std::string>;
  // Errors: CellInternal when the bytes are not a message of this type.
  Result<Text> Of(const google::protobuf::Descriptor& type, std::string_view bytes);

  std::size_t made() const;  // of what happens, so far

 private:
  Text Find(std::string_view bytes);  // null: there is none
  void Keep(std::string_view bytes, const Text& text);

  using Texts = std::map<std::string, Text, std::less<>>;

  mutable std::mutex mutex_;
  Texts texts_;                        // by the message
  std::deque<Texts::iterator> order_;  // the oldest first
  std::size_t bytes_ = 0;
  std::size_t made_ = 0;
};

}  // namespace rmlcell::web
