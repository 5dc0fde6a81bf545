#include "server/base/secret.h"

#include <openssl/crypto.h>

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

}  // namespace rmlcell::server
