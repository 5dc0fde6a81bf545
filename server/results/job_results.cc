#include "server/results/job_results.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/core/letters.h"
#include "engine/core/number_text.h"
#include "engine/families/families.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/sha256.h"
#include "server/base/names.h"
#include "server/base/readable.h"
#include "server/jobs/job_book.h"
#include "server/jobs/job_filter.h"
#include "server/programs/memory_tools.h"
#include "server/programs/program_result.h"
#include "server/records/job_messages.h"

namespace rmlcell::server {
namespace {

constexpr int kSignalsMax = 20;
constexpr int kBucketsMax = 10'000;
constexpr PageSizes kFindingPages{.fallback = 100, .max = 1000};

// Which findings are asked for.
struct FindingQuery {
  std::optional<std::string> code;
  std::optional<v1::Severity> severity;
  std::optional<v1::Verdict> verdict;
  std::optional<int> program;

  // A finding, or many of one code.
  template <class Finding>
  bool FindsKind(const Finding& finding) const {
    return (!code || *code == finding.code()) && (!severity || *severity == finding.severity()) &&
           (!verdict || *verdict == finding.verdict());
  }
  bool Finds(const v1::Diagnostic& finding) const {
    return FindsKind(finding) && (!program || *program == finding.place().program());
  }
};

Error BadValue(std::string_view field, const std::string& value) {
  return {ErrorCode::kCellBadFilter, "no " + std::string(field) + " '" + Readable(value) + "'", {}};
}

// "WARNING", "SEVERITY_WARNING", in letters of any case.
template <class Enum>
std::optional<Enum> ReadWord(std::string_view prefix, const std::string& value,
                             bool (*parse)(const std::string&, Enum*)) {
  std::string name = UpperCase(value);
  if (!name.starts_with(prefix)) name.insert(0, prefix);
  Enum made{};
  if (parse(name, &made)) return made;
  return std::nullopt;
}

Result<FindingQuery> ReadFindingFilter(const std::string& filter) {
  FindingQuery query;
  const auto apply = [&query](const std::string& field, const std::string& value) -> Status {
    if (field == "code") {
      query.code = UpperCase(value);
      return {};
    }
    if (field == "severity") {
      query.severity = ReadWord<v1::Severity>(
          "SEVERITY_", value,
          [](const std::string& name, v1::Severity* made) { return Severity_Parse(name, made); });
      return query.severity ? Status() : BadValue(field, value);
    }
    if (field == "verdict") {
      query.verdict = ReadWord<v1::Verdict>(
          "VERDICT_", value,
          [](const std::string& name, v1::Verdict* made) { return Verdict_Parse(name, made); });
      return query.verdict ? Status() : BadValue(field, value);
    }
    if (field == "program") {
      const auto number = ParseInteger(value);
      if (!number || *number < 0 || *number > kSlotMax) return BadValue(field, value);
      query.program = static_cast<int>(*number);
      return {};
    }
    return Error{ErrorCode::kCellBadFilter,
                 "no field '" + Readable(field) + "'; there are code, severity, verdict, program",
                 {}};
  };
  if (const Status read = ReadFilter(filter, apply); !read) return read.error();
  return query;
}

// The same finding in two runs: of the same kind at the same place.
using FindingKey = std::tuple<std::string, int, int, int>;
FindingKey KeyOf(const v1::Diagnostic& finding) {
  return {finding.code(), finding.place().program(), finding.place().step(),
          finding.place().line()};
}

std::set<FindingKey> KeysOf(const v1::RunReport& report) {
  std::set<FindingKey> keys;
  for (const v1::Diagnostic& finding : report.diagnostics()) keys.insert(KeyOf(finding));
  return keys;
}

void CompareFindings(const v1::RunReport& before, const v1::RunReport& after,
                     v1::CompareJobsResponse& response) {
  const std::set<FindingKey> had = KeysOf(before);
  const std::set<FindingKey> has = KeysOf(after);
  std::set<FindingKey> common;
  for (const v1::Diagnostic& finding : after.diagnostics()) {
    if (had.contains(KeyOf(finding))) {
      common.insert(KeyOf(finding));
    } else {
      *response.add_gained() = finding;
    }
  }
  for (const v1::Diagnostic& finding : before.diagnostics()) {
    if (!has.contains(KeyOf(finding))) *response.add_lost() = finding;
  }
  response.set_common(static_cast<std::int64_t>(common.size()));
}

// A figure of a report: "cycle_s" of its times, "cut_length_mm", those of the family.
struct ReportFigure {
  std::string name;
  std::string unit;
  double value = 0.0;
};

std::string UnitOf(std::string_view name) {
  for (const auto& [ending, unit] :
       {std::pair{"_j_per_mm_max", "J/mm"}, std::pair{"_j_per_mm", "J/mm"}, std::pair{"_mm", "mm"},
        std::pair{"_s", "s"}, std::pair{"_j", "J"}}) {
    if (name.ends_with(ending)) return unit;
  }
  return {};
}

// Each number of a message and of those in it.
void AddNumbers(const google::protobuf::Message& message, std::vector<ReportFigure>& figures) {
  const google::protobuf::Reflection& values = *message.GetReflection();
  const google::protobuf::Descriptor& type = *message.GetDescriptor();
  for (int i = 0; i < type.field_count(); ++i) {
    const google::protobuf::FieldDescriptor& field = *type.field(i);
    switch (field.cpp_type()) {
      case google::protobuf::FieldDescriptor::CPPTYPE_MESSAGE:
        AddNumbers(values.GetMessage(message, &field), figures);
        break;
      case google::protobuf::FieldDescriptor::CPPTYPE_DOUBLE:
        figures.push_back({field.name(), UnitOf(field.name()), values.GetDouble(message, &field)});
        break;
      case google::protobuf::FieldDescriptor::CPPTYPE_INT64:
        figures.push_back(
            {field.name(), {}, static_cast<double>(values.GetInt64(message, &field))});
        break;
      default:
        break;
    }
  }
}

std::vector<ReportFigure> FiguresOf(const v1::RunReport& report) {
  std::vector<ReportFigure> figures;
  AddNumbers(report.total(), figures);
  for (const v1::Figure& figure : report.figures())
    figures.push_back({figure.name(), figure.unit(), figure.value()});
  return figures;
}

void CompareFigures(const v1::RunReport& before, const v1::RunReport& after,
                    v1::CompareJobsResponse& response) {
  std::map<std::string, ReportFigure> others;
  std::vector<ReportFigure> figures = FiguresOf(before);
  for (ReportFigure& figure : FiguresOf(after)) {
    if (std::ranges::find(figures, figure.name, &ReportFigure::name) == figures.end())
      figures.push_back({figure.name, figure.unit, 0.0});
    others.emplace(figure.name, std::move(figure));
  }
  for (const ReportFigure& figure : figures) {
    const auto other = others.find(figure.name);
    const double value = other == others.end() ? 0.0 : other->second.value;
    if (value == figure.value) continue;
    v1::DiffProgramsResponse::FigureChange& change = *response.add_figures();
    change.set_name(figure.name);
    change.set_unit(figure.unit);
    change.set_before(figure.value);
    change.set_after(value);
  }
}

Error NoSuchSignal(const std::string& signal, const v1::SeriesTable& table) {
  std::string known;
  for (const v1::SeriesTable::Column& column : table.columns()) known += " " + column.signal();
  return InvalidArgument("no signal '" + Readable(signal) + "'; there are" + known);
}

// Least and greatest value in each of `count` equal spans.
v1::Series SeriesBetween(const v1::SeriesTable& table, const v1::SeriesTable::Column& column,
                         std::int64_t from_ns, std::int64_t to_ns, int count) {
  v1::Series series;
  series.set_signal(column.signal());
  series.set_unit(column.unit());
  const int parts = table.parts_size();
  int part = 0;  // the first that does not end before the span
  // In double, as the product would not fit; a part is longer than what is lost.
  const double length = static_cast<double>(to_ns - from_ns) / count;
  for (int span = 0; span < count; ++span) {
    const auto begin = from_ns + static_cast<std::int64_t>(length * span);
    const auto end = from_ns + static_cast<std::int64_t>(length * (span + 1));
    while (part < parts && (table.parts(part) + 1) * table.part_ns() <= begin) ++part;
    double low = 0.0;
    double high = 0.0;
    bool any = false;
    const auto take = [&](double least, double most) {
      low = any ? std::min(low, least) : least;
      high = any ? std::max(high, most) : most;
      any = true;
    };
    // What stood before the first part of the span, where that begins later than the span.
    const bool begins_within = part < parts && table.parts(part) * table.part_ns() <= begin;
    if (part > 0 && !begins_within) take(column.last(part - 1), column.last(part - 1));
    for (int k = part; k < parts && (table.parts(k) * table.part_ns() < end || !any); ++k)
      take(column.low(k), column.high(k));
    series.add_low(low);
    series.add_high(high);
  }
  return series;
}

// The lines of its steps, of the source that goes with an object. Empty: there is none.
std::vector<int> LinesOf(const machine::MachineFamily& family,
                         const machine::Parameters& parameters,
                         const storage::ProgramRecord& program) {
  std::string text;
  if (program.source) {
    text = *program.source;
  } else {
    Result<machine::RecoveredSource> source =
        family.tools()->Decompile(program.object, std::nullopt);
    if (!source) return {};
    text = std::move(source->text);
  }
  const std::string name = program.source ? program.source_name : std::string();
  return family
      .Translate({.name = name, .bytes = text, .is_object = false}, parameters,
                 {.advice = false, .source = true})
      .source.step_lines;
}

}  // namespace

Result<v1::RunReport> JobResults::Report(const std::string& job) {
  const Result<std::int64_t> id = ParseJobName(job);
  if (!id) return id.error();
  const Result<std::string> bytes = book_.ReadArtifact(*id, "report");
  if (!bytes) return bytes.error();
  v1::RunReport report;
  if (!report.ParseFromString(*bytes))
    return Error{ErrorCode::kCellStoreCorrupt, "the report of " + job, {}};
  return report;
}

Result<v1::ListJobFindingsResponse> JobResults::Findings(
    const v1::ListJobFindingsRequest& request) {
  const Result<int> size = PageSize(request.page_size(), kFindingPages);
  if (!size) return size.error();
  const Result<FindingQuery> query = ReadFindingFilter(request.filter());
  if (!query) return query.error();
  std::int64_t begin = 0;
  if (!request.page_token().empty()) {
    const auto token = ParseInteger(request.page_token());
    if (!token || *token <= 0) return Error{ErrorCode::kCellBadPageToken, {}, {}};
    begin = *token;
  }
  const Result<v1::RunReport> report = Report(request.name());
  if (!report) return report.error();
  v1::ListJobFindingsResponse response;
  std::int64_t found = 0;
  for (const v1::Diagnostic& finding : report->diagnostics()) {
    if (!query->Finds(finding)) continue;
    if (found >= begin && response.findings_size() < *size) *response.add_findings() = finding;
    ++found;
  }
  response.set_total_size(found);
  // A token may be as large as any number is.
  if (*size < found - begin) response.set_next_page_token(std::to_string(begin + *size));
  for (const v1::GatheredFindings& kind : report->gathered()) {
    if (query->FindsKind(kind)) *response.add_gathered() = kind;
  }
  return response;
}

Result<v1::GetStepMapResponse> JobResults::StepMap(const v1::GetStepMapRequest& request) {
  const Result<std::int64_t> id = ParseJobName(request.name());
  if (!id) return id.error();
  const Result<std::string> bytes = book_.ReadArtifact(*id, "steps");
  if (!bytes) return bytes.error();
  v1::GetStepMapResponse map;
  if (!map.ParseFromString(*bytes))
    return Error{ErrorCode::kCellStoreCorrupt, "the steps of " + request.name(), {}};
  const auto job = store_.GetJob(*id);
  if (!job) return job.error();
  const auto machine = store_.GetMachine(job->machine);
  if (!machine && machine.error().code == ErrorCode::kCellUnknownMachine) return map;  // deleted
  if (!machine) return machine.error();
  const machine::MachineFamily* family = families::FindFamily(machine->family);
  if (family == nullptr || family->tools() == nullptr) return map;
  const auto parameters = machine::MakeParameters(*family, machine->profile, machine->parameters);
  if (!parameters) return map;
  for (v1::GetStepMapResponse::ProgramSteps& program : *map.mutable_programs()) {
    if (!program.lines().empty()) continue;
    const auto stored = store_.GetProgram(machine->id, program.program());
    if (!stored && stored.error().code != ErrorCode::kCellNotFound) return stored.error();
    if (!stored || bridge::Sha256Hex(stored->object) != program.object_sha256()) continue;
    const std::vector<int> lines = LinesOf(*family, *parameters, *stored);
    *program.mutable_lines() = {lines.begin(), lines.end()};
  }
  return map;
}

Result<v1::GetJobSeriesResponse> JobResults::Series(const v1::GetJobSeriesRequest& request) {
  const Result<std::int64_t> id = ParseJobName(request.name());
  if (!id) return id.error();
  const Result<std::string> bytes = book_.ReadArtifact(*id, "series");
  if (!bytes) return bytes.error();
  v1::SeriesTable table;
  if (!table.ParseFromString(*bytes))
    return Error{ErrorCode::kCellStoreCorrupt, "the series of " + request.name(), {}};
  if (request.signals().empty() || request.signals_size() > kSignalsMax)
    return InvalidArgument("signals: 1 to " + std::to_string(kSignalsMax) + " are asked for");
  if (request.buckets() < 1 || request.buckets() > kBucketsMax)
    return InvalidArgument("buckets: allowed are 1 to " + std::to_string(kBucketsMax));
  const std::int64_t end =
      request.to_ns() == 0 ? table.end_ns() : std::min(request.to_ns(), table.end_ns());
  if (request.from_ns() < 0 || request.from_ns() > end)
    return InvalidArgument("from_ns: allowed are 0 to " + std::to_string(end));
  v1::GetJobSeriesResponse response;
  response.set_to_ns(end);
  for (const std::string& signal : request.signals()) {
    const auto column =
        std::ranges::find(table.columns(), signal, &v1::SeriesTable::Column::signal);
    if (column == table.columns().end()) return NoSuchSignal(signal, table);
    *response.add_series() =
        SeriesBetween(table, *column, request.from_ns(), end, request.buckets());
  }
  return response;
}

struct JobResults::Compared {
  std::int64_t id = 0;
  v1::Job job;
  v1::RunReport report;
  std::string program_sha256;

