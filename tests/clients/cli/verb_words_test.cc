// The words that each verb of the library takes: what the help says of it, each option with what it
// must be, needs and excludes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "clients/cli/milling.h"
#include "clients/cli/remote.h"
#include "clients/cli/verbs.h"
#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct VerbRow {
  const char* verb;
  const char* what;
  const char* options;
};

std::string NamesAmong(const std::set<CLI::Option*>& options, const char* head) {
  std::vector<std::string> names;
  for (const CLI::Option* option : options) names.push_back(option->get_name());
  std::ranges::sort(names);
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? head : "&") + name;
  return text;
}

// "!": it must be given; "...": one or more words; "+": one word each time; x2: so many; then what
// separates them, and what they must be.
std::string OptionWords(const CLI::Option& option) {
  std::string text = option.get_name(false, true);
  if (option.get_required()) text += "!";
  const int most = option.get_items_expected_max();
  if (most > 1 && most == option.get_items_expected_min()) {
    text += "x" + std::to_string(most);
  } else if (most > 1) {
    text += option.get_allow_extra_args() ? "..." : "+";
  }
  if (option.get_delimiter() != '\0') text += option.get_delimiter();
  const std::string type = option.get_type_name();
  if (const std::size_t must = type.find(':'); must != std::string::npos) text += type.substr(must);
  return text + NamesAmong(option.get_needs(), " needs ") +
         NamesAmong(option.get_excludes(), " excludes ");
}

std::string AllOptionWords(const CLI::App& verb) {
  std::string words;
  for (const CLI::Option* option : verb.get_options()) {
    if (!option->check_name("--help")) words += (words.empty() ? "" : "; ") + OptionWords(*option);
  }
  return words;
}

const CLI::App& VerbAt(const CLI::App& app, const std::string& path) {
  const CLI::App* verb = &app;
  std::istringstream words(path);
  for (std::string word; words >> word;) verb = verb->get_subcommand(word);
  return *verb;
}

class VerbWords : public testing::Test {
 protected:
  VerbWords() {
    AddTextToolVerbs(app_, exit_code_);
    AddRml1Verbs(app_, exit_code_);
    AddSpecialVerb(app_, remote_, exit_code_);
    AddMachineVerbs(app_, remote_, exit_code_);
  }
  void Expect(const std::vector<VerbRow>& rows) {
    for (const VerbRow& row : rows) {
      const CLI::App& verb = VerbAt(app_, row.verb);
      EXPECT_EQ(verb.get_description(), row.what) << row.verb;
      EXPECT_EQ(AllOptionWords(verb), row.options) << row.verb;
    }
  }
  // What it says to a line: empty where it takes it.
  std::string Said(const std::string& line) {
    std::istringstream text(line);
    std::vector<std::string> words;
    for (std::string word; text >> word;) words.insert(words.begin(), word);
    std::string said;
    Hear([&] {
      try {
        app_.parse(words);
      } catch (const CLI::ParseError& error) {
        said = error.what();
      }
      return 0;
    });
    return said;
  }

  Remote remote_;
  int exit_code_ = 0;
  CLI::App app_;
};

TEST_F(VerbWords, OfProgramTexts) {
  Expect(
      {{"compile", "Compile a source to its object", "FILE!; -o,--output; --json; --map"},
       {"decompile", "Give the source of an object: its own text where 12.MAP beside it has it",
        "FILE!; -o,--output; --json"},
       {"link", "Make the executable of a program with the FUNCTIONs it needs",
        "FILES!...; --slot+; --main:INT in [1 - 99]; -o,--output; --json"},
       {"format", "Put sources into canonical layout; comments stay", "FILES!...; --check; --json"},
       {"convert", "Convert a source between inches/degrees and mm/rad",
        "ARGUMENTS...; -o,--output; --json"},
       {"compensate",
        "Offset the path by the beam's radius, as the ;$ directives of the source say",
        "FILE!; -o,--output; --json"},
       {"transform", "Move and turn a program, head angles included",
        "FILE!; -o,--output; --json; --move; --turn; --shift"},
       {"list", "List a program with line numbers and step numbers as the control counts them",
        "FILE!; -o,--output; --json"},
       {"diff", "Say what two programs do differently: path, time, power, outputs",
        "A!; B!; --profile; --machine; --svg; --json"},
       {"lsp", "Serve an editor: findings, fixes, hover, jumps, names (language server protocol)",
        "--stdio"}});
}

