"""docs/configuration.md and the server name the same keys, defaults and ranges.

The page is tried, not compared with a copy: every default must be what `rmlcelld --print-config` prints,
every bound must be taken and the next value beyond it refused. RMLCELL_BIN: the folder of the binaries.
"""
import os
import pathlib
import re
import subprocess
import tempfile
import tomllib
import unittest

BIN = pathlib.Path(os.environ["RMLCELL_BIN"])
PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "configuration.md"
CLEAN = {"HOME": "/home/nobody", "PATH": "/usr/bin:/bin"}


def configure(*flags, **environment):
    return subprocess.run([BIN / "rmlcelld", "--print-config", *flags], capture_output=True, text=True,
                          timeout=60, env={**CLEAN, **environment})


def printed(*flags, **environment):
    done = configure(*flags, **environment)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return tomllib.loads(done.stdout)


def cells(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def rows(header):
    """Rows of every table of the page whose header begins so."""
    found, inside = [], False
    for line in PAGE.read_text().splitlines():
        if line.startswith(header):
            inside = True
        elif not line.startswith("|"):
            inside = False
        elif inside and not line.startswith("| ---"):
            found.append(cells(line))
    return found


def code(cell):
    match = re.fullmatch(r"`(.*)`", cell)
    assert match, f"{cell} is not in backquotes"
    return match.group(1)


KEYS = {code(row[0]): {"environment": code(row[1]), "default": code(row[2]), "allowed": row[3]}
        for row in rows("| key | environment |")}

# Keys that take one of some words.
WORDS = ("log.level", "log.format", "machines.hosts")


class Page(unittest.TestCase):
    def test_every_key_of_the_server_stands_on_the_page_and_no_other(self):
        keys = {f"{section}.{key}" for section, table in printed().items() if section != "machine"
                for key in table}
        self.assertGreater(len(keys), 20)
        self.assertEqual(set(KEYS), keys)

    def test_every_default_is_the_one_that_the_server_has(self):
        config = printed()
        for name, row in KEYS.items():
            section, key = name.split(".")
            value = tomllib.loads("x = " + row["default"])["x"]
            if name == "state.directory":
                self.assertEqual(config[section][key], "/home/nobody/.local/state/rmlcell")
                self.assertEqual(value, "")
                continue
            self.assertEqual(config[section][key], value, name)
            self.assertIs(type(config[section][key]), type(value), name)

    def test_every_variable_of_the_environment_sets_its_key(self):
        for name, row in KEYS.items():
            section, key = name.split(".")
            value, expected = self.another_value(name, row)
            config = printed(**{row["environment"]: value})
            self.assertEqual(config[section][key], expected, name)

    def test_every_flag_goes_over_its_variable(self):
        for name, row in KEYS.items():
            section, key = name.split(".")
            value, expected = self.another_value(name, row)
            default = tomllib.loads("x = " + row["default"])["x"]
            over = ",".join(default) if isinstance(default, list) else str(default)
            config = printed(f"--{name}={value}", **{row["environment"]: over})
            self.assertEqual(config[section][key], expected, name)

    def test_every_bound_is_taken_and_what_lies_beyond_refused(self):
        ranges = 0
        for name, row in KEYS.items():
            match = re.fullmatch(r"(-?[\d.]+) to ([\d.]+)", row["allowed"])
            if not match:
                continue
            ranges += 1
            low, high = match.groups()
            whole = "." not in row["default"]
            for bound in (low, high):
                self.assertEqual(configure(f"--{name}={bound}").returncode, 0, f"{name} {bound}")
            below = str(int(low) - 1) if whole else str(float(low) - 1e-4)
            above = str(int(high) + 1) if whole else str(float(high) + 1e-3)
            for beyond in (below, above, "many"):
                done = configure(f"--{name}={beyond}")
                self.assertEqual(done.returncode, 78, f"{name} {beyond}")
                self.assertIn(name, done.stderr)
        self.assertGreaterEqual(ranges, 13)

    def test_every_word_is_taken_and_another_refused(self):
        for name in WORDS:
            for word in KEYS[name]["allowed"].split(", "):
                self.assertEqual(configure(f"--{name}", word).returncode, 0, word)
            self.assertEqual(configure(f"--{name}", "loud").returncode, 78)

    def test_the_machines_of_the_page_are_those_that_the_server_makes(self):
        first, second = printed()["machine"]
        table = rows("| key | default of the first |")
        self.assertEqual({code(row[0]) for row in table}, set(first))
        for row in table:
            self.assertEqual(tomllib.loads("x = " + code(row[1]))["x"], first[code(row[0])])
            self.assertEqual(tomllib.loads("x = " + code(row[2]))["x"], second[code(row[0])])

    def test_the_example_is_taken_and_what_it_does_not_name_keeps_its_default(self):
        example = re.search(r"```toml\n(.*?)```", PAGE.read_text(), re.DOTALL).group(1)
        config = self.from_file(example)
        wanted = tomllib.loads(example)
        for section, table in wanted.items():
            if section == "machine":
                self.assertEqual(config["machine"], table)
                continue
            for key, value in table.items():
                self.assertEqual(config[section][key], value)
        self.assertEqual(config["jobs"], printed()["jobs"])

    def test_what_is_printed_reads_back_to_the_same(self):
        done = configure("--workers.count", "3", "--web.origins", "http://a:1,http://b:2")
        with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
            file.write(done.stdout)
            file.flush()
            self.assertEqual(configure("--config", file.name).stdout, done.stdout)

    def test_wrong_files_are_refused_with_line_and_key(self):
        for text, place, key in (("[jobs]\nattempts = 11\n", ":2:", "jobs.attempts"),
                                 ("[jobs]\nattempt = 1\n", ":2:", "jobs.attempt"),
                                 ("[jobs]\nattempts = 1\nattempts = 2\n", ":3:", "attempts"),
                                 ("[jobs]\nattempts = 1.5\n", ":2:", "jobs.attempts")):
            with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
                file.write(text)
                file.flush()
                done = configure("--config", file.name)
            self.assertEqual(done.returncode, 78, text)
            self.assertIn(file.name + place, done.stderr)
            self.assertIn(key, done.stderr)

    # --- helpers ------------------------------------------------------------------------------------
    def from_file(self, text):
        with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
            file.write(text)
            file.flush()
            return printed("--config", file.name)

    def another_value(self, name, row):
        """A value other than the default, as text and as what is then printed."""
        default = tomllib.loads("x = " + row["default"])["x"]
        if name == "listen.grpc":
            return "127.0.0.1:7,unix:/tmp/cell", ["127.0.0.1:7", "unix:/tmp/cell"]
        if name == "listen.web":
            return "[::1]:8", "[::1]:8"
        if isinstance(default, list):
            return "a,b", ["a", "b"]
        match = re.fullmatch(r"(-?[\d.]+) to ([\d.]+)", row["allowed"])
        if match:
            bounds = [type(default)(float(bound)) for bound in match.groups()]
            other = next(bound for bound in bounds if bound != default)
            return str(other), other
        if name in WORDS:
            other = next(word for word in row["allowed"].split(", ") if word != default)
            return other, other
        return "/some/where", "/some/where"


if __name__ == "__main__":
    unittest.main(verbosity=2)
