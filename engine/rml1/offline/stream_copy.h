#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "engine/rml1/offline/stream_walk.h"
#include "engine/rml1/offline/text_parts.h"

namespace rmlcell::rml1 {

// A part of a stream, byte for byte, with some numbers replaced and some text put in. Places are
// those of the stream and must come in ascending order. The first error is kept, and nothing more
// is copied. The stream and the sink must outlive it.
class StreamCopy {
 public:
  StreamCopy(const machine::Bytes& stream, std::int64_t begin, const ByteSink& sink)
      : stream_(stream), text_(sink), next_(begin) {}

  // A number that the device read; it keeps its meaning with what stands around it. `whole`: the
  // text has no fraction. Errors: Rml1NotRewritten for a lone period, for a number with bytes in it
  // that the machine takes out, and for a value outside of the range of coordinates.
  void Replace(const Phrase::Value& number, double value);
  // Before the command whose name begins at `at`.
  void Insert(std::int64_t at, std::string_view text);
  void Refuse(Detail detail, std::int64_t at);

  // Up to `end`.
  Status Finish(std::int64_t end);
  bool failed() const { return error_.has_value(); }

 private:
  bool CopyUpTo(std::int64_t end);

  const machine::Bytes& stream_;
  TextParts text_;
  std::int64_t next_;  // the first byte that is not copied yet
  std::optional<Error> error_;
};

// A command that a rewriting tool cannot follow, because parts of it were not carried out; the
// detail says which. Nothing: it can.
std::optional<Detail> WhyNotFollowed(const Phrase& phrase);

inline constexpr std::size_t kAxisX = 0;
inline constexpr std::size_t kAxisY = 1;
inline constexpr std::size_t kAxisZ = 2;
// Of a value, the one at `index` of its set; nothing: of the rotary axis, or of one that no machine
// has.
std::optional<std::size_t> AxisOf(const Phrase::Value& value, std::size_t index);

// Whether the numbers of a set count from the present place.
bool IsRelative(const Phrase& phrase);

}  // namespace rmlcell::rml1
