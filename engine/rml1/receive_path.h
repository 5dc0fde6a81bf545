#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace rmlcell::rml1 {

// Communication errors that a byte can raise (RML1-4.20).
enum class LinkError : std::uint8_t {
  kNone = 0,
  kBadSequence = 11,
  kBadParameter = 12,
  kParameterOverflow = 13,
  kTooManyParameters = 14,
  kLine = 15,      // framing, parity, overrun: told by the transport
  kOverflow = 16,  // the receive buffer was full: bytes are lost
};

// What one received byte brought about: up to two bytes for the data buffer, up to two errors, or
// ESC.K. The bytes are `bytes[0..count)`; `back` tells how far before the present one each lies.
struct Received {
  struct DataByte {
    unsigned char byte = 0;
    std::uint8_t back = 0;
  };
  std::array<DataByte, 2> bytes{};
  std::uint8_t count = 0;
  std::array<LinkError, 2> errors{};  // kNone where there is none
  bool abort = false;                 // ESC.K
};

// The way of a byte from the link to the data buffer: strips the top bit on a link of 7 data bits
// (RML1-1.12) and takes out device control sequences, ESC . and a character (RML1-4.01 to 4.19). It
// is the same for a serial, a parallel and a network link (RML1-4.24). A few bytes of state.
class ReceivePath {
 public:
  // ESC.M takes 6 parameters, ESC.T takes 5. Nothing: the default.
  static constexpr int kParametersMax = 6;
  using Parameters = std::array<std::optional<int>, kParametersMax>;

  // `all_sequences`: accept ESC.M and ESC.T too, as sequences without effect (RML1-9.37).
  ReceivePath(bool seven_bits, bool all_sequences)
      : seven_bits_(seven_bits), all_sequences_(all_sequences) {}

  Received Put(unsigned char byte);

  // The byte as it goes to the data buffer, when it is no part of a sequence: what Put would say,
  // for nearly every byte of a program at a tenth of the cost. Nothing: ask Put.
  std::optional<unsigned char> Plain(unsigned char byte) const {
    const unsigned char data = seven_bits_ ? byte & 0x7F : byte;
    if (state_ != State::kPlain || data == kEscape) return std::nullopt;
    return data;
  }

  // Bytes that go to the data buffer as they are, whatever the link, outside of a sequence.
  static bool AlwaysPasses(char byte) {
    return static_cast<signed char>(byte) >= 0 && byte != kEscape;
  }

  bool pending() const { return state_ != State::kPlain; }

  // What the last such sequence left; the first 6 or 5 entries count.
  const Parameters& esc_m() const { return esc_m_; }
  const Parameters& esc_t() const { return esc_t_; }

 private:
  enum class State : std::uint8_t { kPlain, kEscape, kPeriod, kParameters };
  static constexpr unsigned char kEscape = 0x1B;
  static constexpr int kValueMax = 65535;

  Received AfterEscape(unsigned char byte);
  Received AfterPeriod(unsigned char byte);
  Received InParameters(unsigned char byte);
  LinkError SetParameter();
  void BeginParameter();

  bool seven_bits_;
  bool all_sequences_;
  State state_ = State::kPlain;
  bool for_esc_m_ = false;
  bool surplus_ = false;  // more parameters than the sequence takes
  bool given_ = false;    // the parameter in progress has a digit
  int index_ = 0;
  int value_ = 0;  // stops above kValueMax
  Parameters esc_m_{};
  Parameters esc_t_{};
};

}  // namespace rmlcell::rml1
