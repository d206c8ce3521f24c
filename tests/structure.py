"""Gates of the house: fails where a class, a folder, the names of libchar:: or a line grows beyond its limit,
where libchar.hpp reaches Eigen, and where a question is answered outside of the function that owns its answer
(gates/owners.py), or something beside the top level is kept.

usage: structure.py ROOT [--lower] [--print]
What is beyond a limit today is a row of gates/ceilings.tsv with a reason: it may shrink, never grow, and a
row that is higher than need be fails too. --lower lowers the rows to what is there and drops those that are
not needed. --print prints the shape of the code: lengths of functions and files, parameters, comments (needs
universal-ctags).
"""
import collections
import dataclasses
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from gates import cpp, rooms, shape  # noqa: E402
from gates.owners import QUESTIONS  # noqa: E402

CEILINGS = pathlib.Path(__file__).resolve().parent / "gates/ceilings.tsv"
COLUMNS = 120
TOP = {"CMakeLists.txt", "LICENSE", "README.md", "docs", "fixtures", "libchar", "tests", "tools"}
LIMITS = {  # of one key of a gate, in what it counts
    "members": (20, "data members of a class"),
    "files": (24, "sources in a folder"),
    "names": (300, "names directly in libchar::, in public headers"),
    "top": (0, "names beside those of the top level"),
    "twice": (1, "classes of one name: the linker takes the functions of one for all"),
    "eigen": (0, "includes of Eigen in a header that libchar/libchar.hpp reaches"),
    "columns": (0, f"lines above {COLUMNS} columns"),
    "owner": (0, "spellings outside of the owner's file"),
    "test": (0, "names of tests with a semicolon, at which CMake cuts the list of them"),
}


class Tree:
    """Sources below a folder: path relative to it → text."""

    def __init__(self, root):
        self.texts = {}
        kept = subprocess.run(["git", "-C", root, "ls-files"], capture_output=True, text=True)  # nothing without git
        self.top = sorted({line.split("/")[0] for line in kept.stdout.splitlines()} - TOP)
        for folder in ("libchar", "tools", "tests"):
            for path in sorted((root / folder).rglob("*")):
                inside = path.relative_to(root)
                made = any(part == "build" or part.startswith(("build-", "__py")) for part in inside.parts[:-1])
                if path.suffix in (".cpp", ".hpp", ".py") and not made:
                    self.texts[inside.as_posix()] = path.read_text(errors="replace")

    def cpp(self, *folders):
        return {path: text for path, text in self.texts.items()
                if path.endswith((".cpp", ".hpp")) and path.split("/")[0] in folders}


@dataclasses.dataclass
class Count:
    number: int = 0
    places: list = dataclasses.field(default_factory=list)

    def add(self, place, number=1):
        self.number += number
        self.places.append(place)


def floor_of(path):
    """libchar/fit, tools, tests/report: where a row belongs that must outlive the moving of files."""
    parts = pathlib.PurePosixPath(path).parts
    return "/".join(parts[:2]) if len(parts) > 2 else parts[0]


def gate_members(tree, counts):
    for path, text in tree.cpp("libchar", "tools").items():
        for within, scope in cpp.parse(text).walk():
            if scope.kind == "class":
                name = "::".join(s.name for s in (*within, scope) if s.kind == "class")
                number = sum(cpp.members_of(statement) for statement, _ in scope.statements)
                counts["members", f"{floor_of(path)} {name}"].add(f"{path}:{scope.line}", number)


def gate_files(tree, counts):
    for path in tree.cpp("libchar", "tools"):
        counts["files", path.rsplit("/", 1)[0]].add(path)


def gate_names(tree, counts):
    names = set()
    for path, text in tree.cpp("libchar").items():
        if path.endswith(".hpp") and rooms.is_public(path):
            for within, scope in cpp.parse(text).walk():
                if "::".join(s.name for s in (*within, scope) if s.kind != "file") == "libchar":
                    names |= cpp.names_of(scope)
    counts["names", "libchar"] = Count(len(names), sorted(names))


def gate_top(tree, counts):
    """Whatever a measurement leaves in the root of the checkout is easily kept with a change."""
    for name in tree.top:
        if not name.startswith("."):
            counts["top", name].add(name)


def gate_twice(tree, counts):
    for path, text in tree.cpp("libchar", "tools").items():
        for within, scope in cpp.parse(text).walk():
            spaces = [s.name for s in within if s.kind != "file"]
            own = scope.kind == "class" and "::" not in scope.name and "(anonymous)" not in (*spaces, scope.name)
            if own and all(s.kind != "class" for s in within):
                counts["twice", "::".join((*spaces, scope.name))].add(f"{path}:{scope.line}")