TEST_F(VerbWords, OfStreams) {
  Expect(
      {{"rml1", "Tools for streams of Roland mills: in words, from and to G-code, moved, repeated",
        ""},
       {"rml1 explain", "Tell a stream in words: each command with its place and what it does",
        "FILE!; --profile; --machine; --origin; --json"},
       {"rml1 to-gcode", "Write what the mill does with a stream as G-code (docs/gcode.md)",
        "FILE!; --profile; --machine; --origin; -o,--output; --force; --json"},
       {"rml1 from-gcode",
        "Make a stream of G-code: lines and arcs, absolute, one tool (docs/gcode.md)",
        "FILE!; --profile; --machine; --origin; -o,--output; --force; --json; --tolerance"},
       {"rml1 move", "Move the work of a stream to another place; all other bytes stay",
        "FILE!; --profile; --machine; --origin; --by!; -o,--output; --force; --json"},
       {"rml1 steps", "Convert a stream between machines of different step sizes",
        "FILE!; --profile; --machine; --origin; --from!; --to!; -o,--output; --force; --json"},
       {"rml1 tile", "Repeat a stream in columns and rows, within the travel",
        "FILE!; --profile; --machine; --origin; --columns excludes --within; --rows excludes --within; --within excludes --columns&--rows; --gap; -o,--output; --force; --json"},
       {"rml1 from-png",
        "Make a stream that mills a circuit board, of a picture in black and white",
        "FILE!; --profile; --machine; --origin; --tool!; --depth!; --step; --passes excludes --outline; --overlap excludes --outline; --outline excludes --overlap&--passes; --dpi; --at; --feed; --plunge; --rpm; --clearance; --tolerance; --invert; -o,--output; --force; --json"}});
}

TEST_F(VerbWords, OfMachinesThatLive) {
  Expect({{"special", "Store the programs that others call and that a new machine does not have",
           "--server; --json; MACHINE!; SLOTS...; --replace"},
          {"machine", "Machines that live: enable, start, hold, look at", "--server; --json"},
          {"machine status", "Show how a machine stands, and what keeps jobs from it", "MACHINE!"},
          {"machine watch", "Follow a machine", "MACHINE!"},
          {"machine log", "Show what happened at a machine, and who did it", "MACHINE!; --follow"},
          {"machine taught", "Show what was taught at a handbox, or take it back",
           "MACHINE!; --take-over; --slot:INT in [1 - 99]; --undo:POSITIVE"},
          {"machine enable", "Switch a machine on: it lives from here on", "MACHINE!"},
          {"machine disable", "Switch a machine off", "MACHINE!"},
          {"machine options",
           "Show how a machine lives, or change that: who starts jobs, what halts it",
           "MACHINE!; VALUES..."},
          {"machine take", "Give a machine to another computer, whoever is its host",
           "MACHINE!; --reason!; --computer"},
          {"machine hold", "Let a run come to rest after the present instruction", "MACHINE!"},
          {"machine stop", "Let a run come to rest at once, on its path", "MACHINE!"},
          {"machine emergency-stop", "End the run; the machine is in alarm", "MACHINE!"},
          {"machine abort", "End the run that is open", "MACHINE!"}});
}

