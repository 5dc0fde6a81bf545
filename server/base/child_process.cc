#include "server/base/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace rmlcell::server {

Status CheckProgram(const std::string& program) {
  struct stat file {};
  int failed =
      ::access(program.c_str(), X_OK) != 0 || ::stat(program.c_str(), &file) != 0 ? errno : 0;
  if (failed == 0 && !S_ISREG(file.st_mode)) failed = EACCES;
  if (failed == 0) return {};
  return Error{ErrorCode::kCellConfiguration,
               "workers.program " + program + ": " + std::strerror(failed),
               {}};
}

Result<pid_t> StartChild(std::vector<std::string> words, std::vector<std::string> secrets,
                         const std::string& log) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::vector<char*> environment;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    if (std::strncmp(*entry, "RMLCELL_", 8) != 0) environment.push_back(*entry);
  }
  for (std::string& secret : secrets) environment.push_back(secret.data());
  environment.push_back(nullptr);
  pid_t process = -1;
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (!log.empty()) {
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, log.c_str(),
                                     O_WRONLY | O_CREAT | O_APPEND, S_IRUSR | S_IWUSR);
  }
  posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
  const int failed = posix_spawn(&process, words.front().c_str(), &actions, &attributes,
                                 arguments.data(), environment.data());
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (failed != 0) return Error{ErrorCode::kCellInternal, std::strerror(failed), {}};
  return process;
}

}  // namespace rmlcell::server
