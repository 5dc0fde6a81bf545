#pragma once

#include "engine/rml1/offline/stream_copy.h"

namespace rmlcell::rml1 {

// A stream with its lengths scaled (rewrite.h). Of each axis it keeps by how much the rounded place
// is short of the exact one, and a relative coordinate makes that good.
class StreamScaler final : public PhraseListener {
 public:
  StreamScaler(const machine::Bytes& stream, double factor, const ByteSink& sink)
      : factor_(factor), copy_(stream, 0, sink) {}

  bool OnPhrase(const Phrase& phrase) override;
  Status Finish(std::int64_t end) { return copy_.Finish(end); }

 private:
  void ScaleSet(const Phrase& phrase);
  void ScaleFixed(const Phrase& phrase);
  // Returns what the rounded number is short of.
  double Replace(const Phrase::Value& value, double exact);

  double factor_;
  StreamCopy copy_;
  // In new units: of the place in X, Y, Z, of the tool heights, and of Z0.
  std::array<double, 3> short_{};
  double short_z1_ = 0.0;
  double short_z2_ = 0.0;
  double short_z0_ = 0.0;
};

}  // namespace rmlcell::rml1
