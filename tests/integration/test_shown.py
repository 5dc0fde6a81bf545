"""What people are shown: the profile everywhere, what is lost, findings gathered, mistakes with what was meant."""
import json
import os
import re
import unittest

from cell import SHARED, WithCell
from command import InFolder, ask

# 20 strokes from inside to 30 mm beyond the 203.2 mm of the SRM-20, 1 mm deep; 600 mm are lost. (RML1-5A.30)
STROKES = "\n".join(["^DF;!MC1;V10;F10;!PZ-100,200;"] +
                    [f"PU18000,{y};PD23320,{y};PU;" for y in range(0, 4000, 200)] + ["!MC0;"]) + "\n"
GOOD = "^DF;!MC1;V5;F10;!PZ-100,200;PU0,0;PD1000,0;PU0,0;!MC0;"
# One on each line from the second on, to and fro at 30 mm beyond the travel.
MANY = "^DF;!MC1;V10;F10;!PZ-100,200;PU0,0;\n" + "PD23320,0;\nPD23320,10;\n" * 1500 + "PU0,0;!MC0;\n"
MINE = "family = 'rml1'\nprofile = 'srm-20'\n[parameters]\nX_MAX = 100\n"


def facts(text):
    return dict(line.split(": ", 1) for line in text.splitlines())


