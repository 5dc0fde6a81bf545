"""The rmlcell command: local verbs without a server."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

from cell import BIN, SQUARE, eventually
from command import InFolder, ask, run


def writer_of(fifo):
    """A descriptor, as soon as somebody reads there."""
    try:
        return os.open(fifo, os.O_WRONLY | os.O_NONBLOCK)
    except OSError:
        return None


def null_devices(process):
    """The descriptors that lead to the null device, and how each is open."""
    found = {}
    for number in os.listdir(f"/proc/{process}/fd"):
        try:
            if os.readlink(f"/proc/{process}/fd/{number}") == os.devnull:
                told = pathlib.Path(f"/proc/{process}/fdinfo/{number}").read_text()
                found[int(number)] = int(told.partition("flags:")[2].split()[0], 8) & os.O_ACCMODE
        except FileNotFoundError:  # closed meanwhile
            pass
    return found


class Local(InFolder):
    def test_check_names_place_code_and_rule(self):
        done = ask("check", self.file("a.S", "SPEED 20\nSPEED 101\n"))
        self.assertEqual(done.returncode, 1)
        self.assertIn("a.S:2:", done.stdout)
        self.assertIn("OPT-E7004", done.stdout)

    # OPT-E.7301, OPT-B.08: before anything moves, every place with its time; exit code 1.
    def test_check_follows_the_motion(self):
        far = self.file("far.S", "COORD ROBOT\nMOVE (9000.,0.,0.,0.,0.)\nMOVE (0.,0.,0.,13.,0.)\n")
        done = ask("check", far)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stdout, r"far.S:2: error OPT-E7301: X of the target .* 5400.000 mm \(step 2, at 0.000 s\)")
        self.assertRegex(done.stdout, r"far.S:3: error OPT-E7301: A of the target .* 0.400 rad \(step 3, at 2\d.\d+ s\)")
        findings = json.loads(ask("check", far, "--json").stdout)
        self.assertFalse(findings.get("ok", False))
        self.assertEqual([(d["code"], d["place"]["step"], d["place"]["line"]) for d in findings["diagnostics"]],
                         [("OPT-E7301", 2, 2), ("OPT-E7301", 3, 3)])
        self.assertGreater(int(findings["diagnostics"][1]["virtualTimeNs"]), 20_000_000_000)

    # OPT-B.09: a program that another one calls is looked at with the SYSDEF of that one.
    def test_check_knows_programs_that_call_each_other(self):
        part = self.file("44.S", "COORD ABSOL\nMOVE (4000.,0.,0.,0.,0.)\n")
        main = self.file("45.S", "SYSDEF (-1000.,0.,-300.,0.,0.,0.)\nCALL 44\n")
        self.assertEqual(ask("check", part, main, "--errors-only").returncode, 0)
        # Alone it hangs on a SYSDEF that nobody told; with none it would leave the travel.
        alone = ask("check", part)
        self.assertEqual(alone.returncode, 0)
        self.assertIn("44.S: DOUBTFUL", alone.stdout)
        self.assertIn("by 400.000 mm, if no SYSDEF is in force before (OPT-E7301, program 44 step 2 line 2)", alone.stdout)
        self.assertEqual(ask("check", part, "--strict").returncode, 1)

    # OPT-2.08: nothing decides whether this run fails. OPT-E7102: what a file calls may be on its machine.
    def test_check_fails_where_every_run_fails(self):
        hole = self.file("6.S", "PATH HOLE (25.1)\nMOVE (1200.,1120.,-350.,0.,0.) / VIA (1200.,1120.,-150.,0.,0.)\n")
        found = ask("check", hole)
        self.assertEqual(found.returncode, 1)
        self.assertIn("6.S: BAD", found.stdout)
        self.assertIn("(OPT-E7302, program 6 step 2 line 2)", found.stdout)
        calls = self.file("5.S", "COORD ABSOL\nCALL 77\n")
        found = ask("check", calls)
        self.assertEqual(found.returncode, 0)
        self.assertIn("5.S: DOUBTFUL", found.stdout)
        self.assertIn("check main.S 77.S", found.stdout)

    # docs/verdict.md: what a run would be judged by is judged before: 10 mm of WORK 0 without its beam.
    def test_check_and_simulate_judge_alike(self):
        cut = self.file("7.S", "COORD ABSOL\nPATH LIN\nMOVE (0.,1000.,-400.,0.,0.)\nSPEED 10\nWORK 0,0 /ON\n"
                               "MOVE (50.,1000.,-400.,0.,0.)\nWORK 2,5 /OFF\nMOVE (60.,1000.,-400.,0.,0.)\n"
                               "WORK 0,0 /OFF\n")
        for verb in ("check", "simulate"):
            done = ask(verb, cut)
            self.assertEqual(done.returncode, 1, verb)
            self.assertIn("BAD", done.stdout, verb)
            self.assertIn("10.000 mm of a process that is ON with the beam off (OPT-E7414", done.stdout, verb)

    def test_check_says_how_far_it_came(self):
        wait = self.file("w.S", "COORD ROBOT\nWAIT (IL[16])\nMOVE (9000.,0.,0.,0.,0.)\n")
        done = ask("check", wait)
        self.assertEqual(done.returncode, 0)
        self.assertIn("motion checked only up to step 2, line 2: OPT-E7902", done.stdout)
        inputs = self.file("inputs.txt", "1.5 IL[16] = 1\n")
        done = ask("check", wait, "--inputs", inputs)
        self.assertEqual(done.returncode, 1)
        self.assertIn("at 1.500 s", done.stdout)

    # motion.md 2.6, 8.2: the simulation goes on, tells all of them, and fails.
    def test_simulate_goes_on_behind_a_violation(self):
        far = self.file("far.S", "COORD ROBOT\nMOVE (9000.,0.,0.,0.,0.)\nMOVE (0.,0.,0.,13.,0.)\n")
        done = ask("simulate", far, "--json")
        self.assertEqual(done.returncode, 1)
        report = json.loads(done.stdout)
        self.assertEqual((report["outcome"]["kind"], report["outcome"]["code"]), ("KIND_FAILED", "OPT-E7301"))
        self.assertEqual([(v["axis"], v["place"]["step"], round(v["excess"], 6)) for v in report["violations"]],
                         [("X", 2, 5400.0), ("A", 3, 0.4)])
        self.assertIn("2 motions leave the travel", report["outcome"]["message"])
        self.assertIn("travel        2 violations", ask("simulate", far).stdout)

    # motion.md 8.2: figures that scripts read from the report.
    def test_the_report_has_the_figures_of_motion(self):
        part = self.file("45.S", "COORD ABSOL\nPATH LIN\nWORKDEF 1,0 (8.,75.,1.,50.)\n"
                                 "MOVE (1000.,1000.,-400.,0.,0.)\nSPEED 8\nWORK 1,0/ON\n"
                                 "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1100.,1100.,-400.,0.,0.)\nWORK 1,0/OFF\n"
                                 "SPEED 100\nMOVE (1101.,1100.,-400.,0.,0.)\n")
        report = json.loads(ask("simulate", part, "--json").stdout)
        self.assertAlmostEqual(report["total"]["energyJPerMm"], 28.125, 6)
        self.assertEqual((report["corners"]["blended"], report["corners"]["stopped"]), ("1", "3"))
        self.assertEqual(report["corners"]["deviationPlace"]["step"], 7)
        self.assertEqual((len(report["beam"]["bySpeedS"]), len(report["beam"]["byPowerS"])), (21, 20))
        self.assertAlmostEqual(sum(report["beam"]["bySpeedS"]), report["total"]["beamOnS"], 6)
        slow = report["slowMoves"][-1]
        self.assertEqual((slow["place"]["step"], slow["cause"], slow["wantedMmS"]), (11, "CAUSE_SHORT", 500.0))
        self.assertAlmostEqual(slow["reachedMmS"], 21.5443469, 3)  # case S03
        x = next(axis for axis in report["axes"] if axis["axis"] == "X")
        self.assertAlmostEqual(x["peakSpeedShare"], x["peakSpeed"] / 500.0, 9)
        self.assertEqual(report["collisions"], "not modelled")
        self.assertEqual(report["programs"][0]["corners"], report["corners"])
        text = ask("simulate", part).stdout
        for word in ("corners", "too slow", "peak speed", "28.125 J/mm"):
            self.assertIn(word, text)

    def test_simulate_prints_the_report_as_json(self):
        done = ask("simulate", self.file("square.rml", SQUARE), "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        report = json.loads(done.stdout)
        self.assertEqual(report["outcome"]["kind"], "KIND_COMPLETED")

    def test_simulate_fills_the_memory_from_a_folder(self):
        self.file("12.S", "CALL 13\nVR[1] = VR[0] + 1.\n")
        self.file("13.S", "VR[0] = 41.\n")
        done = ask("simulate", self.folder, "--main", 12, "--vars", "VR[0..1]", "--facts")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("variable.VR[1]: 42.0", done.stdout)

    def test_variables_are_shown_by_number(self):
        done = ask("simulate", self.file("v.S", "VR[2]=1E-7\nVR[10]=0.5\n"), "--vars", "VR[10],VI[3],VR[2]")
        shown = [line.split() for line in done.stdout.splitlines() if "[" in line]
        self.assertEqual(shown, [["VI[3]", "0"], ["VR[2]", "1.0E-7"], ["VR[10]", "0.5"]])

    def test_an_error_of_a_run_names_its_line(self):
        done = ask("simulate", self.file("d.S", "VR[1]=0\n\n; zero\nVR[0]=1/VR[1]\n"), "--json")
        place = [d["place"] for d in json.loads(done.stdout)["diagnostics"] if d["code"] == "OPT-E7201"][0]
        self.assertEqual((place["program"], place["step"], place["line"]), (1, 2, 4))

    def test_an_error_of_a_mill_is_told_once(self):
        done = ask("simulate", self.file("bad.rml", "PU0,0;QQ5;PD100,100;PU;"))
        self.assertEqual(done.stdout.count("RML1-E1:"), 1, done.stdout)

    def test_inputs_over_time_reach_the_program(self):
        inputs = self.file("inputs.txt", "# the operator\n2.5 IL[20] = 1\n")
        done = ask("simulate", self.file("w.S", "WAIT IL[20]\nVI[2] = 7\n"), "--inputs", inputs, "--vars", "VI[2]",
                   "--json")
        report = json.loads(done.stdout)
        self.assertEqual(report["variables"], [{"name": "VI[2]", "value": {"integer": "7"}, "text": "7"}])
        self.assertAlmostEqual(report["total"]["times"]["conditionS"], 2.5, places=6)

    def test_the_picture_goes_to_standard_output_and_the_run_keeps_its_exit_code(self):
        state = self.folder / "state"
        done = ask("simulate", self.file("bad.S", "SPEED 20\nVR[0] = 1. / VR[1]\n"), "--svg", "-", "--state-out", state)
        self.assertTrue(done.stdout.lstrip().startswith("<"), done.stdout[:80])
        self.assertEqual(done.returncode, 1)
        self.assertGreater(state.stat().st_size, 0)

    # OPT-6.08, OPT-6.14: breakpoint and SIMUL stay in the machine for the next run; off ends that.
    def test_the_kept_state_holds_breakpoint_and_simul_until_they_are_switched_off(self):
        part = self.file("1.S", "DELAY 5.\nVI[2] = 1\n")
        state = self.folder / "state"

        def report(*words):
            done = ask("simulate", part, "--json", "--state-out", state, *words)
            self.assertIn(done.returncode, (0, 1), done.stderr)
            return json.loads(done.stdout)

        def seconds(*words):
            return report(*words)["total"]["times"]["cycleS"]

        self.assertEqual(seconds("--simul", "1/9"), 0.0)  # that step is never reached
        self.assertEqual(seconds("--state-in", state), 0.0)
        self.assertEqual(seconds("--state-in", state, "--simul", "off"), 5.0)
        self.assertEqual(seconds("--state-in", state), 5.0)
        self.assertEqual(seconds("--state-in", state, "--simul", "1/2"), 0.0)  # reached: over
        self.assertEqual(seconds("--state-in", state), 5.0)

        def halts(*words):
            return int(report(*words)["halts"])

        self.assertEqual(halts("--break", "1/1"), 1)
        self.assertEqual(halts("--state-in", state), 1)
        self.assertEqual(halts("--state-in", state, "--break", "off"), 0)
        self.assertEqual(halts("--state-in", state), 0)
        mill = self.file("a.rml", SQUARE)
        self.assertEqual(ask("simulate", mill, "--break", "off", "--simul", "off").returncode, 0)
        self.assertEqual(ask("simulate", part, "--break", "on").returncode, 2)

    def test_a_machine_file_whose_values_do_not_fit_together_is_refused(self):
        for family, name, low, high in (("optimo", "a.S", "TRAVEL_X_MIN", "TRAVEL_X_MAX"), ("rml1", "a.rml", "X_MIN", "X_MAX")):
            program = self.file(name, "DELAY 1.\n" if family == "optimo" else "PU;")
            machine = self.file(f"{family}.toml", f'family = "{family}"\n[parameters]\n{low} = 100\n{high} = 50\n')
            for verb in ("simulate", "check"):
                done = ask(verb, program, "--machine", machine)
                self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
                self.assertIn("CELL-E9011", done.stderr)
                self.assertIn(f"{low} is 100", done.stderr)
                self.assertIn(f"{high}, which is 50", done.stderr)

    def test_listed_parameters_are_a_machine_file_that_changes_nothing(self):
        for family, profile, program in (("optimo", "pw-1993", self.file("a.S", "MOVE (100.0, 0.0, 0.0, 0.0, 0.0)\n")),
                                         ("rml1", "srm-20", self.file("square.rml", SQUARE))):
            words = ["--profile", profile]
            listed = ask("parameters", family, *words)
            self.assertEqual(listed.returncode, 0, listed.stderr)
            machine = self.file(f"{family}.toml", listed.stdout)
            plain = ask("simulate", program, "--facts", *words)
            self.assertEqual(plain.returncode, 0, plain.stderr)
            again = ask("simulate", program, "--facts", "--machine", machine).stdout
            self.assertIn(f"profile_changed_by: {machine}\n", again)
            self.assertEqual(again.replace(f"profile_changed_by: {machine}", "profile_changed_by: none"), plain.stdout)
        slow = self.file("slow.toml", (self.folder / "optimo.toml").read_text().replace("\nVMAX = ", "\nVMAX = 1 # "))
        facts = ask("simulate", self.folder / "a.S", "--facts", "--machine", slow).stdout
        self.assertNotEqual(facts, ask("simulate", self.folder / "a.S", "--facts").stdout)
        self.assertIn("pw-1993", ask("parameters").stdout)
        self.assertEqual(ask("parameters", "lathe").returncode, 2)
        self.assertEqual(ask("parameters", "rml1", "--profile", "none").returncode, 2)

    # What another program writes is run as it comes, and told before the rest is there; all of it gives the same as a file does.
    def test_a_stream_runs_as_it_comes(self):
        begin = "PA;PA;VS15;!VZ8;!PZ-100,200;PU500,500;\n"
        moves = "".join(f"PD{k * 37 % 9000},{k * 91 % 8000};\n" for k in range(12_000))
        stream = begin + moves + "PU0,0;H;"
        self.assertGreater(len(stream), 2 << 16)
        options = ["--family", "rml1", "--profile", "srm-20", "--trace"]
        command = subprocess.Popen([BIN / "rmlcell", "simulate", "/dev/stdin", *options], stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0)
        command.stdin.write(stream[:60_000].encode())
        command.stdin.flush()
        first = b""
        while b" move PD " not in first:  # the rest of it is not written yet
            first = command.stdout.readline()
            self.assertTrue(first)
        rest, _ = command.communicate(stream[60_000:].encode(), timeout=60)
        whole = run("simulate", self.file("stdin", stream), *options)
        self.assertTrue(whole.encode().endswith(first + rest))
        self.assertEqual(command.returncode, 0)

    # Its beginning is a program, and what follows is none: refused as it was when all of it was read first.
    def test_what_turns_out_to_be_no_program_leaves_nothing(self):
        path = self.folder / "half.rml"
        path.write_bytes(b"PA;PA;VS15;" + b"PD100,200;PD200,300;" * 2_500 + b"\xff" * 200_000)
        samples = self.folder / "half.csv"
        done = ask("simulate", path, "--profile", "srm-20", "--samples", "10", samples, "--json")
        self.assertEqual(done.returncode, 1)
        found = json.loads(done.stdout)
        self.assertEqual(found["diagnostics"][0]["code"], "RML1-E8007")
        self.assertFalse(samples.exists())

    def test_the_picture_is_written(self):
        picture = self.folder / "p.svg"
        self.assertEqual(ask("simulate", self.file("square.rml", SQUARE), "--svg", picture).returncode, 0)
        self.assertIn("<svg", picture.read_text())

    def test_curves_over_time_are_written(self):
        plot = self.folder / "t.svg"
        done = ask("simulate", "--plot", "axes,speed", plot, self.file("square.rml", SQUARE))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("tip speed", plot.read_text())
        self.assertEqual(ask("simulate", "--plot", "torque", plot, self.file("square.rml", SQUARE)).returncode, 2)

    def test_samples_are_written(self):
        samples = self.folder / "s.csv"
        done = ask("simulate", self.file("square.rml", SQUARE), "--samples", "100", samples)
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = samples.read_text().splitlines()
        self.assertTrue(lines[0].startswith("t_s,"))
        self.assertTrue(lines[-1].endswith(",end"))
        # One line each 10 ms, from the start on; events have lines of their own in between.
        even = [line.split(",")[0] for line in lines[1:] if line.endswith(",")]
        self.assertEqual(even[:3], ["0.000000000", "0.010000000", "0.020000000"])
        self.assertEqual(ask("simulate", self.file("square.rml", SQUARE), "--samples", "0", samples).returncode, 2)

    def test_wrong_use_and_missing_files_are_told_apart_from_program_errors(self):
        self.assertEqual(ask("simulate", self.folder / "none.S").returncode, 2)
        self.assertEqual(ask("nonsense").returncode, 2)
        self.assertEqual(ask("explain", "OPT-E348").returncode, 0)
        self.assertEqual(ask("jobs", server="127.0.0.1:1").returncode, 3)

    # The number of a stream that is closed must not go to a file: what is there can be neither read nor written.
    def test_a_stream_that_is_closed_is_no_file(self):
        fifo = self.folder / "a.rml"
        os.mkfifo(fifo)
        for closed, held, code in (("", {}, 0), ("0", {0: os.O_WRONLY}, 0), ("1", {1: os.O_RDONLY}, 2),
                                   ("2", {2: os.O_RDONLY}, 0)):
            with self.subTest(closed=closed):
                without = f" {closed}>&-" if closed else ""
                command = subprocess.Popen(["sh", "-c", f'exec "$0" check "$1"{without}', BIN / "rmlcell", fifo],
                                           stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
                self.addCleanup(command.kill)
                writer = eventually(lambda: writer_of(fifo))
                self.assertTrue(writer)
                self.assertEqual(null_devices(command.pid), held)
                os.write(writer, b"PA;!PZ-10,10;PU0,0;PD5,0;PU;")
                os.close(writer)
                command.communicate(timeout=60)
                self.assertEqual(command.returncode, code)


class Refusals(unittest.TestCase):
    """Wrong use: exit code 2, the code of the error and what was wrong, and nothing on standard output."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        for name, text in (("a.S", "DELAY 1.\n"), ("b.S", "DELAY 2.\n"), ("a.rml", "PU;"), ("a.SI", "DELAY 1.\n"),
                           ("empty.S", ""), ("empty.rml", ""), ("notes.txt", "DELAY 1.\n"), ("1.S", "DELAY 1.\n")):
            (self.folder / name).write_text(text)
        self.assertEqual(ask("compile", self.folder / "a.S").returncode, 0)
        (self.folder / "an.O").write_bytes((self.folder / "a.O").read_bytes())

    def run_here(self, line):
        """In `line` an @ stands for the folder."""
        return ask(*(word.replace("@", f"{self.folder}/") for word in line.split()))

    def refused(self, rows):
        for line, code, text in rows:
            with self.subTest(line):
                done = self.run_here(line)
                self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
                self.assertTrue(done.stderr.startswith(f"rmlcell: {code}: "), done.stderr)
                self.assertIn(text.replace("@", f"{self.folder}/"), done.stderr)

    def accepted(self, *lines):
        for line in lines:
            with self.subTest(line):
                done = self.run_here(line)
                self.assertEqual(done.returncode, 0, done.stderr)

    def test_check(self):
        self.refused([("check @empty.S", "CELL-E9017", "@empty.S"), ("check @empty.rml", "CELL-E9017", "@empty.rml"),
                      ("check --fix @empty.S", "CELL-E9017", "@empty.S"),
                      ("check --fix @a.rml", "CELL-E9026", "@a.rml: a stream of"),
                      ("check --fix @none.S", "CELL-E9022", "@none.S"), ("check @none.S", "CELL-E9022", "@none.S"),
                      ("check @none.rml", "CELL-E9022", "@none.rml"),
                      ("check @notes.txt", "CELL-E9018", "@notes.txt': give --family"),
                      ("check @a.S --family lathe", "CELL-E9008", "'lathe'; there are optimo rml1"),
                      ("check @a.S --machine @none.toml", "CELL-E9022", "@none.toml"),
                      ("check @a.S --inputs @none.txt", "CELL-E9022", "@none.txt")])

    def test_places_of_simulate(self):
        place = "write PROGRAM/STEP, such as 45/7, or off"
        self.refused([(f"simulate @a.S {option} {text}", "CELL-E9026", f"'{text}': {place}")
                      for option, text in (("--break", "on"), ("--simul", "0/1"), ("--simul", "100/1"), ("--break", "1/0"),
                                           ("--break", "0"), ("--simul", "-1/1"), ("--simul", "1/1000000001"),
                                           ("--break", "1/"), ("--break", "/1"))])
        self.refused([(f"simulate @a.S {option} 99/1", "CELL-E9026", "--simul, --break: there is no program 99")
                      for option in ("--simul", "--break")])
        self.accepted("simulate @a.S --break 1/1000000000", "simulate @a.S --main 99 --simul 99/1", "simulate @a.S --simul 1")

    def test_numbers_of_simulate(self):
        self.refused([(f"simulate @a.S --budget {text}", "CELL-E9026", f"'{part}': write steps=N,time=SECONDS")
                      for text, part in (("steps=0", "steps=0"), ("steps", "steps"), ("time=9,time=-1", "time=-1"),
                                         ("time=0", "time=0"), ("step=5", "step=5"), ("time=x", "time=x"))])
        self.refused([(f"simulate @a.S --override {text}", "CELL-E9026", f"--override: the value is {float(text):g}; allowed are above 0 to 145 %")
                      for text in ("0", "-1", "145.5")])
        self.refused([("simulate @a.S --mode fast", "CELL-E9026", "'fast': modes are cycle, remote, single, repeat"),
                      ("simulate @a.S --plot torque @p.svg", "CELL-E9026", "'torque': curves are speed, power, axes"),
                      ("simulate @a.S --plot axes,axes @p.svg", "CELL-E9026", "'axes' is there twice"),
                      ("simulate @a.S --samples 0.5 @s.csv", "CELL-E9026", "'0.5': samples a second")])
        self.accepted("simulate @a.S --override 145", "simulate @a.S --budget steps=5,time=60", "simulate @a.S --mode single")
        self.assertEqual(self.run_here("simulate @a.S --budget time=0.5").returncode, 1)

    def test_programs_of_simulate(self):
        self.refused([("simulate @a.S --executable x", "CELL-E9026", "'x': write 44=FILE"),
                      ("simulate @a.S --executable 44", "CELL-E9026", "--executable 44: there is no such program"),
                      ("simulate @a.S --executable 100", "OPT-E7101", "program number is 100"),
                      ("simulate @a.S --slot 44", "CELL-E9026", "'44': write 44=FILE"),
                      ("simulate @a.S --slot 44=", "CELL-E9026", "'44=': write 44=FILE"),
                      ("simulate @a.S --slot 0=@b.S", "OPT-E7101", "program number is 0"),
                      ("simulate @a.S --slot 100=@b.S", "OPT-E7101", "program number is 100"),
                      ("simulate @1.S --slot 1=@b.S", "CELL-E9026",
                       "program 1 comes from two files: @1.S and @b.S"),
                      ("simulate --slot 1=@a.S --slot 2=@b.S", "CELL-E9026", "several programs: say which one is started"),
                      ("simulate", "CELL-E9026", "no program: give a file, or a folder"),
                      ("simulate @empty.S", "CELL-E9017", "@empty.S"),
                      ("simulate @notes.txt", "CELL-E9018", "@notes.txt': give --family"),
                      ("simulate @a.S --state-in @none", "CELL-E9022", "@none")])
        self.accepted("simulate --slot 1=@a.S --slot 99=@b.S --main 99", "simulate --slot 44=@a.S")

    def test_what_does_not_go_to_a_server(self):
        (self.folder / "large.rml").write_bytes(b" " * ((3 << 20) + 1))
        (self.folder / "project.json").write_text('{"title": ')
        self.refused([("submit mill-1 @large.rml", "CELL-E9007", "@large.rml has 3145729 bytes, a job takes 3145728 with it"),
                      ("submit mill-1 @none.rml", "CELL-E9022", "@none.rml"),
                      ("projects create door @project.json", "CELL-E9024", "@project.json: "),
                      ("projects create door @none.json", "CELL-E9022", "@none.json")])

    def test_files_that_cannot_be_written(self):
        options = ("--svg {}", "--plot speed {}", "--samples 100 {}", "--state-out {}")
        self.refused([(f"simulate @a.S {option.format('/dev/full')}", "CELL-E9023", "/dev/full: ") for option in options])
        self.refused([(f"simulate @a.S {option.format('@no/x')}", "CELL-E9023", "@no/x: ") for option in options])
        self.refused([(f"simulate @a.rml --stock 9x9x9 --tool flat:2 --stl {to}", "CELL-E9023", f"{to}: cannot be written")
                      for to in ("/dev/full", "@no/x")])
        self.refused([("compile @a.S -o @no/x.O", "CELL-E9023", "@no/x.O: "), ("compile @a.S -o /dev/full", "CELL-E9023", ""),
                      ("decompile @a.O -o @no/x.S", "CELL-E9023", "@no/x.S: "),
                      ("convert @a.S @no/x.SI", "OPT-E7706", "@no/x.SI: ")])

    def test_tools(self):
        self.refused([("compile @empty.S", "CELL-E9017", "@empty.S"), ("compile @none.S", "CELL-E9022", "@none.S"),
                      ("compile @a.S --json -o -", "CELL-E9026", "--json says what was written"),
                      ("compile @a.S --map -o -", "CELL-E9026", "--map: the object goes into no file"),
                      ("link @1.S --json -o -", "CELL-E9026", "--json says what was written"),
                      ("decompile @none.O", "CELL-E9022", "@none.O"), ("list @none.S", "CELL-E9022", "@none.S"),
                      ("format @an.O", "CELL-E9024", "@an.O is an object; rmlcell decompile gives its source"),
                      ("format @none.S", "CELL-E9022", "@none.S"),
                      ("convert @an.O /i", "CELL-E9024", "@an.O is an object; rmlcell decompile gives its source"),
                      ("convert @none.S", "OPT-E7703", "@none.S"), ("convert @a.S /i /m", "OPT-E7701", "/i and /m"),
                      ("convert @notes.txt", "OPT-E7704", "@notes.txt is neither .S nor .SI"),
                      ("compensate @none.S", "CELL-E9022", "@none.S"),
                      ("transform @none.S --move 1,0,0", "CELL-E9022", "@none.S"),
                      ("transform @a.S", "CELL-E9026", "nothing to do: give --move, --turn or --shift"),
                      ("transform @a.S --shift 1,0,0,0,0,0 --move 1,0,0", "CELL-E9026", "give one or the other"),
                      ("transform @a.S --shift 1,0,0,0,0,0 --turn 1,0,0", "CELL-E9026", "give one or the other"),
                      ("transform @a.SI --move 1,0,0", "OPT-E7030", "@a.SI")])
        for name in ("move", "turn"):
            self.refused([(f"transform @a.S --{name} {values}", f"--{name}", f"'{values}' is no list of numbers")
                          for values in ("inf,0,0", "0,0,nan")])

    # Up to both ends of each range; where no server answers the exit code is 3.
    def test_ranges(self):
        for line, good, wrong in (("submit m --slot {}", (1, 99), (0, 100)),
                                  ("submit m --slot 1 --priority {}", (-100, 100), (-101, 101)),
                                  ("submit m --slot 1 --pace {}", (0, 1000), (-0.5, 1000.5)),
                                  ("move 17 --priority {}", (-100, 100), (-101, 101)),
                                  ("jobs --limit {}", (1, 1000), (0, 1001)),
                                  ("simulate @a.S --main {}", (), (0, 100))):
            for number in good:
                with self.subTest(line, number=number):
                    done = self.run_here(line.format(number) + " --server 127.0.0.1:1")
                    self.assertEqual(done.returncode, 3, done.stderr)
            for number in wrong:
                with self.subTest(line, number=number):
                    done = self.run_here(line.format(number))
                    self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
                    self.assertIn(f"Value {number} not in range", done.stderr)

    def test_options_that_need_or_exclude_others(self):
        for line, text in (("submit m", "give a FILE or --slot"), ("submit m --slot 1 --strict", "--strict requires --watch"),
                           ("submit m --slot 1 --occurrence 2", "--occurrence requires --step"),
                           ("submit m --slot 1 --off-until-work-on", "--off-until-work-on requires --step"),
                           ("submit m --slot 1 --kind test", "'test' is none of simulate, check, run"),
                           ("jobs --order sideways", "'sideways' is none of newest, oldest, queue"),
                           ("get m 1 --form text", "'text' is none of source, object, executable, listing"),
                           ("simulate @a.S --facts --json", "excludes"), ("check @a.S --dry-run", "--dry-run requires --fix")):
            with self.subTest(line):
                done = self.run_here(line)
                self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
                self.assertIn(text, done.stderr)
        # Each takes one word: what follows is the file.
        self.accepted("simulate --slot 44=@b.S @a.S", "simulate --executable 1 @a.S", "simulate --samples 10 @s.csv @a.S",
                      "simulate --plot speed @t.svg @a.S")


