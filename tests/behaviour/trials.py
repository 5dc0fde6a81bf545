"""One thing that is tried with two builds: files, command lines, and the files that these are to write."""
import dataclasses
import pathlib
import re
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SECONDS_MAX = 600
DATE = re.compile(rb"- \w{3} \w{3} [ \d]\d \d\d:\d\d:\d\d \d{4}")  # of a program that was made


@dataclasses.dataclass
class Trial:
    name: str  # unique: "random/optimo/17"
    files: tuple  # (name, bytes)
    runs: tuple  # the words of each command line
    products: tuple = ()  # names of files that are written
    spoken: bytes = b""  # on standard input

    def said(self, command, environment=None, seconds=SECONDS_MAX, limits=None):
        """All that the command says, as bytes; `limits` is called in each process before it begins."""
        with tempfile.TemporaryDirectory(prefix="behaviour-") as folder:
            place = pathlib.Path(folder)
            for name, content in self.files:
                (place / name).write_bytes(content)
            parts = []
            for words in self.runs:
                done = subprocess.run([command, *words], cwd=place, capture_output=True, timeout=seconds, check=False,
                                      env=environment, input=self.spoken, preexec_fn=limits)
                parts += [f"== {' '.join(words)}: {done.returncode}\n".encode(), done.stdout, b"-- errors\n", done.stderr]
            for name in self.products:
                path = place / name
                parts += [f"== {name}\n".encode(), path.read_bytes() if path.exists() else b"none\n"]
            return DATE.sub(b"- DATE", b"".join(parts))
