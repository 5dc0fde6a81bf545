#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "clients/cli/handbox_terminal.h"
#include "clients/cli/local.h"
#include "clients/cli/place_option.h"
#include "clients/cli/remote.h"
#include "clients/cli/replay.h"
#include "clients/cli/terminal.h"
#include "clients/cli/usage_error.h"
#include "clients/cli/verbs.h"
#include "clients/cli/version.h"
#include "engine/families/families.h"

// The rmlcell command: what it can do, and nothing of how.
namespace {

using namespace rmlcell::cli;  // NOLINT: this file is nothing but the wiring of that folder

// Whoever asks for help wants to see it done first.
class ExamplesFirst final : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    if (mode == CLI::AppFormatMode::Sub) return make_expanded(app);
    std::string text = make_description(app) + make_footer(app) + "\n" +
                       make_usage(app, std::move(name)) + make_positionals(app) +
                       make_groups(app, mode) + make_subcommands(app, mode);
    text.erase(text.find_last_not_of('\n') + 1);
    return text + "\n";
  }
};

constexpr const char* kExamples = R"(Examples:
  rmlcell check part.S                          what is wrong with a program, and where
  rmlcell simulate part.rml --svg part.svg      time, lengths and a picture, without a server
  rmlcell simulate 32.S progs/ --trace          progs/44.S and the like fill the program memory
  rmlcell explain 348                           what an error code means
  rmlcell put mill-1 7 part.rml                 store a program in slot 7 of a machine
  rmlcell submit mill-1 --slot 7 --watch        run it as a job and watch it live
  rmlcell submit optimo-1 part.S --watch        run a file without storing it
  rmlcell report 17; rmlcell picture 17 -o p.svg

Each verb has its own --help and examples. Verbs that need a server take --server HOST:PORT or unix:/PATH
(environment: RMLCELL_SERVER). Exit codes: 0 good, 1 the program has
errors or its verdict is BAD (with --strict DOUBTFUL, too), 2 wrong use, 3 server.)";

constexpr const char* kMachineCoordinatesText =
    "positions from the zero of the machine, not of the work";
// "optimo or rml1".
std::string FamilyNames() {
  std::string names;
  const auto known = rmlcell::families::Families();
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (i > 0) names += i + 1 < known.size() ? ", " : " or ";
    names += known[i]->info().id;
  }
  return names;
}

constexpr const char* kStrictText = "exit with 1 when the verdict is DOUBTFUL, too";

void AddMachineOptions(CLI::App* verb, MachineChoice& machine) {
  verb->add_option("--family", machine.family, FamilyNames() + "; default: from the file name");
  verb->add_option("--profile", machine.profile,
                   "profile of a machine model, such as srm-20 or pw-1993");
  verb->add_option("--machine", machine.file, "machine file (TOML): family, profile, [parameters]");
  AddPlace(*verb, "--origin", "X,Y[,Z]: where the work origin of a mill lies on the machine, mm", 2,
           3, machine.origin);
  verb->add_option("--clamps", machine.clamps_mm,
                   "how high the clamps of a mill stand above the surface of the work, mm");
}

void AddCheckVerb(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* verb =
      app.add_subcommand("check", "Say what is wrong with programs, before anything moves");
  verb->footer(
      "Examples:\n"
      "  rmlcell check part.S                    one program: errors, warnings, advice, each "
      "with place and rule\n"
      "  rmlcell check progs/*.S --errors-only   errors alone; exit code 1 when there is one\n"
      "  rmlcell check part.S --fix              apply the fixes; layout and comments stay\n"
      "  rmlcell check part.S --fix --dry-run    show them as a patch\n"
      "  rmlcell check 45.S 44.S --inputs keys.txt  programs that call each other, with inputs\n"
      "  rmlcell check part.S --json             for an editor or a script\n\n"
      "Motion is followed as a run with these inputs (default: all off) would do it: axes that leave\n"
      "their travel are errors, axes that hold a contour back are advice.");
  verb->add_option("FILES", options->files, "programs")->required();
  AddMachineOptions(verb, options->machine);
  verb->add_option("--inputs", options->inputs_file,
                   "inputs and keys over time, while the motion is checked");
  verb->add_flag("--errors-only", options->errors_only, "leave warnings and advice out");
  CLI::Option* fix =
      verb->add_flag("--fix", options->fix, "apply the fixes of findings, in the files");
  verb->add_flag("--dry-run", options->dry_run,
                 "with --fix: show the changes as a patch; write nothing")
      ->needs(fix);
  verb->add_flag("--machine-coordinates", options->machine_coordinates, kMachineCoordinatesText);
  verb->add_flag("--strict", options->strict, kStrictText);
  verb->add_flag("--json", options->json, "print findings as JSON, one line a file");
  verb->callback([options, &exit_code] { exit_code = Check(*options); });
}

