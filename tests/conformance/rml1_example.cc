#include "tests/conformance/rml1_example.h"

#include <fstream>
#include <sstream>

#include "engine/core/check.h"
#include "engine/rml1/profile.h"

namespace rmlcell::rml1::conformance {
namespace {

// One record of a CSV text: fields with quotes doubled inside quotes; no line ends inside fields.
std::vector<std::string> CsvFields(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += '"';
      ++i;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

std::string Trim(std::string text) {
  const std::size_t begin = text.find_first_not_of(' ');
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

std::vector<std::string> SplitAt(const std::string& text, const std::string& separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (;;) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == std::string::npos) return parts;
    begin = end + separator.size();
  }
}

// "{T1A} {dc} PU;" -> "{T1A} {dc}" and "PU;". {resume} belongs to the input.
void SplitTags(const std::string& text, Example& example) {
  std::size_t at = 0;
  while (text.compare(at, 1, "{") == 0 && text.compare(at, 8, "{resume}") != 0) {
    const std::size_t end = text.find("} ", at);
    if (end == std::string::npos) break;
    at = end + 2;
  }
  example.tags = Trim(text.substr(0, at));
  example.input = text.substr(at);
}

bool IsExampleRow(const std::string& line) {
  if (line.rfind("| RML1-", 0) != 0) return false;
  const char chapter = line[7];
  return chapter >= '1' && chapter <= '7';
}

bool HasTag(const Example& example, const std::string& tag) {
  return example.tags.find("{" + tag + "}") != std::string::npos;
}

}  // namespace

std::vector<Example> LoadExamples(const std::string& csv_path) {
  std::vector<Example> examples;
  std::ifstream file(csv_path);
  std::string line;
  std::getline(file, line);  // heading
  while (std::getline(file, line)) {
    const std::vector<std::string> fields = CsvFields(line);
    RMLCELL_CHECK(fields.size() == 5);
    examples.push_back({fields[0], std::stoi(fields[1]), fields[2], fields[3], fields[4]});
  }
  return examples;
}

std::vector<Example> ExtractExamples(const std::string& spec_path) {
  std::vector<Example> examples;
  std::ifstream file(spec_path);
  std::string line;
  while (std::getline(file, line)) {
    if (!IsExampleRow(line)) continue;
    const std::vector<std::string> cells = SplitAt(line, " | ");
    if (cells.size() < 4) continue;
    int number = 0;
    for (std::string part : SplitAt(cells[cells.size() - 2], "<br>")) {
      part = Trim(part);
      const std::size_t arrow = part.find("` -> ");
      if (part.empty() || part[0] != '`' || arrow == std::string::npos) continue;
      Example example;
      example.id = cells[0].substr(2);
      example.number = ++number;
      SplitTags(part.substr(1, arrow - 1), example);
      example.facts = part.substr(arrow + 5);
      examples.push_back(example);
    }
  }
  return examples;
}

std::vector<Stroke> Unescape(std::string_view input) {
  constexpr std::string_view kResume = "{resume}";
  std::vector<Stroke> strokes(1);
  std::string* out = &strokes.back().bytes;
  for (std::size_t i = 0; i < input.size(); ++i) {
    if (input.substr(i, kResume.size()) == kResume) {
      strokes.back().resume = true;
      out = &strokes.emplace_back().bytes;
      i += kResume.size() - 1;
    } else if (input[i] != '\\') {
      *out += input[i];
    } else {
      const char c = input[++i];
      if (c == 'x') {
        *out += static_cast<char>(std::stoi(std::string(input.substr(i + 1, 2)), nullptr, 16));
        i += 2;
      } else {
        *out += c == 'r' ? '\r' : c == 'n' ? '\n' : '\t';
      }
    }
  }
  return strokes;
}

machine::Parameters ParametersFor(const Example& example) {
  machine::Parameters parameters(ParameterTable());
  const auto set = [&](const char* name, std::string_view word) {
    RMLCELL_CHECK(parameters.Set(name, word).ok());
  };
  for (const machine::MachineProfile& profile : MachineProfiles()) {
    const bool wanted = (HasTag(example, "T1A") && profile.id == "t1a") ||
                        (HasTag(example, "T1N") && profile.id == "t1n") ||
                        (HasTag(example, "T1S") && profile.id == "t1s") ||
                        (HasTag(example, "T1F") && profile.id == "t1f");
    if (wanted) RMLCELL_CHECK(parameters.Apply(profile).ok());
  }
  if (HasTag(example, "mode1")) set("COMMAND", "MODE1");
  if (HasTag(example, "mode2")) set("COMMAND", "MODE2");
  if (HasTag(example, "7bit")) set("DATA_BITS", "7");
  if (HasTag(example, "dc")) set("SEQUENCES", "ALL");
  if (HasTag(example, "pause")) set("OVER_AREA", "PAUSE");
  const std::size_t origin = example.tags.find("{origin ");
  if (origin != std::string::npos) {
    std::istringstream numbers(example.tags.substr(origin + 8));
    double x = 0.0;
    double y = 0.0;
    numbers >> x >> y;
    RMLCELL_CHECK(parameters.Set("ORIGIN_X", x / 100.0).ok());
    RMLCELL_CHECK(parameters.Set("ORIGIN_Y", y / 100.0).ok());
  }
  return parameters;
}

bool ResumesOutsidePauses(const Example& example) { return HasTag(example, "pause"); }

}  // namespace rmlcell::rml1::conformance