TEST_F(VerbWords, OfWhatIsDoneWithMachines) {
  Expect(
      {{"machine start", "Start a stored program, the selected one, or a job of the queue",
        "MACHINE!; --take-over; SLOT:INT in [1 - 99] excludes --job; --job excludes SLOT; --seen..., needs --job"},
       {"machine zero", "Let the axes find their reference; in REMOTE program 4 follows",
        "MACHINE!; --take-over"},
       {"machine resume", "Let a held run go on",
        "MACHINE!; --take-over; --accept-displaced; --restore-process"},
       {"machine mode", "Set the operating mode",
        "MACHINE!; --take-over; MODE!:{remote,cycle,single,repeat,manual}"},
       {"machine override", "Set the override of the programmed speed",
        "MACHINE!; --take-over; PERCENT!"},
       {"machine factor", "Let the time of a virtual machine go faster or slower",
        "MACHINE!; --take-over; FACTOR!"},
       {"machine acknowledge", "Acknowledge an alarm, or all of them",
        "MACHINE!; --take-over; ALARM"},
       {"machine confirm", "Say that machine and part were inspected after a run was cut off",
        "MACHINE!; --take-over"},
       {"machine read", "Read variables, inputs and outputs", "MACHINE!; VARIABLES!..."},
       {"machine write", "Write variables and outputs", "MACHINE!; --take-over; VALUES!..."},
       {"machine key", "Press keys of the panel of a mill, or of a handbox",
        "MACHINE!; --take-over; KEYS!...; --for:FLOAT in [0 - 50]; --fast"},
       {"machine input", "Set inputs, door and power of a virtual machine",
        "MACHINE!; --take-over; VALUES!..."},
       {"machine gates", "Set which programs gate 1 and gate 2 start",
        "MACHINE!; --take-over; SLOTS!x2:INT in [0 - 99]"},
       {"machine start-at", "Start a program at a step, behind a safe way there",
        "MACHINE!; --take-over; STEP; --slot:INT in [1 - 99]; --occurrence; --direct; --off-until-work-on; --stock needs --tool; --tool needs --stock; --untouched needs --stock; --preview; --halt excludes --no-halt; --no-halt excludes --halt; --seen...,; --reason"}});
}

TEST_F(VerbWords, OfBlocksAndTools) {
  CLI::App simulate;
  MillingOptions milling;
  AddMillingOptions(simulate, milling);
  EXPECT_EQ(
      AllOptionWords(simulate),
      "--stock needs --tool; --tool needs --stock; --cell needs --stock; --material needs --stock; --rpm:FLOAT in [1 - 1e+06] needs --stock; --target needs --stock; --stl needs --stock; --stl-tolerance:FLOAT in [0 - 1000] needs --stl; --relief needs --stock; --height-map needs --stock; --target-tolerance:FLOAT in [0 - 1000] needs --target; --target-png needs --target");
  CLI::App submit;
  JobMillingOptions of_job;
  AddJobMillingOptions(submit, of_job);
  EXPECT_EQ(
      AllOptionWords(submit),
      "--stock needs --tool; --tool needs --stock; --cell needs --stock; --material needs --stock; --rpm:FLOAT in [1 - 1e+06] needs --stock; --target needs --stock excludes --target-slot; --target-slot:INT in [1 - 99] needs --stock excludes --target; --target-tolerance:FLOAT in [0 - 1000] needs --stock; --products+,:{relief,height-map,height-grid,stl,target} needs --stock; --stl-tolerance:FLOAT in [0 - 1000] needs --products");
}

// Whoever asks for help sees it done: each example calls the verb that it stands with.
TEST_F(VerbWords, EachHasExamples) {
  for (const char* path : {"compile",       "decompile",
                           "link",          "format",
                           "convert",       "compensate",
                           "transform",     "list",
                           "diff",          "lsp",
                           "rml1",          "rml1 explain",
                           "rml1 to-gcode", "rml1 from-gcode",
                           "rml1 move",     "rml1 steps",
                           "rml1 tile",     "rml1 from-png",
                           "special",       "machine"}) {
    const std::string footer = VerbAt(app_, path).get_footer();
    EXPECT_THAT(footer, StartsWith("Examples:\n  rmlcell " + std::string(path) + " "));
  }
}

TEST_F(VerbWords, OfTwoGroupsOneVerbIsNeeded) {
  EXPECT_THAT(Said("rml1"), HasSubstr("subcommand is required"));
  EXPECT_THAT(Said("machine"), HasSubstr("subcommand is required"));
  EXPECT_NE(Said("rml1 explain a.rml move a.rml --by 1,2"), "");
}

