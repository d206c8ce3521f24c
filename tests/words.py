"""Holds the English of every text that people read: plain syntax, the field's terms, numbers written for people.

usage: words.py ROOT [--lower] [--list [KEY]]
Reads README.md, the pages of docs/ and fixtures/, the texts of findings, the documentation of the Python module, the
string literals of libchar/ and tools/ and of the scripts of pages, the words of tools/page/page.html, and the comments
of public headers, of docs/examples and of the C that `model --to c` writes. RULES lists what is refused and what to
write instead, LONGEST how long a sentence may be. gates/words.tsv lists where a pattern may still occur, and how often,
with a reason: a number there may fall, never grow, and --lower lowers it to what is there. --list prints each
occurrence (of the keys that begin with KEY).
"""
import ast
import collections
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import structure  # noqa: E402
from gates import cpp, rooms  # noqa: E402

CEILINGS = pathlib.Path(__file__).resolve().parent / "gates/words.tsv"
COUNTED = (r"(?:algorithm|axis|bin|block|byte|cell|channel|class|column|core|curve|day|decade|device|draw"
           r"|figure|file|finding|floor|folder|hour|input|instant|interval|kind|line|log|message|method|minute|model"
           r"|module|number|octave|page|pair|part|point|record|recording|row|run|sample|scene|second|section|sensor"
           r"|step|target|task|term|test|topic|unit|value|verb|word)")
# Words that make "a … a" a phrase of another kind.
BETWEEN = (r"(?!(?:a|about|an|and|as|at|before|behind|but|by|does|for|from|had|has|have|in|inside|into|is|of|on|once|or"
           r"|over|per|took|share|than|that|to|twice|under|was|when|where|which|with|within|without)\b)[\w/-]+")
