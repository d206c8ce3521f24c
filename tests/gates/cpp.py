"""As much of C++ as the gates need: a file as a tree of namespaces, classes and what is declared in them. No
macros, no types."""
import dataclasses
import re

TOKEN = re.compile(
    r'//(?:[^\n\\]|\\.)*|/\*.*?\*/|R"(?P<end>[^(\s]*)\(.*?\)(?P=end)"|'
    r'"(?:[^"\\\n]|\\.)*"|(?<![0-9a-fA-F])\'(?:[^\'\\\n]|\\.)+\'', re.S)


def blanked(text, keep=()):
    """The text with blanks for comments and literals, in the same places; kinds in `keep` (comment, string) stay."""
    def blank(token):
        kind = "comment" if token[0].startswith(("//", "/*")) else "string"
        if kind in keep:
            return token[0]
        return re.sub(r"[^\n]", " ", token[0])
    return TOKEN.sub(blank, text)


def raw_string_lines(text):
    """Numbers of the lines that a raw string covers: bytes that somebody reads, not lines of code."""
    lines = set()
    for token in TOKEN.finditer(text):
        if token[0].startswith('R"'):
            first = text.count("\n", 0, token.start()) + 1
            lines.update(range(first, first + token[0].count("\n") + 1))
    return lines


@dataclasses.dataclass
class Scope:
    kind: str  # "namespace", "class" or "file"
    name: str  # "" has none
    line: int
    scopes: list = dataclasses.field(default_factory=list)
    statements: list = dataclasses.field(default_factory=list)  # text and line; bodies and values in braces are {}

    def walk(self, within=()):
        """Every scope with those that it is in, outermost first."""
        yield within, self
        for scope in self.scopes:
            yield from scope.walk((*within, self))


CLASS = re.compile(r"^(?:class|struct|union)\b(?:\s*\[\[.*?\]\])?\s*(?P<name>[\w:]*)[^=()]*$", re.S)
NAMESPACE = re.compile(r"^(?:inline\s+)?namespace\b\s*(?P<name>[\w:\s]*)$")


def without_angles(text):
    """Without template arguments and parameters."""
    before = None
    while before != text:
        before, text = text, re.sub(r"<[^<>;{}]*>", "", text)
    return text


def without_template(head):
    """Without `template <…>` and `requires` in front of what is declared, and without labels of access."""
    head = re.sub(r"^(?:\s*(?:public|private|protected)\s*:(?!:))+", "", head).strip()
    while head.startswith("template"):
        head = re.sub(r"^template\s*", "", without_angles(head)).strip()
        head = re.sub(r"^requires\s+[\w:]+\s*(?:\|\|\s*[\w:]+\s*|&&\s*[\w:]+\s*)*(?=\w)", "", head)
    return head


