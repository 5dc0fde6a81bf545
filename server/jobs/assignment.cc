#include "server/jobs/assignment.h"

#include <algorithm>

#include "engine/core/units.h"
#include "engine/families/families.h"
#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/job_book.h"
#include "server/jobs/job_milling.h"
#include "server/records/job_messages.h"
#include "server/records/machine_messages.h"

namespace rmlcell::server {
namespace {

// What is larger follows in messages of its own; all programs of an assignment together stay below
// the limit of one message.
constexpr std::size_t kInlineBytes = 64 << 10;
constexpr std::size_t kInlineTotal = 1 << 20;

template <class T>
T Least(T wanted, T allowed) {
  return wanted > T{0} ? std::min(wanted, allowed) : allowed;
}

v1::Budget BudgetOf(const v1::Budget& wanted, const Config& config) {
  v1::Budget budget;
  budget.set_steps(Least<std::int64_t>(wanted.steps(), config.limit_steps));
  budget.set_virtual_time_ns(Least<std::int64_t>(wanted.virtual_time_ns(),
                                                 FromSeconds(config.limit_virtual_time_s).count()));
  budget.set_memory_bytes(Least<std::int64_t>(wanted.memory_bytes(), config.limit_memory_bytes));
  budget.set_processor_ns(
      Least<std::int64_t>(wanted.processor_ns(), FromSeconds(config.limit_processor_s).count()));
  budget.set_output_bytes(Least<std::int64_t>(wanted.output_bytes(), config.limit_output_bytes));
  return budget;
}

class ProgramsOfAssignment {
 public:
  ProgramsOfAssignment(v1::WorkerAssignment& assignment, AssignmentMessages& messages)
      : assignment_(assignment), messages_(messages) {}

  // A later program of the same slot replaces an earlier one. `revision`: of the object, where it
  // is stored and executables made of it may be kept.
  void Add(int slot, const std::string& title, const std::string& file_name, std::string bytes,
           bool is_source, const std::optional<std::string>& executable,
           storage::Revision revision = 0) {
    v1::AssignedProgram program;
    program.set_object_revision(revision);
    program.set_slot(slot);
    program.set_title(title);
    program.set_file_name(file_name);
    program.set_is_source(is_source);
    if (executable) program.set_executable(*executable);
    SetContent(program, std::move(bytes));
    by_slot_[slot] = std::move(program);
  }

  // What should be left of the block of the job.
  void AddTarget(const v1::MillTarget& target, std::string bytes) {
    const v1::ProgramText& program = target.inline_program();
    v1::AssignedProgram& made = *assignment_.mutable_target();
    made.set_file_name(target.has_file() ? target.file().file_name() : program.file_name());
    made.set_is_source(target.has_inline_program() && program.form() != v1::PROGRAM_FORM_OBJECT);
    SetContent(made, std::move(bytes));
  }

  void Finish(bool keep_executables) {
    for (auto& [slot, program] : by_slot_) {
      if (!keep_executables) program.clear_object_revision();
      if (program.content().empty() && large_.contains(slot))
        messages_.programs.emplace_back(slot, large_[slot]);
      *assignment_.add_programs() = std::move(program);
    }
    if (large_.contains(0)) messages_.programs.emplace_back(0, large_[0]);
  }

 private:
  void SetContent(v1::AssignedProgram& program, std::string bytes) {
    program.set_size(static_cast<std::int64_t>(bytes.size()));
    if (bytes.size() <= kInlineBytes && inline_total_ + bytes.size() <= kInlineTotal) {
      inline_total_ += bytes.size();
      program.set_content(std::move(bytes));
    } else {
      large_[program.slot()] = std::make_shared<const std::string>(std::move(bytes));
    }
  }

