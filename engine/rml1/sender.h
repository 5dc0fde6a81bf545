#pragma once

#include <cstddef>
#include <string_view>

#include "engine/machine/bytes.h"
#include "engine/rml1/device.h"

namespace rmlcell::rml1 {

// The other end of the link: hands a stored stream to a device, so that nothing of the program is
// held but the byte in hand (RML1-9.06).
class Sender {
 public:
  // Bytes that the device has seen, and those of them that it need not see again.
  std::size_t sent() const { return given_ + (in_hand_ ? 1 : 0); }
  std::size_t given() const { return given_; }
  bool done(std::string_view stream) const { return given_ == stream.size(); }

  // As many bytes as Device::Read takes, and no more than up to `sent_max`. Preconditions: not
  // done; fewer were given; and those of Read.
  void Send(Device& device, std::string_view stream, std::size_t sent_max, std::uint64_t commands,
            DeviceListener& listener) {
    const Device::Taken taken = device.Read(stream.substr(given_, sent_max - given_),
                                            static_cast<std::int64_t>(given_), commands, listener);
    given_ += taken.bytes;
    in_hand_ = taken.next;
  }

  // While the device is paused the sender goes on until flow control stops it (RML1-9.35). Two
  // places are kept free: a byte behind ESC may bring the ESC with it.
  void FillBuffer(Device& device, machine::Bytes& stream, DeviceListener& listener) {
    constexpr std::size_t kSpare = 2;
    for (; device.room() >= kSpare; ++given_) {
      stream.ReadOn(given_ + 2);  // it is not over where only what has come is
      if (done(*stream)) return;
      const auto byte = static_cast<unsigned char>((*stream)[given_]);
      device.Receive(byte, static_cast<std::int64_t>(given_), listener);
      in_hand_ = false;
    }
  }

 private:
  std::size_t given_ = 0;
  bool in_hand_ = false;  // the byte behind these has been looked at
};

}  // namespace rmlcell::rml1