EACH = rf"an?\s+{COUNTED}\b(?!-|\s+(?:or|later|after|apart|before)\b)"
UNITS = r"(?:ns|µs|ms|s|B|bytes|KiB|MiB|MB|GB|%)"
# Rule, what is refused, what to write instead, and where it does not apply: "table" or "".
RULES = [
    ("per", rf"(?<!\b[Ii]n )(?<!\b[Ff]or )(?<!\bof )\b(?:an?|one)\s+(?:{BETWEEN}\s+)?{BETWEEN}(?<!\w[a-rt-z]s)\s+{EACH}"
     rf"|\bone\s+{EACH}"
     rf"|(?:\b(?:two|three|four|five|six|ten)|\d)\s+(?:{BETWEEN}(?<!s)\s+)?(?:[a-z-]+s|{UNITS})\s+{EACH}"
     rf"|\b{UNITS}\s+{EACH}|\b(?:an?|one)\s+`[^`]*`\s+{EACH}", "per", ""),
    ("whom", r"\bwhom\b", "a noun", ""),
    ("is none", r"(?<!\b[Tt]here )\b(?:[Ii]s|[Aa]re|was|were|be)\s+none\b|\bnone\s+(?:that|who)\b",
     "is not a …, cannot be …", ""),
    ("is no", r"(?<!\bthere )(?<!\bthere\n)\b(?:is|are|was|were)\s+no\s+(?!longer\b|more\b|less\b|worse\b|better\b"
     r"|\w+er\s+than\b)", "is not a …, does not have …", ""),
    ("has not", r"\b(?:has|have|had)\s+not(?=\s*(?:[.,;:)]|$)|\s+(?:the|an?|and|or|but)\b)", "does not have", ""),
    ("that there is", r"\bthat\s+there\s+(?:is|are|was|were)\b", "that exist, or nothing", ""),
    ("told", r"\btold\b", "given, specified; distinguished", ""),
    ("stands", r"\b(?:stands?|stood)\b(?!\s+for\b|-)|\bstanding\b(?!\s+wave)", "is in, listed, written; is constant",
     ""),
    ("beside", r"\bbesides?\b", "next to, as well as", ""),
    ("of which", r"\bof\s+(?:which|whose)\b|\bof\s+those\s+(?:of|that|which|who|in|with)\b", "of, or a new sentence",
     ""),
    ("behind", r"\b(?:rows?|words|lines|bytes|put|those|all|nothing(?=\s+behind\s+\w)|stamps|columns?|units|digits"
     r"|comes?|begins|ends)\s+behind\b"
     r"|\bbehind\s+(?:(?:the|their|its)\s+)?(?:last|first|end|beginning|array|row|head|stamp|learning|warm-up|document"
     r"|script|words?|numbers?|\{\}|@|comma|mark)", "after", ""),
    ("in front of", r"\bin\s+front\s+of\b", "before", ""),
    ("so much", r"(?:^|[,;:(]|\b(?:by|over|to|of|reads|for|than)\b)\s*so\s+(?:long|much|many)\b"
     r"(?!\s+(?:as|that|for)\b)",
     "how much, this much, a noun", ""),
    ("anew", r"\banew\b", "again", ""),
    ("otherwise than", r"\botherwise\s+than\b", "differently from", ""),
    ("borne out", r"\bborne\s+out\b", "supported by the data", ""),
    ("says it", r"\bsays?\s+(?:it|this)\b", "states it; given by …", ""),
    ("unlike", r"(?<!--)\bunlike\s+(?:\w+s)\b(?!\s*,)", "different", ""),
    ("what is said", r"\bwhat\s+is\s+said\b", "the notes on …", ""),
    ("as asked", r"\bas\s+asked\b", "as requested", ""),
    ("exponent", r"(?<![\w.])\d+(?:\.\d+)?e[-+]?\d+\b", "an SI prefix or a word; digits", "table"),
    ("digits", r"(?<![\w.^/-])(?<!arXiv )\d+\.\d+(?![\w.]*[\w/-])", "at most four digits", "table"),
    ("long", None, "two sentences", ""),
]
TABLES = RULES[:-1]  # the documentation of a Python function: tables without marks
# The most words of a sentence, and of its part up to a semicolon or a colon. Code, formulas and numbers do not count.
LONGEST = ((40, re.compile(r"(?<!\be\.g)(?<!\bi\.e)[.!?](?=[)\"”*_]*(?:\s|$))")),
           (28, re.compile(r"(?<!\be\.g)(?<!\bi\.e)[.!?;:](?=[)\"”*_]*(?:\s|$))")))
# What a text is made of: a row of a table, a heading, or a paragraph or item of a list.
ROW, HEADING, ITEM = r"[ \t]*\|[^\n]*", r"#+ [^\n]*", r"[ \t]*(?:[-*+]|\d+\.)[ \t]"
BLOCK = re.compile(rf"^(?:{ROW}|{HEADING}|[^\n]*\S[^\n]*(?:\n(?!{ITEM}|{ROW}|{HEADING})[^\n]*\S[^\n]*)*)$", re.M)
# Of a command's help alone: options are noun phrases, and a default is marked as one.
QUESTION = ("question", r"[a-z]\?(?=\s*(?:\(default|$))", "an imperative or a noun phrase", "")
DEFAULT = ("default", r"\((?:\d+(?:\.\d+)?|all|none|one|auto|the [a-z ]+|from the \w+|by its \w+|auto: [^)]*)\)$",
           "(default: …)", "")
PATTERNS = {name: re.compile(pattern, 0 if name in ("per", "is none") else re.I)
            for name, pattern, *_ in [*RULES, QUESTION, DEFAULT] if pattern}


def blanks(match):
    return re.sub(r"[^\n]", " ", match[0])


