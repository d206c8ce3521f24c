"""What is known to be wrong, and to be mended: a cell of these has to fail, and is taken out when it is mended."""

# verb, how, why it fails, codes
KNOWN = [
    ("replay of its model", ("text",), "replay weighs by models and says nothing of what is known of them",
     "slow_channel"),
    ("fit", ("JSON",), "the document holds what the fit found, not what is judged of the channel",
     "counter no_value"),
    ("lot", ("JSON",), "a lot neither counts nor lists findings",
     "constant moves_throughout"),
    ("plot", ("text",), "plot says nothing of what it draws",
     "counter looks_transposed"),
    ("psd", ("JSON", "text"), "psd does not look at the quality of the samples",
     "no_value"),
    ("remedy", ("remedy of psd",), "a rate that leaves no samples together",
     "uneven_stamps"),
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
