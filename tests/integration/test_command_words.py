"""The words that the verbs of the rmlcell command take: each as its help shows it."""
import re
import unittest

from command import ask

# What a verb is for, and its words: what each must be, what it needs and what it excludes.
VERBS = {
    "check": ("Say what is wrong with programs, before anything moves",
        ["FILES TEXT ... REQUIRED", "--family TEXT", "--profile TEXT", "--machine TEXT", "--origin TEXT",
         "--clamps FLOAT", "--inputs TEXT", "--errors-only", "--fix", "--dry-run Needs: --fix",
         "--machine-coordinates", "--strict", "--json"]),
    "simulate": ("Run a program in virtual time and report",
        ["FILES TEXT ...", "--slot TEXT ...", "--main INT:INT in [1 - 99]", "--executable TEXT ...", "--family TEXT",
         "--profile TEXT", "--machine TEXT", "--origin TEXT", "--clamps FLOAT", "--inputs TEXT", "--mode TEXT",
         "--override FLOAT", "--simul TEXT", "--break TEXT", "--budget TEXT", "--vars TEXT", "--svg TEXT",
         "--toolpath TEXT", "--samples TEXT", "--plot TEXT", "--stock TEXT Needs: --tool",
         "--tool TEXT Needs: --stock", "--cell FLOAT Needs: --stock", "--material TEXT Needs: --stock",
         "--rpm FLOAT:FLOAT in [1 - 1e+06] Needs: --stock", "--target TEXT Needs: --stock",
         "--stl TEXT Needs: --stock", "--stl-tolerance FLOAT:FLOAT in [0 - 1000] Needs: --stl",
         "--relief TEXT Needs: --stock", "--height-map TEXT Needs: --stock",
         "--target-tolerance FLOAT:FLOAT in [0 - 1000] Needs: --target", "--target-png TEXT Needs: --target",
         "--state-in TEXT", "--state-out TEXT", "--trace", "--facts Excludes: --json", "--json Excludes: --facts",
         "--machine-coordinates", "--strict"]),
    "parameters": ("List machine parameters: meaning, range and value, as a machine file",
        ["FAMILY TEXT", "--profile TEXT", "--json"]),
    "explain": ("Say what an error code means and what to do about it",
        ["CODES TEXT ...", "--json"]),
    "machines": ("List the machines of the cell",
        ["--server TEXT", "--json"]),
    "programs": ("List the programs of a machine",
        ["MACHINE TEXT REQUIRED", "--server TEXT", "--json"]),
    "put": ("Store a program in a slot of a machine",
        ["MACHINE TEXT REQUIRED", "SLOT INT REQUIRED", "FILE TEXT REQUIRED", "--server TEXT", "--json", "--etag TEXT",
         "--check-only", "--force"]),
    "get": ("Get a program of a machine",
        ["MACHINE TEXT REQUIRED", "SLOT INT REQUIRED", "--server TEXT", "--json",
         "--form TEXT:{source,object,executable,listing}", "-o,--output TEXT"]),
    "delete": ("Delete a program, or the executable of slot - 100",
        ["MACHINE TEXT REQUIRED", "SLOT INT REQUIRED", "--server TEXT", "--json"]),
    "stale": ("Say which executables of a machine are older than its programs, and why",
        ["MACHINE TEXT REQUIRED", "--server TEXT", "--json"]),
    "projects": ("List, make, show, update, delete, transfer, export and import projects",
        ["--server TEXT", "--json"]),
    "handbox": ("The handbox of a machine that lives, on the whole terminal: keys and mouse",
        ["MACHINE TEXT REQUIRED", "--take-over TEXT", "--server TEXT"]),
    "submit": ("Submit a job",
        ["MACHINE TEXT REQUIRED", "FILE TEXT", "--server TEXT", "--json", "--slot INT:INT in [1 - 99]",
         "--kind TEXT:{simulate,check,run}", "--unzeroed", "--ticket TEXT", "--step TEXT",
         "--occurrence INT Needs: --step", "--off-until-work-on Needs: --step", "--seen TEXT ...", "--title TEXT",
         "--label TEXT ...", "--request-id TEXT", "--override FLOAT", "--pace FLOAT:FLOAT in [0 - 1000]",
         "--inputs TEXT", "--stock TEXT Needs: --tool Excludes: --project", "--tool TEXT Needs: --stock",
         "--cell FLOAT Needs: --stock", "--material TEXT Needs: --stock",
         "--rpm FLOAT:FLOAT in [1 - 1e+06] Needs: --stock", "--target TEXT Needs: --stock Excludes: --target-slot",
         "--target-slot INT:INT in [1 - 99] Needs: --stock Excludes: --target",
         "--target-tolerance FLOAT:FLOAT in [0 - 1000] Needs: --stock",
         "--products TEXT:{relief,height-map,height-grid,stl,target} ... Needs: --stock",
         "--stl-tolerance FLOAT:FLOAT in [0 - 1000] Needs: --products", "--project TEXT Excludes: --stock", "--trace",
         "--priority INT:INT in [-100 - 100]", "--hold", "--not-before TEXT", "--after-job TEXT ...", "--watch",
         "--strict Needs: --watch"]),
    "watch": ("Watch a job live to its end",
        ["JOB TEXT REQUIRED", "--server TEXT", "--json", "--after INT", "--strict"]),
    "jobs": ("List jobs, newest first",
        ["--server TEXT", "--json", "--filter TEXT", "--order TEXT:{newest,oldest,queue}",
         "--limit INT:INT in [1 - 1000]"]),
    "job": ("Show one job",
        ["JOB TEXT REQUIRED", "--server TEXT", "--json"]),
    "cancel": ("Cancel a job",
        ["JOB TEXT REQUIRED", "--server TEXT", "--json"]),
    "hold": ("Hold a job: one that waits does not start",
        ["JOB TEXT REQUIRED", "--server TEXT", "--json"]),
    "resume": ("Let a job go on, or start, that is held",
        ["JOB TEXT REQUIRED", "--server TEXT", "--json"]),
    "move": ("Give a job that waits another place in the queue",
        ["JOB TEXT REQUIRED", "--server TEXT", "--json", "--before TEXT", "--priority INT:INT in [-100 - 100]"]),
    "report": ("Show the report of a job",
        ["JOB TEXT REQUIRED", "--server TEXT", "--json", "--machine-coordinates"]),
    "picture": ("Get the picture of a job (SVG)",
        ["JOB TEXT REQUIRED", "--server TEXT", "--json", "-o,--output TEXT"]),
    "artifact": ("Get a product of a job, as it is kept",
        ["JOB TEXT REQUIRED", "NAME TEXT REQUIRED", "--server TEXT", "--json", "-o,--output TEXT"]),
    "replay": ("Play what a machine did again, and say whether it comes out the same",
        ["WHAT TEXT REQUIRED", "--from INT:NONNEGATIVE", "--to INT:NONNEGATIVE", "-o,--output TEXT", "--server TEXT"]),
    "projects list": ("List the projects",
        []),
    "projects show": ("Print what is in a project",
        ["PROJECT TEXT REQUIRED"]),
    "projects create": ("Make a project of a folder or of a JSON file (message Project)",
        ["PROJECT TEXT REQUIRED", "PATH TEXT REQUIRED"]),
    "projects update": ("Put a folder or a JSON file (message Project) in place of a project",
        ["PROJECT TEXT REQUIRED", "PATH TEXT REQUIRED"]),
    "projects delete": ("Delete a project",
        ["PROJECT TEXT REQUIRED"]),
    "projects transfer": ("Compile and store a project on a machine: all or nothing",
        ["PROJECT TEXT REQUIRED", "MACHINE TEXT REQUIRED", "--insert", "--check-only"]),
    "projects take": ("Make a project of what a machine holds",
        ["PROJECT TEXT REQUIRED", "MACHINE TEXT REQUIRED", "--slots INT ...", "--inch"]),
    "projects export": ("Write a project as one file",
        ["PROJECT TEXT REQUIRED", "-o,--output TEXT"]),
    "projects import": ("Make a project of such a file",
        ["PROJECT TEXT REQUIRED", "FILE TEXT REQUIRED"]),
}


