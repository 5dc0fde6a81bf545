"""A terminal for the tests of commands that take it whole: a pty, and what is to be seen on it."""
import fcntl
import os
import pty
import re
import signal
import struct
import subprocess
import termios
import threading

from cell import BIN, eventually

ROWS, COLUMNS = 24, 80
SEQUENCE = re.compile(rb"\x1b\[([?<>=]?)([0-9;]*)([@-~])")


class Terminal:
    """Knows what the command uses, of what xterm knows."""

    def __init__(self, rows=ROWS, columns=COLUMNS):
        self.master, self.slave = pty.openpty()
        self.drawing = threading.Lock()  # held while the screen is another one than before
        self.resize(rows, columns)
        self.before = termios.tcgetattr(self.slave)
        self.answers = True  # to the question whether it is there
        self.row = self.column = 0
        self.modes = set()
        self.seen = b""
        self.process = None
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def resize(self, rows, columns):
        with self.drawing:
            self.cells = [[" "] * columns for _ in range(rows)]
        fcntl.ioctl(self.master, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def start(self, *words):
        # Not preexec_fn: Python code between fork and exec hangs now and then beside the threads of gRPC.
        self.process = subprocess.Popen(["setsid", "--ctty", os.path.join(BIN, "rmlcell"), *words],
                                        stdin=self.slave, stdout=self.slave, stderr=self.slave)
        return self

    def end(self):
        """Of a test: nothing of it is left."""
        for process in [*self.inner(), self.process.pid]:
            try:
                os.kill(process, signal.SIGKILL)
            except ProcessLookupError:
                pass
        self.process.wait(timeout=60)
        os.close(self.slave)
        self.reader.join(timeout=60)
        os.close(self.master)

    def inner(self):
        """The process that reads keys; the one that was started waits for it."""
        try:
            with open(f"/proc/{self.process.pid}/task/{self.process.pid}/children", encoding="ascii") as children:
                return [int(child) for child in children.read().split()]
        except OSError:
            return []

    def type(self, text):
        os.write(self.master, text.encode())

    def mouse(self, button, down):
        """On the button of a key, by what stands there: "x X+"."""
        row, column = self.place_of(button)
        self.type(f"\x1b[<0;{column + 2};{row + 1}{'M' if down else 'm'}")

    def place_of(self, button):
        def found():
            places = [(row, line.find(button)) for row, line in enumerate(self.lines()) if button in line]
            return places if len(places) == 1 else None
        places = eventually(found)  # the screen may be half drawn still
        assert places, f"{button}\n{self.text()}"
        return places[0]

    def lines(self):
        return ["".join(row) for row in self.cells]

    def text(self):
        return "\n".join(self.lines())

    def shows(self, text):
        return eventually(lambda: text in self.text())

    # --- what it is sent ------------------------------------------------------------------------------
    def read(self):
        pending = b""
        while True:
            try:
                sent = os.read(self.master, 65536)
            except OSError:
                return
            if not sent:
                return
            self.seen += sent
            with self.drawing:
                pending = self.draw(pending + sent)

    def draw(self, sent):
        """Returns what is no whole sequence yet."""
        while sent:
            if sent[:1] == b"\x1b":
                found = SEQUENCE.match(sent)
                if not found:
                    return sent
                self.obey(*(part.decode() for part in found.groups()))
                sent = sent[found.end():]
                continue
            character = sent[:1].decode("latin-1")
            sent = sent[1:]
            if character == "\r":
                self.column = 0
            elif character == "\n":
                self.row += 1
            elif character >= " " and self.row < len(self.cells) and self.column < len(self.cells[0]):
                self.cells[self.row][self.column] = character
                self.column += 1
        return b""

    def obey(self, private, numbers, name):
        if private == "?" and name in "hl":
            for mode in numbers.split(";"):
                (self.modes.add if name == "h" else self.modes.discard)(int(mode))
        elif name == "H":
            self.row, self.column = (int(number) - 1 for number in (numbers or "1;1").split(";"))
        elif name == "J":
            self.cells = [[" "] * len(row) for row in self.cells]
        elif name == "K":
            if self.row < len(self.cells):  # it may have been drawn for more of them
                self.cells[self.row][self.column:] = [" "] * (len(self.cells[0]) - self.column)
        elif name == "n" and numbers == "5" and self.answers:
            self.type("\x1b[0n")
        elif name != "m" and not (name == "n" and numbers == "5"):
            raise AssertionError(f"unknown sequence {private}{numbers}{name}")
