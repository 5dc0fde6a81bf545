// Whether anything goes on in the process of a test: how a test shows that something does NOT
// happen, without a guess at how long that would take.
#pragma once

#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <thread>

namespace rmlcell {

// How often each thread but the calling one has gone to sleep; nothing: one of them does not sleep.
// proc(5)
inline std::optional<std::map<std::string, std::string>> SleepsOfOthers() {
  std::map<std::string, std::string> sleeps;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task", error)) {
    const std::string thread = entry.path().filename();
    if (thread == std::to_string(::gettid())) continue;
    std::ifstream file(entry.path() / "status");
    for (std::string line; std::getline(file, line);) {
      if (line.starts_with("State:") && !line.starts_with("State:\tS")) return std::nullopt;
      if (line.starts_with("voluntary_ctxt_switches:")) sleeps[thread] = line;
    }
  }
  return error ? std::nullopt : std::optional(sleeps);
}

// Until all other threads sleep at the same time: whatever was to be done is done, or waits for
// something that has not come. Whoever is woken is seen awake from then on. False: they do not
// within a minute, which only a failing test takes.
inline bool ComesToRest() {
  const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (std::chrono::steady_clock::now() < until) {
    const auto before = SleepsOfOthers();
    if (before && SleepsOfOthers() == before) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

}  // namespace rmlcell
