#include "engine/simulation/run/simulate.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <ranges>
#include <set>
#include <system_error>
#include <tuple>
#include <utility>

#include "clients/cli/findings_text.h"
#include "clients/cli/local.h"
#include "clients/cli/messages.h"
#include "clients/cli/milling.h"
#include "clients/cli/program_files.h"
#include "clients/cli/terminal.h"
#include "clients/cli/verdict_text.h"
#include "engine/core/number_text.h"
#include "engine/simulation/report/facts.h"
#include "engine/simulation/verdict/verdict.h"
#include "proto/bridge/files.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/framing.h"
#include "proto/bridge/report.h"
#include "proto/bridge/setup.h"
#include "proto/bridge/spooled_bytes.h"
#include "proto/bridge/thread_pool.h"

namespace rmlcell::cli {
namespace {

// What was found in the text, and is found again at the same place when it runs.
void DropFindings(const simulation::PreparedRun& before, v1::RunReport& report) {
  const std::vector<Diagnostic>& told = before.diagnostics;
  std::set<std::tuple<std::string, int, int>> places;
  for (const Diagnostic& finding : told)
    places.emplace(CodeText(finding.code), finding.where.line, finding.where.column);
  auto& again = *report.mutable_diagnostics();
  again.erase(
      std::remove_if(again.begin(), again.end(),
                     [&](const v1::Diagnostic& finding) {
                       const v1::SourcePlace& place = finding.place();
                       return place.line() > 0 &&
                              places.contains({finding.code(), place.line(), place.column()});
                     }),
      again.end());
  // What the text counts of a kind, the run counts, too.
  auto& kinds = *report.mutable_gathered();
  for (int i = kinds.size(); i-- > 0;) {
    const auto of_text = std::ranges::find_if(
        before.diagnostics_dropped.kinds(),
        [&](const auto& kind) { return CodeText(kind.first) == kinds[i].code(); });
    if (of_text == before.diagnostics_dropped.kinds().end()) continue;
    const bool more = kinds[i].count() > static_cast<std::int64_t>(of_text->second.count);
    if (more) continue;
    report.set_diagnostics_dropped(report.diagnostics_dropped() - kinds[i].count());
    kinds.DeleteSubrange(i, 1);
  }
}

std::vector<std::string> SplitCommas(const std::string& text) {
  std::vector<std::string> parts;
  for (const auto part : std::views::split(text, ',')) {
    if (!part.empty()) parts.emplace_back(part.begin(), part.end());
  }
  return parts;
}

// A program that cannot run: its findings, and a verdict all the same.
int TellWhyNot(const SimulateOptions& options, const simulation::ProgramMemory& memory,
               const simulation::PreparedRun& prepared) {
  const machine::Judgement judgement = simulation::JudgeFindings(prepared.diagnostics);
  if (options.json) {
    v1::Findings found =
        bridge::FindingsOf(false, prepared.diagnostics, prepared.diagnostics_dropped, {});
    bridge::SetJudgement(judgement, found);
    found.set_family(std::string(memory.family->info().id));
    bridge::SetMachine(simulation::MachineOf(memory), found);
    PrintJson(found);
  } else if (options.facts) {
    simulation::RunReport report;
    report.family = memory.family->info().id;
    report.machine = simulation::MachineOf(memory);
    report.finished = true;
    report.outcome.kind = machine::OutcomeKind::kFailed;
    if (!judgement.reasons.empty()) report.outcome.code = judgement.reasons.front().code;
    report.judgement = judgement;
    PrintRaw(simulation::FactsText(report));
  } else {
    std::string_view source;
    if (memory.programs.size() == 1) source = *memory.programs.front().bytes;
    PrintFindings(prepared.diagnostics, prepared.diagnostics_dropped, source);
    PrintRaw("verdict       " + VerdictText(v1::VERDICT_BAD) + "\n");
  }
  return kProgramErrors;
}

// What a run leaves besides its report, as the options ask for it. Must outlive the run.
class RunProducts {
 public:
  RunProducts(const SimulateOptions& options, const machine::FamilyInfo& family)
      : options_(options), family_(family) {}