def prose_of_page(text):
    """Without code, formulas, quotations, pictures and the targets of links, in the same places."""
    text = re.sub(r"^ *```.*?^ *```|^(?: {4}|\t|>)[^\n]*$|<!--.*?-->|\$\$.*?\$\$", blanks, text,
                  flags=re.S | re.M)
    text = re.sub(r"`(?:[^`\n]|\n(?!\n))*`", lambda code: re.sub(r"[^`\n]", "x", code[0]), text)
    return re.sub(r"\]\([^)]*\)|\$[^$\n]+\$|<[^>\n]*>", blanks, text)


def strings(text):
    """The literals of a source that are a sentence or a phrase; neighbours that the compiler joins are one."""
    found, end = [], 0
    for token in cpp.TOKEN.finditer(text):
        if token[0].startswith(("//", "/*", "'")):
            continue
        raw = token[0].startswith("R")
        value = re.sub(r'^R"[^(]*\(|\)[^)"]*"$', "", token[0]) if raw else token[0][1:-1]
        if found and not text[end:token.start()].strip():
            found[-1][1] += value
        elif not re.search(r"#\s*include\s*$", text[:token.start()].rsplit("\n", 1)[-1]):
            found.append([text.count("\n", 0, token.start()) + 1, value])
        end = token.end()
    return [(line, re.sub(r"\\n", " ", value)) for line, value in found if re.search(r"\w\s+\w", value)]


SCRIPT = re.compile(r"//[^\n]*|/\*.*?\*/|\"(?:[^\"\\\n]|\\.)*\"|'(?:[^'\\\n]|\\.)*'|`(?:[^`\\]|\\.)*`", re.S)


def script_strings(text):
    """The literals of a script of a page that are a phrase; what it puts in between is a word."""
    found = [(text.count("\n", 0, token.start()) + 1, re.sub(r"\$\{[^}]*\}", "X", token[0][1:-1]))
             for token in SCRIPT.finditer(text) if token[0][0] in "\"'`"]
    return [(line, value) for line, value in found if re.search(r"\w\s+\w", value)]


def words_of_html(text):
    """What a browser shows, in the same places."""
    return re.sub(r"<(script|style)\b.*?</\1>|<!--.*?-->|<[^>]*>", blanks, text, flags=re.S)


def comments(text):
    """The comments of a source, lines that follow each other joined."""
    found, end = [], -1
    for token in cpp.TOKEN.finditer(text):
        if not token[0].startswith(("//", "/*")):
            continue
        value = re.sub(r"^\s*(?://+[<!]?|/\*+<?|\*+/?)|\*/$", "", token[0], flags=re.M)
        value = re.sub(r"`[^`\n]*`", lambda code: "x" * len(code[0]), value)  # code, as in a page
        if found and re.fullmatch(r"\n[ \t]*", text[end:token.start()] if end >= 0 else ""):
            found[-1][1] += "\n" + value
        else:
            found.append([text.count("\n", 0, token.start()) + 1, value])
        end = token.end()
    return found


def texts(root):
    """(key of its ceiling, place, first line, text, rules)"""
    pages = [root / "README.md", *sorted([*(root / "docs").rglob("*.md"), *(root / "fixtures").rglob("*.md")])]
    for path in pages:
        name = path.relative_to(root).as_posix()
        yield name, name, 1, prose_of_page(path.read_text()), RULES
    for number, line in enumerate((root / "libchar/core/findings.tsv").read_text().splitlines(), 1):
        if not line.startswith("#"):
            yield "libchar/core/findings.tsv", "libchar/core/findings.tsv", number, line, RULES
    for path in sorted([*(root / "tools/python").rglob("*.py"), *(root / "docs/examples").rglob("*.py")]):
        name = path.relative_to(root).as_posix()
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                yield name, name, node.lineno, node.value, TABLES
    html = root / "tools/page/page.html"
    yield "tools/page", "tools/page/page.html", 1, words_of_html(html.read_text()), RULES
    for path in sorted([*(root / "tools/page").rglob("*.js"), *(root / "libchar/report").rglob("*.js")]):
        if not path.name.endswith(".min.js"):
            for line, value in script_strings(path.read_text()):
                yield "tools/page", path.relative_to(root).as_posix(), line, value, RULES
    for path in sorted([*(root / "libchar/fusion").rglob("*.c.in"), *(root / "docs/examples").glob("*.cpp")]):
        name = path.relative_to(root).as_posix()
        for line, value in comments(path.read_text()):
            yield name, name, line, value, RULES
    tree = structure.Tree(root)
    for path, text in tree.cpp("libchar", "tools").items():
        floor = "/".join(path.split("/")[:2]) if path.startswith("libchar/") else "tools"
        for line, value in strings(text):
            yield f"strings {floor}", path, line, value, RULES + [QUESTION, DEFAULT] * (floor == "tools")
        if path.endswith(".hpp") and (rooms.is_public(path) or floor == "tools"):
            for line, value in comments(text):
                yield f"comments {floor}", path, line, value, RULES


