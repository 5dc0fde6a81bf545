"""The options of the verbs that need no server: what each does, wherever it stands on the line, and what is refused."""
import json
import subprocess
import unittest

from command import BIN, InFolder, ask, run

VERBS = ["check", "simulate", "parameters", "explain", "machines", "programs", "put", "get", "delete", "stale", "projects",
         "submit", "watch", "jobs", "job", "cancel", "hold", "resume", "move", "handbox", "replay", "report", "picture",
         "artifact", "compile", "format", "diff", "rml1", "special", "machine"]
# Its verdict is DOUBTFUL: the spindle turns on, and nothing sets a speed.
STREAM = "PA;!PZ-10,10;PU0,0;PD5,0;PU;"
CALLER = "CALL 44\nCALL 45\nVR[1] = VR[0] + 1.\n"


class Options(InFolder):
    def refused(self, said, *words):
        with self.subTest(words):
            done = ask(*words)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn(said, done.stderr)
            self.assertTrue(done.stderr.startswith("rmlcell: "))

    # Its own examples, not those of the whole command.
    def test_each_verb_shows_its_own_examples(self):
        for verb in VERBS:
            with self.subTest(verb):
                told = run(verb, "--help")
                self.assertRegex(told, rf"\nExamples:\n(  rmlcell .*\n)*  rmlcell {verb}\b")
                self.assertNotIn("Each verb has its own --help", told)
        self.assertRegex(run("check", "--help"), r"--family TEXT +optimo or rml1; default: from the file name\n")
        self.assertRegex(run("parameters", "--help"), r"FAMILY TEXT +optimo or rml1; none: list the families\n")

    def test_help_is_asked_for_in_two_ways(self):
        self.assertEqual(run("-h"), run("--help"))
        self.assertEqual(run("jobs", "-h"), run("jobs", "--help"))
        self.assertIn("Each verb has its own --help", run("-h"))

    # Whatever follows it.
    def test_a_word_that_is_no_verb(self):
        for words in (["simulat"], ["simulat", "part.S", "--facts"], ["simulat", "--help"]):
            self.refused("there is no verb 'simulat'; did you mean simulate? (rmlcell --help)", *words)
        self.refused("--json stands behind the verb", "--json", "jobs")
        self.refused("SLOT is required", "put", "mill-1")

    # An option takes its own words and leaves the program to the verb; --slot and --executable may be repeated.
    def test_options_stand_before_or_behind_the_program(self):
        caller, called = self.file("12.S", CALLER), self.file("called", "VR[0] = 41.\n")
        other = self.file("other", "VI[2] = 3\n")
        options = [["--vars", "VR[1],VI[2]", "--facts"], ["--samples", 10, self.folder / "s.csv"],
                   ["--plot", "speed", self.folder / "p.svg"], ["--executable", 12], ["--slot", f"44={called}"],
                   ["--slot", f"45={other}"]]
        for n in range(len(options)):
            words = [*sum(options[n:], []), caller, *sum(options[:n], [])]
            told = run("simulate", *words)
            self.assertIn("\nvariable.VR[1]: 42.0\nvariable.VI[2]: 3\n", told)
            self.assertTrue((self.folder / "s.csv").read_text().startswith("t_s,X_"))
            self.assertIn("<svg", (self.folder / "p.svg").read_text())
            (self.folder / "s.csv").unlink()
            (self.folder / "p.svg").unlink()
        last = [option for option in options if "--executable" not in option]
        self.assertIn("\nvariable.VR[1]: 42.0\n", run("simulate", *sum(last, []), "--executable", 12, caller))
        chosen = ["simulate", "--family", "optimo", "--facts", "--vars", "VR[0],VI[2]"]
        self.assertIn("\nvariable.VR[0]: 0.0\nvariable.VI[2]: 3\n",
                      run(*chosen, "--slot", f"44={called}", "--slot", f"45={other}", "--main", 45))
        self.assertIn("\nvariable.VR[0]: 41.0\n", run(*chosen, "--slot", f"99={called}", "--main", 99))
        self.refused("--samples wants more: RATE FILE: ", "simulate", caller, "--samples", 10)
        self.refused("--plot wants more: CURVES FILE: ", "simulate", caller, "--plot", "speed")
        for slot in (0, 100):
            self.refused("--main", "simulate", caller, "--main", slot)

    def test_a_work_origin_has_two_or_three_numbers(self):
        stream = self.file("a.rml", STREAM)
        for verb in ("check", "simulate"):
            told = run(verb, stream, "--origin", "1,2")
            self.assertIn("changed       ORIGIN_X 1 (profile: 0), ORIGIN_Y 2 (profile: 0); by --origin\n", told)
            self.assertIn("ORIGIN_Y 2 (profile: 0), Z0 -3 (", run(verb, stream, "--origin", "1,2,-3"))
            self.assertIn("by --origin and --clamps\n", run(verb, stream, "--origin", "1,2", "--clamps", 4))
            for wrong in ("1", "1,2,3,4"):
                self.refused(f"--origin: '{wrong}': give X,Y[,Z]: ", verb, stream, "--origin", wrong)

    # A verdict that is not GOOD is no error, unless that is wanted.
    def test_a_doubtful_program_is_good_unless_it_is_strict(self):
        stream = self.file("a.rml", STREAM)
        for verb in ("check", "simulate"):
            self.assertIn("DOUBTFUL", run(verb, stream))
            self.assertIn("DOUBTFUL", run(verb, stream, "--strict", code=1))
            origin = ["--origin", "10,20,-30"]
            placed, from_zero = run(verb, stream, *origin), run(verb, stream, *origin, "--machine-coordinates")
            self.assertNotEqual(placed, from_zero)
            found = json.loads(run(verb, stream, "--json"))
            self.assertEqual(found.get("outcome", found)["verdict"], "VERDICT_DOUBTFUL")

    def test_a_trace_is_told_where_it_is_wanted(self):
        stream = self.file("a.rml", STREAM)
        self.assertNotIn(" move PD ", run("simulate", stream))
        self.assertIn(" move PD ", run("simulate", stream, "--trace"))
        self.assertEqual(json.loads(run("simulate", stream, "--json"))["traceRecords"], [])
        self.assertNotEqual(json.loads(run("simulate", stream, "--trace", "--json"))["traceRecords"], [])

    # The lists of both verbs without a word are whole; --json is one document of the one, and a line each of the other.
    def test_lists_are_for_people_unless_json_is_wanted(self):
        self.assertTrue(run("parameters").startswith("optimo  Amada OPTIMO 5-axis laser\n"))
        self.assertEqual([one["family"] for one in json.loads(run("parameters", "--json"))["families"]], ["optimo", "rml1"])
        self.assertTrue(run("parameters", "rml1", "--profile", "srm-20").startswith("# Roland mill or engraver, RML-1\n"))
        self.assertEqual(json.loads(run("parameters", "rml1", "--profile", "srm-20", "--json"))["family"], "rml1")
        self.assertTrue(run("explain", 348, "OPT-E60").startswith("OPT-E348  HOLE_RADIUS_ZERO  (program error)\n"))
        told = [json.loads(line) for line in run("explain", 348, "OPT-E60", "--json").splitlines()]
        self.assertEqual([one["code"] for one in told], ["OPT-E348", "OPT-E60"])
        self.assertEqual(len(run("explain").splitlines()), len(run("explain", "--json").splitlines()))
        self.assertEqual(ask("explain", "NOTHING").returncode, 2)

    def test_what_cannot_be_written_is_told(self):
        # A picture leaves in one piece: nothing of it is left to be written at the end.
        stream = self.file("a.rml", "PA;!PZ-10,10;PU0,0;" + "".join(f"PD{k},{k % 7 * 50};" for k in range(0, 5000, 10)) + "PU;")
        for words in (["explain", "348"], ["explain"], ["simulate", stream, "--svg", "-"]):
            with open("/dev/full", "w", encoding="ascii") as full:
                done = subprocess.run([BIN / "rmlcell", *words], stdout=full, stderr=subprocess.PIPE, text=True, timeout=60, check=False)
            self.assertEqual((done.returncode, done.stderr), (2, "rmlcell: standard output could not be written\n"))
        self.refused("a handbox needs a terminal", "handbox", "m")


if __name__ == "__main__":
    unittest.main()