// Files about the path that was run.
void AddPathProducts(CLI::App* verb, SimulateOptions& options) {
  verb->add_option("--svg", options.svg, "write a picture of the toolpath");
  verb->add_option("--toolpath", options.toolpath,
                   "write the toolpath that a viewer draws (docs/toolpath.md)");
  verb->add_option("--samples", options.samples,
                   "RATE FILE: write where the machine is, RATE times a second, as CSV")
      ->type_size(2)
      ->expected(1)
      ->allow_extra_args(false);
  verb->add_option("--plot", options.plot,
                   "CURVES FILE: write curves over time, of speed,power,axes")
      ->type_size(2)
      ->expected(1)
      ->allow_extra_args(false);
}

void AddSimulateVerb(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App* verb = app.add_subcommand("simulate", "Run a program in virtual time and report");
  verb->footer(
      "Examples:\n"
      "  rmlcell simulate part.rml --svg part.svg       figures, and a picture\n"
      "  rmlcell simulate 45.S --plot speed,power t.svg curves over time\n"
      "  rmlcell simulate part.rml --stock 100x80x10 --tool flat:3 --stl part.stl   what is left\n"
      "  rmlcell simulate part.rml --stock 100x80x10 --tool ball:3 --relief part.png   the same as a picture\n"
      "  rmlcell simulate new.rml --stock 100x80x10 --tool flat:3:flute=12 --target old.rml   beside what should be left\n"
      "  rmlcell simulate 32.S progs/ --trace           progs/44.S and the like fill the program "
      "memory\n"
      "  rmlcell simulate part.S --simul 12/40          dry up to step 40 of program 12, real "
      "after it\n"
      "  rmlcell simulate part.S --inputs keys.txt --vars 'VR[0..9],VI[99]'\n"
      "  rmlcell simulate part.S --facts | grep cycle   key: value lines for scripts");
  verb->add_option("FILES", options->files,
                   "the program, then further ones or folders of 12.S, 44.S ...");
  verb->add_option("--slot", options->slots, "44=FILE: a further program, in slot 44")
      ->expected(-1)
      ->allow_extra_args(false);
  verb->add_option("--main", options->main_slot, "slot of the program that is started")
      ->check(CLI::Range(1, 99));
  verb->add_option("--executable", options->executables,
                   "44: link program 44 beforehand; 44=FILE: its executable")
      ->allow_extra_args(false);
  AddMachineOptions(verb, options->machine);
  verb->add_option("--inputs", options->inputs_file,
                   "inputs and keys over time, a line each: 0.5 IL[20] = 1");
  verb->add_option("--mode", options->mode, "cycle (START given once), remote, single, repeat");
  verb->add_option("--override", options->override_percent,
                   "override of the programmed speed, percent");
  verb->add_option("--simul", options->simul, "P/S: dry run up to step S of program P; off: none");
  verb->add_option("--break", options->breakpoint,
                   "P/S: halt after step S of program P; off: none");
  verb->add_option("--budget", options->budget,
                   "steps=N,time=SECONDS: end the run when it needs more");
  verb->add_option("--vars", options->variables, "variables to show at the end: VR[0..9],VI[99]");
  AddPathProducts(verb, *options);
  AddMillingOptions(*verb, options->milling);
  verb->add_option("--state-in", options->state_in,
                   "begin with the machine state that an earlier run kept");
  verb->add_option("--state-out", options->state_out, "keep the machine state for a later run");
  verb->add_flag("--trace", options->trace, "write the trace: a line for each thing that happened");
  CLI::Option* facts =
      verb->add_flag("--facts", options->facts, "key: value lines for scripts (docs/facts.md)");
  verb->add_flag("--json", options->json, "print the report as JSON")->excludes(facts);
  verb->add_flag("--machine-coordinates", options->machine_coordinates, kMachineCoordinatesText);
  verb->add_flag("--strict", options->strict, kStrictText);
  verb->callback([options, &exit_code] { exit_code = Simulate(*options); });
}