class Local(InFolder):
    def test_the_profile_stands_in_text_json_facts_and_picture(self):
        part = self.file("part.rml", GOOD)
        for verb in ("check", "simulate"):
            self.assertIn("Roland monoFab SRM-20 (srm-20): no profile was named", ask(verb, part).stdout)
            found = json.loads(ask(verb, part, "--json").stdout)
            self.assertEqual((found["family"], found["profile"], found["profileNamed"]), ("rml1", "srm-20", False))
            named = json.loads(ask(verb, part, "--json", "--profile", "MDX15").stdout)
            self.assertEqual((named["profile"], named["profileNamed"]), ("mdx-15", True))
            laser = json.loads(ask(verb, self.file("1.S", "SPEED 5\n"), "--json").stdout)
            self.assertEqual((laser["family"], laser["profile"]), ("optimo", "standard"))
        told = facts(ask("simulate", part, "--facts").stdout)
        self.assertEqual([told[key] for key in ("profile", "profile_named", "profile_changes", "profile_changed_by")],
                         ["srm-20", "no", "none", "none"])
        self.assertIn(">Roland monoFab SRM-20 (srm-20): no profile was named<", ask("simulate", part, "--svg", "-").stdout)
        # A program that cannot run has run on no other machine.
        bad = self.file("2.S", "SPEED 101\n")
        self.assertEqual(facts(ask("simulate", bad, "--facts").stdout)["profile"], "standard")
        self.assertEqual(json.loads(ask("simulate", bad, "--json").stdout)["profile"], "standard")

    def test_a_machine_of_ones_own_has_its_name_and_sources(self):
        part = self.file("part.rml", GOOD)
        own = self.file("own.toml", 'name = "My mill"\nprofile = "srm-20"\n[parameters]\nX_MAX = 100\n'
                                    '[sources]\nX_MAX = "measured"\n')
        title = "My mill, based on Roland monoFab SRM-20 (srm-20)"
        for verb in ("check", "simulate"):
            told = ask(verb, part, "--machine", own).stdout
            self.assertRegex(told, rf"(?m)^machine +{re.escape(title)}$")
            self.assertIn("X_MAX 100 (profile: 203.2; source: measured)", told)
            found = json.loads(ask(verb, part, "--machine", own, "--json").stdout)
            self.assertEqual((found["machineName"], found["profileChanges"][0]["source"]), ("My mill", "measured"))
        self.assertEqual(facts(ask("simulate", part, "--machine", own, "--facts").stdout)["machine_name"], "My mill")
        self.assertIn(f">{title}<", ask("simulate", part, "--machine", own, "--svg", "-").stdout)
        bare = self.file("bare.toml", "[parameters]\nX_MAX = 100\n")
        told = ask("check", part, "--machine", bare).stdout
        self.assertIn(f"{bare}, based on Roland monoFab SRM-20 (srm-20): the default, as it names no profile", told)
        self.assertNotIn("no profile was named", told)

    def test_a_machine_file_and_what_it_changed_are_named(self):
        part, mine = self.file("part.rml", GOOD), self.file("mine.toml", MINE)
        said = f"X_MAX 100 (profile: 203.2); by {mine}"
        for verb in ("check", "simulate"):
            self.assertRegex(ask(verb, part, "--machine", mine).stdout, rf"(?m)^changed +{re.escape(said)}$")
            found = json.loads(ask(verb, part, "--machine", mine, "--json").stdout)
            self.assertEqual(found["profileChanges"], [{"name": "X_MAX", "value": "100", "ofProfile": "203.2", "source": ""}])
            self.assertEqual(found["profileChangedBy"], str(mine))
            both = ask(verb, part, "--machine", mine, "--origin", "3,4").stdout
            self.assertIn(f"by {mine} and --origin", both)
        told = facts(ask("simulate", part, "--machine", mine, "--facts").stdout)
        self.assertEqual((told["profile_changes"], told["profile_changed_by"]), ("X_MAX=100", str(mine)))
        picture = ask("simulate", part, "--machine", mine, "--svg", "-").stdout
        self.assertIn(">changed: X_MAX 100 (profile: 203.2); by ", picture)

    def test_a_comparison_names_its_machine(self):
        a, b, mine = self.file("a.rml", GOOD), self.file("b.rml", GOOD.replace("PD1000", "PD1500")), self.file("mine.toml", MINE)
        self.assertIn("machine       Roland monoFab SRM-20 (srm-20): no profile was named\ncut_length  13 -> 18 mm",
                      ask("diff", a, b).stdout)
        self.assertIn("SRM-20 (srm-20): no profile was named<", ask("diff", a, b, "--svg", "-").stdout)
        found = json.loads(ask("diff", a, b, "--machine", mine, "--json").stdout)
        self.assertEqual((found["family"], found["profile"], found["profileNamed"], found["profileChangedBy"]),
                         ("rml1", "srm-20", True, str(mine)))
        self.assertEqual(ask("diff", a, a).stdout, "they do the same\n")

    # The names of a check's JSON are those of a simulation's, and what both know is the same.
    def test_the_json_of_check_and_simulate_agree(self):
        if not (SHARED / "corpus").exists():
            self.skipTest("the shared corpora are not here")
        names = ["01-fts_mini_cut.rml", "06-ROUGH_LEFT.prn", "07-ROUGH_LEFT_EXTRA1.prn", "15-output_bis2.rml"]
        for name in names:
            part = SHARED / "corpus" / "rml1" / name
            check = json.loads(ask("check", part, "--json").stdout)
            run = json.loads(ask("simulate", part, "--json").stdout)
            self.assertEqual(check["verdict"], run["outcome"]["verdict"], name)
            why = [[(reason["code"], reason["verdict"], reason["message"], reason.get("first", {}).get("step"))
                    for reason in reasons] for reasons in (check["reasons"], run["outcome"]["reasons"])]
            self.assertEqual(why[0], why[1], name)
            for field in ("family", "profile", "profileNamed", "profileChanges", "profileChangedBy"):
                self.assertEqual(check[field], run[field], (name, field))
            ran = {figure["name"]: figure["value"] for figure in run["figures"]}
            both = [figure for figure in check["figures"] if figure["name"] in ran]
            self.assertGreater(len(both), 20, name)
            for figure in both:
                self.assertAlmostEqual(figure["value"], ran[figure["name"]], 6, (name, figure["name"]))
            self.assertEqual({d["code"] for d in check["diagnostics"]} - {d["code"] for d in run["diagnostics"]}, set())

    def test_what_is_lost_is_drawn_with_its_length(self):
        part = self.file("far.rml", STROKES)
        picture = ask("simulate", part, "--svg", "-").stdout
        self.assertIn('<g class="lost"', picture)
        self.assertIn(">beyond the travel, not cut<", picture)
        lost = next(f["value"] for f in json.loads(ask("check", part, "--json").stdout)["figures"]
                    if f["name"] == "clipped_cut_length")
        self.assertAlmostEqual(lost, 20 * (233.2 - 203.2), 6)
        self.assertIn(f">{lost:.1f} mm lost<", picture)
        self.assertNotIn("lost", ask("simulate", self.file("good.rml", GOOD), "--svg", "-").stdout)

    def test_findings_that_make_a_verdict_bad_say_so(self):
        part = self.file("far.rml", STROKES)
        for verb in ("check", "simulate"):
            lines = [line for line in ask(verb, part).stdout.splitlines() if " RML1-E8002: " in line]
            self.assertGreater(len(lines), 0, verb)
            for line in lines:
                self.assertIn("BAD RML1-E8002: ", line, verb)
            judged = {d["code"]: d["verdict"] for d in json.loads(ask(verb, part, "--json").stdout)["diagnostics"]}
            self.assertEqual(judged["RML1-E8002"], "VERDICT_BAD")

    def test_each_file_is_checked_whatever_is_wrong_with_another(self):
        good, bad = self.file("good.rml", GOOD), self.file("bad.S", "SPEED 101\n")
        missing, empty = self.folder / "missing.rml", self.file("empty.rml", "")
        done = ask("check", good, missing, bad, empty, "--strict")
        self.assertEqual(done.returncode, 1)
        self.assertIn("good.rml: GOOD", done.stdout)
        self.assertIn("bad.S: BAD", done.stdout)
        self.assertIn("missing.rml", done.stderr)
        self.assertIn("empty.rml", done.stderr)
        lines = [json.loads(line) for line in ask("check", good, missing, bad, "--json").stdout.splitlines()]
        self.assertEqual([(line["file"].rsplit("/", 1)[-1], line["ok"]) for line in lines],
                         [("good.rml", True), ("missing.rml", False), ("bad.S", False)])
        self.assertEqual(lines[1]["diagnostics"][0]["code"], "CELL-E9022")
        # Alone it is a wrong use, as before.
        self.assertEqual(ask("check", missing).returncode, 2)

    def test_format_goes_on_behind_a_file_that_is_not_there(self):
        loose = self.file("a.S", "  SPEED   5\n")
        done = ask("format", self.folder / "missing.S", loose)
        self.assertEqual(done.returncode, 1)
        self.assertIn("missing.S", done.stderr)
        self.assertIn("a.S: formatted", done.stdout)
        self.assertEqual(ask("format", self.folder / "missing.S").returncode, 2)

    def test_mistakes_are_answered_with_what_was_meant(self):
        for line, said in ((["simulat", "a.rml"], "there is no verb 'simulat'; did you mean simulate?"),
                           (["simulate", "a.rml", "--stok", "1x1x1"], "simulate has no option --stok; did you mean --stock?"),
                           (["rml1", "explian", "a.rml"], "rml1 has no verb 'explian'; did you mean explain?"),
                           (["check", self.file("a.rml", GOOD), "--profile", "smr-20"],
                            "no profile 'smr-20'; did you mean srm-20?")):
            done = ask(*line)
            self.assertEqual(done.returncode, 2, line)
            self.assertIn(said, done.stderr, line)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)

    # Every verb says what it wants, each in lines that a terminal shows.
    def test_every_verb_has_help_that_a_terminal_shows(self):
        verbs = re.findall(r"(?m)^  ([a-z0-9]+) +[A-Z]", ask("--help").stdout)
        self.assertGreater(len(verbs), 25)
        for verb in verbs:
            done = ask(verb, "--help")
            self.assertEqual(done.returncode, 0, verb)
            self.assertIn("Example", done.stdout, verb)


    # 3,000 ways beyond the travel: five are told, and the others once, to the last one.
    def test_findings_beyond_a_thousand_are_counted_by_kind(self):
        part = self.file("many.rml", MANY)
        for verb in ("check", "simulate"):
            told = [line for line in ask(verb, part).stdout.splitlines()
                    if "RML1-E8002" in line and line[:1] != " " and not line.startswith("verdict")]
            self.assertEqual(told[-1], "and 2995 more RML1-E8002, lines 7 to 3001", verb)
            self.assertEqual(len(told), 6, told)
            found = json.loads(ask(verb, part, "--json").stdout)
            self.assertEqual(len(found["diagnostics"]) + int(found["diagnosticsDropped"]), 3000)
            [rest] = found["gathered"]
            self.assertEqual((rest["code"], rest["count"], rest["first"]["line"], rest["last"]["line"], rest["verdict"]),
                             ("RML1-E8002", "2000", 1002, 3001, "VERDICT_BAD"))
        self.assertIn(">3000</text>", ask("simulate", part, "--svg", "-").stdout)
        explained = ask("rml1", "explain", part).stdout
        self.assertEqual(explained.count("BAD RML1-E8002"), 3000)
        self.assertNotIn("advice RML1", explained)

    def test_a_directory_is_called_one(self):
        done = ask("check", self.folder)
        self.assertEqual(done.returncode, 2)
        self.assertIn("is a directory", done.stderr)
        self.assertIn("is a directory", ask("check", self.folder, "--family", "rml1").stderr)

    def test_gcode_given_as_a_stream_is_told_in_a_few_lines(self):
        part = self.file("gcode.rml", "G21 G90\nG0 Z5\nG0 X10 Y10\nM3 S5000\nG1 Z-1 F100\nG1 X20 F200\nG0 Z5\nM5\n")
        lines = [line for line in ask("check", part).stdout.splitlines() if re.match(r".*gcode.rml:.* RML1-E", line)]
        codes = [re.search(r"RML1-E\d+", line).group() for line in lines]
        self.assertEqual(len(codes), len(set(codes)), lines)