  // Errors: CellUsage, CellInvalidArgument, CellFileUnwritable.
  Status AskFor(simulation::SimulationRequest& request) {
    request.products.picture = !options_.svg.empty();
    request.picture.machine_frame = options_.machine_coordinates;
    if (options_.trace) AskForTrace(request.products);
    if (!options_.toolpath.empty()) {
      request.products.toolpath = [this](std::string_view block) {
        bridge::AddFrame(block, toolpath_);
        return true;
      };
    }
    if (!options_.plot.empty()) {
      Result<std::vector<simulation::PlotCurve>> curves =
          simulation::ParsePlotCurves(options_.plot[0]);
      if (!curves) return curves.error();
      request.products.plot = true;
      request.plot.curves = *std::move(curves);
    }
    return options_.samples.empty() ? Status() : AskForSamples(request.products);
  }

  // A picture or plot that goes to standard output ("-") is not written here.
  Status Write(const simulation::SimulationResult& result, simulation::ParallelFor& parallel) {
    if (result.material) {
      if (const Status written =
              WriteMaterial(*result.material, result.target, options_.milling, parallel);
          !written)
        return written.error();
    }
    const std::string plot = options_.plot.empty() ? std::string() : options_.plot[1];
    const machine::Bytes toolpath = toolpath_.Finish();
    for (const Status& written :
         {WriteFile(options_.toolpath, *toolpath, toolpath.keeper()),
          plot == "-" ? Status() : WriteFile(plot, result.plot),
          options_.svg == "-" ? Status() : WriteFile(options_.svg, result.svg),
          WriteFile(options_.state_out, result.machine_state)}) {
      if (!written) return written;
    }
    if (!samples_.is_open()) return {};
    samples_.close();
    if (samples_) return {};
    return Error{
        ErrorCode::kCellFileUnwritable, options_.samples[1] + ": not written to its end", {}};
  }

  // Of what turned out to be no program.
  void Discard() {
    if (!samples_.is_open()) return;
    samples_.close();
    std::error_code ignored;
    std::filesystem::remove(options_.samples[1], ignored);
  }

  // Of --trace with --json: a part of the report.
  void MoveTraceTo(v1::RunReport& report) {
    report.mutable_trace_records()->Swap(traced_.mutable_trace_records());
  }

 private:
  void AskForTrace(simulation::Products& products) {
    products.trace = [this](const simulation::TraceRecord& record) {
      if (options_.json) {
        *traced_.add_trace_records() = bridge::ToProto(family_, record);
      } else {
        line_.clear();
        simulation::AppendTraceText(record, line_);
        line_ += '\n';
        PrintRaw(line_);
      }
      return true;
    };
  }

  Status AskForSamples(simulation::Products& products) {
    const Result<double> rate = simulation::ParseSampleRate(options_.samples[0]);
    if (!rate) return rate.error();
    samples_.open(options_.samples[1], std::ios::binary | std::ios::trunc);
    if (!samples_) {
      return Error{ErrorCode::kCellFileUnwritable, options_.samples[1] + ": cannot be written", {}};
    }
    products.samples_hz = *rate;
    products.samples = [this](std::string_view lines) {
      return static_cast<bool>(
          samples_.write(lines.data(), static_cast<std::streamsize>(lines.size())));
    };
    return {};
  }

  static Status WriteFile(const std::string& file, std::string_view bytes,
                          const machine::BytesKeeper* keeper = nullptr) {
    return file.empty() ? Status() : WriteWholeFile(file, bytes, keeper);
  }

