#pragma once

#include <array>
#include <cstdint>

#include "engine/rml1/offline/stream_copy.h"

namespace rmlcell::rml1 {

// Device units in X, Y, Z.
using UnitVector = std::array<double, 3>;

// A part of a stream, moved; rewrite.h says what that means. It keeps what it owes: how far the
// tool stands from where the moved program would have it. Absolute coordinates pay that. Where the
// program would cut, or go on relatively, before it is paid, a relative three-axis command is put
// in, which changes neither mode nor tool state. It crosses above the work: where the tool stands
// at the surface or below, it rises to the top first and comes down behind.
class StreamMover final : public PhraseListener {
 public:
  struct Part {
    std::int64_t begin = 0;
    std::int64_t end = 0;
  };
  // `owed`: at the beginning of the part. Power-on: all of `by`.
  StreamMover(const machine::Bytes& stream, const Profile& profile, const UnitVector& by,
              const UnitVector& owed, const Part& part, const ByteSink& sink);

  bool OnPhrase(const Phrase& phrase) override;
  Status Finish() { return copy_.Finish(part_.end); }

 private:
  void PayBefore(const Phrase& phrase);
  void MoveSet(const Phrase& phrase);
  void MoveFixed(const Phrase& phrase);
  void MoveHeights(const Phrase& phrase);
  void UseToolHeight(const Phrase& phrase);
  void Shift(const Phrase::Value& value, std::size_t axis);

  const Profile& profile_;
  UnitVector by_;
  UnitVector owed_;
  Part part_;
  StreamCopy copy_;
  bool z1_given_ = false;  // tool heights that the program gave, and this moved
  bool z2_given_ = false;
};

}  // namespace rmlcell::rml1
