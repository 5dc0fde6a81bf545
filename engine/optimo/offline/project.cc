#include "engine/optimo/offline/project.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "engine/core/units.h"
#include "engine/optimo/language/checker.h"
#include "engine/optimo/language/program.h"
#include "engine/optimo/offline/convert.h"
#include "engine/optimo/offline/text_edits.h"
#include "engine/optimo/offline/translate.h"

namespace rmlcell::optimo {
namespace {

constexpr std::size_t kProcesses = 30;  // kinds 0..2, numbers 0..9

std::size_t ProcessIndex(const Instruction& i) { return i.numbers[0] * 10U + i.numbers[1]; }
Detail ProcessText(std::size_t process) {
  return Told("kind", process / 10) + "," + Told("process", process % 10);
}

// A program on its way through the transfer.
struct Draft {
  const machine::ProjectProgram* from = nullptr;
  std::string text;  // metric
  ParsedProgram parsed;
  std::set<int> functions;                           // FUNCTION numbers that it uses
  std::array<bool, kProcesses> defines{};            // it has this WORKDEF
  std::array<std::uint32_t, kProcesses> first_on{};  // instruction of its first WORK ON, plus one
  bool uses_sysdef = false;
  bool absol_move_without_sysdef = false;
  bool own_text = true;  // but for units it is what the project has
};

class Planner {
 public:
  Planner(const machine::ProjectBundle& project, const machine::TransferOptions& options,
          std::uint32_t object_limit, const ContourMachine& contour_machine)
      : project_(project),
        options_(options),
        object_limit_(object_limit),
        contour_machine_(contour_machine) {}

  machine::TransferPlan Run() {
    drafts_.reserve(project_.programs.size());  // ParsedProgram::text looks into Draft::text
    CheckBundle();
    for (const machine::ProjectProgram& program : project_.programs) AddDraft(program);
    for (Draft& draft : drafts_) CompareDefinitions(draft);
    for (Draft& draft : drafts_) RequireDefinitions(draft);
    AdviseSysdef();
    for (Draft& draft : drafts_) CompileDraft(draft);
    plan_.ok = !failed_;
    if (failed_) plan_.programs.clear();  // all or nothing, OPT-8.71
    return std::move(plan_);
  }

 private:
  void CheckBundle();
  void AddDraft(const machine::ProjectProgram& program);
  void Survey(Draft& draft);
  void CompareDefinitions(Draft& draft);
  void CompareOne(Draft& draft, const Instruction& i);
  void RequireSchedule(const Draft* draft, const Instruction* i, double number);
  void RequireDefinitions(Draft& draft);
  void AdviseSysdef();
  void CompileDraft(Draft& draft);
  std::set<int> Relatives(int slot) const;

  void Add(Diagnostic diagnostic) {
    failed_ = failed_ || IsError(diagnostic.severity);
    plan_.diagnostics.push_back(std::move(diagnostic));
  }
  // A finding about the project as a whole, or about a statement of a program.
  void Report(ErrorCode code, Detail detail, std::string_view rule, const Draft* draft = nullptr,
              const Instruction* i = nullptr) {
    Findings findings;
    findings.Add(code, draft != nullptr && i != nullptr ? draft->parsed.At(*i) : Place{},
                 std::move(detail), rule);
    Diagnostic found =
        findings
            .Take(draft != nullptr ? std::string_view(draft->text) : std::string_view(),
                  draft != nullptr ? draft->from->file.name : "")
            .front();
    if (draft != nullptr) found.program = draft->from->slot;
    Add(std::move(found));
  }
  const machine::ProcessDefinition* Definition(std::size_t process) const {
    const auto found = definitions_.find(process);
    return found == definitions_.end() ? nullptr : found->second;
  }

