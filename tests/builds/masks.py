"""What compare_builds.py does not compare: measured times and memory, the version's commit, folders, names
made of digests."""
import re

# A number, a list of numbers, or a figure with its interval.
VALUE = r'": *(\{[^{}]*\}|\[[^\]]*\]|[^,}\n]*)'
KEYS = ("seconds|ns_per_[a-z_0-9]+|peak_bytes|bytes_per_second|own_bytes|resident_bytes|learning_s|run_s|expected_s"
        "|expected_bytes|seconds_left|front_gap|time_ratio|machine|exponent")
ALWAYS = [
    (re.compile(f'"({KEYS}){VALUE}'), r'"\1": MASKED'),
    (re.compile(r'"build": *"[^"]*"'), '"build": MASKED'),
    (re.compile(r"^(sensorchar \S+) \(.*\)$", re.M), r"\1"),
    (re.compile(r"(written by sensorchar \S+) \(.*\)$", re.M), r"\1"),
    # of a page that says by which build it was made
    (re.compile(r'("[a-z]+\.(html|md)"): *"[0-9a-f]{64}"'), r"\1: MASKED"),
    (re.compile(r'"measured": *\{[^{}]*\}', re.S), '"measured": MASKED'),
    (re.compile(r"^[WE]\d{8} [\d:.]+ +\d+ ", re.M), "W "),  # a warning of Ceres: time and thread
]
# Replays and fleets measure time and memory, and show them in many ways.
OF_TIMES = [
    (re.compile(r"\b[\d.]+ (ns|µs|ms|s)\b"), "# s"),
    (re.compile(r"\b[\d.]+ (B|kB|MB|GB)\b"), "# B"),
    (re.compile(r'data-value="[^"]*">[^<]*'), 'data-value="">#'),  # report.json has the same numbers
    (re.compile(r"(%|-|x) +[\d.e+]+ +# (B|kB|MB|GB) *\*? *"), r"\1 # # "),
    (re.compile(r"Of these \S+ is the cheapest"), "Of these # is the cheapest"),
    (re.compile(r"fronts?: [a-z, ]*"), "fronts: "),
    (re.compile(r'("pareto_front"|"front[a-z_]*"): *(\{[^{}]*\}|\[[^\[\]]*\]|\w+)'), r"\1: MASKED"),
]
TIMED_VERBS = {"replay", "compare", "fleet", "bench"}
NUMBER = re.compile(r"-?\d+\.?\d*(?:e[+-]?\d+)?")
OF_FLEETS = [
    (re.compile(r"\babout [\d.]+ (min|h)\b"), "about # s"),
    # Digests of what holds a folder's whole path: a plan, records, tables of a lot. What they are of is compared.
    (re.compile(r"\b[0-9a-f]{64}\b"), "DIGEST"),
    (re.compile(r"\b[0-9a-f]{2}/(UNIT\d+)"), r"\1"),
    (re.compile(r"'<U\d+'"), "'<U#'"),
]


def masked(text, run):
    verb = run.words[0]
    masks = ALWAYS + (OF_TIMES if verb in TIMED_VERBS else []) + (OF_FLEETS if verb == "fleet" else [])
    for pattern, to in masks:
        text = pattern.sub(to, text)
    return re.sub(r" +", " ", NUMBER.sub("#", text)) if run.measured else text
