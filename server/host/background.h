#pragma once

#include <functional>
#include <stop_token>
#include <thread>

namespace rmlcell::server {

// One thing at a time that takes a while, on a thread that everything else goes before. It is asked
// to stop when this goes, and waited for.
class Background {
 public:
  // False: something is under way. `work` ends soon when it is to stop, and says Done() at its end,
  // or has somebody say it.
  bool Do(std::function<void(const std::stop_token&)> work);
  void Done() { busy_ = false; }  // on the thread that calls Do()

 private:
  bool busy_ = false;
  std::jthread thread_;
};

// Processor time of the thread that calls, seconds.
double ThreadTime_s();

}  // namespace rmlcell::server
