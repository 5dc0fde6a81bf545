#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/machine/family.h"
#include "engine/simulation/run/rehearsal.h"
#include "proto/bridge/setup.h"
#include "rmlcell/v1/program.pb.h"
#include "server/programs/program_result.h"
#include "storage/store.h"

namespace rmlcell::server {

struct Config;
struct ProgramPlace;

// The program memory of machines: translation, checks and storage of programs.
// Thread-safe; blocks on the store and on compilation.
class ProgramBook {
 public:
  ProgramBook(storage::Store& store, const Config& config) : store_(store), config_(config) {}

  // Asked whether a run of the machine is in the program of a slot, before that is deleted: as its
  // host told last, so that one that begins in this moment is not known. OPT-4.63
  void OnInUse(std::function<bool(const std::string& machine, int slot)> is_in_use) {
    is_in_use_ = std::move(is_in_use);
  }
  // Before who stored something in the memory of a machine is answered. LIVE-3.20
  void OnStored(std::function<void()> stored) { on_stored_ = std::move(stored); }
  void TellStored() const {
    if (on_stored_) on_stored_();
  }

  struct Put {
    std::string name;  // resource name
    std::string file_name;
    v1::ProgramForm form = v1::PROGRAM_FORM_UNSPECIFIED;
    std::string title;
    std::string etag;
    std::string bytes;
    bool validate_only = false;
    bool force = false;
    std::string caller{};
  };
  // All or nothing. Errors: CellEmptyProgram, CellTooLarge, the first compile error,
  // CellEtagMismatch, CellUnknownMachine, FamilyInfo::no_slot, empty_slot for an executable without
  // its object and CellInvalidArgument for that of another program (OPT-1.15),
  // MachineFamily::ProgramMemory where there is no room (OPT-B.73).
  ProgramResult<v1::Program> Store(Put put);

  Result<v1::Program> Get(std::string_view name);

  struct Content {
    std::string bytes;
    v1::ProgramForm form = v1::PROGRAM_FORM_SOURCE;
    std::string file_name;
    std::string sha256;
    bool own_text = false;        // a source as it was stored, not made of the object
    std::string object_sha256{};  // of the object that it belongs to
  };
  Result<Content> Read(std::string_view name, v1::ProgramForm form);

  Result<v1::ListProgramsResponse> List(const v1::ListProgramsRequest& request);
  Status Delete(const v1::DeleteProgramRequest& request, std::string_view caller);

  // Translates without storing. Errors: CellUnknownFamily and what names machine or family wrongly.
  Result<machine::Translation> Translate(const std::string& family, const std::string& machine,
                                         const v1::ProgramText& program, bool advice);

  // The same, and follows the motion of what has no errors; on a machine in the state in which that
  // is, with its programs.
  Result<simulation::CheckedProgram> Check(const std::string& family, const std::string& machine,
                                           const v1::ProgramText& program, bool advice);

  // A stored program with all that it needs to run on its machine as that stands. Errors:
  // CellUnknownMachine, FamilyInfo::no_slot, empty_slot.
  struct Opened {
    simulation::ProgramMemory memory{};
    int slot = 0;
    std::string etag{};  // of the object
  };
  Result<Opened> Open(std::string_view name);

  // Of a whole program. Error: CellTooLarge, with the limit of the configuration.
  Status CheckSize(std::int64_t bytes) const;

 private:
  Result<std::optional<storage::ProgramSummary>> FindExpected(const std::string& machine, int slot,
                                                              storage::Revision expected);
  // What a program is checked for.
  struct Subject {
    const machine::MachineFamily* family = nullptr;
    std::optional<storage::MachineMemory> memory{};
    std::optional<machine::Parameters> parameters{};
  };
  // The memory of the machine has its programs where `wants_programs` says so.
  Result<Subject> FindSubject(const std::string& family, const std::string& machine,
                              const v1::ProgramText& program,
                              const storage::Store::WantsPrograms& wants_programs);
  ProgramResult<v1::Program> StoreExecutable(const Put& put, const ProgramPlace& place);

  storage::Store& store_;
  const Config& config_;
  std::function<bool(const std::string&, int)> is_in_use_{};
  std::function<void()> on_stored_{};
};

}  // namespace rmlcell::server
