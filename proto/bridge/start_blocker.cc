#include "proto/bridge/start_blocker.h"

#include "proto/bridge/findings.h"
#include "rmlcell/v1/common.pb.h"

namespace rmlcell::bridge {

v1::StartBlocker ToStartBlocker(const Error& error) {
  const v1::ErrorDetail detail = ToErrorDetail(error);
  v1::StartBlocker blocker;
  blocker.set_code(detail.code());
  blocker.set_symbol(detail.symbol());
  blocker.set_message(detail.message());
  blocker.set_advice(detail.advice());
  return blocker;
}

}  // namespace rmlcell::bridge
