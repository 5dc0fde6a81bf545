#include "server/programs/program_office.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/formatter.h"
#include "engine/optimo/offline/compensate.h"
#include "engine/optimo/offline/convert.h"
#include "engine/optimo/offline/listing.h"
#include "engine/optimo/offline/transform.h"
#include "engine/optimo/offline/translate.h"
#include "proto/bridge/findings.h"

namespace rmlcell::server {
namespace {

v1::Findings FindingsOf(const std::vector<Diagnostic>& findings, std::uint64_t dropped = 0) {
  return bridge::FindingsOf(!HasErrors(findings), findings, dropped, {});
}

bool IsInch(const v1::ProgramText& program) {
  return optimo::FormOfFile(program.file_name(), program.content()) ==
         optimo::FileForm::kInchSource;
}

Status CheckText(const v1::ProgramText& program) {
  if (program.content().empty())
    return Error{ErrorCode::kCellEmptyProgram, program.file_name(), {}};
  if (IsObject(program))
    return InvalidArgument("an object is no source; DecompileProgram gives its source");
  return {};
}

Status CheckMetricText(const v1::ProgramText& program) {
  if (const Status good = CheckText(program); !good) return good;
  if (IsInch(program)) return Error{ErrorCode::kSourceIsInch, program.file_name(), {}};
  return {};
}

struct Offset {
  motion::MachineVector move;    // mm
  std::array<double, 3> turn{};  // about Z, Y, X, rad
};

Result<Offset> OffsetOf(const v1::Point& translation,
                        const google::protobuf::RepeatedField<double>& rotation) {
  if (!rotation.empty() && rotation.size() != 3) {
    return InvalidArgument("rotation has " + std::to_string(rotation.size()) +
                           " values, needs none or three");
  }
  Offset offset{{translation.x(), translation.y(), translation.z()}, {}};
  std::ranges::copy(rotation, offset.turn.begin());
  for (const double value : {offset.move.x(), offset.move.y(), offset.move.z(), offset.turn[0],
                             offset.turn[1], offset.turn[2]}) {
    if (!std::isfinite(value)) return InvalidArgument("translation and rotation must be finite");
  }
  return offset;
}

}  // namespace

bool IsObject(const v1::ProgramText& program) {
  return program.form() == v1::PROGRAM_FORM_OBJECT ||
         optimo::FormOfFile(program.file_name(), program.content()) == optimo::FileForm::kObject;
}

Result<v1::FormatProgramResponse> FormatText(const v1::FormatProgramRequest& request) {
  const v1::ProgramText& program = request.program();
  if (const Status good = CheckText(program); !good) return good.error();
  const optimo::Compilation read =
      optimo::Compile(program.content(), program.file_name(), {.object_limit = 0, .advice = false});
  v1::FormatProgramResponse response;
  response.set_content(optimo::Format(program.content()).text);
  // The numbers of an inch source are not for the control; only its form matters here.
  if (!IsInch(program))
    *response.mutable_findings() = FindingsOf(read.diagnostics, read.diagnostics_dropped);
  return response;
}

Result<v1::ConvertProgramResponse> ConvertText(const v1::ConvertProgramRequest& request,
                                               const std::string& now) {
  const v1::ProgramText& program = request.program();
  if (const Status good = CheckText(program); !good) return good.error();
  std::vector<std::string> arguments = {program.file_name().empty() ? "program"
                                                                    : program.file_name()};
  if (!request.output_name().empty()) arguments.push_back(request.output_name());
  if (request.target() == v1::ConvertProgramRequest::TARGET_METRIC) arguments.emplace_back("/m");
  if (request.target() == v1::ConvertProgramRequest::TARGET_INCH) arguments.emplace_back("/i");
  const auto wanted = optimo::ReadConvertArguments(arguments);
  if (!wanted) return wanted.error();
  if (!*wanted) return InvalidArgument("program.file_name is empty");
  const optimo::Conversion made =
      optimo::Convert(program.content(), (*wanted)->direction,
                      optimo::FileNames{.input = (*wanted)->input,
                                        .output = (*wanted)->output,
                                        .date = request.date().empty() ? now : request.date()});
  v1::ConvertProgramResponse response;
  response.set_content(made.text);
  response.set_file_name((*wanted)->output);
  *response.mutable_findings() = FindingsOf(made.diagnostics);
  return response;
}

Result<v1::CompensateProgramResponse> CompensateText(const v1::CompensateProgramRequest& request,
                                                     const std::string& now) {
  const v1::ProgramText& program = request.program();
  if (const Status good = CheckText(program); !good) return good.error();
  const std::string output =
      std::filesystem::path(program.file_name()).replace_extension(".CMP").string();
  const optimo::Compensation made = optimo::Compensate(
      program.content(),
      optimo::FileNames{.input = program.file_name(), .output = output, .date = now},
      IsInch(program));
  v1::CompensateProgramResponse response;
  response.set_content(made.text);
  *response.mutable_findings() = FindingsOf(made.diagnostics);
  return response;
}

Result<v1::TransformProgramResponse> TransformText(const v1::TransformProgramRequest& request) {
  const v1::ProgramText& program = request.program();
  if (const Status good = CheckMetricText(program); !good) return good.error();
  const Result<Offset> by = OffsetOf(request.translation(), request.rotation());
  if (!by) return by.error();
  const optimo::Rewriting made = optimo::Transform(
      program.content(), motion::RigidMotionOf(by->move, by->turn[0], by->turn[1], by->turn[2]));
  v1::TransformProgramResponse response;
  response.set_content(made.text);
  *response.mutable_findings() = FindingsOf(made.diagnostics);
  return response;
}

Result<v1::ShiftProgramResponse> ShiftText(const v1::ShiftProgramRequest& request) {
  const v1::ProgramText& program = request.program();
  if (const Status good = CheckMetricText(program); !good) return good.error();
  const Result<Offset> by = OffsetOf(request.translation(), request.rotation());
  if (!by) return by.error();
  const optimo::Rewriting made = optimo::Shift(
      program.content(),
      {by->move.x(), by->move.y(), by->move.z(), by->turn[0], by->turn[1], by->turn[2]});
  v1::ShiftProgramResponse response;
  response.set_content(made.text);
  *response.mutable_findings() = FindingsOf(made.diagnostics);
  return response;
}

Result<v1::MakeListingResponse> ListText(const v1::MakeListingRequest& request) {
  const v1::ProgramText& program = request.program();
  if (program.content().empty())
    return Error{ErrorCode::kCellEmptyProgram, program.file_name(), {}};
  v1::MakeListingResponse response;
  if (IsObject(program)) {
    Result<std::string> listing = ListingOf(program.content());
    if (!listing) return listing.error();
    response.set_content(*std::move(listing));
    response.mutable_findings()->set_ok(true);
    return response;
  }
  const optimo::Compilation read =
      optimo::Compile(program.content(), program.file_name(),
                      {.object_limit = 0, .advice = false, .inch = IsInch(program)});
  if (read.ok) response.set_content(optimo::List(read.module));
  *response.mutable_findings() = FindingsOf(read.diagnostics, read.diagnostics_dropped);
  return response;
}

Result<std::string> ListingOf(const std::string& object) {
  const Result<optimo::Module> module = optimo::DecodeObject(object);
  if (!module) return module.error();
  return optimo::List(*module);
}

}  // namespace rmlcell::server