// Each asks for its file, which is not there.
TEST_F(VerbWords, EachIsCarriedOut) {
  for (const std::string line :
       {"compile @a.S", "decompile @a.O", "link @12.S", "format @a.S", "convert @a.S",
        "compensate @a.S", "transform @a.S --move 1,2,3", "list @a.S", "diff @a.S @b.S",
        "rml1 explain @a.rml", "rml1 to-gcode @a.rml", "rml1 from-gcode @a.nc",
        "rml1 move @a.rml --by 1,2", "rml1 steps @a.rml --from 40 --to 100", "rml1 tile @a.rml",
        "rml1 from-png @a.png --tool 1 --depth 1"}) {
    std::string said = line;
    for (std::size_t at = 0; (at = said.find('@')) != std::string::npos;)
      said.replace(at, 1, "/nowhere/");
    exit_code_ = -1;
    EXPECT_EQ(Said(said), "") << said;
    EXPECT_GT(exit_code_, 0) << said;
  }
}

// What stands at the end of the line may be of the group.
TEST_F(VerbWords, TheServerMayStandAtTheEnd) {
  EXPECT_EQ(Said("machine options m --server unix:/nowhere/at/all --json"), "");
  EXPECT_EQ(remote_.server, "unix:/nowhere/at/all");
  EXPECT_TRUE(remote_.json);
}

// So many numbers and no others, whichever file it is about.
TEST_F(VerbWords, PlacesHaveTheirNumbers) {
  const std::string one = "1", two = "1,2", three = "1,2,3", four = "1,2,3,4";
  for (const std::string verb : {"explain", "to-gcode", "from-gcode", "steps --from 40 --to 100",
                                 "tile", "from-png --tool 1 --depth 1", "move --by 1,2"}) {
    const std::string head = "rml1 " + verb + " /nowhere/part.rml --origin ";
    EXPECT_EQ(Said(head + two), "") << verb;
    EXPECT_EQ(Said(head + three), "") << verb;
    EXPECT_THAT(Said(head + one), HasSubstr("'1': give X,Y or X,Y,Z")) << verb;
    EXPECT_THAT(Said(head + four), HasSubstr("'1,2,3,4': give X,Y or X,Y,Z")) << verb;
  }
  const std::string move = "rml1 move /nowhere/part.rml --by ";
  EXPECT_EQ(Said(move + two), "");
  EXPECT_EQ(Said(move + three), "");
  EXPECT_THAT(Said(move + one), HasSubstr("give X,Y or X,Y,Z in mm"));
  EXPECT_THAT(Said(move + four), HasSubstr("give X,Y or X,Y,Z in mm"));
  const std::string at = "rml1 from-png /nowhere/a.png --tool 1 --depth 1 --at ";
  EXPECT_EQ(Said(at + two), "");
  EXPECT_THAT(Said(at + one), HasSubstr("give X,Y in mm of the lower left corner"));
  EXPECT_THAT(Said(at + three), HasSubstr("give X,Y in mm of the lower left corner"));
  for (const std::string name : {"--move", "--turn"}) {
    const std::string head = "transform /nowhere/a.S " + name + " ";
    EXPECT_EQ(Said(head + three), "") << name;
    EXPECT_THAT(Said(head + two), HasSubstr("'1,2': give ")) << name;
    EXPECT_THAT(Said(head + four), HasSubstr("'1,2,3,4': give ")) << name;
  }
  const std::string shift = "transform /nowhere/a.S --shift ";
  EXPECT_EQ(Said(shift + "1,2,3,4,5,6"), "");
  EXPECT_THAT(Said(shift + "1,2,3,4,5"), HasSubstr("'1,2,3,4,5': give X,Y,Z,rz,ry,rx"));
  EXPECT_THAT(Said(shift + "1,2,3,4,5,6,7"), HasSubstr("'1,2,3,4,5,6,7': give X,Y,Z,rz,ry,rx"));
}

}  // namespace
}  // namespace rmlcell::cli