  const SimulateOptions& options_;
  machine::FamilyInfo family_;
  v1::RunReport traced_;
  std::string line_;  // of the trace: its room is kept
  bridge::SpooledBytes toolpath_;
  std::ofstream samples_;
};

// The programs of a run. Streams call no others: a second one would be loaded and never run.
Result<LoadedFiles> LoadPrograms(const SimulateOptions& options, const std::string& family) {
  Result<LoadedFiles> loaded = OpenFiles(options.files, options.slots, options.main_slot, family,
                                         [] { std::fflush(stdout); });
  if (!loaded || loaded->family->tools() != nullptr || loaded->programs.size() == 1 ||
      options.main_slot != 0) {
    return loaded;
  }
  return Error{ErrorCode::kCellUsage,
               std::to_string(loaded->programs.size()) +
                   " programs for a machine whose programs call no others: simulate one at a time, "
                   "or say which by --main",
               {}};
}

// What runs, on which machine, and what is asked about it.
struct PreparedCommand {
  LoadedFiles loaded;
  simulation::ProgramMemory memory;
  simulation::RunOptions how;
  simulation::PreparedRun run;
  std::vector<std::string> variables;
};

// A stream that comes runs as it comes, and is checked when all of it is there; unless its
// beginning is no program already: then it is read to its end first, as others are. Errors: those
// of reading it; of MakeParameters.
Status LookAtBeginning(LoadedFiles& loaded, simulation::ProgramMemory& memory) {
  simulation::MemoryProgram& program = memory.programs.front();
  const auto parameters =
      machine::MakeParameters(*memory.family, memory.profile, memory.parameters);
  if (!parameters) return parameters.error();
  if (simulation::TranslateProgram(*memory.family, *parameters, program, {.advice = false}).ok) {
    auto unchecked = std::make_shared<machine::Translation>();
    unchecked->ok = unchecked->as_it_came = true;
    program.translation = std::move(unchecked);
    return {};
  }
  program.bytes.ReadAll();
  return std::exchange(loaded.stream, nullptr)->status();
}

// Behind its run. Errors: those of reading it; of PrepareRun.
Status CheckWhole(PreparedCommand& prepared) {
  simulation::MemoryProgram& program = prepared.memory.programs.front();
  program.bytes.ReadAll();
  program.translation = nullptr;
  if (const Status& read = prepared.loaded.stream->status(); !read) return read.error();
  Result<simulation::PreparedRun> whole = simulation::PrepareRun(prepared.memory, prepared.how);
  if (!whole) return whole.error();
  prepared.run = *std::move(whole);
  return {};
}

Result<PreparedCommand> Prepare(const SimulateOptions& options) {
  Result<bridge::MachineFile> machine = ReadMachine(options.machine);
  if (!machine) return machine.error();
  Result<LoadedFiles> loaded = LoadPrograms(options, machine->family);
  if (!loaded) return loaded.error();
  if (const Status placed = PlaceWork(options.machine, *loaded->family, machine->parameters);
      !placed)
    return placed.error();
  const Result<v1::SimulationOptions> message = OptionsMessage(options, *loaded->family);
  if (!message) return message.error();
  if (const Status there = CheckPlaces(*message, loaded->programs); !there) return there.error();
  const Result<v1::Budget> budget = ParseBudget(options.budget);
  if (!budget) return budget.error();
  Result<std::vector<std::string>> variables =
      bridge::ExpandVariables(SplitCommas(options.variables));
  if (!variables) return variables.error();
  const Result<std::vector<int>> to_make =
      AddExecutables(options.executables, *loaded->family, loaded->programs);
  if (!to_make) return to_make.error();
  Result<std::string> state = std::string();
  if (!options.state_in.empty()) state = bridge::ReadFile(options.state_in, kFileBytesMax);
  if (!state) return state.error();

  simulation::ProgramMemory memory{.family = loaded->family,
                                   .profile = machine->profile,
                                   .parameters = machine->parameters,
                                   .parameters_of = ParametersOf(options.machine),
                                   .own = OwnOf(options.machine, *machine),
                                   .programs = loaded->programs,
                                   .machine_state = *std::move(state)};
  const Result<simulation::RunOptions> how =
      bridge::RunOptionsOf(*message, *budget, loaded->main_slot, machine::Mode::kCycle);
  if (!how) return how.error();
  if (loaded->stream != nullptr) {
    if (const Status looked = LookAtBeginning(*loaded, memory); !looked) return looked.error();
  }
  Result<simulation::PreparedRun> run = simulation::PrepareRun(memory, *how);
  if (!run) return run.error();
  for (const int slot : *to_make) {
    if (!run->setup) break;  // it is told why
    if (const Status made = simulation::MakeExecutable(*loaded->family, *run->setup, slot); !made)
      return made.error();
  }
  return PreparedCommand{*std::move(loaded), std::move(memory), *how, *std::move(run),
                         *std::move(variables)};
}

// The picture or plot, where that is to be a file of its own, or the report.
void TellResult(const SimulateOptions& options, const simulation::SimulationResult& result,
                const simulation::PreparedRun& run, v1::RunReport report) {
  if (options.svg == "-") {
    PrintRaw(result.svg);
  } else if (!options.plot.empty() && options.plot[1] == "-") {
    PrintRaw(result.plot);
  } else if (options.json) {
    PrintJson(report);
  } else if (options.facts) {
    PrintRaw(simulation::FactsText(result.report));
    for (const auto& [name, value] : result.variables)
      Print("variable." + name + ": " + value.text);
  } else {
    PrintFindings(run.diagnostics, run.diagnostics_dropped, {});
    DropFindings(run, report);
    PrintRaw(ReportText(report, options.machine_coordinates ? Zero::kMachine : Zero::kWork));
  }
}

}  // namespace

int Simulate(const SimulateOptions& options) {
  Result<PreparedCommand> prepared = Prepare(options);
  if (!prepared) return Refuse(prepared.error());
  const machine::MachineFamily& family = *prepared->loaded.family;
  simulation::PreparedRun& run = prepared->run;
  if (!run.setup) return TellWhyNot(options, prepared->memory, run);

  bridge::ThreadPool threads(bridge::ThreadsForMaterial());
  simulation::SimulationRequest request;
  RunProducts products(options, family.info());
  if (const Status asked = products.AskFor(request); !asked) return Refuse(asked.error());
  request.products.each_step = options.json;  // texts have nothing of single steps
  if (!options.milling.block.stock.empty()) {
    Result<simulation::Milling> milling =
        MillingOf(options.milling, family.Shape(run.setup->parameters), prepared->memory);
    if (!milling) return Refuse(milling.error());
    request.products.milling = *std::move(milling);
    request.products.parallel = &threads;
  }
  request.variables = prepared->variables;
  ProgressLine progress;
  request.options.slice = std::chrono::seconds(10);
  int slices = 0;
  request.options.progress = [&](const simulation::Progress& here) {
    if (++slices % 16 == 0 && !options.json) {
      progress.Show(here.state.progress,
                    Fixed(ToSeconds(here.state.time), 1) + " s of virtual time");
    }
    return true;
  };
  const Result<simulation::SimulationResult> result =
      simulation::Simulate(family, *std::move(run.setup), std::move(request));
  progress.Clear();
  if (!result) return Refuse(result.error());
  if (prepared->loaded.stream != nullptr) {
    const Status whole = CheckWhole(*prepared);
    if (!whole || !run.setup) products.Discard();
    if (!whole) return Refuse(whole.error());
    if (!run.setup) return TellWhyNot(options, prepared->memory, run);
  }
  if (const Status written = products.Write(*result, threads); !written)
    return Refuse(written.error());
  for (const std::string& name : prepared->variables) {
    if (std::ranges::find(result->variables, name, &machine::NamedVariable::name) !=
        result->variables.end())
      continue;
    Complain("the machine has no variable " + name);
    break;
  }
  v1::RunReport report = bridge::ToProto(family.info(), result->report, result->variables);
  const v1::Outcome outcome = report.outcome();
  products.MoveTraceTo(report);
  machine::MarkJudged(result->report.judgement, run.diagnostics);
  machine::MarkJudged(result->report.judgement, run.diagnostics_dropped);
  TellResult(options, *result, run, std::move(report));
  return ExitOf(outcome, options.strict);
}

}  // namespace rmlcell::cli