def words_of(text):
    """The left column of positionals and options, without --help."""
    words = []
    for part in re.findall(r"(?ms)^(?:Positionals|Options):\n(.*?)(?:\n\n|\Z)", text):
        words += [re.split(r"\s{2,}| edge of", line.strip())[0] for line in part.splitlines() if re.match(r"  \S", line)]
    return [word for word in words if not word.startswith("-h")]


class Words(unittest.TestCase):
    def test_each_verb_says_what_it_takes(self):
        for verb, (what, words) in VERBS.items():
            with self.subTest(verb):
                told = ask(*verb.split(), "--help").stdout
                self.assertEqual(told.splitlines()[:2], [what, "Examples:"])
                self.assertIn(f"\n  rmlcell {verb.split()[0]}", told)
                self.assertEqual(words_of(told), words)

    # Verbs in their order, and what they share, behind examples that show them at work.
    def test_the_command_names_its_verbs(self):
        told = ask("--help").stdout
        self.assertEqual(told.splitlines()[:3], ["Programs for machines: check, simulate, store, run as jobs, watch.",
                                                 "Examples:", "  rmlcell check part.S                          "
                                                 "what is wrong with a program, and where"])
        self.assertFalse(told.endswith("\n\n"))
        self.assertIn("\n\nUsage: rmlcell [OPTIONS] SUBCOMMAND\n", told)
        listed = dict(re.findall(r"(?m)^  ([a-z0-9]+) {2,}([A-Z].*)$", told.partition("Subcommands:")[2]))
        for verb, (what, _) in VERBS.items():
            if " " not in verb:
                self.assertEqual(listed[verb], what)
        for line in ("optimo or rml1; default: from the file name", "optimo or rml1; none: list the families"):
            self.assertIn(line, ask("check", "--help").stdout + ask("parameters", "--help").stdout)

    def test_what_stands_before_its_verb_is_no_verb(self):
        for words, said in (((), "rmlcell needs a verb"), (("simulat",), "there is no verb 'simulat'; did you mean simulate?"),
                            (("--json", "jobs"), "--json stands behind the verb"), (("",), "there is no verb ''")):
            with self.subTest(words):
                done = ask(*words)
                self.assertEqual((done.returncode, done.stdout), (2, ""))
                self.assertIn(said, done.stderr)
        self.assertRegex(ask("--version").stdout, r"^\d+\.\d+\.\d+")


if __name__ == "__main__":
    unittest.main()
