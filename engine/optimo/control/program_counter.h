#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/optimo/control/program_context.h"
#include "engine/optimo/machine/situation.h"
#include "engine/optimo/machine/telling.h"

namespace rmlcell::optimo {

struct ProgramCounterState {
  std::vector<ProgramContext> programs{};  // innermost last; empty: none was found
  std::map<int, std::string> made_executables{};
  std::map<int, Loaded> loaded{};  // executables of this run, by slot
  int selected = 0;                // main program whose executions VI[98] counts, OPT-B.63
};

// Which instruction is next: programs that CALL programs, modules that call FUNCTIONs, GOSUBs in
// them, and the GOSUBs of timers. It evaluates nothing.
//
//   CALL, GO          Begin            the end of a program   EndProgram
//   FUNCTION          EnterFunction    its ENDTASK, RETURN    LeaveFunction
//   GOSUB, TIMER      Gosub            RETURN                 ReturnFromGosub
//
//   timer     by                                        next
//   any       TIMER           SetTimer                  kCounts: a new one takes its place
//             TIMER /DIS      ClearTimer                kNone
//   kCounts   it is due       TakeDueGosub              kRuns with /AUTO, else kNone: its GOSUB is
//                                                       made
//   kRuns     RETURN from it  ReturnFromGosub           kCounts, to the next period not yet missed
//   kCounts,  CALL            Begin                     kStands
//   kRuns     activation over TakeDueGosub, in that     kNone
//                             which called it
//   kStands   end of CALLed   EndProgram                what it was before, with the time left
//   any       GO, the end of its program                kNone: each program has its own
class ProgramCounter {
 public:
  static constexpr std::size_t kFunctionLevels = 4;  // OPT-9.08

  ProgramCounter(ProgramCounterState& state, const Situation& situation,
                 const OptimoParameters& parameters, const machine::RunSetup& setup,
                 const Telling& telling)
      : s_(state),
        situation_(situation),
        parameters_(parameters),
        setup_(setup),
        telling_(telling) {}

  // Before the main program began, or when there is none: then nothing below may be asked.
  bool empty() const { return s_.programs.empty(); }
  const std::vector<ProgramContext>& programs() const { return s_.programs; }
  ProgramContext& program() { return s_.programs.back(); }
  const ProgramContext& program() const { return s_.programs.back(); }
  Frame& frame() { return program().frames.back(); }
  const Frame& frame() const { return program().frames.back(); }
  const LinkedModule& linked() const {
    return program().program->executable.modules[static_cast<std::size_t>(frame().module)];
  }
  const Module& module() const { return linked().module; }
  const ModuleIndex& index() const {
    return program().program->index[static_cast<std::size_t>(frame().module)];
  }
  Modal& modal() { return program().modal; }
  const Modal& modal() const { return program().modal; }

  std::size_t call_level() const { return s_.programs.size(); }  // 1: no CALL is open
  std::size_t level() const { return program().frames.size(); }  // 1: the main module
  bool in_function() const { return level() > 1; }
  bool in_gosub() const { return !frame().returns.empty(); }
  // A TIMER is set, or a GOSUB due: instructions may be followed by one that no program asks for.
  bool may_be_interrupted() const { return program().timer || program().due_gosub; }

  // The executable of a slot: the stored one, or made of the object now (OPT-1.11).
  // Errors: ProgramMissing, ObjectCorrupt, CallNotExecutable, CmosFull, those of Link.
  Result<Loaded> Acquire(int slot, bool must_be_executable);
  void Begin(Loaded loaded, const std::array<float, kParameterCount>& parameters);
  // Of a CALLed program: the one that called it goes on.
  void EndProgram();
  // The main program, in place of all that runs. False: it was selected before. OPT-B.63
  bool BeginMain(const Loaded& loaded, int slot);
  // GO selects its program anew.
  void Deselect() { s_.selected = 0; }

  // Errors: LabelNotFound; Gosub: GosubTooDeep, too.
  Status Jump(int label);
  Status Gosub(int label);
  void ReturnFromGosub();
  // Errors: FunctionTooDeep, FunctionMissing.
  Result<const LinkedModule*> FindFunction(int slot) const;
  void EnterFunction(const LinkedModule& function,
                     const std::array<float, kParameterCount>& parameters);
  void LeaveFunction() { program().frames.pop_back(); }

  // An error goes on at the label of the innermost module with an armed ERR, up to the main module
  // of this executable, and disarms it; what is called from there is over. False: none is armed.
  // Errors: LabelNotFound, where nothing has changed. OPT-3.55, OPT-3.57
  Result<bool> JumpToErrorLabel();

  // `period`, `due`: OPT-B.30
  void SetTimer(int label, SimTime due, SimTime period, bool repeats);
  void ClearTimer() { program().timer.reset(); }
  // The sequence number of a GOSUB that is due between two instructions, of TIMER or of the /TIME
  // of a /NEXT motion: made in the activation that asked for it, and dropped when that is over.
  std::optional<int> TakeDueGosub();
  // The machine stood halted so long.
  void Shift(SimTime stood);
  void MakeDue(const DueGosub& gosub) { program().due_gosub = gosub; }

 private:
  bool HasRoomFor(std::size_t bytes) const;
  Result<Loaded> LoadStored(int slot, std::string_view bytes);
  Result<Loaded> Make(int slot);

  ProgramCounterState& s_;
  const Situation& situation_;
  const OptimoParameters& parameters_;
  const machine::RunSetup& setup_;
  const Telling& telling_;
};

}  // namespace rmlcell::optimo