void AddLocalVerbs(CLI::App& app, int& exit_code) {
  AddCheckVerb(app, exit_code);
  AddSimulateVerb(app, exit_code);
  {
    auto family = std::make_shared<std::string>();
    auto profile = std::make_shared<std::string>();
    CLI::App* verb = app.add_subcommand(
        "parameters", "List machine parameters: meaning, range and value, as a machine file");
    verb->footer(
        "Examples:\n"
        "  rmlcell parameters                                    families and their profiles\n"
        "  rmlcell parameters optimo > mine.toml                 a file for --machine, to be changed\n"
        "  rmlcell parameters rml1 --profile srm-20 | less");
    verb->add_option("FAMILY", *family, FamilyNames() + "; none: list the families");
    verb->add_option("--profile", *profile, "values of this profile");
    auto json = std::make_shared<bool>(false);
    verb->add_flag("--json", *json, "as JSON");
    verb->callback([family, profile, json, &exit_code] {
      exit_code = ListParameters(*family, *profile, *json);
    });
  }
  {
    auto codes = std::make_shared<std::vector<std::string>>();
    auto json = std::make_shared<bool>(false);
    CLI::App* verb =
        app.add_subcommand("explain", "Say what an error code means and what to do about it");
    verb->footer(
        "Examples:\n"
        "  rmlcell explain 348              a code of the control\n"
        "  rmlcell explain CELL-E9003       one of ours\n"
        "  rmlcell explain                  all of them");
    verb->add_option("CODES", *codes, "348, OPT-E348, HOLE_RADIUS_ZERO; none: list all");
    verb->add_flag("--json", *json, "as JSON, one line each");
    verb->callback([codes, json, &exit_code] { exit_code = Explain(*codes, *json); });
  }
}

// What the verbs of a server are given on the command line; each uses its own.
struct RemoteArguments {
  std::string machine, project, job, artifact;
  std::string file, form, output, etag, filter, order = "newest", before;
  std::optional<int> priority;
  int slot = 0;
  int limit = 20;
  std::int64_t after = 0;
  bool check_only = false;
  bool force = false;
  bool insert = false;
  bool inch = false;
  std::vector<int> slots;
  bool machine_coordinates = false;
  SubmitRequest submit;
};

CLI::App* RemoteVerb(CLI::App& app, const char* name, const char* text, const std::string& examples,
                     Remote& remote) {
  CLI::App* verb = app.add_subcommand(name, text);
  verb->footer("Examples:\n" + examples);
  verb->add_option("--server", remote.server,
                   "host:port or unix:/path; default: RMLCELL_SERVER, or 127.0.0.1:50051");
  verb->add_flag("--json", remote.json, "print messages as JSON, one line each");
  return verb;
}

