"""The bash completion and the manual pages have every verb and option that `--help` has.

The completion is run by bash as readline would call it. RMLCELL_BIN: the folder of the binaries.
"""
import functools
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import time
import unittest

BIN = pathlib.Path(os.environ["RMLCELL_BIN"])
ROOT = pathlib.Path(__file__).resolve().parents[2]
COMPLETION = ROOT / "deploy" / "completion" / "rmlcell.bash"
MAN = ROOT / "deploy" / "man"
NOWHERE = "127.0.0.1:1"


def run(*words, **environment):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=60,
                          env={"PATH": f"{BIN}:/usr/bin:/bin", "RMLCELL_SERVER": NOWHERE, **environment})


@functools.cache
def help_text(program, *verb):
    done = run(BIN / program, *verb, "--help")
    assert done.returncode == 0, done.stderr
    return done.stdout


def section(text, name):
    """The entries below "NAME:" up to the next line that is not indented."""
    match = re.search(rf"^{name}:\n((?:  .*\n|\n)*)", text + "\n", re.MULTILINE)
    return match.group(1) if match else ""


def verbs(*verb):
    return re.findall(r"^  ([a-z]\S*)", section(help_text("rmlcell", *verb), "Subcommands"), re.MULTILINE)


def all_verbs():
    found = []
    for verb in verbs():
        found.append((verb,))
        found += [(verb, inner) for inner in verbs(verb)]
    return found


def options(program, *verb):
    """Names of all options, long and short: {"--output", "-o"}."""
    text = help_text(program, *verb)
    heads = re.findall(r"^  (-\S+)", section(text, "Options") + section(text, "Configuration"), re.MULTILINE)
    return {name for head in heads for name in head.split(",")}


def values(*verb):
    """{"--kind": [...]} for each option whose values stand in the help."""
    return {match[0].split(",")[-1]: match[1].split(",") for match in
            re.findall(r"^  (-\S+) \S+:\{([^}]*)\}", section(help_text("rmlcell", *verb), "Options"), re.MULTILINE)}


def complete(line, folder=None, server=NOWHERE):
    """What bash offers when Tab is hit at the end of the line."""
    words = [part for word in re.split(r"\s+", line) for part in (re.findall(r"[=:]+|[^=:]+", word) or [""])]
    quoted = " ".join("'" + word + "'" for word in words)
    script = (f"source '{COMPLETION}'; COMP_WORDS=({quoted}); COMP_CWORD={len(words) - 1}; _rmlcell; "
              'printf "%s\\n" "${COMPREPLY[@]}"')
    done = subprocess.run(["bash", "--norc", "-c", script], capture_output=True, text=True, timeout=60, cwd=folder,
                          env={"PATH": f"{BIN}:/usr/bin:/bin", "RMLCELL_SERVER": server})
    assert done.stderr == "", done.stderr
    return sorted(word for word in done.stdout.split("\n") if word)


