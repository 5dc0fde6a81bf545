// A process that was started without standard input, output or error gets their numbers for the
// next files that it opens: a library's event counter would be read as commands, a database be
// written to as a terminal. They are opened here so that reading and writing fails, before anything
// else opens a file.
#include <fcntl.h>

#include <cerrno>

namespace {

void HoldStandardStreams() {
  for (int stream = 0; stream <= 2; ++stream) {
    if (fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
    // The lowest number that is free is this one. It stays open; the wrong way round nothing goes
    // through it.
    static_cast<void>(open("/dev/null", stream == 0 ? O_WRONLY : O_RDONLY));
  }
}

// Before the libraries are initialised, which open files of their own; constructors come behind
// them.
[[gnu::section(".preinit_array"),
  gnu::used]] void (*const hold_standard_streams)() = HoldStandardStreams;

}  // namespace