def gate_eigen(tree, counts):
    reached, todo = set(), ["libchar/libchar.hpp"]
    while todo:
        path = todo.pop()
        if path in reached or path not in tree.texts:
            continue
        reached.add(path)
        for included in re.findall(r'^\s*#\s*include\s+["<]([^">]+)[">]', tree.texts[path], re.M):
            if included.startswith("Eigen/"):
                counts["eigen", path].add(f"{path}: {included}")
            todo.append(included)


def lines_that_may_be_long(path, text):
    """Of strings over several lines: bytes that somebody else reads. Not of docstrings."""
    if not path.endswith(".py"):
        return cpp.raw_string_lines(text)
    return shape.string_lines(text)


def gate_columns(tree, counts):
    for path, text in tree.texts.items():
        lines = text.split("\n")
        if max(map(len, lines)) <= COLUMNS:
            continue
        free = lines_that_may_be_long(path, text)
        floor = "libchar/log/csv" if path.startswith("libchar/log/csv/") else floor_of(path)
        for number, line in enumerate(lines, 1):
            if len(line) > COLUMNS and "://" not in line and number not in free:
                counts["columns", floor].add(f"{path}:{number}")


def gate_owners(tree, counts):
    sources = {path: cpp.blanked(text, keep=("string",)) for path, text in tree.cpp("libchar", "tools").items()}
    for question in QUESTIONS:
        if question.owner and (question.file() not in sources or not question.is_there(sources[question.file()])):
            counts["owner", question.name].add(f"tests/gates/owners.py: {question.owner} is not there")
        own = {question.file(), question.file().replace(".cpp", ".hpp")}
        for path, text in sources.items():
            for hit in re.finditer(question.spelling, text) if path not in own else []:
                line = text.count("\n", 0, hit.start()) + 1
                counts["owner", f"{question.name}: {floor_of(path)}"].add(f"{path}:{line}")


def gate_tests(tree, counts):
    for path, text in tree.cpp("tests").items():
        for called in re.finditer(r'TEST_CASE(?:_METHOD)?\(\s*((?:"(?:[^"\\]|\\.)*"\s*)+)', text):
            name = "".join(re.findall(r'"((?:[^"\\]|\\.)*)"', called[1]))
            if ";" in name:
                counts["test", path].add(f"{path}: {name}")


def measured(root):
    tree, counts = Tree(root), collections.defaultdict(Count)
    for gate in (gate_members, gate_files, gate_names, gate_top, gate_twice, gate_eigen, gate_columns, gate_owners,
                 gate_tests):
        gate(tree, counts)
    return counts


def read_ceilings(path):
    rows = {}
    for line in path.read_text().splitlines() if path.exists() else []:
        if line and not line.startswith("#"):
            gate, key, number, reason = line.split("\t")
            rows[gate, key] = int(number), reason
    return rows


def faults_of(counts, ceilings, limits=LIMITS):
    beyond = {key: count for key, count in counts.items() if count.number > limits[key[0]][0]}
    for (gate, name), count in sorted(beyond.items()):
        limit, what = limits[gate]
        ceiling = ceilings.get((gate, name), (limit, ""))[0]
        if count.number > ceiling:
            places = ", ".join(count.places[:8] if gate != "names" else [])
            yield f"{gate}: {name}: {count.number} {what}, at most {ceiling} are allowed: {places}"
        elif count.number < ceiling:
            yield f"{gate}: {name}: {count.number} {what}, the ceiling is {ceiling}: lower it (--lower)"
    for (gate, name), (number, reason) in sorted(ceilings.items()):
        if gate not in limits:
            yield f"{gate}: {name}: there is no such gate"
        elif (gate, name) not in beyond:
            yield f"{gate}: {name}: the row is not needed: drop it (--lower)"
        if not reason.strip():
            yield f"{gate}: {name}: the row has no reason"


def lower(path, counts, limits=LIMITS):
    kept = []
    for line in path.read_text().splitlines():
        if line and not line.startswith("#"):
            gate, key, number, reason = line.split("\t")
            there = counts[gate, key].number
            if there <= limits[gate][0]:
                continue
            line = "\t".join((gate, key, str(min(int(number), there)), reason))
        kept.append(line)
    path.write_text("\n".join(kept) + "\n")


def main():
    roots = [word for word in sys.argv[1:] if not word.startswith("--")]
    root = pathlib.Path(roots[0] if roots else ".")
    if "--print" in sys.argv:
        return shape.print_shape(root)
    counts = measured(root)
    if "--lower" in sys.argv:
        lower(CEILINGS, counts)
    ceilings = read_ceilings(CEILINGS)
    faults = list(faults_of(counts, ceilings))
    print("\n".join(faults)
          or f"structure: {len(LIMITS)} gates hold, {len(ceilings)} rows are beyond a limit and may only shrink")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
