"""The rmlcell command as a shell calls it, and a folder of files to call it with."""
import os
import pathlib
import subprocess
import tempfile
import unittest

BIN = pathlib.Path(os.environ["RMLCELL_BIN"])


def ask(*words, server=None, text=True, **more):
    """One call, whatever its exit status; `more` is what subprocess.run takes."""
    environment = {**os.environ, "NO_COLOR": "1"}
    if server:
        environment["RMLCELL_SERVER"] = server
    if "stdout" not in more and "stderr" not in more:
        more["capture_output"] = True
    return subprocess.run([BIN / "rmlcell", *map(str, words)],
                          **{"text": text, "timeout": 120, "env": environment, **more})


def run(*words, code=0, **more):
    """What one call prints that must end with `code`."""
    done = ask(*words, **more)
    assert done.returncode == code, (words, done.returncode, done.stdout, done.stderr)
    return done.stdout


class InFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def file(self, name, content):
        path = self.folder / name
        path.write_text(content)
        return path
