"""Which verb says which finding: a finding that touches a quantity goes wherever that quantity goes."""

NOISE = {"noise", "N", "B", "K"}
OF_A_CURVE = NOISE | {"values", "time", "rate", "scale"}
# What each verb prints, of what findings change.
PRINTS = {
    "inspect": OF_A_CURVE | {"mean"},
    "allan": OF_A_CURVE,
    "psd": OF_A_CURVE,
    "fit": OF_A_CURVE,
    "characterize": OF_A_CURVE | {"mean", "verdict"},
    "page": OF_A_CURVE | {"mean", "verdict"},
    "model file": OF_A_CURVE | {"mean"},
    "export": OF_A_CURVE,
    "model": OF_A_CURVE,
    "plot": OF_A_CURVE,
    "compare": OF_A_CURVE,
    "lot": OF_A_CURVE,
    "simulate": OF_A_CURVE,
    "convert": {"values", "time", "rate", "scale"},
}
# Findings whose option belongs to one verb, and what that verb is told.
OF_ANOTHER_VERB = {
    "stamps_apart": ("replay", "--sensors", "A,B"),
}
# Errors of `plot` behind which nothing is drawn.
NO_FIGURE = {"E0976": "no figure: unlike units share no axis", "E0984": "no figure: too many curves"}
READS = ("inspect", "allan", "psd", "fit", "characterize", "page", "convert")  # the log itself
WEIGHS = ("export", "plot", "compare", "lot", "simulate")  # say what is doubtful, not what is worth knowing
# Severities that a maker chooses beside that of the table.
OTHER_SEVERITIES = {
    "constant": {"bad"},  # of a channel without a fit
    "counter": {"bad"},  # likewise
    "repeated_samples": {"bad"},  # above one per cent
    "time_unit_guessed": {"caution"},  # another unit is as usual
    "motion": {"bad"},  # more than a tenth of N
    "interpolated": {"bad"},  # more than a hundredth of the samples
    "stuck": {"bad"},  # more than a hundredth of the samples
    "not_gravity": {"caution"},  # gravity taken out: nothing says a factor
    "not_earth_field": {"bad"},  # no magnetometer reads so much
    "slow_channel": {"bad"},  # in the grid of the table
    "spikes_left_out": {"caution"},  # more than a thousandth of the samples
    "spikes_kept": {"caution"},  # too many
    "lines_left_out": {"caution"},  # in the Allan curve
    "moves_throughout": {"caution"},  # or a low-pass with other noise behind it
    "staircase": {"note"},  # rounding that N is without
    "undetermined": {"caution"},  # of N
    "not_stationary": {"note"},  # less than is noticeable
    "simulation_disagrees": {"bad"},  # by more than a few per cent
}


def why_not(made, verb, severity, effects):
    """A clause where the finding does not matter to the verb; "" where the verb has to say it."""
    if verb in made.not_in:
        return made.not_in[verb]
    if verb in READS and made.made_by == "reading":
        return ""  # what a reader found or did is said by whoever reads
    if verb == "inspect":
        return "" if made.made_by == "samples" else "inspect fits nothing"
    if verb in ("characterize", "page"):
        return ""  # all that is known
    if verb == "convert":
        return "convert copies the samples and computes nothing from them"
    if verb == "allan" and made.made_by == "curve":
        return ""
    if verb == "psd" and made.made_by == "curve":
        return "the spectrum shows it"
    if verb in ("allan", "psd") and made.made_by == "fit":
        return "it is found by the fit, which a curve does not make"
    if verb == "fit" and made.made_by in ("fit", "curve"):
        return ""
    if verb in WEIGHS and severity == "note":
        return "the numbers hold"
    if not effects & PRINTS[verb]:
        return "it changes nothing that the verb prints"
    return ""
