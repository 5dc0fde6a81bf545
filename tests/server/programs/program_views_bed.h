#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "server/base/config.h"
#include "server/programs/program_book.h"
#include "server/programs/program_views.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {

// Programs of a store, and why one cannot be shown.
class ProgramViewsBed : public testing::Test {
 protected:
  std::optional<ErrorCode> Picture(const std::string& name) {
    v1::GetProgramPictureRequest request;
    request.set_name(name);
    return CodeOf(views.Picture(request));
  }
  std::optional<ErrorCode> Path(const std::string& name) {
    v1::StreamProgramToolpathRequest request;
    request.set_name(name);
    return CodeOf(views.Path(request));
  }

  ServerBed bed;
  Config config;
  ProgramBook programs{bed.store(), config};
  ProgramViews views{programs};
};

}  // namespace rmlcell::server
