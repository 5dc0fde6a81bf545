#pragma once

#include <functional>
#include <string>

#include "rmlcell/v1/program.pb.h"
#include "server/programs/program_book.h"

namespace rmlcell::server {

inline constexpr std::string_view kMediaTypeOfPictures = "image/svg+xml";

// What a stored program looks like, found by running it in virtual time on its machine as that
// stands: no job, nothing is stored. A program that runs long is followed as far as a check follows
// it. Thread-safe; blocks on the store and on the run.
//
// Errors everywhere: those of ProgramBook::Open.
class ProgramViews {
 public:
  explicit ProgramViews(ProgramBook& programs) : programs_(programs) {}

  // Error: CellInvalidArgument for a width that makes no sense.
  Result<v1::GetProgramPictureResponse> Picture(const v1::GetProgramPictureRequest& request);

  // The same in two steps: what the picture is made of is known before the program is run.
  struct Drawing {
    std::string etag{};
    std::function<Result<v1::GetProgramPictureResponse>()> draw{};  // takes seconds; once
  };
  Result<Drawing> Prepare(const v1::GetProgramPictureRequest& request);

  struct Toolpath {
    std::string frames;  // of blocks: proto/bridge/framing.h
    v1::ToolpathHeader header;
  };
  // Error: CellInvalidArgument for a level that there is not.
  Result<Toolpath> Path(const v1::StreamProgramToolpathRequest& request);

 private:
  ProgramBook& programs_;
};

}  // namespace rmlcell::server
