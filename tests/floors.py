"""Fails on any #include that looks up, and on any that looks into a folder inside another floor: the order of
the floors lives here and nowhere else. A header is public and installed, in its floor or in a room of it, unless
tests/gates/rooms.py says that the folder above it belongs to its floor. A header that
nobody outside its floor gets to see (another floor, a verb, an example, the front door libchar.hpp) has to be in
such a folder."""
import pathlib
import re
import sys

from gates.rooms import is_public

ORDER = {"core": 0, "log": 1, "allan": 1, "spectrum": 1, "fusion": 1, "model": 1, "fit": 2, "simulate": 2, "export": 2,
         "characterize": 3, "scene": 3, "lot": 4, "replay": 4, "benchmark": 5, "figure": 6, "report": 7, "fleet": 8}
# Floors of one rank do not know each other.
# Libraries that are kept to their floors.
KEPT = {"fftw3.h": {"spectrum"}, "ceres/": {"fit", "fusion"}, "CLI/": set(), "cairo": {"figure"},
        "fontconfig/": {"figure"}}

root = pathlib.Path(sys.argv[1])
faults = []
for path in sorted((root / "libchar").rglob("*.[ch]pp")):
    where = path.relative_to(root).as_posix()
    floor = where.split("/")[1]
    if floor == path.name:  # the front door
        continue
    for number, line in enumerate(path.read_text().splitlines(), 1):
        own = re.match(r'\s*#include "libchar/((\w+)/[\w/]+\.hpp)', line)
        if own and own[2] != floor and ORDER[own[2]] >= ORDER[floor]:
            faults.append(f"{path}:{number}: {floor} includes {own[2]}, which is not below it")
        if own and own[2] != floor and not is_public("libchar/" + own[1]):
            faults.append(f"{path}:{number}: {own[1]} belongs to {own[2]}, {floor} is not to look into it")
        if own and not is_public("libchar/" + own[1]) and path.suffix == ".hpp" and is_public(where):
            faults.append(f"{path}:{number}: a public header includes what is not installed")
        for library, floors in KEPT.items():
            if re.match(rf"\s*#include <{re.escape(library)}", line) and floor not in floors:
                faults.append(f"{path}:{number}: {library} is not to be used in {floor}")


def includes(path):
    return set(re.findall(r'#include "(libchar/[^"]+)"', path.read_text()))


public = {path.relative_to(root).as_posix() for path in (root / "libchar").glob("*/**/*.hpp")}
public = {path for path in public if is_public(path)}
seen = set()  # from outside, directly or through a public header
wanted = set().union(*(includes(path) for folder in ("tools", "docs/examples")
                       for path in (root / folder).rglob("*.[ch]pp")))
for path in (root / "libchar").rglob("*.[ch]pp"):
    floor = path.relative_to(root / "libchar").parts[0]
    wanted |= {name for name in includes(path) if name.split("/")[1] != floor}
while wanted:
    name = wanted.pop()
    if name in public - seen:
        seen.add(name)
        wanted |= includes(root / name)
for name in sorted(public - seen):
    faults.append(f"{name}: nobody outside its floor sees it: it belongs into detail/")
print("\n".join(faults) or "floors: every include looks down")
sys.exit(bool(faults))
