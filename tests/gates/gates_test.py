"""Every gate of structure.py refuses a tree that was made to offend it, and accepts one that was not: a gate
that can be passed by anything is none. usage: gates_test.py"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

TESTS = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(TESTS))
import structure  # noqa: E402
import words  # noqa: E402
from gates import cpp  # noqa: E402
from gates.owners import QUESTIONS  # noqa: E402

SPELLINGS = {
    "whole number of a real one": "auto n = static_cast<std::size_t>(std::floor(x));",
    "threads": "tbb::parallel_for(0, n, work);",
    "SHA-256": "EVP_DigestFinal_ex(context, digest, &size);",
    "word of a shell": r"""out += "'\\''";""",
    "cell of CSV": r'''out += std::string("\"\"");''',
    "entities of HTML and XML": 'out += "&lt;";',
    "range FROM..TO": 'const std::size_t dots = text.find("..");',
    "number in a text": "return std::stod(text);",
    "length of time in words": 'return fmt::format("{:.1f} min", seconds / 60);',
    "digits of a number": 'return fmt::format("jitter {:.2g} us", jitter);',
    "value in the field's units": "for (const HabitualValue& habit : habitual_units(key, unit)) add(habit);",
    "logarithm of the gamma function": "const double y = std::lgamma(x);",
    "one or many": 'return n == 1 ? "" : "s";',
    "nearest word that exists": 'return "did you mean " + word;',
    "rating of a channel": "channel.rating = Rating::caution;",
    "recording in JSON": 'out["jitter_s"] = jitter;',
    "end of a 95 % interval": "return mean + 1.96 * sigma;",
    "file that is whole or absent": "std::ofstream out(path);",
    "what a sentence means": 'if (verdict.starts_with("Fusion does not pay")) return;',
}
MEMBERS = """
namespace libchar {
template <class T>
class Many final : public Base<T> {
 public:
  explicit Many(int a) : a_(a), b_{1, 2} {}
  static constexpr int kFree = 1;  // no state
  using Word = int;
  enum class Use { one, two } use = Use::one;
  std::vector<double> rows() const { return {a_, b_}; }
  struct Inner { int x = 0, y = 0; };
  virtual void run(int, double) = 0;
  Many& operator=(const Many&) = delete;