class Parser:
    def __init__(self, text):
        text = blanked(text)
        self.text = re.sub(r"^[ \t]*#(?:[^\n\\]|\\\n|\\.)*", lambda m: re.sub(r"[^\n]", " ", m[0]), text, flags=re.M)
        self.at = 0

    def line(self, at):
        return self.text.count("\n", 0, at) + 1

    def skip_group(self):
        """From an opening brace to behind its closing one."""
        depth = 0
        for brace in re.compile(r"[{}]").finditer(self.text, self.at):
            depth += 1 if brace[0] == "{" else -1
            if depth == 0:
                self.at = brace.end()
                return
        self.at = len(self.text)

    def is_body(self, head):
        """Of a function: what stands before the brace ends a parameter list or what may follow it."""
        plain = without_angles(head)
        if re.search(r"\)\s*(?:noexcept\s*)?:(?!:)", plain):  # initializers of members
            return head.rstrip()[-1:] in ")}"
        return bool(re.search(r"\)\s*(?:const\b|noexcept\b|override\b|final\b|&|->\s*[\w:&*\s]+|requires\b.*|\s)*$",
                              plain, re.S)) \
            and not re.search(r"(?<![=!<>])=(?!=)", re.sub(r"\([^()]*\)|operator\s*\S+", "", plain))

    def read(self, scope):
        """Fills a scope up to its closing brace."""
        begin, said, depth = self.at, "", 0
        while self.at < len(self.text):
            c = self.text[self.at]
            depth += c in "(["
            depth -= c in ")]"
            if c == "}" and depth == 0:
                self.at += 1
                return
            if c == ";" and depth == 0:
                self.declare(scope, said, begin)
                self.at += 1
                begin, said = self.at, ""
                continue
            if c != "{":
                said += c
                self.at += 1
                continue
            if depth > 0:
                self.skip_group()
                said += "{}"
                continue
            inner = self.inner(said.strip(), begin)
            if inner:
                self.at += 1
                self.read(inner)
                scope.scopes.append(inner)
                begin, said = self.at, "struct " if inner.kind == "class" else ""
                continue
            body = self.is_body(said)
            self.skip_group()
            if body:
                self.declare(scope, said + "{}", begin)
                begin, said = self.at, ""
            else:
                said += "{}"

    def inner(self, head, begin):
        line = self.line(begin + len(self.text[begin:]) - len(self.text[begin:].lstrip()))
        if re.match(r'^extern\s*$', head):
            return Scope("namespace", "", line)
        space = NAMESPACE.match(head)
        if space:
            return Scope("namespace", re.sub(r"\s*inline\s+", "", space["name"]).strip() or "(anonymous)", line)
        kind = CLASS.match(without_angles(without_template(head)))
        return Scope("class", kind["name"] or "(anonymous)", line) if kind else None

    def declare(self, scope, said, begin):
        text = re.sub(r"\s+", " ", said).strip()
        if text and text != "struct":
            scope.statements.append((text, self.line(begin + len(self.text[begin:]) - len(self.text[begin:].lstrip()))))


def parse(text):
    parser = Parser(text)
    file = Scope("file", "", 1)
    while parser.at < len(parser.text):
        parser.read(file)
    return file


NO_MEMBER = re.compile(
    r"^(?:using|typedef|friend|static_assert|template|enum|operator|explicit|virtual|static|inline static|constexpr "
    r"static|concept"
    r"|requires|namespace)\b|^(?:class|struct|union) [\w:]+$|^~")


def members_of(statement):
    """Data members that a statement of a class declares; static ones are no state."""
    text = without_angles(without_template(statement))
    text = re.sub(r"\[\[.*?\]\]|\balignas\([^()]*\)|\bdecltype\([^()]*\)", "", text).strip()
    text = re.sub(r"^enum [\w :]*\{\} (?=\w)", "int ", text)  # enum Kind {…} kind
    if not text or NO_MEMBER.match(text):
        return 0
    text = re.sub(r"\(\s*\*\s*(\w+)\s*\)\s*\([^()]*\)", r" \1", text)  # a pointer to a function
    before = None
    declared = re.split(r"(?<![=!<>])=(?!=)|\{", text, maxsplit=1)[0]
    if "(" in declared or re.search(r"\boperator\b", declared):
        return 0
    while before != text:
        before, text = text, re.sub(r"\([^()]*\)|\{[^{}]*\}|\[[^\[\]]*\]", "", text)
    return text.count(",") + 1


def names_of(scope):
    """What a namespace declares directly, each name once."""
    names = {inner.name.split("::")[-1] for inner in scope.scopes if inner.kind == "class"
             and inner.name != "(anonymous)"}
    for statement, _ in scope.statements:
        text = without_angles(without_template(statement))
        text = re.sub(r"\[\[.*?\]\]", "", text).strip()
        if re.match(r"^(?:static_assert|namespace|friend)\b|^using namespace\b", text):
            continue
        word = re.match(r"^(?:using|enum class|enum struct|enum|concept|class|struct|union)\s+(?:[\w]+::)*(\w+)", text)
        if word:
            names.add(word[1])
            continue
        declared = re.split(r"(?<![=!<>])=(?!=)|\{", text, maxsplit=1)[0]
        function = re.search(r"(?:^|[\s&*])(~?[\w:]+|operator\s*\S+?)\s*\(", declared)
        variable = re.search(r"(\w+)\s*(?:\[[^\]]*\])?\s*$", declared)
        name = function[1] if function else variable[1] if variable else ""
        if name and "::" not in name:
            names.add(name.replace(" ", ""))
    return names
