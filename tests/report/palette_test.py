"""The colours of methods and of sensors on a replay's page can be told apart by readers who miss a kind of
cone, on white and on dark paper.

usage: palette_test.py PAGE_COMMON_JS
Distances are those of Oklab (Ottosson 2020) times 100, between any two colours of a palette and from the ink,
as seen with normal sight and without one kind of cone (Machado, Oliveira and Fernandes 2009); marks stand out
from the paper by 3 : 1 (WCAG 2.1, 1.4.11).
"""
import itertools
import re
import sys

SIGHT = {
    "normal sight": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "protanopia": ((0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216), (-0.003882, -0.048116, 1.051998)),
    "deuteranopia": ((0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413), (-0.011820, 0.042940, 0.968881)),
    "tritanopia": ((1.255528, -0.076749, -0.178779), (-0.078411, 0.930809, 0.147602), (0.004733, 0.691367, 0.303900)),
}
TO_CONES = ((0.4122214708, 0.5363325363, 0.0514459929), (0.2119034982, 0.6806995451, 0.1073969566),
            (0.0883024619, 0.2817188376, 0.6299787005))
TO_LAB = ((0.2104542553, 0.7936177850, -0.0040720468), (1.9779984951, -2.4285922050, 0.4505937099),
          (0.0259040371, 0.7827717662, -0.8086757660))
LEAST = {"methods": 12, "sensors": 8}


def times(matrix, vector):
    return [sum(m * v for m, v in zip(row, vector)) for row in matrix]


def linear(colour):
    parts = [int(colour[i:i + 2], 16) / 255 for i in (1, 3, 5)]
    return [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]


def lab(rgb):
    cones = times(TO_CONES, [min(1, max(0, v)) for v in rgb])
    return times(TO_LAB, [max(0, v) ** (1 / 3) for v in cones])


def distance(a, b, sight):
    x, y = (lab(times(sight, linear(c))) for c in (a, b))
    return 100 * sum((p - q) ** 2 for p, q in zip(x, y)) ** 0.5


def contrast(a, b):
    low, high = sorted(sum(w * v for w, v in zip((0.2126, 0.7152, 0.0722), linear(c))) for c in (a, b))
    return (high + 0.05) / (low + 0.05)


def main():
    script, wrong, seen = open(sys.argv[1], encoding="utf-8").read(), [], 0
    for paper_name in ("LIGHT", "DARK"):
        block = re.search(r"const " + paper_name + r" = \{(.*?)\n  \};", script, re.S).group(1)
        paper, ink = (re.search(name + r': "(#[0-9a-f]{6})"', block).group(1) for name in ("paper", "ink"))
        for palette, least in LEAST.items():
            colours = re.findall(r"#[0-9a-f]{6}", re.search(palette + r": \[(.*?)\]", block).group(1))
            for (a, b), (name, sight) in itertools.product(itertools.combinations(colours + [ink], 2), SIGHT.items()):
                seen += 1
                if distance(a, b, sight) < least:
                    wrong.append(f"{paper_name} {palette}: {a} and {b} are {distance(a, b, sight):.1f} apart with "
                                 f"{name}, less than {least}")
            wrong += [f"{paper_name} {palette}: {c} has a contrast of {contrast(c, paper):.2f} with the paper"
                      for c in colours if contrast(c, paper) < 3]
    # The check itself: red and green of one lightness are far apart, and not without a cone.
    assert distance("#d05050", "#50a050", SIGHT["normal sight"]) > 20 > 10 > distance("#c96a4a", "#8f8f3f",
                                                                                      SIGHT["protanopia"])
    print("\n".join(wrong) or f"palettes: {seen} pairs are far enough apart")
    return 1 if wrong or seen < 300 else 0


sys.exit(main())