 private:
  std::function<void(int, double)> call;
  std::map<std::string, std::vector<int>> map = make<int, int>(1, 2);
  int a_ = 0, b_[2] = {1, 2}, c{3};
  void (*hook)(int) = nullptr;
  %s
};
}  // namespace libchar
"""


class Gates(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        for question in QUESTIONS:
            if question.owner:
                owners = [q.owner.split(": ")[1] for q in QUESTIONS if q.file() == question.file()]
                self.write(question.file(), "".join(f"int {owner}();\n" for owner in owners))
        self.write("libchar/libchar.hpp", '#include "libchar/fit/fit.hpp"\nnamespace libchar { void fit(); }\n')

    def tearDown(self):
        self.folder.cleanup()

    def write(self, path, text):
        path = self.root / path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def refused(self, gate, key, ceilings=None):
        faults = list(structure.faults_of(structure.measured(self.root), ceilings or {}))
        self.assertEqual(len(faults), 1, faults)
        self.assertTrue(faults[0].startswith(f"{gate}: {key}: "), faults)
        return faults[0]

    def accepted(self, ceilings=None):
        self.assertEqual(list(structure.faults_of(structure.measured(self.root), ceilings or {})), [])

    def test_clean(self):
        self.accepted()

    def test_members(self):
        self.write("libchar/fit/many.hpp", MEMBERS % "int d, e, f, g, h, i, j, k, l, m, n, o, p;")
        self.accepted()  # 7 above and 13 are 20
        self.write("libchar/fit/many.hpp", MEMBERS % "int d, e, f, g, h, i, j, k, l, m, n, o, p;\n  bool last = a < b;")
        self.assertIn("21 data members", self.refused("members", "libchar/fit Many"))

    def test_files(self):
        for k in range(24):
            self.write(f"tools/verbs/verb{k}.cpp", "")
        self.accepted()
        self.write("tools/verbs/one_more.hpp", "")
        self.refused("files", "tools/verbs")

    def test_names(self):
        body = "".join(f"int f{k}(int);\nint f{k}(double);\n" for k in range(299))
        self.write("libchar/fit/names.hpp", f"namespace libchar {{ {body} namespace detail {{ int g(); }} }}")
        self.accepted()  # with libchar::fit 300; overloads and detail do not count
        for more in ("struct More;", "using More = int;", "enum class More { a };", "inline constexpr int kMore = 1;",
                     "template <class T> concept More = true;", "std::vector<int> more(int a = f(1));"):
            self.write("libchar/fit/more.hpp", f"namespace libchar {{\n{more}\n}}\n")
            self.refused("names", "libchar")

    def test_top(self):
        self.write("README.md", "")
        self.write("curves.npy", "")
        self.write(".gitignore", "")
        for words in (["init", "-q"], ["add", "README.md", ".gitignore"]):
            subprocess.run(["git", "-C", self.root, *words], check=True)
        self.accepted()  # what is not kept is nobody's
        subprocess.run(["git", "-C", self.root, "add", "-f", "curves.npy"], check=True)
        self.refused("top", "curves.npy")

    def test_twice(self):
        self.write("libchar/fit/one.hpp", "namespace libchar { struct One { int a; }; struct Two; }")
        self.write("libchar/fit/two.cpp", "namespace libchar { namespace { struct One { int b; }; } struct Two {}; }")
        self.accepted()
        self.write("libchar/log/one.hpp", "namespace libchar { struct One { int b; }; }")
        self.refused("twice", "libchar::One")

    def test_eigen(self):
        self.write("libchar/core/numeric/dense.hpp", "#include <Eigen/Core>\n")
        self.accepted()
        self.write("libchar/fit/fit.hpp", '#include "libchar/core/numeric/dense.hpp"\n')
        self.refused("eigen", "libchar/core/numeric/dense.hpp")

    def test_columns(self):
        self.write("libchar/fit/url.hpp", "// https://example.org/" + "a" * 120 + "\n")
        self.write("tests/raw_test.cpp", 'const char* text = R"(' + "a" * 120 + ')";\n')
        self.write("tests/page.py", 'page = """\n' + "a" * 121 + '"""\n')
        self.accepted()
        for path, line in (("libchar/fit/wide.hpp", "// " + "a" * 118), ("tools/wide.cpp", "int a" + "a" * 116 + ";"),
                           ("tests/fit/wide.py", '"""' + "a" * 118 + '"""')):
            self.write(path, line + "\n")
            self.refused("columns", structure.floor_of(path))
            (self.root / path).unlink()

    def test_tests(self):
        self.write("tests/fit/one_test.cpp", 'TEST_CASE("fit: a, b: c") { int d; }\n')
        self.accepted()
        self.write("tests/fit/one_test.cpp", 'TEST_CASE(\n    "fit: a \\"b\\", "\n    "c; d") {}\n')
        self.refused("test", "tests/fit/one_test.cpp")

    def test_every_question_has_a_spelling_here(self):
        self.assertEqual(sorted(SPELLINGS), sorted(question.name for question in QUESTIONS))

    def test_questions(self):
        for question in QUESTIONS:
            line = SPELLINGS[question.name]
            self.write("libchar/replay/other.cpp", f"// {line}\nvoid f() {{\n  {line}\n}}\n")
            fault = self.refused("owner", f"{question.name}: libchar/replay")
            self.assertIn(" 1 spellings", fault)  # a comment is none
            self.assertIn("libchar/replay/other.cpp:3", fault)
        (self.root / "libchar/replay/other.cpp").unlink()
        question = next(q for q in QUESTIONS if [o.file() for o in QUESTIONS].count(q.file()) == 1)  # alone there
        self.write(question.file(), f"int {question.owner.split(': ')[1]}();\n{SPELLINGS[question.name]}\n")
        self.accepted()
        self.write(question.file(), "// moved\n")
        self.assertIn("is not there", self.refused("owner", question.name))

    def test_ceilings(self):
        self.write("libchar/fit/wide.hpp", ("// " + "a" * 118 + "\n") * 3)
        key = "columns", "libchar/fit"
        self.accepted({key: (3, "old")})
        self.assertIn("at most 2", self.refused(*key, {key: (2, "old")}))
        self.assertIn("lower it", self.refused(*key, {key: (4, "old")}))
        self.assertIn("no reason", self.refused(*key, {key: (3, " ")}))
        self.assertIn("not needed", self.refused("columns", "tools",
                                                 {key: (3, "old"), ("columns", "tools"): (1, "gone")}))
        self.assertIn("no such gate", self.refused("colums", "tools", {key: (3, "old"), ("colums", "tools"): (1, "?")}))

    def test_lower(self):
        self.write("libchar/fit/wide.hpp", "// " + "a" * 118 + "\n")
        path = self.root / "ceilings.tsv"
        path.write_text("# head\ncolumns\tlibchar/fit\t3\told\ncolumns\ttools\t1\tgone\n")
        structure.lower(path, structure.measured(self.root))
        self.assertEqual(path.read_text(), "# head\ncolumns\tlibchar/fit\t1\told\n")
        path.write_text("columns\tlibchar/fit\t0\ttoo low\n")
        structure.lower(path, structure.measured(self.root))
        self.assertEqual(path.read_text(), "columns\tlibchar/fit\t0\ttoo low\n")  # it raises nothing

    def test_program(self):
        self.write("libchar/fit/wide.hpp", "// " + "a" * 118 + "\n")
        ran = subprocess.run([sys.executable, TESTS / "structure.py", self.root], capture_output=True, text=True)
        self.assertEqual(ran.returncode, 1)
        self.assertIn("columns: libchar/fit: ", ran.stdout)

    def test_reader(self):
        tree = cpp.parse('namespace a::b {\nextern "C" int f();  // };\nconst char* s = "}{";\nstruct S '
                         '{ char c = \'{\'; };\n}\n')
        found = [("::".join(s.name for s in (*within, scope)), scope.line) for within, scope in tree.walk()]
        self.assertEqual(found, [("", 1), ("::a::b", 1), ("::a::b::S", 4)])


class Words(unittest.TestCase):
    """Sentences as they were, and sentences of the same kind that are right."""

    def found(self, text, rules=words.RULES):
        return [name for name, *_ in words.hits(words.prose_of_page(text), rules, page=True)]

    def test_refused(self):
        for rule, text in (("per", "one `CHANNEL.sensor.yaml` a channel."), ("per", "deviations, a flag a sensor"),
                           ("per", "a column a number, all digits"), ("per", "ten averaging times\na decade"),
                           ("per", "41 ns a sample"), ("whom", "the device whom the mean is of"),
                           ("is none", "a picture of 9000 pixels is none that can be drawn"),
                           ("is no", "the record is no noise"), ("has not", "a channel that the recording has not,"),
                           ("that there is", "the figures that there are"), ("told", "not told from another term"),
                           ("stands", "the log in which it stands"), ("beside", "the folder beside it"),
                           ("of which", "an array of which more is to be said"), ("exponent", "agrees to 1e-12"),
                           ("digits", "regret 26070.09 %"), ("long", "word " * 29 + "."),
                           ("long", "| cell | " + "word " * 29 + "|"), ("long", "half a word, " * 7 + "and so; " * 10)):
            self.assertIn(rule, self.found(text), text)
        self.assertEqual(self.found("rows to skip? (default: 0)", [words.QUESTION]), ["question"])

    def test_accepted(self):
        for text in ("one file per channel", "a file in a folder", "a scene names a file", "There is no gap.",
                     "empty where there is none", "when it took a channel out",
                     "It is no longer used.", "It has not changed.", "letters stand for axes", "`told` and 0.24 deg/√h",
                     "```sh\nallan --taus 1e-3\n```", "| 1e-12 | 0.004021 |", "one second a minute later",
                     "word " * 28 + ". " + "word " * 28, "- " + "word " * 28 + "\n- " + "word " * 28,
                     "a key: " + "`code`, 12, " * 30):
            self.assertEqual(self.found(text), [], text)

    def test_sources(self):
        strings = words.strings('f("a line "\n"a sensor"); // told\nchar c = \'"\'; g(R"(it stands here)");')
        self.assertEqual(strings, [(1, "a line a sensor"), (3, "it stands here")])
        self.assertEqual(words.comments("/// one\n/// two\nint a;  ///< three\n"), [[1, " one\n two"], [3, " three"]])


if __name__ == "__main__":
    unittest.main()
