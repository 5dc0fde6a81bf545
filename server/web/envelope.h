#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

// The 5-byte envelopes that gRPC-Web and Connect streams share: one byte of flags, a length of four
// bytes with the highest first, and the message.
namespace rmlcell::web {

inline constexpr std::size_t kEnvelopeHeaderBytes = 5;
inline constexpr std::uint8_t kEnvelopeCompressed = 0x01;
inline constexpr std::uint8_t kConnectEndStream = 0x02;
inline constexpr std::uint8_t kGrpcWebTrailers = 0x80;

// Precondition: the message is shorter than 4 GiB; gRPC's own limit is lower.
std::string MakeEnvelope(std::uint8_t flags, std::string_view message);

// What a request body of one envelope holds.
struct EnvelopeRead {
  std::optional<std::string_view> message;  // a view into the body
  std::string_view problem;                 // why there is none
  bool compressed = false;                  // the problem is a compression that is not offered
};

// The one message of a unary or server-streaming request. A body of zero bytes, a second message, a
// length that does not fit and unknown flags are problems. Zero bytes inside an envelope are a
// message.
EnvelopeRead ReadSingleEnvelope(std::string_view body);

}  // namespace rmlcell::web
