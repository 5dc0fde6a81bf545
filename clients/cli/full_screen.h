#pragma once

#include <sys/types.h>
#include <termios.h>

#include <functional>
#include <string>
#include <string_view>

#include "engine/core/result.h"

// A terminal that is taken whole for a while, and given back as it was.
namespace rmlcell::cli {

// Raw bytes in, an empty screen of its own, with the mouse, from here until this is deleted.
// Standard input and output are the terminal.
class FullScreen {
 public:
  // Errors: CellInvalidArgument, they are none.
  static Status Check();
  FullScreen();
  ~FullScreen();
  FullScreen(const FullScreen&) = delete;
  FullScreen& operator=(const FullScreen&) = delete;

  // False: the terminal has gone.
  bool Write(std::string_view text) const;
  struct Size {
    int rows = 0;
    int columns = 0;
    bool operator==(const Size&) const = default;
  };
  static Size Now();

 private:
  termios before_{};
};

// Does something in a process of its own, and waits for it. However that ends, also by a SIGKILL,
// the terminal is as it was: who dies like that cannot do it. What it returns is the exit code.
// Orders to end (SIGINT, SIGTERM, SIGHUP, SIGQUIT) are blocked in both; `work` gets them by
// EndSignals(), those for the process that waits, too, and as SIGTERM when that one is killed.
// Precondition: there is one thread.
int WithTerminalGuarded(const std::function<int()>& work);

// Of SIGINT, SIGTERM, SIGHUP, SIGQUIT and SIGWINCH: a descriptor that can be read when one has
// come; below 0: there is none.
int EndSignals();
// One that has come; 0: none.
int TakeSignal(int descriptor);

}  // namespace rmlcell::cli