void AddProgramVerbs(CLI::App& app, Remote& remote, RemoteArguments& given, int& exit_code) {
  RemoteVerb(app, "machines", "List the machines of the cell", "  rmlcell machines", remote)
      ->callback([&] { exit_code = Machines(remote); });
  CLI::App* programs = RemoteVerb(app, "programs", "List the programs of a machine",
                                  "  rmlcell programs mill-1", remote);
  programs->add_option("MACHINE", given.machine)->required();
  programs->callback([&] { exit_code = Programs(remote, given.machine); });
  CLI::App* put = RemoteVerb(
      app, "put", "Store a program in a slot of a machine",
      "  rmlcell put mill-1 7 part.rml                  as it is, or refused with all that is "
      "wrong\n"
      "  rmlcell put optimo-1 44 44.S --check-only      say what would be stored\n"
      "  rmlcell put optimo-1 44 44.S --etag 3          only if nobody has changed it since",
      remote);
  put->add_option("MACHINE", given.machine)->required();
  put->add_option("SLOT", given.slot, "1 to 99; 101 to 199 for an executable")->required();
  put->add_option("FILE", given.file)->required();
  put->add_option("--etag", given.etag,
                  "only if the program still has this etag; none: only if the slot is empty");
  put->add_flag("--check-only", given.check_only, "say what would be stored");
  put->add_flag("--force", given.force,
                "store what looks like no program of the machine at all, too");
  put->callback([&] {
    exit_code =
        PutProgram(remote, given.machine, given.slot, given.file,
                   {.etag = given.etag, .check_only = given.check_only, .force = given.force});
  });
  CLI::App* get = RemoteVerb(
      app, "get", "Get a program of a machine",
      "  rmlcell get optimo-1 44                        its source: as it was stored, or decompiled\n"
      "  rmlcell get optimo-1 44 --form listing         with step numbers\n"
      "  rmlcell get optimo-1 44 -o 44.O                its object\n"
      "  rmlcell get optimo-1 144 -o 144.X              its executable",
      remote);
  get->add_option("MACHINE", given.machine)->required();
  get->add_option("SLOT", given.slot)->required();
  get->add_option("--form", given.form,
                  "source, object, executable, listing; default: source, object into a file .O")
      ->check(CLI::IsMember({"source", "object", "executable", "listing"}));
  get->add_option("-o,--output", given.output, "file; default: standard output");
  get->callback(
      [&] { exit_code = GetProgram(remote, given.machine, given.slot, given.form, given.output); });
  CLI::App* remove =
      RemoteVerb(app, "delete", "Delete a program, or the executable of slot - 100",
                 "  rmlcell delete optimo-1 44                     the program and its executable\n"
                 "  rmlcell delete optimo-1 144                    the executable alone",
                 remote);
  remove->add_option("MACHINE", given.machine)->required();
  remove->add_option("SLOT", given.slot)->required();
  remove->callback([&] { exit_code = DeleteProgram(remote, given.machine, given.slot); });
  CLI::App* stale = RemoteVerb(
      app, "stale", "Say which executables of a machine are older than its programs, and why",
      "  rmlcell stale optimo-1                         they run the old FUNCTION code until "
      "they are deleted\n"
      "  rmlcell delete optimo-1 132                    the next run of 32 links again",
      remote);
  stale->add_option("MACHINE", given.machine)->required();
  stale->callback([&] { exit_code = StaleExecutables(remote, given.machine); });
}

