#include "server/programs/text_tools.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "engine/families/families.h"
#include "proto/bridge/findings.h"

namespace rmlcell::server {
namespace {

v1::Findings FindingsOf(const std::vector<Diagnostic>& findings, const UntoldFindings& dropped) {
  return bridge::FindingsOf(!HasErrors(findings), findings, dropped, {});
}

using machine::FileForm;

// A text that one of the tools is asked for.
struct ToolText {
  const machine::MachineFamily* family = nullptr;
  const machine::Tools* tools = nullptr;
  machine::SourceFile file;
  bool inch = false;
};

Result<ToolText> AnyForm(const v1::ProgramText& program) {
  if (program.content().empty())
    return Error{ErrorCode::kCellEmptyProgram, program.file_name(), {}};
  const Result<const machine::MachineFamily*> family =
      families::FamilyWithTools(program.file_name());
  if (!family) return family.error();
  const machine::Tools* tools = (*family)->tools();
  const FileForm form = tools->FormOf(program.file_name(), program.content());
  return ToolText{*family,
                  tools,
                  {.name = program.file_name(), .bytes = program.content()},
                  form == FileForm::kInchSource};
}

Result<ToolText> SourceText(const v1::ProgramText& program) {
  Result<ToolText> text = AnyForm(program);
  if (text && IsObject(program))
    return InvalidArgument("an object is no source; DecompileProgram gives its source");
  return text;
}

Result<ToolText> MetricText(const v1::ProgramText& program) {
  Result<ToolText> text = SourceText(program);
  if (text && text->inch)
    return Error{text->tools->codes().source_is_inch, program.file_name(), {}};
  return text;
}

Result<machine::Displacement> DisplacementOf(
    const v1::Point& translation, const google::protobuf::RepeatedField<double>& rotation) {
  if (!rotation.empty() && rotation.size() != 3) {
    return InvalidArgument("rotation has " + std::to_string(rotation.size()) +
                           " values, needs none or three");
  }
  machine::Displacement by{.move_mm = {translation.x(), translation.y(), translation.z()}};
  std::ranges::copy(rotation, by.turn_rad.begin());
  const auto finite = [](double value) { return std::isfinite(value); };
  if (!std::ranges::all_of(by.move_mm, finite) || !std::ranges::all_of(by.turn_rad, finite))
    return InvalidArgument("translation and rotation must be finite");
  return by;
}

template <class Response>
Response ResponseOf(machine::RewrittenText made) {
  Response response;
  response.set_content(std::move(made.text));
  *response.mutable_findings() = FindingsOf(made.diagnostics, made.diagnostics_dropped);
  return response;
}

}  // namespace

bool IsObject(const v1::ProgramText& program) {
  if (program.form() == v1::PROGRAM_FORM_OBJECT) return true;
  const auto family = families::FamilyWithTools(program.file_name());
  return family &&
         (*family)->tools()->FormOf(program.file_name(), program.content()) == FileForm::kObject;
}

Result<v1::FormatProgramResponse> FormatText(const v1::FormatProgramRequest& request) {
  const Result<ToolText> text = SourceText(request.program());
  if (!text) return text.error();
  machine::FormattedText made = text->tools->Format(text->file);
  v1::FormatProgramResponse response;
  response.set_content(std::move(made.text));
  if (!text->inch)
    *response.mutable_findings() = FindingsOf(made.diagnostics, made.diagnostics_dropped);
  return response;
}

Result<v1::ConvertProgramResponse> ConvertText(const v1::ConvertProgramRequest& request,
                                               const std::string& now) {
  const v1::ProgramText& program = request.program();
  const Result<ToolText> text = SourceText(program);
  if (!text) return text.error();
  std::vector<std::string> arguments = {program.file_name().empty() ? "program"
                                                                    : program.file_name()};
  if (!request.output_name().empty()) arguments.push_back(request.output_name());
  if (request.target() == v1::ConvertProgramRequest::TARGET_METRIC) arguments.emplace_back("/m");
  if (request.target() == v1::ConvertProgramRequest::TARGET_INCH) arguments.emplace_back("/i");
  const auto wanted = text->tools->ReadConvertArguments(arguments);
  if (!wanted) return wanted.error();
  if (!*wanted) return InvalidArgument("program.file_name is empty");
  auto response = ResponseOf<v1::ConvertProgramResponse>(
      text->tools->Convert(program.content(), (*wanted)->direction,
                           {.input = (*wanted)->input,
                            .output = (*wanted)->output,
                            .date = request.date().empty() ? now : request.date()}));
  response.set_file_name((*wanted)->output);
  return response;
}

Result<v1::CompensateProgramResponse> CompensateText(const v1::CompensateProgramRequest& request,
                                                     const std::string& now) {
  const v1::ProgramText& program = request.program();
  const Result<ToolText> text = SourceText(program);
  if (!text) return text.error();
  const std::string output = std::filesystem::path(program.file_name())
                                 .replace_extension(text->tools->extensions().compensated)
                                 .string();
  return ResponseOf<v1::CompensateProgramResponse>(text->tools->Compensate(
      program.content(), {.input = program.file_name(), .output = output, .date = now},
      text->inch));
}

Result<v1::TransformProgramResponse> TransformText(const v1::TransformProgramRequest& request) {
  const Result<ToolText> text = MetricText(request.program());
  if (!text) return text.error();
  const auto by = DisplacementOf(request.translation(), request.rotation());
  if (!by) return by.error();
  return ResponseOf<v1::TransformProgramResponse>(text->tools->Transform(text->file.bytes, *by));
}

Result<v1::ShiftProgramResponse> ShiftText(const v1::ShiftProgramRequest& request) {
  const Result<ToolText> text = MetricText(request.program());
  if (!text) return text.error();
  const auto by = DisplacementOf(request.translation(), request.rotation());
  if (!by) return by.error();
  return ResponseOf<v1::ShiftProgramResponse>(text->tools->Shift(text->file.bytes, *by));
}

Result<v1::MakeListingResponse> ListText(const v1::MakeListingRequest& request) {
  const Result<ToolText> text = AnyForm(request.program());
  if (!text) return text.error();
  std::string object = request.program().content();
  v1::MakeListingResponse response;
  response.mutable_findings()->set_ok(true);
  if (!IsObject(request.program())) {
    machine::CompiledProgram compiled =
        text->tools->Compile(text->file, machine::Parameters(text->family->parameters()),
                             {.advice = false, .inch = text->inch, .any_size = true});
    *response.mutable_findings() = FindingsOf(compiled.diagnostics, compiled.diagnostics_dropped);
    if (!compiled.ok) return response;
    object = std::move(compiled.object);
  }
  Result<std::string> listing = text->tools->List(object);
  if (!listing) return listing.error();
  response.set_content(*std::move(listing));
  return response;
}

}  // namespace rmlcell::server
