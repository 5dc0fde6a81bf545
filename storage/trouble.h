#pragma once

#include "engine/core/result.h"

namespace rmlcell::storage {

// Not of what was asked for: the same may succeed in a moment.
inline bool IsTroubleOfTheStore(const Error& error) {
  return error.code == ErrorCode::kCellStoreFailed || error.code == ErrorCode::kCellStoreBusy ||
         error.code == ErrorCode::kCellStoreUnavailable ||
         error.code == ErrorCode::kCellResourceExhausted;
}

}  // namespace rmlcell::storage
