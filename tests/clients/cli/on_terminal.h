#pragma once

#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <cstdio>
#include <functional>
#include <stdexcept>
#include <string>

namespace rmlcell::cli {

// What `draw` writes to a descriptor while that is a terminal. It must be less than a terminal
// keeps, 4 KiB.
inline std::string OnTerminal(int descriptor, std::FILE* stream,
                              const std::function<void()>& draw) {
  termios raw{};
  ::cfmakeraw(&raw);
  int outside = -1;
  int inside = -1;
  if (::openpty(&outside, &inside, nullptr, &raw, nullptr) != 0)
    throw std::runtime_error("no terminal");
  std::fflush(stream);
  const int kept = ::dup(descriptor);
  ::dup2(inside, descriptor);
  draw();
  std::fflush(stream);
  ::dup2(kept, descriptor);
  ::close(kept);
  ::close(inside);
  std::string text;
  char room[4096];
  for (ssize_t size = 0; (size = ::read(outside, room, sizeof room)) > 0;)
    text.append(room, static_cast<std::size_t>(size));
  ::close(outside);
  return text;
}
inline std::string OnErrors(const std::function<void()>& draw) {
  return OnTerminal(STDERR_FILENO, stderr, draw);
}

}  // namespace rmlcell::cli
