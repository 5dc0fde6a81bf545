#include "server/programs/program_office.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
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

Error Invalid(std::string detail) { return {ErrorCode::kCellInvalidArgument, std::move(detail), {}}; }

bool HasErrors(const std::vector<Diagnostic>& findings) {
  return std::ranges::any_of(findings, [](const Diagnostic& finding) { return IsError(finding.severity); });
}

v1::Findings FindingsOf(const std::vector<Diagnostic>& findings, std::uint64_t dropped = 0) {
  return bridge::FindingsOf(!HasErrors(findings), findings, dropped, {});
}

Status CheckText(const v1::ProgramText& program) {
  if (program.content().empty()) return Error{ErrorCode::kCellEmptyProgram, program.file_name(), {}};
  if (optimo::FormOfFile(program.file_name(), program.content()) == optimo::FileForm::kObject) {
    return Invalid("an object is no source; DecompileProgram gives its source");
  }
  return {};
}

bool IsInch(const v1::ProgramText& program) {
  return optimo::FormOfFile(program.file_name(), program.content()) == optimo::FileForm::kInchSource;
}

}  // namespace

Result<v1::FormatProgramResponse> FormatText(const v1::FormatProgramRequest& request) {
  const v1::ProgramText& program = request.program();
  if (const Status good = CheckText(program); !good) return good.error();
  const optimo::Compilation read = optimo::Compile(
      program.content(), program.file_name(), {.object_limit = 0, .advice = false});
  v1::FormatProgramResponse response;
  response.set_content(optimo::Format(program.content()).text);
  // The numbers of an inch source are not for the control; only its form matters here.
  if (!IsInch(program)) *response.mutable_findings() = FindingsOf(read.diagnostics, read.diagnostics_dropped);
  return response;
}

Result<v1::ConvertProgramResponse> ConvertText(const v1::ConvertProgramRequest& request, const std::string& now) {
  const v1::ProgramText& program = request.program();
  if (const Status good = CheckText(program); !good) return good.error();
  std::vector<std::string> arguments = {program.file_name().empty() ? "program" : program.file_name()};
  if (!request.output_name().empty()) arguments.push_back(request.output_name());
  if (request.target() == v1::ConvertProgramRequest::TARGET_METRIC) arguments.emplace_back("/m");
  if (request.target() == v1::ConvertProgramRequest::TARGET_INCH) arguments.emplace_back("/i");
  const auto wanted = optimo::ReadConvertArguments(arguments);
  if (!wanted) return wanted.error();
  if (!*wanted) return Invalid("program.file_name is empty");
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
  const std::string output = std::filesystem::path(program.file_name()).replace_extension(".CMP").string();
  const optimo::Compensation made =
      optimo::Compensate(program.content(),
                         optimo::FileNames{.input = program.file_name(), .output = output, .date = now}, IsInch(program));
  v1::CompensateProgramResponse response;
  response.set_content(made.text);
  *response.mutable_findings() = FindingsOf(made.diagnostics);
  return response;
}

Result<v1::TransformProgramResponse> TransformText(const v1::TransformProgramRequest& request) {
  const v1::ProgramText& program = request.program();
  if (const Status good = CheckText(program); !good) return good.error();
  if (IsInch(program)) return Error{ErrorCode::kSourceIsInch, program.file_name(), {}};
  if (request.rotation_size() != 0 && request.rotation_size() != 3) {
    return Invalid("rotation has " + std::to_string(request.rotation_size()) + " values, needs none or three");
  }
  std::array<double, 3> turn{};
  std::ranges::copy(request.rotation(), turn.begin());
  const motion::Vec3 move{request.translation().x(), request.translation().y(), request.translation().z()};
  for (const double value : {move.x, move.y, move.z, turn[0], turn[1], turn[2]}) {
    if (!std::isfinite(value)) return Invalid("translation and rotation must be finite");
  }
  const optimo::Rewriting made =
      optimo::Transform(program.content(), optimo::RigidMotion::Of(move, turn[0], turn[1], turn[2]));
  v1::TransformProgramResponse response;
  response.set_content(made.text);
  *response.mutable_findings() = FindingsOf(made.diagnostics);
  return response;
}

Result<std::string> ListingOf(const std::string& object) {
  const Result<optimo::Module> module = optimo::DecodeObject(object);
  if (!module) return module.error();
  return optimo::List(*module);
}

std::string HeaderDate() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, 40> text{};
  const std::size_t size = std::strftime(text.data(), text.size(), "%a %b %d %H:%M:%S %Y", &utc);
  return {text.data(), size};
}

}  // namespace rmlcell::server
