# SPDX-License-Identifier: MIT
"""A source file and the places in it that may be changed."""
import dataclasses


@dataclasses.dataclass(frozen=True)
class Change:
    """text: what stands in the program, with {N} for the mutant's number and {0}, {1} ... for ranges of the site."""
    what: str
    text: str


@dataclasses.dataclass
class Site:
    path: str
    line: int
    start: int
    end: int
    ranges: list
    changes: list
    lines: int = 1
    source_line: str = ""


class Source:
    def __init__(self, path):
        with open(path, "rb") as file:
            self.bytes = file.read()
        self.path = path
        self.macros = []

    def text(self, start, end):
        return self.bytes[start:end].decode()

    def in_macro(self, start, end):
        return any(first < end and start < last for first, last in self.macros)

    def line_text(self, offset):
        first = self.bytes.rfind(b"\n", 0, offset) + 1
        last = self.bytes.find(b"\n", offset)
        return self.bytes[first:last].decode().strip()


def short(text):
    joined = " ".join(text.split())
    return joined if len(joined) <= 60 else joined[:57] + "..."
