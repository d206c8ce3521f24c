"""What is known to be wrong, and to be mended: a cell of these has to fail, and is taken out when it is mended."""

# verb, how, why it fails, codes
KNOWN = [
]


ASKED = set()


def text_of(code, verb, how):
    """Why this cell fails; "" where it has to hold."""
    ASKED.add((code, verb, how))
    for verb_, how_, text, codes in KNOWN:
        if verb == verb_ and how in how_ and code in codes.split():
            return text
    return ""


def stale(done):
    """Cells of these codes that stand here and that nobody asked for."""
    listed = {(code, verb, how) for verb, hows, _, codes in KNOWN for how in hows for code in codes.split()}
    return sorted(cell for cell in listed - ASKED if cell[0] in done)