void AddProjectVerbs(CLI::App& app, Remote& remote, RemoteArguments& given, int& exit_code) {
  CLI::App* projects = RemoteVerb(
      app, "projects", "List, make, show, update, delete, transfer, export and import projects",
      "  rmlcell projects                               all of them\n"
      "  rmlcell projects create door door/             12.S, 44.SI ... and project.json of a folder\n"
      "  rmlcell projects create door door.json\n"
      "  rmlcell projects transfer door optimo-1 --check-only\n"
      "  rmlcell projects transfer door optimo-1 --insert\n"
      "  rmlcell projects take door optimo-1 --slots 12 44   of what the machine holds\n"
      "  rmlcell projects export door -o door.zip\n"
      "  rmlcell projects import door-2 door.zip",
      remote);
  projects->require_subcommand(0, 1);
  projects->fallthrough();  // --server and --json may stand at the end, too
  projects->callback([&, projects] {
    if (projects->get_subcommands().empty()) exit_code = Projects(remote);
  });
  CLI::App* list = projects->add_subcommand("list", "List the projects");
  list->callback([&] { exit_code = Projects(remote); });
  CLI::App* show = projects->add_subcommand("show", "Print what is in a project");
  show->add_option("PROJECT", given.project)->required();
  show->callback([&] { exit_code = GetProject(remote, given.project); });
  CLI::App* create = projects->add_subcommand(
      "create", "Make a project of a folder or of a JSON file (message Project)");
  create->add_option("PROJECT", given.project)->required();
  create->add_option("PATH", given.file, "folder with files like 12.S, or JSON file")->required();
  create->callback([&] { exit_code = CreateProject(remote, given.project, given.file); });
  CLI::App* update = projects->add_subcommand(
      "update", "Put a folder or a JSON file (message Project) in place of a project");
  update->add_option("PROJECT", given.project)->required();
  update->add_option("PATH", given.file, "folder with files like 12.S, or JSON file")->required();
  update->callback([&] { exit_code = UpdateProject(remote, given.project, given.file); });
  CLI::App* remove = projects->add_subcommand("delete", "Delete a project");
  remove->add_option("PROJECT", given.project)->required();
  remove->callback([&] { exit_code = DeleteProject(remote, given.project); });
  CLI::App* transfer = projects->add_subcommand(
      "transfer", "Compile and store a project on a machine: all or nothing");
  transfer->add_option("PROJECT", given.project)->required();
  transfer->add_option("MACHINE", given.machine)->required();
  transfer->add_flag("--insert", given.insert, "insert missing WORKDEFs of the project");
  transfer->add_flag("--check-only", given.check_only, "say what would be stored");
  transfer->callback([&] {
    exit_code =
        TransferProject(remote, given.project, given.machine, given.insert, given.check_only);
  });
  CLI::App* take = projects->add_subcommand("take", "Make a project of what a machine holds");
  take->add_option("PROJECT", given.project)->required();
  take->add_option("MACHINE", given.machine)->required();
  take->add_option("--slots", given.slots, "these alone; else all that hold a program");
  take->add_flag("--inch", given.inch, "convert the programs to inches and degrees");
  take->callback([&] {
    exit_code = TakeProject(remote, given.project, given.machine, given.slots, given.inch);
  });
  CLI::App* out = projects->add_subcommand("export", "Write a project as one file");
  out->add_option("PROJECT", given.project)->required();
  out->add_option("-o,--output", given.output,
                  "ZIP archive; - for standard output; else PROJECT.zip");
  out->callback([&] { exit_code = ExportProject(remote, given.project, given.output); });
  CLI::App* in = projects->add_subcommand("import", "Make a project of such a file");
  in->add_option("PROJECT", given.project)->required();
  in->add_option("FILE", given.file)->required();
  in->callback([&] { exit_code = ImportProject(remote, given.project, given.file); });
}

void AddQueueOptions(CLI::App& verb, SubmitRequest& submit) {
  verb.add_option("--priority", submit.priority, "jobs of a higher one start first")
      ->check(CLI::Range(-100, 100));
  verb.add_flag("--hold", submit.hold, "it waits until rmlcell resume");
  verb.add_option("--not-before", submit.not_before, "2026-11-25T10:00:00Z");
  verb.add_option("--after-job", submit.after, "starts when these have succeeded")
      ->allow_extra_args(false);
}

void AddRunOptions(CLI::App& verb, SubmitRequest& submit) {
  verb.add_option("--kind", submit.kind, "simulate, check, or run on the machine itself")
      ->check(CLI::IsMember({"simulate", "check", "run"}));
  verb.add_flag("--unzeroed", submit.unzeroed,
                "with --kind run: the program zeroes the axes itself");
  verb.add_option("--ticket", submit.ticket,
                  "with --kind run: the simulation that proves the program, such as 17");
  CLI::Option* step = verb.add_option(
      "--step", submit.step,
      "with --kind run: begin at PROGRAM/STEP, such as 45/10, behind a safe way there");
  verb.add_option("--occurrence", submit.occurrence,
                  "the how manieth time that control comes there")
      ->needs(step);
  verb.add_flag("--off-until-work-on", submit.off_until_work_on,
                "a WORK is on there: keep the beam off until the next one")
      ->needs(step);
  verb.add_option("--seen", submit.seen,
                  "what you have looked at for that: clamps, tool, origin-valid, table-clear")
      ->delimiter(',');
}