class Stored(WithCell, InFolder):
    def test_bytes_that_are_no_program_are_refused_in_a_line_or_two(self):
        noise = os.urandom(60_000)
        for size in (22, 200, 60_000):
            path = self.folder / f"noise{size}.rml"
            path.write_bytes(bytes(127 + byte % 128 for byte in noise[:size]))
            done = self.cell.command("put", "mill-1", 80, path, check=False)
            self.assertEqual(done.returncode, 1, size)
            self.assertLessEqual(done.stderr.count("\n"), 2, done.stderr)
            self.assertRegex(done.stderr, rf"noise{size}.rml: error RML1-E8007: 1?[0-9]+\.[0-9] % of the bytes .*; store ")
            self.assertEqual(ask("check", path).returncode, 1)
        gcode = self.file("part.prn", "G21\nG90\nG0 X0 Y0 Z5\nG1 Z-1 F100\nG1 X10 Y0\nG1 X10 Y10\nM5\nM30\n")
        done = self.cell.command("put", "mill-1", 80, gcode, check=False)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn("rmlcell rml1 from-gcode", done.stderr)
        self.assertEqual(self.cell.command("put", "mill-1", 80, gcode, "--force").returncode, 0)

    def test_no_real_program_is_taken_for_something_else(self):
        if not (SHARED / "corpus").exists():
            self.skipTest("the shared corpora are not here")
        for path in sorted((SHARED / "corpus" / "rml1").glob("*.[rp]*")):
            done = self.cell.command("put", "mill-1", 81, path, "--check-only", check=False)
            self.assertEqual(done.returncode, 0, f"{path.name}: {done.stderr}")

    def test_a_job_gathers_findings_of_one_kind(self):
        # 20 ways that are lost: as in its report five of them singly, then the other 15 once.
        job = self.cell.command("submit", "mill-1", self.file("far.rml", STROKES), "--watch", check=False)
        self.assertEqual(job.returncode, 1)
        lines = [line for line in job.stdout.splitlines() if "RML1-E8002" in line and " ended: " not in line]
        self.assertEqual(len(lines), 6, job.stdout)
        self.assertIn("and 15 more RML1-E8002, lines 7 to 21: ", lines[-1])
        self.assertNotIn("advice", job.stdout)  # of what makes it BAD
        number = re.search(r"jobs/(\d+)|job (\d+)", job.stdout + job.stderr).group(0).split("/")[-1].split(" ")[-1]
        events = [json.loads(line) for line in self.cell.command("watch", number, "--json", check=False).stdout.splitlines()]
        gathered = [e["event"]["gathered"] for e in events if e.get("event", {}).get("gathered")]
        self.assertEqual([(g["code"], g["count"], g["first"]["line"], g["last"]["line"]) for g in gathered],
                         [("RML1-E8002", "15", 7, 21)])
        report = self.cell.command("report", number, "--json").stdout
        # Each place once, though it is found in the text and again when it runs.
        self.assertEqual([d["place"]["line"] for d in json.loads(report)["diagnostics"]], list(range(2, 22)))
        self.assertEqual((json.loads(report)["profile"], json.loads(report)["profileNamed"]), ("srm-20", True))
        self.assertIn("BAD RML1-E8002", self.cell.command("report", number).stdout)

    def test_put_and_jobs_count_beyond_a_thousand_and_judge(self):
        part = self.file("many.rml", MANY)
        done = self.cell.command("put", "mill-1", 82, part)
        self.assertIn("\nand 2995 more RML1-E8002, lines 7 to 3001\n", done.stdout)
        self.assertIn("\nverdict: BAD\n  ", done.stdout)
        self.assertIn("machines/mill-1/programs/82 stored: many, object ", done.stdout)
        self.assertLess(done.stdout.count("\n"), 12)
        self.assertNotIn("advice RML1", done.stdout)
        for kind in ([], ["--kind", "check"]):
            job = self.cell.command("submit", "mill-1", part, *kind, "--watch", check=False)
            self.assertIn("and 2995 more RML1-E8002, lines 7 to 3001: ", job.stdout, kind)
            number = re.search(r"jobs/(\d+)", job.stdout + job.stderr).group(1)
            self.assertIn("\nand 2995 more RML1-E8002, lines 7 to 3001\n", self.cell.command("report", number).stdout)
        forced = self.folder / "noise.rml"
        forced.write_bytes(bytes(127 + byte % 128 for byte in os.urandom(200_000)))
        done = self.cell.command("put", "mill-1", 83, forced, "--force")
        self.assertLess(done.stdout.count("\n"), 40)
        self.assertIn("\nverdict: BAD\n", done.stdout)

    def test_a_check_job_tells_its_machine(self):
        job = self.cell.command("submit", "mill-1", self.file("far.rml", STROKES), "--kind", "check", "--watch", check=False)
        number = re.search(r"jobs/(\d+)", job.stdout + job.stderr).group(1)
        text = self.cell.command("report", number).stdout
        self.assertRegex(text, r"machine +Roland monoFab SRM-20 \(srm-20\)")
        self.assertIn("BAD RML1-E8002", text)


if __name__ == "__main__":
    unittest.main(verbosity=2)
