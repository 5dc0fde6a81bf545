"""What the compiler refuses of the switches of each source, so that nobody asks it again.

Asking for all sources takes most of an hour; refused.txt keeps the answers by a hash over the source and over what makes
the switches. An answer that holds no longer, since a header changed, is noticed when the source does not compile.
"""
import hashlib
import pathlib

HERE = pathlib.Path(__file__).parent
MAKERS = ("changes.h", "operands.py", "switched_source.py")
KEY_LETTERS = 24


class Refusals:
    def __init__(self, path):
        self.path = path
        self.made_by = b"".join((HERE / name).read_bytes() for name in MAKERS)
        self.known = {}
        self.used = set()
        if path.exists():
            for line in path.read_text(encoding="ascii").splitlines():
                key, _, numbers = line.partition(" ")
                self.known[key] = numbers_of(numbers)

    def key(self, source, places):
        """`places` are those of the source in their order: a number below is one's place among them."""
        text = repr([(place.begin, place.end, place.kind, place.after) for place in places])
        return hashlib.sha256(self.made_by + source.encode() + text.encode()).hexdigest()[:KEY_LETTERS]

    def get(self, key):
        self.used.add(key)
        return self.known.get(key)

    def put(self, key, numbers):
        self.used.add(key)
        self.known[key] = set(numbers)
        with open(self.path, "a", encoding="ascii") as file:
            file.write(f"{key} {text_of(numbers)}\n")

    def keep(self):
        """Only what was asked for since: the rest is of sources that are no more."""
        lines = [f"{key} {text_of(self.known[key])}" for key in sorted(self.used & self.known.keys())]
        self.path.write_text("".join(line.rstrip() + "\n" for line in lines), encoding="ascii")


def text_of(numbers):
    """"0-3,7" of 0, 1, 2, 3, 7."""
    parts = []
    for number in sorted(numbers):
        if parts and parts[-1][1] == number - 1:
            parts[-1][1] = number
        else:
            parts.append([number, number])
    return ",".join(f"{first}" if first == last else f"{first}-{last}" for first, last in parts)


def numbers_of(text):
    numbers = set()
    for part in text.split(",") if text else ():
        first, _, last = part.partition("-")
        numbers |= set(range(int(first), int(last or first) + 1))
    return numbers