void AddQueueVerbs(CLI::App& app, Remote& remote, RemoteArguments& given, int& exit_code) {
  CLI::App* hold = RemoteVerb(app, "hold", "Hold a job: one that waits does not start",
                              "  rmlcell hold 17", remote);
  hold->add_option("JOB", given.job)->required();
  hold->callback([&] { exit_code = HoldJob(remote, given.job); });
  CLI::App* resume = RemoteVerb(app, "resume", "Let a job go on, or start, that is held",
                                "  rmlcell resume 17", remote);
  resume->add_option("JOB", given.job)->required();
  resume->callback([&] { exit_code = ResumeJob(remote, given.job); });
  CLI::App* move =
      RemoteVerb(app, "move", "Give a job that waits another place in the queue",
                 "  rmlcell move 17 --before 12                    in front of job 12\n"
                 "  rmlcell move 17 --priority 10                  before all of less",
                 remote);
  move->add_option("JOB", given.job)->required();
  move->add_option("--before", given.before, "job; else behind all of its priority");
  move->add_option("--priority", given.priority, "from now on")->check(CLI::Range(-100, 100));
  move->callback([&] { exit_code = MoveJob(remote, given.job, given.before, given.priority); });
}

void AddJobVerbs(CLI::App& app, Remote& remote, RemoteArguments& given, int& exit_code) {
  CLI::App* verb = RemoteVerb(
      app, "submit", "Submit a job",
      "  rmlcell submit mill-1 --slot 7 --watch         a stored program, watched live\n"
      "  rmlcell submit optimo-1 part.S --watch         a file, without storing it\n"
      "  rmlcell submit optimo-1 part.S --pace 1 --watch   as fast as the machine would be\n"
      "  rmlcell submit mill-1 part.rml --stock 100x80x10 --tool flat:3   what is left, as a picture\n"
      "  rmlcell submit mill-1 new.rml --stock 100x80x10 --tool flat:3 --target old.stl --products target   beside what should be left\n"
      "  rmlcell submit optimo-1 part.S --kind check    only what is wrong with it\n"
      "  rmlcell submit mill-1 --slot 7 --kind run      on the machine itself, which lives",
      remote);
  verb->add_option("MACHINE", given.submit.machine)->required();
  verb->add_option("FILE", given.submit.file, "a program for this job only; or give --slot");
  verb->add_option("--slot", given.submit.slot, "slot of a stored program, or where FILE goes")
      ->check(CLI::Range(1, 99));
  AddRunOptions(*verb, given.submit);
  verb->add_option("--title", given.submit.title);
  verb->add_option("--label", given.submit.labels, "a word to find the job by; may be repeated")
      ->allow_extra_args(false);
  verb->add_option("--request-id", given.submit.request_id, "repeating it gives the same job");
  verb->add_option("--override", given.submit.override_percent,
                   "override of the programmed speed, percent");
  verb->add_option("--pace", given.submit.pace,
                   "1: as fast as the machine would be; 10: ten times; 0: at once")
      ->check(CLI::Range(0.0, 1000.0));
  verb->add_option("--inputs", given.submit.inputs_file, "inputs and keys over time");
  AddJobMillingOptions(*verb, given.submit.milling);
  verb->add_option("--project", given.submit.milling_project,
                   "block, tool and target of the same slot's program in this project")
      ->excludes("--stock");
  verb->add_flag("--trace", given.submit.trace, "keep a trace");
  AddQueueOptions(*verb, given.submit);
  CLI::Option* watched = verb->add_flag("--watch", given.submit.watch, "watch the job to its end");
  verb->add_flag("--strict", given.submit.strict, kStrictText)->needs(watched);
  verb->callback([&] {
    if (given.submit.file.empty() && given.submit.slot == 0)
      throw CLI::ValidationError("submit", "give a FILE or --slot");
    exit_code = SubmitJob(remote, given.submit);
  });
  CLI::App* watch =
      RemoteVerb(app, "watch", "Watch a job live to its end",
                 "  rmlcell watch 17                               from its beginning to its end\n"
                 "  rmlcell watch 17 --after 120                   what came after event 120\n"
                 "  rmlcell watch 17 --json | jq .event            for a script",
                 remote);
  watch->add_option("JOB", given.job)->required();
  watch->add_option("--after", given.after, "events after this sequence number only");
  watch->add_flag("--strict", given.submit.strict, kStrictText);
  watch->callback(
      [&] { exit_code = WatchJob(remote, given.job, given.after, given.submit.strict); });
  CLI::App* jobs =
      RemoteVerb(app, "jobs", "List jobs, newest first",
                 "  rmlcell jobs                                   the newest 20\n"
                 "  rmlcell jobs --order queue                     as they will run\n"
                 "  rmlcell jobs --filter 'state = FAILED AND machine = machines/mill-1'",
                 remote);
  jobs->add_option("--filter", given.filter, "state = FAILED AND machine = machines/mill-1");
  jobs->add_option("--order", given.order, "newest, oldest, queue")
      ->transform(CLI::IsMember({"newest", "oldest", "queue"}));
  jobs->add_option("--limit", given.limit)->check(CLI::Range(1, 1000));
  jobs->callback([&] { exit_code = Jobs(remote, given.filter, given.order, given.limit); });
  CLI::App* show = RemoteVerb(app, "job", "Show one job", "  rmlcell job 17", remote);
  show->add_option("JOB", given.job)->required();
  show->callback([&] { exit_code = ShowJob(remote, given.job); });
  CLI::App* cancel = RemoteVerb(app, "cancel", "Cancel a job", "  rmlcell cancel 17", remote);
  cancel->add_option("JOB", given.job)->required();
  cancel->callback([&] { exit_code = CancelJob(remote, given.job); });
  AddQueueVerbs(app, remote, given, exit_code);
}

