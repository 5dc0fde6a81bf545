#include "server/web/envelope.h"

namespace rmlcell::web {

std::string MakeEnvelope(std::uint8_t flags, std::string_view message) {
  std::string out;
  out.reserve(kEnvelopeHeaderBytes + message.size());
  out += static_cast<char>(flags);
  for (const unsigned shift : {24U, 16U, 8U, 0U}) {
    out += static_cast<char>((message.size() >> shift) & 0xFFU);
  }
  out += message;
  return out;
}

EnvelopeRead ReadSingleEnvelope(std::string_view body) {
  if (body.size() < kEnvelopeHeaderBytes) {
    return {.message = {}, .problem = "the body holds no whole envelope"};
  }
  const auto flags = static_cast<std::uint8_t>(body[0]);
  std::size_t length = 0;
  for (std::size_t i = 1; i < kEnvelopeHeaderBytes; ++i) {
    length = length << 8U | static_cast<unsigned char>(body[i]);
  }
  body.remove_prefix(kEnvelopeHeaderBytes);
  if ((flags & kEnvelopeCompressed) != 0) {
    return {.message = {}, .problem = "compressed messages are not offered", .compressed = true};
  }
  if (flags != 0) return {.message = {}, .problem = "the envelope has unknown flags"};
  if (length > body.size()) return {.message = {}, .problem = "the body ends inside its message"};
  if (length < body.size()) return {.message = {}, .problem = "more than one message"};
  return {.message = body, .problem = {}};
}

}  // namespace rmlcell::web
