#pragma once

#include <cstddef>
#include <string_view>

#include "engine/rml1/device.h"

namespace rmlcell::rml1 {

// The other end of the link: hands a stored stream to a device byte by byte, so that nothing of the
// program is held but the byte in hand (RML1-9.06).
class Sender {
 public:
  std::size_t sent() const { return sent_; }
  bool done(std::string_view stream) const { return sent_ == stream.size(); }

  // Precondition: not done.
  void SendByte(Device& device, std::string_view stream, DeviceListener& listener) {
    const auto byte = static_cast<unsigned char>(stream[sent_]);
    device.Receive(byte, static_cast<std::int64_t>(sent_), listener);
    ++sent_;
  }

  // While the device is paused the sender goes on until flow control stops it (RML1-9.35). Two
  // places are kept free: a byte behind ESC may bring the ESC with it.
  void FillBuffer(Device& device, std::string_view stream, DeviceListener& listener) {
    constexpr std::size_t kSpare = 2;
    while (!done(stream) && device.room() >= kSpare) SendByte(device, stream, listener);
  }

 private:
  std::size_t sent_ = 0;
};

}  // namespace rmlcell::rml1