void AddHandboxVerb(CLI::App& app, Remote& remote, int& exit_code) {
  auto request = std::make_shared<HandboxRequest>();
  CLI::App* verb = app.add_subcommand(
      "handbox", "The handbox of a machine that lives, on the whole terminal: keys and mouse");
  verb->footer(
      "Examples:\n"
      "  rmlcell handbox optimo-1                       q or Ctrl-C quits; Space is STOP\n"
      "  rmlcell handbox optimo-1 --take-over 'shift change'\n\n"
      "The screen shows what to type for each key. A jog key or HOME moves axes while it is down by\n"
      "mouse, or while it repeats on the keyboard: a tap moves nothing. The machine stops by itself\n"
      "when this command, the terminal or the line to it is cut off.");
  verb->add_option("MACHINE", request->machine)->required();
  verb->add_option("--take-over", request->take_over,
                   "why control is taken from whoever has it, for all to read");
  verb->add_option("--server", remote.server,
                   "host:port or unix:/path; default: RMLCELL_SERVER, or 127.0.0.1:50051");
  verb->callback([request, &remote, &exit_code] { exit_code = Handbox(remote, *request); });
}

void AddReplayVerb(CLI::App& app, Remote& remote, int& exit_code) {
  auto request = std::make_shared<ReplayRequest>();
  CLI::App* verb = app.add_subcommand(
      "replay", "Play what a machine did again, and say whether it comes out the same");
  verb->footer(
      "Examples:\n"
      "  rmlcell replay 17                              the run of a job\n"
      "  rmlcell replay mill-1 -o now.rmlj              what a machine has recorded last, and keep it\n"
      "  rmlcell replay now.rmlj                        on another computer, without a server");
  verb->add_option("WHAT", request->what, "a recording (.rmlj), a job that ran, or a machine")
      ->required();
  verb->add_option("--from", request->from,
                   "from the newest mark at or before this time of the machine, ns")
      ->check(CLI::NonNegativeNumber);
  verb->add_option("--to", request->to,
                   "up to this time of the machine, ns, and say how it stood there")
      ->check(CLI::NonNegativeNumber);
  verb->add_option("-o,--output", request->output, "keep the recording in this file");
  verb->add_option("--server", remote.server,
                   "host:port or unix:/path; default: RMLCELL_SERVER, or 127.0.0.1:50051");
  verb->callback([request, &remote, &exit_code] { exit_code = Replay(remote, *request); });
}

