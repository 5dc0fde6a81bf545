// `rmlcell machine ...`: machines that live.
#include <CLI/CLI.hpp>
#include <memory>

#include "clients/cli/remote_machines.h"
#include "clients/cli/verbs.h"
#include "engine/core/number_text.h"

namespace rmlcell::cli {
namespace {

using Act = int (*)(const Remote&, const MachineAct&);

class MachineVerbs {
 public:
  MachineVerbs(CLI::App& group, const Remote& remote, int& exit_code)
      : group_(group), remote_(remote), exit_code_(exit_code) {}

  CLI::App* Add(const char* name, const char* text, Act act) {
    CLI::App* verb = group_.add_subcommand(name, text);
    verb->add_option("MACHINE", given_->machine)->required();
    verb->callback([given = given_, act, &remote = remote_, &code = exit_code_] {
      code = act(remote, *given);
    });
    return verb;
  }
  // What only one client does at a time.
  CLI::App* AddControlled(const char* name, const char* text, Act act) {
    CLI::App* verb = Add(name, text, act);
    verb->add_option("--take-over", given_->take_over,
                     "why control is taken from whoever has it, for all to read");
    return verb;
  }
  MachineAct& given() { return *given_; }

 private:
  CLI::App& group_;
  const Remote& remote_;
  int& exit_code_;
  std::shared_ptr<MachineAct> given_ = std::make_shared<MachineAct>();
};

void AddStartAt(MachineVerbs& verbs) {
  MachineAct& given = verbs.given();
  CLI::App* at = verbs.AddControlled(
      "start-at", "Start a program at a step, behind a safe way there", StartAtStep);
  at->add_option("STEP", given.step,
                 "PROGRAM/STEP, such as 45/10; default: where a run was cut off");
  at->add_option("--slot", given.program, "the program that is started; default: the selected one")
      ->check(CLI::Range(1, 99));
  at->add_option("--occurrence", given.occurrence, "the how manieth time that control comes there");
  at->add_flag("--direct", given.direct,
               "without an approach: the first move begins where it stands");
  at->add_flag("--off-until-work-on", given.off_until_work_on,
               "a WORK is on there: keep the beam off until the next one");
  CLI::Option* stock = at->add_option(
      "--stock", given.stock, "mill: the block on the table, such as 100x80x10; with --tool");
  CLI::Option* tool =
      at->add_option("--tool", given.tool, "what mills it, such as flat:3")->needs(stock);
  stock->needs(tool);
  at->add_flag("--untouched", given.untouched, "nothing of that block has been cut yet")
      ->needs(stock);
  at->add_flag("--preview", given.look, "say what it would do, and do not start");
  CLI::Option* halt =
      at->add_flag("--halt", given.halt,
                   "halt before the step; behind a run that was cut off it does so by itself");
  at->add_flag("--no-halt", given.goes_on, "begin the step at once")->excludes(halt);
  at->add_option("--seen", given.seen,
                 "what you have looked at: clamps, tool, origin-valid, table-clear; behind a run "
                 "that was cut off: inspected")
      ->delimiter(',');
  at->add_option("--reason", given.reason, "why it goes on, for all to read");
}

// How it stands, what happened to it, and how it lives.
void AddLife(MachineVerbs& verbs) {
  MachineAct& given = verbs.given();
  verbs.Add("status", "Show how a machine stands, and what keeps jobs from it", ShowMachine);
  verbs.Add("watch", "Follow a machine", WatchMachine);
  verbs.Add("log", "Show what happened at a machine, and who did it", ShowMachineLog)
      ->add_flag("--follow", given.follow, "go on with what comes");
  CLI::App* taught = verbs.AddControlled(
      "taught", "Show what was taught at a handbox, or take it back", ShowTaught);
  taught->add_option("--slot", given.program, "of this program alone")->check(CLI::Range(1, 99));
  taught->add_option("--undo", given.undo, "take entries of a program back, down to this number")
      ->check(CLI::PositiveNumber);
  verbs.Add("enable", "Switch a machine on: it lives from here on", EnableMachine);
  verbs.Add("disable", "Switch a machine off", DisableMachine);
  verbs
      .Add("options", "Show how a machine lives, or change that: who starts jobs, what halts it",
           MachineOptions)
      ->add_option("VALUES", given.values,
                   "such as start=person, ticket-needed=on, server-lost=go-on, late-hold=2 (s)");
  CLI::App* take =
      verbs.Add("take", "Give a machine to another computer, whoever is its host", TakeMachine);
  take->add_option("--reason", given.reason, "why, for all to read")->required();
  take->add_option("--computer", given.computer, "whose host gets it; default: this one");
}

void AddActs(MachineVerbs& verbs) {
  MachineAct& given = verbs.given();
  verbs.Add("hold", "Let a run come to rest after the present instruction", HoldMachine);
  verbs.Add("stop", "Let a run come to rest at once, on its path", StopMachine);
  verbs.Add("emergency-stop", "End the run; the machine is in alarm", EmergencyStopMachine);
  verbs.Add("abort", "End the run that is open", AbortRun);
  CLI::App* start = verbs.AddControlled(
      "start", "Start a stored program, the selected one, or a job of the queue", StartMachine);
  CLI::Option* slot = start->add_option("SLOT", given.program, "1 to 99")->check(CLI::Range(1, 99));
  CLI::Option* job = start->add_option("--job", given.job, "a RUN job that waits for a person");
  job->excludes(slot);
  start
      ->add_option("--seen", given.seen,
                   "arm the machine for the job: you have looked at tool, origin-valid, clamps "
                   "and cover")
      ->delimiter(',')
      ->needs(job);
  verbs.AddControlled("zero", "Let the axes find their reference; in REMOTE program 4 follows",
                      ZeroMachine);
  CLI::App* resume = verbs.AddControlled("resume", "Let a held run go on", ResumeMachine);
  resume->add_flag("--accept-displaced", given.accept_displaced,
                   "keys have moved the machine meanwhile: go on from where it stands");
  resume->add_flag("--restore-process", given.restore_process,
                   "a spindle that a person has stopped meanwhile turns again");
  verbs.AddControlled("mode", "Set the operating mode", SetMode)
      ->add_option("MODE", given.word)
      ->required()
      ->check(CLI::IsMember({"remote", "cycle", "single", "repeat", "manual"}));
  verbs.AddControlled("override", "Set the override of the programmed speed", SetOverride)
      ->add_option("PERCENT", given.number)
      ->required();
  verbs.AddControlled("factor", "Let the time of a virtual machine go faster or slower", SetFactor)
      ->add_option("FACTOR", given.number, "virtual seconds a real second, 0.1 to 100")
      ->required();
  verbs.AddControlled("acknowledge", "Acknowledge an alarm, or all of them", AcknowledgeAlarms)
      ->add_option("ALARM", given.alarm, "its number");
  verbs.AddControlled("confirm", "Say that machine and part were inspected after a run was cut off",
                      ConfirmMachine);
  verbs.Add("read", "Read variables, inputs and outputs", ReadVariables)
      ->add_option("VARIABLES", given.values, "such as VR[0..9], IL[20], X")
      ->required();
  verbs.AddControlled("write", "Write variables and outputs", WriteVariables)
      ->add_option("VALUES", given.values, "such as VR[5]=2.5, OL[3]=on")
      ->required();
  CLI::App* key =
      verbs.AddControlled("key", "Press keys of the panel of a mill, or of a handbox", PressKeys);
  key->add_option("KEYS", given.values, "X+, PAUSE, CONTINUE, POWER; JOB 4 5 ENT, START, REC ...")
      ->required();
  key->add_option("--for", given.held_s, "hold the last one for so many seconds; else it is tapped")
      ->check(CLI::Range(0.0, 50.0))
      ->check([](const std::string& text) {  // what is no number lies in every range
        return ParseDouble(text) ? std::string() : "'" + text + "' is no number of seconds";
      });
  key->add_flag("--fast", given.fast, "jog at the highest speed");
  verbs.AddControlled("input", "Set inputs, door and power of a virtual machine", SetInputs)
      ->add_option("VALUES", given.values,
                   "such as IL[20]=on, door=open, gate=1, power=off, emergency-stop=released")
      ->required();
  verbs.AddControlled("gates", "Set which programs gate 1 and gate 2 start", SetGates)
      ->add_option("SLOTS", given.gates, "that of gate 1 and that of gate 2; 0: none")
      ->required()
      ->expected(2)
      ->check(CLI::Range(0, 99));
}

}  // namespace

void AddMachineVerbs(CLI::App& app, Remote& remote, int& exit_code) {
  CLI::App* group =
      app.add_subcommand("machine", "Machines that live: enable, start, hold, look at");
  group->footer(
      "Examples:\n"
      "  rmlcell machine enable mill-1                  from here on it lives\n"
      "  rmlcell machine start mill-1 7                 the program of slot 7\n"
      "  rmlcell machine watch mill-1\n"
      "  rmlcell machine stop mill-1; rmlcell machine resume mill-1\n"
      "  rmlcell submit mill-1 --slot 7 --kind run      the same as a job of the queue\n"
      "  rmlcell machine status mill-1                  and what keeps jobs from it\n"
      "  rmlcell machine options mill-1 start=person    nobody else starts jobs there\n"
      "  rmlcell machine start-at mill-1 --preview      where a run was cut off, and how it goes on");
  group->add_option("--server", remote.server,
                    "host:port or unix:/path; default: RMLCELL_SERVER, or 127.0.0.1:50051");
  group->add_flag("--json", remote.json, "print messages as JSON, one line each");
  group->require_subcommand(1);
  group->fallthrough();  // --server and --json may stand at the end, too
  MachineVerbs verbs(*group, remote, exit_code);
  AddLife(verbs);
  AddActs(verbs);
  AddStartAt(verbs);
}

}  // namespace rmlcell::cli
