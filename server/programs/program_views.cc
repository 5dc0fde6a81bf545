#include "server/programs/program_views.h"

#include <chrono>

#include "engine/core/units.h"
#include "engine/simulation/run/input_description.h"
#include "engine/simulation/run/simulate.h"
#include "proto/bridge/framing.h"
#include "proto/bridge/report.h"
#include "server/records/toolpath_levels.h"

namespace rmlcell::server {
namespace {

constexpr int kWidthMin_px = 64;
constexpr int kWidthMax_px = 8192;
constexpr int kThumbnailMax_px = 400;  // narrower ones show one view
// Of real time; what is drawn until then is what there is to see.
constexpr std::chrono::seconds kFollowedFor{5};

struct FollowedProgram {
  simulation::SimulationResult result;
  bool complete = false;
};

// What is run: the program on its machine as that stands.
Result<machine::RunSetup> SetupOf(const ProgramBook::Opened& opened) {
  Result<simulation::PreparedRun> prepared = simulation::PrepareRun(
      opened.memory,
      {.main_program = opened.slot,
       .mode = machine::Mode::kCycle,
       .budget = {.steps = simulation::kCheckStepsMax, .virtual_time = simulation::kCheckTimeMax}});
  if (!prepared) return prepared.error();
  if (prepared->setup) return *std::move(prepared->setup);
  for (const Diagnostic& finding : prepared->diagnostics)
    if (IsError(finding.severity)) return Error{finding.code, finding.detail, finding.where};
  return Error{ErrorCode::kCellBadText, "a program of the machine cannot be translated", {}};
}

// A halt lasts no longer than it takes to press START.
Result<FollowedProgram> Follow(const machine::MachineFamily& family, machine::RunSetup setup,
                               simulation::SimulationRequest request) {
  const auto until = std::chrono::steady_clock::now() + kFollowedFor;
  request.options = {.at_halt = simulation::AtHalt::kStart,
                     .progress = [until](const simulation::Progress&) {
                       return std::chrono::steady_clock::now() < until;
                     }};
  Result<simulation::SimulationResult> result =
      simulation::Simulate(family, std::move(setup), std::move(request));
  if (!result) return result.error();
  const machine::OutcomeKind how = result->report.outcome.kind;
  const bool complete =
      how != machine::OutcomeKind::kCancelled && how != machine::OutcomeKind::kBudgetExceeded;
  return FollowedProgram{*std::move(result), complete};
}

}  // namespace

Result<ProgramViews::Drawing> ProgramViews::Prepare(const v1::GetProgramPictureRequest& request) {
  simulation::SimulationRequest asked{.products = {.picture = true}};
  if (request.width_px() != 0) {
    if (request.width_px() < kWidthMin_px || request.width_px() > kWidthMax_px) {
      return InvalidArgument("width_px is " + std::to_string(request.width_px()) +
                             ", allowed are 64 to 8192");
    }
    asked.picture.width_px = request.width_px();
    if (request.width_px() < kThumbnailMax_px) asked.picture.views = {simulation::PictureView::kXY};
  }
  const Result<ProgramBook::Opened> opened = programs_.Open(request.name());
  if (!opened) return opened.error();
  const machine::MachineFamily& family = *opened->memory.family;
  Result<machine::RunSetup> setup = SetupOf(*opened);
  if (!setup) return setup.error();
  std::string etag = simulation::DescribeInputs(family, *setup).hash + "-" +
                     std::to_string(asked.picture.width_px);
  const auto shared = std::make_shared<machine::RunSetup>(*std::move(setup));
  return Drawing{.etag = etag,
                 .draw = [&family, shared, asked, etag]() -> Result<v1::GetProgramPictureResponse> {
                   Result<FollowedProgram> followed = Follow(family, std::move(*shared), asked);
                   if (!followed) return followed.error();
                   v1::GetProgramPictureResponse response;
                   response.set_content(std::move(followed->result.svg));
                   response.set_media_type(std::string(kMediaTypeOfPictures));
                   response.set_complete(followed->complete);
                   response.set_etag(etag);
                   return response;
                 }};
}

Result<v1::GetProgramPictureResponse> ProgramViews::Picture(
    const v1::GetProgramPictureRequest& request) {
  const Result<Drawing> drawing = Prepare(request);
  return drawing ? drawing->draw() : drawing.error();
}

Result<ProgramViews::Toolpath> ProgramViews::Path(const v1::StreamProgramToolpathRequest& request) {
  if (const Status level = CheckToolpathLevel(request.level()); !level) return level.error();
  const Result<ProgramBook::Opened> opened = programs_.Open(request.name());
  if (!opened) return opened.error();
  Result<machine::RunSetup> setup = SetupOf(*opened);
  if (!setup) return setup.error();
  Toolpath path;
  const simulation::ToolpathOptions options;
  Result<FollowedProgram> followed = Follow(*opened->memory.family, *std::move(setup),
                                            {.products = {.toolpath = [&](std::string_view block) {
                                               bridge::AddFrame(block, path.frames);
                                               return true;
                                             }}});
  if (!followed) return followed.error();
  const v1::RunReport report =
      bridge::ToProto(opened->memory.family->info(), followed->result.report, {});
  path.header.set_points(report.toolpath().records());
  path.header.set_complete(report.toolpath().complete() && followed->complete);
  if (report.has_tip_box()) *path.header.mutable_tip_box() = report.tip_box();
  path.header.set_duration_ns(followed->result.report.cycle_time.count());
  path.frames = ToolpathAtLevel(path.frames, options.tolerance_mm, request.level());
  SetLevel(options.tolerance_mm, request.level(), path.frames.size(), path.header);
  return path;
}

}  // namespace rmlcell::server