void AddProductVerbs(CLI::App& app, Remote& remote, RemoteArguments& given, int& exit_code) {
  CLI::App* report = RemoteVerb(app, "report", "Show the report of a job",
                                "  rmlcell report 17\n"
                                "  rmlcell report 17 --json",
                                remote);
  report->add_option("JOB", given.job)->required();
  report->add_flag("--machine-coordinates", given.machine_coordinates, kMachineCoordinatesText);
  report->callback([&] { exit_code = JobReport(remote, given.job, given.machine_coordinates); });
  CLI::App* picture = RemoteVerb(app, "picture", "Get the picture of a job (SVG)",
                                 "  rmlcell picture 17 -o part.svg", remote);
  picture->add_option("JOB", given.job)->required();
  picture->add_option("-o,--output", given.output, "file; default: standard output");
  picture->callback([&] { exit_code = JobPicture(remote, given.job, given.output); });
  CLI::App* artifact =
      RemoteVerb(app, "artifact", "Get a product of a job, as it is kept",
                 "  rmlcell job 17                                 which there are\n"
                 "  rmlcell artifact 17 relief.png -o part.png     what a mill left\n"
                 "  rmlcell artifact 17 left.stl -o part.stl       the same as a body",
                 remote);
  artifact->add_option("JOB", given.job)->required();
  artifact->add_option("NAME", given.artifact)->required();
  artifact->add_option("-o,--output", given.output, "file; default: standard output");
  artifact->callback(
      [&] { exit_code = JobArtifact(remote, given.job, given.artifact, given.output); });
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Programs for machines: check, simulate, store, run as jobs, watch.", "rmlcell"};
  app.set_version_flag("--version", std::string(kVersion));
  app.formatter(std::make_shared<ExamplesFirst>());
  app.require_subcommand(1);
  app.footer(kExamples);
  Remote remote;
  // Not by the option itself: the library would let the environment win over the flag of another
  // verb.
  if (const char* server = std::getenv("RMLCELL_SERVER"); server != nullptr && *server != '\0')
    remote.server = server;
  RemoteArguments given;
  int exit_code = kGood;
  AddLocalVerbs(app, exit_code);
  AddTextToolVerbs(app, exit_code);
  AddRml1Verbs(app, exit_code);
  AddProgramVerbs(app, remote, given, exit_code);
  AddSpecialVerb(app, remote, exit_code);
  AddProjectVerbs(app, remote, given, exit_code);
  AddMachineVerbs(app, remote, exit_code);
  AddHandboxVerb(app, remote, exit_code);
  AddJobVerbs(app, remote, given, exit_code);
  AddProductVerbs(app, remote, given, exit_code);
  AddReplayVerb(app, remote, exit_code);
  const auto named = [&](CLI::App* verb) { return argc > 1 && verb->get_name() == argv[1]; };
  if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(named).empty()) {
    Complain(NoSuchVerb(app, argv[1]));
    return kUsage;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help, or the version
    Complain(UsageText(app, error));
    return kUsage;
  }
  // A full disk or a closed pipe: what was asked for did not arrive.
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    Complain("standard output could not be written");
    return kUsage;
  }
  return exit_code;
}
