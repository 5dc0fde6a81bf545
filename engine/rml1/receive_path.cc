#include "engine/rml1/receive_path.h"

#include <algorithm>

namespace rmlcell::rml1 {
namespace {

constexpr int kEscMParameters = 6;
constexpr int kEscTParameters = 5;

Received Data(unsigned char byte) { return {.bytes = {{{byte, 0}, {}}}, .count = 1}; }

}  // namespace

Received ReceivePath::Put(unsigned char byte) {
  if (seven_bits_) byte &= 0x7F;
  switch (state_) {
    case State::kPlain:
      if (byte != kEscape) return Data(byte);
      state_ = State::kEscape;
      return {};
    case State::kEscape:
      return AfterEscape(byte);
    case State::kPeriod:
      return AfterPeriod(byte);
    case State::kParameters:
      return InParameters(byte);
  }
  return {};
}

// RML1-4.02, RML1-4.04.
Received ReceivePath::AfterEscape(unsigned char byte) {
  if (byte == '.') {
    state_ = State::kPeriod;
    return {};
  }
  if (byte == kEscape) return {.bytes = {{{kEscape, 1}, {}}}, .count = 1};
  state_ = State::kPlain;
  return {.bytes = {{{kEscape, 1}, {byte, 0}}}, .count = 2};
}

// RML1-4.05 to 4.08.
Received ReceivePath::AfterPeriod(unsigned char byte) {
  if (byte == 'K') {
    state_ = State::kPlain;
    return {.abort = true};
  }
  if (all_sequences_ && (byte == 'M' || byte == 'T')) {
    for_esc_m_ = byte == 'M';
    (for_esc_m_ ? esc_m_ : esc_t_).fill(std::nullopt);
    index_ = 0;
    surplus_ = false;
    BeginParameter();
    state_ = State::kParameters;
    return {};
  }
  state_ = byte == kEscape ? State::kEscape : State::kPlain;
  Received received = byte == kEscape ? Received{} : Data(byte);
  received.errors[0] = LinkError::kBadSequence;
  return received;
}

// RML1-4.13 to 4.19.
Received ReceivePath::InParameters(unsigned char byte) {
  if (byte >= '0' && byte <= '9') {
    given_ = true;
    value_ = std::min(value_ * 10 + (byte - '0'), kValueMax + 1);
    return {};
  }
  Received received;
  if (byte == ';') {
    if (surplus_) return {};
    received.errors[0] = SetParameter();
    ++index_;
    surplus_ = index_ == (for_esc_m_ ? kEscMParameters : kEscTParameters);
    if (surplus_) received.errors[1] = LinkError::kTooManyParameters;
    BeginParameter();
    return received;
  }
  if (byte == ':') {
    if (!surplus_) received.errors[0] = SetParameter();
    state_ = State::kPlain;
    return received;
  }
  state_ = byte == kEscape ? State::kEscape : State::kPlain;
  if (byte != kEscape) received = Data(byte);
  received.errors[0] = LinkError::kBadParameter;
  return received;
}

LinkError ReceivePath::SetParameter() {
  if (!given_) return LinkError::kNone;
  if (value_ > kValueMax) return LinkError::kParameterOverflow;
  (for_esc_m_ ? esc_m_ : esc_t_)[static_cast<std::size_t>(index_)] = value_;
  return LinkError::kNone;
}

void ReceivePath::BeginParameter() {
  given_ = false;
  value_ = 0;
}

}  // namespace rmlcell::rml1
