#include "server/base/secret.h"

#include <openssl/crypto.h>

namespace rmlcell::server {

bool KnowsSecret(std::string_view given, std::string_view secret) {
  return !secret.empty() && given.size() == secret.size() &&
         CRYPTO_memcmp(given.data(), secret.data(), secret.size()) == 0;
}

}  // namespace rmlcell::server