  const machine::ProjectBundle& project_;
  const machine::TransferOptions& options_;
  std::uint32_t object_limit_;
  const ContourMachine& contour_machine_;
  machine::TransferPlan plan_;
  std::vector<Draft> drafts_;
  std::map<std::size_t, const machine::ProcessDefinition*> definitions_;
  std::set<int> schedules_;
  bool failed_ = false;
};

void Planner::CheckBundle() {
  std::set<int> slots;
  for (const machine::ProjectProgram& program : project_.programs) {
    if (!IsSlot(program.slot)) {
      Report(ErrorCode::kProgramNumber,
             "program number " + Told("program", program.slot) + " is outside 1..99", "OPT-1.10");
    } else if (!slots.insert(program.slot).second) {
      Report(ErrorCode::kProjectDuplicate,
             "program " + Told("program", program.slot) + " stands twice", "OPT-8.68");
    }
  }
  for (const machine::LaserSchedule& schedule : project_.schedules) {
    const Detail text = "laser schedule " + Told("schedule", schedule.number);
    if (schedule.number < 1 || schedule.number > 63) {
      Report(ErrorCode::kScheduleRange, text + " is outside 1..63", "OPT-3.44");
    } else if (!schedules_.insert(schedule.number).second) {
      Report(ErrorCode::kProjectDuplicate, text + " stands twice", "OPT-8.68");
    }
  }
  for (const machine::ProcessDefinition& definition : project_.processes) {
    std::vector<Diagnostic> errors = CheckProcess(definition);
    const bool good = errors.empty();
    for (Diagnostic& error : errors) Add(std::move(error));
    if (!good) continue;
    const auto process = static_cast<std::size_t>(definition.kind * 10 + definition.process);
    if (!definitions_.emplace(process, &definition).second) {
      Report(ErrorCode::kProjectDuplicate,
             "process definition " + ProcessText(process) + " stands twice", "OPT-8.68");
    }
    if (definition.kind == 2) RequireSchedule(nullptr, nullptr, definition.values[0]);
    if (definition.values.size() == 5) RequireSchedule(nullptr, nullptr, definition.values[4]);
  }
}

void Planner::AddDraft(const machine::ProjectProgram& program) {
  Draft& draft = drafts_.emplace_back();
  draft.from = &program;
  if (program.file.bytes.empty()) {
    return Report(ErrorCode::kProjectSource,
                  "program " + Told("program", program.slot) + " has no text", "OPT-8.68", &draft);
  }
  const FileForm form = FormOfFile(program.file.name, program.file.bytes);
  if (form == FileForm::kObject) {
    const Result<std::string> source = ObjectToSource(program.file.bytes);
    if (!source) return Report(source.error().code, source.error().detail, "OPT-B.71", &draft);
    draft.text = *source;
    draft.own_text = false;
  } else if (program.inch || form == FileForm::kInchSource) {
    Conversion converted = Convert(program.file.bytes, Direction::kToMetric);
    draft.text = std::move(converted.text);
    draft.own_text = form == FileForm::kInchSource;  // else its name would not tell its units
    for (Diagnostic& found : converted.diagnostics) {
      // What is no legal RML is reported by the compiler, with its own code.
      if (found.code == ErrorCode::kConvertNotRml) continue;
      found.file = program.file.name;
      found.program = program.slot;
      // CONVERT goes on after this, and so does the transfer: what may still be inches is told.
      Add(std::move(found));
    }
    converted.diagnostics_dropped.ForEachPlace([&program](Diagnostic& place) {
      place.file = program.file.name;
      place.program = program.slot;
    });
    for (const auto& [code, kind] : converted.diagnostics_dropped.kinds()) {
      if (code != ErrorCode::kConvertNotRml) plan_.diagnostics_dropped.Add(kind);
    }
  } else {
    draft.text = std::string(program.file.bytes);
  }
  for (const Diagnostic& found : CheckProgramNumber(program.slot, program.file.bytes))
    Report(found.code, found.detail, found.rule, &draft);
  Survey(draft);
}

void Planner::Survey(Draft& draft) {
  Findings unused(0);  // the compiler reports them, of the text as it is stored
  draft.parsed = Parse(draft.text, unused);
  Check(draft.parsed, unused);
  const Module& module = draft.parsed.module;
  bool absol = false;
  for (std::uint32_t n = 0; n < module.instructions.size(); ++n) {
    const Instruction& i = module.instructions[n];
    switch (i.op) {
      case Op::kFunction:
        draft.functions.insert(i.numbers[0]);
        break;
      case Op::kWorkdef:
        draft.defines[ProcessIndex(i)] = true;
        break;
      case Op::kWork:
        if (i.Has(kOn) && draft.first_on[ProcessIndex(i)] == 0)
          draft.first_on[ProcessIndex(i)] = n + 1;
        break;
      case Op::kSysdef:
        draft.uses_sysdef = true;
        break;
      case Op::kCoord:
        absol = i.choice == static_cast<std::uint8_t>(CoordType::kAbsol);
        break;
      case Op::kMove:
        if (absol && !draft.uses_sysdef) draft.absol_move_without_sysdef = true;
        break;
      default:
        break;
    }
  }
}

void Planner::RequireSchedule(const Draft* draft, const Instruction* i, double number) {
  const int schedule = static_cast<int>(number);
  if (schedule < 1 || schedule > 63 || schedules_.contains(schedule)) return;
  Report(ErrorCode::kProjectSource,
         "the project has no laser schedule " + Told("schedule", schedule), "OPT-8.68", draft, i);
}

void Planner::CompareDefinitions(Draft& draft) {
  for (const Instruction& i : draft.parsed.module.instructions) {
    if (i.op == Op::kWorkdef) CompareOne(draft, i);
  }
}

// Values that are computed cannot be compared; literals and constants must agree to 24 bits.
void Planner::CompareOne(Draft& draft, const Instruction& i) {
  const Module& module = draft.parsed.module;
  std::vector<std::optional<float>> values;
  for (int v = 0; v < i.value_count; ++v) {
    const Expression value = module.Value(i, v);
    const bool known =
        value.size() == 1 && value[0].op != Node::kVariable && value[0].op != Node::kName;
    values.push_back(known ? std::optional<float>(value[0].number) : std::nullopt);
  }
  const bool by_schedule = i.numbers[0] == 2 || values.size() == 5;
  if (by_schedule && values.back())
    RequireSchedule(&draft, &i, static_cast<double>(*values.back()));
  const std::size_t process = ProcessIndex(i);
  if (project_.processes.empty() || process < 10) return;  // kind 0 has no parameters
  const machine::ProcessDefinition* definition = Definition(process);
  if (definition == nullptr) {
    return Report(ErrorCode::kProjectProcess,
                  "the project has no definition of process " + ProcessText(process), "OPT-3.11",
                  &draft, &i);
  }
  bool differs = definition->values.size() != values.size();
  for (std::size_t v = 0; v < values.size() && !differs; ++v) {
    differs = values[v] && *values[v] != static_cast<float>(definition->values[v]);
  }
  if (!differs) return;
  Report(ErrorCode::kProjectProcess,
         "the project defines " + Told("definition", WorkdefText(*definition)), "OPT-3.11", &draft,
         &i);
}

// The programs whose WORKDEFs are in force where this one runs: those that it is a FUNCTION of and
// those that are FUNCTIONs of it, near and far. OPT-3.12, OPT-9.16
std::set<int> Planner::Relatives(int slot) const {
  std::set<int> found = {slot};
  for (bool more = true; more;) {
    more = false;
    for (const Draft& draft : drafts_) {
      const int own = draft.from->slot;
      for (const int function : draft.functions) {
        if (found.contains(own) && found.insert(function).second) more = true;
        if (found.contains(function) && found.insert(own).second) more = true;
      }
    }
  }
  return found;
}

void Planner::RequireDefinitions(Draft& draft) {
  struct Insertion {
    const Instruction* work;
    const machine::ProcessDefinition* definition;
  };
  std::vector<Insertion> insertions;
  std::optional<std::set<int>> relatives;
  for (std::size_t process = 1; process < kProcesses; ++process) {  // 0,0 needs none, OPT-3.10
    if (draft.first_on[process] == 0 || draft.defines[process]) continue;
    if (!relatives) relatives = Relatives(draft.from->slot);
    const bool elsewhere = std::ranges::any_of(drafts_, [&](const Draft& other) {
      return relatives->contains(other.from->slot) && other.defines[process];
    });
    if (elsewhere) continue;
    const Instruction& work = draft.parsed.module.instructions[draft.first_on[process] - 1];
    const machine::ProcessDefinition* definition = Definition(process);
    if (definition == nullptr) {
      Report(ErrorCode::kWorkdefMissing,
             "WORK " + ProcessText(process) +
                 " has neither a WORKDEF nor a process definition of the project",
             "OPT-3.09", &draft, &work);
    } else if (options_.insert_missing_definitions) {
      insertions.push_back({&work, definition});
    } else {
      Report(ErrorCode::kProjectProcess,
             "no WORKDEF before WORK " + ProcessText(process) + "; the project defines " +
                 Told("definition", WorkdefText(*definition)),
             "OPT-3.09", &draft, &work);
    }
  }
  if (insertions.empty()) return;
  // At the beginning, behind the declarations: every way to a WORK leads through there, jumps and
  // subroutines included. The beginning is TASK 1, where there is one (OPT-9.12).
  std::ranges::sort(insertions, {}, &Insertion::work);
  const ParsedProgram& parsed = draft.parsed;
  std::size_t first = 0;
  const auto declares = [&](Op op) {
    return op == Op::kDeclare || op == Op::kDefine || op == Op::kTask;
  };
  for (std::size_t i = 0; i + 1 < parsed.statements.size(); ++i) {
    const Instruction& instruction = parsed.module.instructions[i];
    if (instruction.op == Op::kTask && instruction.numbers[0] == 1) {
      first = i + 1;
      break;
    }
  }
  while (first + 1 < parsed.statements.size() && declares(parsed.module.instructions[first].op))
    ++first;
  const std::size_t begin = parsed.statements[first].begin;
  const std::size_t line = begin == 0 ? 0 : draft.text.rfind('\n', begin - 1) + 1;  // npos + 1 is 0
  std::string text;
  for (const Insertion& insertion : insertions) {
    text += "     " + WorkdefText(*insertion.definition) + std::string(LineEndOf(draft.text));
  }
  const std::vector<Fix> edits = {{static_cast<std::int64_t>(line), 0, std::move(text)}};
  draft.text = ApplyEdits(draft.text, edits);
  draft.own_text = false;
}

// If one program of a project uses SYSDEF, all should. OPT-7.39
void Planner::AdviseSysdef() {
  if (std::ranges::none_of(drafts_, &Draft::uses_sysdef)) return;
  for (const Draft& draft : drafts_) {
    if (!draft.absol_move_without_sysdef) continue;
    const bool function = std::ranges::any_of(
        drafts_, [&](const Draft& other) { return other.functions.contains(draft.from->slot); });
    if (function) continue;  // it moves in the system of its callers
    Report(ErrorCode::kPracticeAdvice,
           draft.uses_sysdef
               ? "ABSOL moves before the first SYSDEF of the program"
               : "ABSOL moves without SYSDEF, while other programs of the project use it",
           "OPT-7.39", nullptr);
    Diagnostic& found = plan_.diagnostics.back();
    found.program = draft.from->slot;
    found.file = draft.from->file.name;
  }
}

void Planner::CompileDraft(Draft& draft) {
  if (draft.text.empty()) return;
  Compilation compiled =
      Compile(draft.text, draft.from->file.name,
              {.object_limit = object_limit_, .further_advice = ContourAdvice(contour_machine_)});
  for (Diagnostic& found : compiled.diagnostics) {
    found.program = draft.from->slot;
    Add(std::move(found));
  }
  compiled.diagnostics_dropped.ForEachPlace(
      [&](Diagnostic& place) { place.program = draft.from->slot; });
  plan_.diagnostics_dropped.Add(compiled.diagnostics_dropped);
  if (!compiled.ok) return;
  plan_.programs.push_back(
      {draft.from->slot, std::move(draft.text), std::move(compiled.object), draft.own_text});
}

}  // namespace

machine::TransferPlan PlanTransfer(const machine::ProjectBundle& project,
                                   const machine::TransferOptions& options,
                                   std::uint32_t object_limit,
                                   const ContourMachine& contour_machine) {
  return Planner(project, options, object_limit, contour_machine).Run();
}

}  // namespace rmlcell::optimo
