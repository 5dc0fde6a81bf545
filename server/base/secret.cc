#include "server/base/secret.h"

#include <fcntl.h>
#include <openssl/crypto.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <random>

#include "engine/core/hex.h"

namespace rmlcell::server {

bool KnowsSecret(std::string_view given, std::string_view secret) {
  return !secret.empty() && given.size() == secret.size() &&
         CRYPTO_memcmp(given.data(), secret.data(), secret.size()) == 0;
}

std::string RandomText() {
  std::random_device device;
  std::string text;
  for (int i = 0; i < 32; ++i) text += HexDigit(device());
  return text;
}

Result<std::string> KeptSecret(const std::string& path) {
  {
    std::ifstream file(path);
    std::string secret;
    if (file >> secret && secret.size() >= 32) return secret;
  }
  const std::string made = path + ".new";
  const auto failed = [&path, &made](int number) {
    ::unlink(made.c_str());
    return Error{ErrorCode::kCellConfiguration, path + ": " + std::strerror(number), {}};
  };
  const int file =
      ::open(made.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file < 0) return failed(errno);
  const std::string secret = RandomText();
  const bool written =
      ::write(file, secret.data(), secret.size()) == static_cast<ssize_t>(secret.size()) &&
      ::fsync(file) == 0;
  const int number = errno;
  ::close(file);
  if (!written) return failed(number);
  if (::rename(made.c_str(), path.c_str()) != 0) return failed(errno);
  return secret;
}

}  // namespace rmlcell::server
