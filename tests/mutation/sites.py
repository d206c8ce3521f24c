"""Places where a C++ source can be broken, and how: mutants(text) → [Mutant].

The sources are as .clang-format leaves them, which is what makes it simple: a binary operator has a space on
either side and a template's bracket has none, so that lines with comments and strings blanked out can be
rewritten by patterns."""
import collections
import re

# line: index from 0; before, after: the line; operator: the kind of rewriting
Mutant = collections.namedtuple("Mutant", "line before after operator")

BINARY = {
    " < ": " <= ", " <= ": " < ", " > ": " >= ", " >= ": " > ", " == ": " != ", " != ": " == ",
    " && ": " || ", " || ": " && ",
    " + ": " - ", " - ": " + ", " * ": " / ", " / ": " * ", " += ": " -= ", " -= ": " += ", " *= ": " /= ",
    " /= ": " *= ",
}
KIND = {" < ": "relation", " <= ": "relation", " > ": "relation", " >= ": "relation", " == ": "relation",
        " != ": "relation",
        " && ": "logic", " || ": "logic"}
NUMBER = re.compile(r"(?<![\w.])(\d+\.\d*(?:e[+-]?\d+)?|\d+e[+-]?\d+|\d+)(U|ULL|L)?(?![\w.])")
IF = re.compile(r"^(\s*(?:\} else )?if \()(.+)(\)(?: \{| [^{};]+;|))$")
STATEMENT = re.compile(r"^\s+(?:[\w:.\[\]*()]|->)+(?:\s[-+*/|&^%]?=\s.+|\(.*\)|\+\+|--)?;$|^\s+(?:\+\+|--)[\w.\[\]]+;$")
NO_STATEMENT = re.compile(
    r"^\s*(?:return|throw|break|continue|case|using|default|static_assert|public|private|namespace|\}|else\b)")
AFTER = re.compile(r"[;{}]\s*$|\)\s*$|else$|^\s*$")


def blanked(text):
    """The text with comments, strings, characters and preprocessor lines replaced by blanks of equal length."""
    def blank(match):
        if match[0][0] in "\"'":
            return match[0][0] + "\1" * (len(match[0]) - 2) + match[0][-1]
        return re.sub(r"[^\n]", " ", match[0])
    text = re.sub(r'R"(\w*)\(.*?\)\1"', lambda m: re.sub(r"[^\n]", "\1", m[0]), text, flags=re.S)
    text = re.sub(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|(?<!\w)\'(?:\\.|[^\'\\\n])+\'', blank, text, flags=re.S)
    return re.sub(r"^#[^\n]*", lambda m: " " * len(m[0]), text, flags=re.M)


def balanced(text):
    depth = 0
    for character in text:
        depth += character == "("
        depth -= character == ")"
        if depth < 0:
            return False
    return depth == 0


def of_operators(clean):
    for old, new in BINARY.items():
        for match in re.finditer(re.escape(old), clean):
            yield match.start(), match.end(), new, KIND.get(old, "arithmetic")
    for match in re.finditer(r"(?<=\()!(?=\w)|(?<= )!(?=\w)", clean):
        yield match.start(), match.end(), "", "logic"


def of_constants(clean):
    for match in NUMBER.finditer(clean):
        value = match[1]
        if re.fullmatch(r"\d+", value):
            yield match.start(1), match.end(1), str(int(value) + 1), "constant"
            if int(value) > 0:
                yield match.start(1), match.end(1), str(int(value) - 1), "constant"
        else:
            yield match.start(1), match.end(1), f"(2 * {value})" if float(value) != 0 else "1.0", "constant"


def of_conditions(clean):
    match = IF.match(clean)
    if not match or not balanced(match[2]) or ";" in match[2] or clean.lstrip().startswith("if constexpr"):
        return
    for fixed in ("true", "false"):
        yield match.start(2), match.end(2), fixed, "condition"


def of_returns(clean):
    match = re.match(r"^(\s*(?:.*\) )?return )(.+);$", clean)
    if not match or match[2] in ("{}", "*this"):
        return
    swap = {"true": "false", "false": "true"}.get(match[2].strip())
    yield match.start(2), match.end(2), swap or "{}", "return"


def of_statements(clean, previous):
    if STATEMENT.match(clean) and not NO_STATEMENT.match(clean) and balanced(clean) and AFTER.search(previous):
        start = len(clean) - len(clean.lstrip())
        yield start, len(clean), ";", "statement"


def mutants(text):
    lines, clean = text.split("\n"), blanked(text).split("\n")
    found, previous = [], "{"
    for number, (line, seen) in enumerate(zip(lines, clean)):
        seen = seen.rstrip()
        if not seen.strip():
            continue
        if "static_assert" not in seen and "template <" not in seen and "operator" not in seen:
            for start, end, new, kind in (*of_operators(seen), *of_constants(seen), *of_conditions(seen),
                                          *of_returns(seen),
                                          *of_statements(seen, previous)):
                if "\1" not in seen[start:end] or kind in ("condition", "return", "statement"):
                    found.append(Mutant(number, line, line[:start] + new + line[end:], kind))
        previous = seen
    return found