class Sockets(unittest.TestCase):
    def test_a_socket_in_use_is_refused_and_one_left_behind_is_taken(self):
        with tempfile.TemporaryDirectory() as folder:
            socket = pathlib.Path(folder) / "cell.sock"

            def server(state):
                return subprocess.Popen([BIN / "rmlcelld", "--state.directory", pathlib.Path(folder) / state,
                                         "--listen.grpc", f"unix:{socket}", "--listen.web", "", "--workers.count", "0"],
                                        stderr=subprocess.PIPE, text=True)

            def answers():
                return ask("machines", server=f"unix:{socket}").returncode == 0

            first = server("one")
            self.addCleanup(first.communicate)
            self.addCleanup(first.kill)
            self.assertTrue(eventually(answers))
            second = server("two")
            self.assertIn("CELL-E9202", second.communicate(timeout=60)[1])
            self.assertEqual(second.returncode, 69)
            self.assertTrue(answers())
            first.kill()
            first.wait()
            self.assertTrue(socket.exists())
            third = server("two")
            self.addCleanup(third.communicate)
            self.addCleanup(third.kill)
            self.assertTrue(eventually(answers))

    def test_another_file_is_not_taken_for_a_socket(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "notes"
            file.write_text("mine")
            for address in (file, f"{folder}/a%20b", f"//{str(file)[1:]}", f"{folder}/{100 * 'x'}/{100 * 'y'}"):
                done = subprocess.run([BIN / "rmlcelld", "--state.directory", pathlib.Path(folder) / "state",
                                       "--listen.grpc", f"unix:{address}", "--listen.web", "", "--workers.count", "0"],
                                      stderr=subprocess.PIPE, text=True, timeout=60)
                self.assertEqual(done.returncode, 69, address)
                self.assertIn("CELL-E9202", done.stderr)
            self.assertEqual(file.read_text(), "mine")
            self.assertEqual(sorted(entry.name for entry in pathlib.Path(folder).iterdir()), ["notes", "state"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
