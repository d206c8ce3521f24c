"""Questions, and the one function that answers each. Another spelling of its answer is refused outside of the
owner's file.

A row that others still spell has ceilings in ceilings.tsv, which only shrink. A new owner takes the old one's
place here.
"""
import dataclasses
import re


@dataclasses.dataclass(frozen=True)
class Question:
    name: str
    owner: str  # "FILE: NAME": the file that may spell it, a name that it defines; "": nobody may
    spelling: str  # in code, literals included, comments not

    def file(self):
        return self.owner.split(":")[0]

    def is_there(self, text):
        return re.search(rf"\b{re.escape(self.owner.split(': ')[1])}\b", text) is not None


QUESTIONS = [
    Question("word of a shell", "libchar/core/text/text.cpp: shell_word", r"'\\\\''"),
    Question("cell of CSV", "libchar/core/text/markup.cpp: csv_cell", r'"\\"\\""'),
    Question("entities of HTML and XML", "libchar/core/text/markup.cpp: markup_entities", r"&(?:amp|lt|gt|quot|#39);"),
    Question("range FROM..TO", "libchar/core/text/quantity_text.cpp: parse_range", r'\bfind\("\.\."\)'),
    Question("number in a text", "libchar/core/text/decimal.cpp: parse_double",
             r"\bstd::sto(?:d|f|i|l|ul|ll)\(|\bstrto(?:d|f|l|ll|ul)\(|\bato[fil]\("),
    Question("length of time in words", "libchar/core/text/readable.cpp: duration_text",
             r'\} (?:min|h)\b|" (?:min|h)"'),
    Question("digits of a number", "libchar/core/text/readable.cpp: number_text", r"\{\w*:[#+]?(?:\.\d+)?g\}"),
    Question("value in the field's units", "libchar/core/text/term_cells.cpp: term_cells",
             r"\bhabitual_units\((?!std::)"),
    Question("whole number of a real one", "libchar/core/numeric/whole.hpp: clamped_whole",
             r"\bl?l(?:round|rint)\(|"
             r"static_cast<(?!double|float)[\w: ]+>\(std::(?:ceil|floor|round|rint|trunc|pow|exp|log\w*|sqrt)\("),
    # std::lgamma writes the sign to a global: a race between threads.
    Question("logarithm of the gamma function", "libchar/lot/detail/statistics/lognormal_effects.cpp: log_gamma",
             r"\blgamma(?:_r)?\("),
    Question("one or many", "libchar/core/text/text.cpp: plural", r'== 1 \? "" : "s"|\? "s" : ""'),
    Question("nearest word that exists", "libchar/core/text/spelling.cpp: did_you_mean", r'"did you mean'),
    Question("rating of a channel", "libchar/characterize/judgement.cpp: judge",
             r"(?<!== )\bRating::(?:caution|bad)\b"),
    Question("recording in JSON", "libchar/log/recording_json.cpp: recording_json",
             r'"(?:log_format|jitter_s|rows_dropped)"'),
    Question("end of a 95 % interval", "libchar/core/numeric/interval.hpp: kNormal95", r"\b1\.96\b|\b1\.9599"),
    Question("file that is whole or absent", "libchar/core/file/whole_file.cpp: WholeFile",
             r"\bstd::ofstream\b|\bfopen\("),
    # What differs between platforms (libchar/cmake/libchar_platform.cmake) has one place each.
    Question("threads", "libchar/core/parallel/threads.cpp: over_ranges", r"\btbb::|<tbb/"),
    Question("SHA-256", "libchar/core/file/sha256_openssl.cpp: Sha256", r"\bEVP_\w+\(|<openssl/"),
    # No code searches a sentence that the program itself made: what it means is data.
    Question("what a sentence means", "",
             r'\brfind\("[a-z]+ ", 0\)|\bstarts_with\("[A-Z][a-z]+ [^"]*"\)|\.find\("published"\)'
             r"|substr\((\w+)\.find\('\['\)\)"
             r"|\.(?:sentence|phrase|why|verdict|title|statistic)\.(?:find|rfind|starts_with|ends_with|contains)\("),
]
