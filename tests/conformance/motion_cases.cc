#include "tests/conformance/motion_cases.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "engine/core/number_text.h"
#include "tests/conformance/motion_case_kinds.h"

namespace rmlcell::motion {
namespace {

constexpr double kAgreement = 1e-6;

// Splits CSV text into records; quotes as RFC 4180 has them.
std::vector<std::vector<std::string>> Records(std::string_view csv) {
  std::vector<std::vector<std::string>> records;
  std::vector<std::string> fields(1);
  bool quoted = false;
  const auto end_record = [&] {
    if (fields.size() > 1 || !fields[0].empty()) records.push_back(fields);
    fields.assign(1, "");
  };
  for (std::size_t i = 0; i < csv.size(); ++i) {
    const char c = csv[i];
    if (quoted) {
      if (c != '"') {
        fields.back() += c;
      } else if (i + 1 < csv.size() && csv[i + 1] == '"') {
        fields.back() += '"';
        ++i;
      } else {
        quoted = false;
      }
    } else if (c == '"') {
      quoted = true;
    } else if (c == ',') {
      fields.emplace_back();
    } else if (c == '\n') {
      end_record();
    } else if (c != '\r') {
      fields.back() += c;
    }
  }
  end_record();
  return records;
}

bool Agrees(double value, double reference) {
  return std::abs(value - reference) <= kAgreement * std::max(1.0, std::abs(reference));
}

// T_min and T_max enclose the time that is called T in the engine's figures.
bool AgreesWith(const Figures& figures, const std::string& name, double reference,
                std::optional<double>& ours) {
  const bool lowest = name == "T_min";
  const bool highest = name == "T_max";
  const auto figure = figures.find(lowest || highest ? "T" : name);
  if (figure == figures.end()) return false;
  const double value = figure->second;
  ours = value;
  const double room = kAgreement * std::max(1.0, std::abs(reference));
  if (lowest) return value >= reference - room;
  if (highest) return value <= reference + room;
  return Agrees(value, reference);
}

}  // namespace

Result<std::vector<ReferenceCase>> ReadReferenceCases(std::string_view csv) {
  std::vector<std::vector<std::string>> records = Records(csv);
  const std::vector<std::string> headings{"case", "group", "text", "input", "output"};
  if (records.empty() || records[0] != headings) {
    return Error{ErrorCode::kCellBadText, "no line 'case,group,text,input,output'", {}};
  }
  std::vector<ReferenceCase> cases;
  for (std::size_t i = 1; i < records.size(); ++i) {
    std::vector<std::string>& f = records[i];
    if (f.size() != headings.size()) {
      return Error{
          ErrorCode::kCellBadText, "record " + std::to_string(i) + " has not five fields", {}};
    }
    cases.push_back({f[0], f[1], f[2], f[3], f[4]});
  }
  return cases;
}

ReferenceVerdict Judge(const ReferenceCase& reference) {
  using nlohmann::json;
  ReferenceVerdict verdict;
  const json input = json::parse(reference.input, nullptr, false);
  const json output = json::parse(reference.output, nullptr, false);
  if (!input.is_object() || !output.is_object() || !input.contains("f") ||
      !input["f"].is_string()) {
    return {ReferenceVerdict::Kind::kUnreadable, {"input or output is not a JSON object with f"}};
  }
  Figures figures;
  try {
    Result<Figures> computed = Compute(input);
    if (!computed) return {ReferenceVerdict::Kind::kUnreadable, {computed.error().detail}};
    figures = std::move(*computed);
  } catch (const json::exception& error) {  // a member is missing or of another type
    return {ReferenceVerdict::Kind::kUnreadable, {error.what()}};
  }
  if (output.empty())
    return {ReferenceVerdict::Kind::kUnreadable, {"the output names no figure to compare with"}};
  for (const auto& [name, value] : output.items()) {
    if (!value.is_number())
      return {ReferenceVerdict::Kind::kUnreadable, {name + " is not a number"}};
    std::optional<double> ours;
    if (!AgreesWith(figures, name, value.get<double>(), ours)) {
      verdict.kind = ReferenceVerdict::Kind::kDiffers;
      verdict.differences.push_back(name + ": " + (ours ? ShortestText(*ours) : "not computed") +
                                    ", reference " + ShortestText(value.get<double>()));
    }
  }
  return verdict;
}

}  // namespace rmlcell::motion