  v1::WorkerAssignment& assignment_;
  AssignmentMessages& messages_;
  std::map<int, v1::AssignedProgram> by_slot_;
  std::map<int, std::shared_ptr<const std::string>> large_;
  std::size_t inline_total_ = 0;
};

// A mill runs one stream; only a family whose programs call each other needs the whole memory.
bool RunsFromMemory(const storage::MachineRecord& machine, std::string_view kind) {
  const machine::MachineFamily* family = families::FindFamily(machine.family);
  if (family == nullptr || !family->info().has_executables) return false;
  return family->info().checked_by_running || kind != storage::kCheckKind;
}

// A check takes no material off, and so compares nothing.
Status AddTarget(storage::Store& store, std::int64_t id, const v1::Job& job,
                 ProgramsOfAssignment& programs) {
  const v1::Milling& milling = job.simulation().milling();
  if (!milling.has_target() || job.kind() == v1::JOB_KIND_CHECK) return {};
  Result<std::string> bytes = store.ReadArtifact(id, kTargetAttachment);
  if (!bytes) return bytes.error();
  programs.AddTarget(milling.target(), *std::move(bytes));
  return {};
}

// All of it but its programs.
Status SetMachine(const storage::MachineMemory& memory, v1::WorkerAssignment& assignment) {
  const storage::MachineRecord& machine = memory.machine;
  assignment.set_family(machine.family);
  assignment.set_profile(machine.profile);
  for (const auto& [name, value] : machine.parameters)
    (*assignment.mutable_parameters())[name] = value;
  Result<std::string> state = StateForRun(machine.id, memory.mark);
  if (!state) return state.error();
  assignment.set_machine_state(*std::move(state));
  assignment.set_default_schedules(memory.schedules.empty());
  for (const storage::ScheduleRecord& schedule : memory.schedules)
    *assignment.add_schedules() = ToAssigned(schedule);
  return {};
}

}  // namespace

Result<v1::Job> SpecificationOf(storage::Store& store, std::int64_t id) {
  const auto record = store.GetJob(id);
  if (!record) return record.error();
  v1::Job job;
  if (!job.ParseFromString(record->specification))
    return Error{ErrorCode::kCellStoreCorrupt, "the specification of " + JobName(id), {}};
  return job;
}

Result<v1::AssignedProgram> ProgramOfJob(storage::Store& store, std::int64_t id) {
  const Result<v1::Job> specification = SpecificationOf(store, id);
  if (!specification) return specification.error();
  const v1::Job& job = *specification;
  Result<std::string> bytes = store.ReadArtifact(id, kMainAttachment);
  if (!bytes) return bytes.error();
  v1::AssignedProgram program;
  program.set_slot(MainSlotOf(job));
  const std::optional<BroughtProgram> brought = ProgramBrought(job);
  if (brought) program.set_file_name(brought->file_name);
  program.set_is_source(brought && brought->form != v1::PROGRAM_FORM_OBJECT);
  program.set_size(static_cast<std::int64_t>(bytes->size()));
  program.set_content(*std::move(bytes));
  return program;
}

Result<AssignmentMessages> MakeAssignment(storage::Store& store, const Config& config,
                                          const storage::LeasedJob& leased) {
  auto memory =
      store.GetMachineMemory(leased.job.machine, [&](const storage::MachineRecord& machine) {
        return RunsFromMemory(machine, leased.job.kind);
      });
  if (!memory) return memory.error();
  AssignmentMessages messages;
  v1::WorkerAssignment& assignment = *messages.first.mutable_assignment();
  v1::Job& job = *assignment.mutable_job();
  if (!job.ParseFromString(leased.job.specification)) {
    return Error{
        ErrorCode::kCellStoreCorrupt, "the specification of " + JobName(leased.job.id), {}};
  }
  job.set_name(JobName(leased.job.id));
  if (const Status set = SetMachine(*memory, assignment); !set) return set.error();
  *assignment.mutable_budget() = BudgetOf(job.budget(), config);

  // The attached bytes count for the program that is started: its slot may have been stored again.
  Result<std::string> main_bytes = store.ReadArtifact(leased.job.id, kMainAttachment);
  if (!main_bytes) return main_bytes.error();

  ProgramsOfAssignment programs(assignment, messages);
  const int main_slot = MainSlotOf(job);
  const bool stored_main = job.program_source_case() == v1::Job::kProgram;
  std::string main_title;
  std::optional<std::string> main_executable;
  storage::Revision main_revision = 0;
  for (storage::ProgramRecord& program : memory->programs) {
    if (program.slot == main_slot && stored_main && program.object == *main_bytes) {
      main_title = program.name;
      main_executable = std::move(program.executable);
      main_revision = program.revision;
    } else if (program.slot != main_slot) {
      programs.Add(program.slot, program.name, {}, std::move(program.object), false,
                   program.executable, program.revision);
    }
  }
  assignment.mutable_deleted_programs()->Add(memory->deleted.begin(), memory->deleted.end());
  const std::optional<BroughtProgram> brought = ProgramBrought(job);
  const bool is_source = brought && brought->form != v1::PROGRAM_FORM_OBJECT;
  programs.Add(main_slot, main_title, brought ? brought->file_name : std::string(),
               std::move(*main_bytes), is_source, main_executable, main_revision);
  for (const v1::SlotProgram& further : job.simulation().programs()) {
    Result<std::string> bytes = store.ReadArtifact(leased.job.id, AttachmentName(further.slot()));
    if (!bytes) return bytes.error();
    programs.Add(further.slot(), {}, further.program().file_name(), std::move(*bytes),
                 further.program().form() != v1::PROGRAM_FORM_OBJECT, std::nullopt);
  }
  if (const Status added = AddTarget(store, leased.job.id, job, programs); !added)
    return added.error();
  // An executable that is linked while the memory has programs that the machine has not, or not any
  // more, holds their code: it is for this job only.
  programs.Finish(main_revision > 0 && job.simulation().programs().empty());
  assignment.set_main_program(main_slot);
  return messages;
}

}  // namespace rmlcell::server