def blocks(text):
    """(place, paragraph or cell)"""
    for block in BLOCK.finditer(text):
        cells = re.compile(r"[^|]+" if block[0].lstrip().startswith("|") else r"[^\t]+")
        yield from ((block.start() + cell.start(), cell[0]) for cell in cells.finditer(block[0]))


def long_ones(text):
    """(place in the text, its first words) of each sentence, or part of one, that is longer than LONGEST."""
    for place, block in blocks(text):
        for most, end in LONGEST:
            begin = 0
            for stop in [*(hit.end() for hit in end.finditer(block)), len(block)]:
                said = re.sub(r"`[^`]*`|\{[^}]*\}|<[^>]*>", "", block[begin:stop])
                words = re.findall(r"(?<![^\s(“\"'*_/–-])[^\W\d_][\w’'-]*", said)
                if len(words) > most and len(words) > .75 * len(said.split()):  # otherwise it is code
                    yield place + begin, f"{' '.join(said.split()[:6])} …, {len(words)} words of {most}"
                begin = stop


def hits(text, rules, page):
    """(rule, place in the text, what is said, what to write)"""
    outside = re.sub(r"^[ \t]*\|[^\n]*$", blanks, text, flags=re.M) if page else text
    for name, pattern, instead, apart in rules:
        if not pattern:
            yield from ((name, at, said, instead) for at, said in long_ones(text))
            continue
        for hit in PATTERNS[name].finditer(outside if apart == "table" else text):
            if name != "digits" or len(hit[0].replace(".", "").lstrip("0")) > 4:
                yield name, hit.start(), re.sub(r"\s+", " ", hit[0]), instead


def occurrences(root):
    for key, path, first, text, rules in texts(root):
        for name, at, said, instead in hits(text, rules, path.endswith(".md")):
            line = first + (0 if key.startswith("strings") else text.count("\n", 0, at))
            yield key, name, f"{path}:{line}", said, instead


def main():
    words = [word for word in sys.argv[1:] if not word.startswith("--")]
    root = pathlib.Path(words[0] if words else ".")
    found = list(occurrences(root))
    if "--list" in sys.argv:
        wanted = words[1] if len(words) > 1 else ""
        print("\n".join(f"{place}: {name}: “{said}”: write {instead}" for key, name, place, said, instead in found
                        if key.startswith(wanted)))
        return 0
    counts = collections.defaultdict(structure.Count)
    for key, name, place, said, instead in found:
        counts["long" if name == "long" else "words", key].add(f"{place} “{said}” ({name}: {instead})")
    limits = {"words": (0, "patterns of tests/words.py (--list shows them)"), "long": (0, "long sentences")}
    if "--lower" in sys.argv:
        structure.lower(CEILINGS, counts, limits)
    ceilings = structure.read_ceilings(CEILINGS)
    faults = list(structure.faults_of(counts, ceilings, limits))
    print("\n".join(faults) or f"words: {len(PATTERNS)} rules hold; {len(ceilings)} rows with "
          f"{sum(number for number, _ in ceilings.values())} older occurrences may only shrink")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
