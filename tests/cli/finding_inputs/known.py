"""What is known to be wrong, and to be mended: a cell of these has to fail, and is taken out when it is mended."""

# verb, how, why it fails, codes
KNOWN = [
    ("replay of its model", ("JSON", "text"), "replay weighs by models and says nothing of what is known of them",
     "allan_disagrees backward_timestamp bursts checksum clock_change coarse_resolution dead_band digital_misfit "
     "dropout duplicate_timestamp events_left_in float_step frequency_mean held_values high_passed hump "
     "looks_transposed misfit missing_mark missing_samples motion much_saturated not_gravity not_stationary "
     "outliers_in_n phase_wraps power_law quantization_limited rail rate_change saturated simulation_disagrees "
     "slow_channel spikes_kept spiky staircase strength_change stuck uneven_sampling wild_stamp"),
    ("compare", ("JSON",), "compare says nothing of what it compares",
     "backward_timestamp bursts checksum clock_change dropout duplicate_timestamp implausible_magnitude "
     "looks_transposed rate_change uneven_sampling wild_stamp"),
    ("compare", ("text",), "compare says nothing of what it compares",
     "backward_timestamp bursts checksum clock_change dropout duplicate_timestamp implausible_magnitude "
     "looks_transposed rate_change slow_channel uneven_sampling wild_stamp"),
    ("fit", ("JSON",), "the document holds what the fit found, not what is judged of the channel",
     "counter no_value"),
    ("lot", ("JSON",), "a lot neither counts nor lists findings",
     "allan_disagrees coarse_resolution constant counter dead_band digital_misfit events_left_in float_step "
     "frequency_mean held_values high_passed hump misfit missing_mark missing_samples motion moves_throughout "
     "much_saturated no_value not_gravity not_stationary outliers_in_n phase_wraps power_law quantization_limited "
     "rail saturated simulation_disagrees spikes_kept spiky staircase strength_change stuck"),
    ("plot", ("text",), "plot says nothing of what it draws",
     "backward_timestamp bursts checksum clock_change counter dropout duplicate_timestamp implausible_magnitude "
     "looks_transposed rate_change slow_channel uneven_sampling wild_stamp"),
    ("psd", ("JSON", "text"), "psd does not look at the quality of the samples",
     "no_value"),
    ("remedy", ("next",), "the next line does not run",
     "looks_transposed"),
    ("remedy", ("next of inspect",), "the next line does not run",
     "looks_transposed phase_wraps"),
    ("remedy", ("remedy",), "the document has an option that the terminal does not print",
     "slow_channel"),
    ("remedy", ("remedy of psd",), "a rate that leaves no samples together",
     "uneven_stamps"),
    ("sentence", ("text",), "a number with an exponent",
     "frequency_mean implausible_magnitude"),
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
