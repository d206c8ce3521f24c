"""The shape of a checkout's C++, printed: lengths of functions and files, files per folder, parameters,
comments in public headers."""
import ast
import collections
import io
import json
import re
import statistics
import subprocess
import tokenize

from gates import rooms


def docstrings(text):
    """Numbers of the lines of docstrings."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.Module, ast.ClassDef,
                             ast.FunctionDef)) and ast.get_docstring(node, clean=False) is not None:
            yield from range(node.body[0].lineno, node.body[0].end_lineno + 1)


def string_lines(text):
    """Numbers of the lines of Python's strings over several lines that are no docstrings."""
    lines = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.STRING and token.end[0] > token.start[0]:
            lines.update(range(token.start[0], token.end[0] + 1))
    return lines - set(docstrings(text))


def spread(values):
    values = sorted(values)
    if not values:
        return "-"
    return f"{statistics.median(values):.0f} / {values[int(0.9 * (len(values) - 1))]} / {values[-1]}"


def functions_of(folder):
    ctags = subprocess.run(
        ["ctags", "--output-format=json", "--languages=C++", "--kinds-C++=f", "--fields=+neS", "-R",
         "--langmap=C++:.cpp.hpp", "-f", "-", str(folder)],
        capture_output=True, text=True, check=True)
    for line in ctags.stdout.splitlines():
        tag = json.loads(line)
        if "end" in tag:
            yield tag


def parameters(signature):
    depth = 0
    inside = signature.strip()[1:-1].strip()
    if not inside or inside == "void":
        return 0
    count = 1
    for character in inside:
        depth += character in "(<[{"
        depth -= character in ")>]}"
        count += character == "," and depth == 0
    return count


def print_shape(root):
    for name in ("libchar", "tools"):
        folder = root / name
        sources = [p for p in folder.rglob("*.[ch]pp")]
        functions = list(functions_of(folder))
        lengths = [tag["end"] - tag["line"] + 1 for tag in functions]
        print(f"{name}: {len(sources)} files, {sum(len(p.read_text().splitlines()) for p in sources)} lines")
        print(f"  function lines, median / p90 / longest     {spread(lengths)} of {len(lengths)}")
        for tag in sorted(functions, key=lambda t: t["line"] - t["end"]):
            if tag["end"] - tag["line"] + 1 > 60:
                print(f"    above 60: {tag['end'] - tag['line'] + 1} {tag['path']}:{tag['line']} {tag['name']}")
        print(f"  file lines, median / p90 / longest         "
              f"{spread([len(p.read_text().splitlines()) for p in sources])}")
        per_folder = collections.Counter(p.parent for p in sources)
        print(f"  files a folder, median / p90 / largest     {spread(per_folder.values())}")
        print(f"  parameters, median / p90 / most            "
              f"{spread([parameters(t.get('signature', '()')) for t in functions])}")
        comment = code = 0
        public = [p for p in folder.rglob("*.hpp") if rooms.is_public(p.relative_to(root).as_posix())]
        for path in public:
            for line in path.read_text().splitlines():
                comment += bool(re.search(r"//", line))
                code += bool(re.sub(r"//.*", "", line).strip())
        print(f"  public headers: {len(public)}, comment lines per code line {comment / max(code, 1):.2f}")
        with_header = sum(p.with_suffix(".hpp").exists() for p in sources if p.suffix == ".cpp")
        print(f"  sources with a header of their name        {with_header} of "
              f"{sum(p.suffix == '.cpp' for p in sources)}")