class Completion(unittest.TestCase):
    def test_help_was_understood(self):
        self.assertIn(("projects", "transfer"), all_verbs())
        self.assertLessEqual({"--form", "-o", "--output", "--server"}, options("rmlcell", "get"))
        self.assertEqual(values("get")["--form"], ["source", "object", "executable", "listing"])

    def test_every_verb_is_offered_and_nothing_else(self):
        self.assertEqual(complete("rmlcell "), sorted(verbs()))
        self.assertEqual(complete("rmlcell projects "), sorted(verbs("projects")))
        self.assertEqual(complete("rmlcell sub"), ["submit"])

    def test_every_long_option_is_offered_and_nothing_else(self):
        for verb in [(), *all_verbs()]:
            wanted = sorted(name for name in options("rmlcell", *verb) if name.startswith("--"))
            self.assertEqual(complete(" ".join(["rmlcell", *verb, "--"])), wanted, verb)

    def test_an_option_that_takes_a_value_is_not_followed_by_a_positional(self):
        for verb in all_verbs():
            for head in re.findall(r"^  (-\S+) [A-Z]", section(help_text("rmlcell", *verb), "Options"), re.MULTILINE):
                for name in head.split(","):
                    words = " ".join(["rmlcell", *verb, name, ""])
                    self.assertNotIn("show", complete(words), words)
                    self.assertFalse([word for word in complete(words) if word.startswith("--")], words)

    def test_values_of_options_are_those_of_the_help(self):
        checked = 0
        for verb in all_verbs():
            for name, words in values(*verb).items():
                self.assertEqual(complete(" ".join(["rmlcell", *verb, name, ""])), sorted(words))
                self.assertEqual(complete(" ".join(["rmlcell", *verb, name + "="])), sorted(words))
                checked += 1
        self.assertGreaterEqual(checked, 2)

    def test_families_modes_and_profiles_are_those_that_the_command_takes(self):
        with tempfile.TemporaryDirectory() as folder:
            optimo = pathlib.Path(folder) / "a.S"
            optimo.write_text("SPEED 20\n")
            mill = pathlib.Path(folder) / "a.rml"
            mill.write_text("PA;")
            for family in complete("rmlcell check --family "):
                self.assertIn(run(BIN / "rmlcell", "check", "--family", family, optimo).returncode, (0, 1))
            for mode in complete("rmlcell simulate --mode "):
                done = run(BIN / "rmlcell", "simulate", optimo, "--mode", mode, "--budget", "steps=50")
                self.assertIn(done.returncode, (0, 1), mode)  # REPEAT ends at its budget
            known = []
            for program in (optimo, mill):
                refused = run(BIN / "rmlcell", "simulate", program, "--profile", "none-of-them").stderr
                known += re.search(r"there are (.*)", refused).group(1).split()
            self.assertEqual(complete("rmlcell simulate --profile "), sorted(known))

    def test_files_are_offered_by_their_extension(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("a.S", "b.rml", "c.PRN", "d.O", "e.si", "f.cmp", "m.toml", "p.svg", "j.json", "x.txt"):
                (pathlib.Path(folder) / name).write_text("")
            (pathlib.Path(folder) / "progs").mkdir()
            programs = ["a.S", "b.rml", "c.PRN", "d.O", "e.si", "f.cmp", "progs"]
            self.assertEqual(complete("rmlcell simulate ", folder), programs)
            self.assertEqual(complete("rmlcell check a.S ", folder), programs)
            self.assertEqual(complete("rmlcell check --json ", folder), programs)
            self.assertEqual(complete("rmlcell put mill-1 7 ", folder), programs)
            self.assertEqual(complete("rmlcell submit mill-1 ", folder), programs)
            self.assertEqual(complete("rmlcell simulate a.S --slot 44=", folder), programs)
            self.assertEqual(complete("rmlcell simulate a.S --slot 44=b", folder), ["b.rml"])
            self.assertEqual(complete("rmlcell simulate --machine ", folder), ["m.toml", "progs"])
            self.assertEqual(complete("rmlcell simulate --machine=", folder), ["m.toml", "progs"])
            self.assertEqual(complete("rmlcell simulate --svg ", folder), ["p.svg", "progs"])
            self.assertEqual(complete("rmlcell simulate --plot speed ", folder), ["p.svg", "progs"])
            self.assertIn("a.S", complete("rmlcell simulate --plot speed p.svg ", folder))
            self.assertEqual(complete("rmlcell projects create bracket ", folder), ["j.json", "progs"])
            self.assertIn("x.txt", complete("rmlcell simulate --inputs ", folder))

    def test_codes_are_offered(self):
        self.assertEqual(complete("rmlcell explain OPT-E348"), ["OPT-E348"])
        self.assertEqual(complete("rmlcell explain HOLE_RADIUS_Z"), ["HOLE_RADIUS_ZERO"])
        self.assertGreater(len(complete("rmlcell explain CELL-E93")), 5)

    def test_without_a_server_nothing_is_offered_and_nothing_hangs(self):
        for line in ("rmlcell programs ", "rmlcell watch ", "rmlcell get mill-1 ", "rmlcell projects show "):
            self.assertEqual(complete(line), [])  # ends by itself

    def test_names_come_from_the_server_that_the_line_or_the_environment_names(self):
        folder = pathlib.Path(tempfile.mkdtemp(prefix="rmlcell-"))
        self.addCleanup(shutil.rmtree, folder, ignore_errors=True)
        log = folder / "log"
        log.write_text("")
        server = subprocess.Popen([BIN / "rmlcelld", "--state.directory", folder / "store", "--listen.grpc",
                                   "127.0.0.1:0", "--listen.web", "", "--workers.count", "1", "--log.file", log])
        self.addCleanup(server.wait)
        self.addCleanup(server.terminate)
        until = time.monotonic() + 60
        while "is ready" not in log.read_text():
            self.assertLess(time.monotonic(), until, log.read_text())
            time.sleep(0.02)
        address = re.search(r"gRPC on (\S+)", log.read_text()).group(1)
        program = folder / "a.rml"
        program.write_text("PA;PU100,100;")
        for words in (("put", "mill-1", 7, program), ("submit", "mill-1", program, "--watch")):
            done = run(BIN / "rmlcell", *words, RMLCELL_SERVER=address)
            self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(complete("rmlcell programs ", server=address), ["mill-1", "optimo-1"])
        self.assertEqual(complete(f"rmlcell programs --server {address} "), ["mill-1", "optimo-1"])
        self.assertEqual(complete(f"rmlcell programs --server={address} mi"), ["mill-1"])
        self.assertEqual(complete(f"rmlcell get --server {address} mill-1 "), ["7"])
        self.assertEqual(complete("rmlcell submit mill-1 --slot ", server=address), ["7"])
        self.assertEqual(complete("rmlcell watch ", server=address), ["1"])
        self.assertEqual(complete("rmlcell report ", server=address), ["1"])
        self.assertEqual(complete("rmlcell artifact 1 pi", server=address), ["picture.svg"])
        self.assertEqual(complete("rmlcell cancel ", server=address), [])


class Manual(unittest.TestCase):
    def page(self, name):
        """The page as plain text without the typewriter's backslashes."""
        return (MAN / name).read_text().replace("\\-", "-").replace("\\&", "")

    def test_every_verb_has_a_part_with_every_option_of_it(self):
        page = self.page("rmlcell.1")
        for verb in all_verbs():
            head = f".SS {' '.join(verb)}\n"
            self.assertIn(head, page)
            part = page[page.index(head) + len(head):]
            part = re.split(r"^\.S[SH] ", part, maxsplit=1, flags=re.MULTILINE)[0]
            server = "--server" in options("rmlcell", *verb)
            for name in options("rmlcell", *verb) - {"-h", "--help"}:
                if server and name in ("--server", "--json"):
                    continue  # once for all, below
                self.assertRegex(part, rf"(?<![-\w]){re.escape(name)}(?![-\w])", f"{verb} {name}")
        for name in ("--server", "--json", "--help", "--version"):
            self.assertIn(name, page)

    def test_the_manual_has_no_option_that_the_command_lacks(self):
        known = {name for verb in [(), *all_verbs()] for name in options("rmlcell", *verb)}
        for name in re.findall(r"(?<![-\w])--[a-z][-a-z]*", self.page("rmlcell.1")):
            self.assertIn(name, known)

    def test_the_pages_of_server_and_worker_have_every_option(self):
        for page, program in (("rmlcelld.8", "rmlcelld"), ("rmlcell-worker.8", "rmlcell-worker")):
            text = self.page(page)
            for name in options(program) - {"-h"}:
                # Keys of the configuration stand without their dashes.
                self.assertIn(name if "." not in name else name.removeprefix("--"), text, page)

    def test_the_pages_are_set_without_a_warning(self):
        tool = next((words for words in (["man", "--warnings", "-l"], ["groff", "-man", "-ww", "-Tutf8", "-z"],
                                         ["mandoc", "-Tlint", "-Wwarning"]) if shutil.which(words[0])), None)
        if tool is None:
            self.skipTest("none of man, groff, mandoc is here")
        for page in ("rmlcell.1", "rmlcelld.8", "rmlcell-worker.8"):
            done = subprocess.run([*tool, MAN / page], capture_output=True, text=True, timeout=60,
                                  env={"PATH": os.environ["PATH"], "MANWIDTH": "80", "LC_ALL": "C.UTF-8"})
            self.assertEqual((done.returncode, done.stderr), (0, ""), page)


if __name__ == "__main__":
    unittest.main(verbosity=2)