  // "parameters.VMAX" and the like, by name.
  std::map<std::string, std::string> Inputs() const {
    std::map<std::string, std::string> inputs = {{"machine", job.machine()},
                                                 {"profile", report.profile()},
                                                 {"kind", v1::JobKind_Name(job.kind())},
                                                 {"engine_version", report.engine_version()},
                                                 {"program", program_sha256}};
    for (const auto& [name, value] : report.parameters()) inputs["parameters." + name] = value;
    return inputs;
  }
};

Result<JobResults::Compared> JobResults::ReadCompared(const std::string& job) {
  Compared compared;
  const Result<std::int64_t> id = ParseJobName(job);
  if (!id) return id.error();
  compared.id = *id;
  Result<v1::RunReport> report = Report(job);
  if (!report) return report.error();
  compared.report = *std::move(report);
  Result<v1::Job> asked = book_.Get(job);
  if (!asked) return asked.error();
  compared.job = *std::move(asked);
  const auto program = book_.FindArtifact(*id, kMainAttachment);
  if (!program) return program.error();
  compared.program_sha256 = program->sha256;
  return compared;
}

void JobResults::ComparePrograms(const Compared& before, const Compared& after,
                                 v1::CompareJobsResponse& response) {
  if (before.program_sha256 == after.program_sha256) return;
  v1::DiffProgramsRequest request;
  const auto add = [&](const Compared& one, v1::DiffProgramsRequest::Side& side) -> Status {
    Result<std::string> bytes = book_.ReadArtifact(one.id, kMainAttachment);
    if (!bytes) return bytes.error();
    v1::ProgramText& text = *side.mutable_text();
    text.set_content(*std::move(bytes));
    const std::optional<BroughtProgram> brought = ProgramBrought(one.job);
    const machine::MachineFamily* family = families::FindFamily(one.report.family());
    const bool streams = family == nullptr || family->tools() == nullptr;
    if (brought) {
      text.set_file_name(brought->file_name);
      text.set_form(brought->form);
    } else {
      const std::string slot = one.job.program().substr(one.job.program().rfind('/') + 1);
      text.set_file_name(slot +
                         (streams ? ".rml" : std::string(family->tools()->extensions().object)));
      if (!streams) text.set_form(v1::PROGRAM_FORM_OBJECT);
    }
    return {};
  };
  Status read = add(before, *request.mutable_before());
  if (read) read = add(after, *request.mutable_after());
  ProgramResult<v1::DiffProgramsResponse> difference =
      read ? tools_.Diff(request) : ProgramResult<v1::DiffProgramsResponse>(read.error());
  if (difference) {
    *response.mutable_difference() = *std::move(difference.value);
  } else {
    const Error& error = difference.error.error;
    *response.mutable_difference_error() = bridge::ToProto(Diagnostic{
        .code = error.code, .severity = Lookup(error.code).severity, .detail = error.detail});
  }
}

Result<v1::CompareJobsResponse> JobResults::Compare(const v1::CompareJobsRequest& request) {
  const auto before = ReadCompared(request.before());
  if (!before) return before.error();
  const auto after = ReadCompared(request.after());
  if (!after) return after.error();
  if (before->report.family() != after->report.family()) {
    return Error{ErrorCode::kCellPrecondition,
                 request.before() + " ran on a machine of the family " + before->report.family() +
                     ", " + request.after() + " on one of " + after->report.family(),
                 {}};
  }
  v1::CompareJobsResponse response;
  response.set_verdict_before(before->report.outcome().verdict());
  response.set_verdict_after(after->report.outcome().verdict());
  const auto given = before->Inputs();
  auto other = after->Inputs();
  for (const auto& [name, value] : given) other.emplace(name, std::string());
  for (const auto& [name, value] : other) {
    const auto first = given.find(name);
    const std::string was = first == given.end() ? std::string() : first->second;
    if (was == value) continue;
    v1::CompareJobsResponse::InputChange& change = *response.add_inputs();
    change.set_name(name);
    change.set_before(was);
    change.set_after(value);
  }
  CompareFigures(before->report, after->report, response);
  CompareFindings(before->report, after->report, response);
  ComparePrograms(*before, *after, response);
  return response;
}

}  // namespace rmlcell::server
