# SPDX-License-Identifier: MIT
"""Writes mutants into their sources: every one of them in the same text, asleep until its number is chosen."""
import pathlib
import random

INCLUDE = '#include "core/mutant.hpp"'


class Mutant:
    def __init__(self, number, site, change):
        self.number, self.site, self.change = number, site, change

    def __str__(self):
        return f"{self.site.path}:{self.site.line}: {self.change.what}"

    def key(self):
        """What stays when other lines of the file move: the file, the line's text, the change."""
        return self.site.path, self.site.source_line, self.change.what


def sample(sites_by_room, count, seed):
    """count mutants, as many of each room as the others where a room has that many; one change a site."""
    chosen = random.Random(seed)
    rest, left, mutants = len(sites_by_room), count, []
    for room in sorted(sites_by_room, key=lambda name: len(sites_by_room[name])):
        sites = sites_by_room[room]
        share = min(len(sites), left // rest)
        rest, left = rest - 1, left - share
        for site in sorted(chosen.sample(sites, share), key=lambda site: (site.path, site.start, site.end)):
            mutants.append((site, chosen.choice(site.changes)))
    return [Mutant(number, site, change) for number, (site, change) in enumerate(mutants)]


def render(text, start, end, mutants):
    """text[start:end] with the mutants within it, the outermost first."""
    outermost = None
    for mutant in mutants:
        site = mutant.site
        if start <= site.start and site.end <= end:
            size = (site.start, -site.end, site.ranges != [(site.start, site.end)])
            if outermost is None or size < outermost[0]:
                outermost = size, mutant
    if outermost is None:
        return text[start:end].decode()
    mutant = outermost[1]
    site, others = mutant.site, [other for other in mutants if other is not mutant]
    parts = [render(text, first, last, others) for first, last in site.ranges]
    changed = mutant.change.text.replace("{N}", str(mutant.number))
    if changed.count("{0}") + changed.count("{1}") > len(parts):
        parts = [" ".join(part.split()) for part in parts]
    for index, part in enumerate(parts):
        changed = changed.replace("{%d}" % index, part)
    # As many lines as before, so that what the compiler says finds its mutant.
    changed += "\n" * (text[site.start:site.end].count(b"\n") - changed.count("\n"))
    return render(text, start, site.start, others) + changed + render(text, site.end, end, others)


def can_be_written(site, text):
    """What stands twice in the change stands in one line, where a comment would end it."""
    return b"//" not in text[site.start:site.end]


def mutated(path, mutants):
    text = pathlib.Path(path).read_bytes()
    whole = render(text, 0, len(text), mutants)
    if not mutants:
        return whole
    first, rest = whole.split("\n", 1)
    if not first.startswith("// SPDX"):
        raise SystemExit(f"mutate: {path} does not begin with its license")
    return INCLUDE + "\n" + rest
