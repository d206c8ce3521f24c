"""What is known to be wrong, and to be mended: a cell of these has to fail, and is taken out when it is mended."""

# verb, how, why it fails, codes
KNOWN = [
    ("replay of its model", ("JSON", "text"), "replay weighs by models and says nothing of what is known of them",
     "allan_disagrees backward_timestamp bursts checksum clock_change coarse_resolution dead_band digital_misfit "
     "dropout duplicate_timestamp events_left_in float_step frequency_mean held_values high_passed hump "
     "looks_transposed misfit missing_mark missing_samples motion much_saturated not_gravity not_stationary "
     "outliers_in_n phase_wraps power_law quantization_limited rail rate_change saturated simulation_disagrees "
     "slow_channel spikes_kept spiky staircase strength_change stuck uneven_sampling wild_stamp"),
    ("allan", ("JSON",), "what is found in samples is a line on stderr, and not in the document",
     "coarse_resolution constant counter dead_band float_step frequency_mean missing_mark much_saturated no_value "
     "not_gravity phase_wraps quantization_limited saturated stuck"),
    ("allan", ("text",), "gravity is judged where the quality is asked for, which it is not",
     "not_gravity"),
    ("compare", ("JSON", "text"), "compare says nothing of what it compares",
     "allan_disagrees backward_timestamp bursts checksum clock_change coarse_resolution constant counter dead_band "
     "digital_misfit dropout duplicate_timestamp events_left_in float_step frequency_mean held_values high_passed "
     "hump implausible_magnitude looks_transposed misfit missing_mark missing_samples motion moves_throughout "
     "much_saturated no_value not_gravity not_stationary outliers_in_n phase_wraps power_law quantization_limited "
     "rail rate_change saturated simulation_disagrees slow_channel spikes_kept spiky staircase strength_change stuck "
     "uneven_sampling wild_stamp"),
    ("export", ("comment",), "what the reader found does not reach the export",
     "backward_timestamp bursts clock_change dropout duplicate_timestamp rate_change uneven_sampling wild_stamp"),
    ("fit", ("JSON",), "the document holds what the fit found, not what is judged of the channel",
     "allan_disagrees coarse_resolution counter dead_band float_step frequency_mean held_values lines_left_out "
     "missing_mark missing_samples motion much_saturated no_value not_gravity phase_wraps quantization_limited rail "
     "reaches_zero saturated spikes_left_out spiky staircase strength_change stuck undetermined"),
    ("fit", ("text",), "the text holds what the fit found, not what is judged of the channel",
     "allan_disagrees events_left_in lines_left_out missing_samples not_gravity reaches_zero undetermined"),
    ("fusion.yaml", ("YAML",), "what an algorithm remarks does not reach what was learnt",
     "fault_watch_stood_down faults_ambiguous faults_not_watched input_repeats variances_not_identifiable"),
    ("lot", ("JSON",), "a lot neither counts nor lists findings",
     "allan_disagrees coarse_resolution constant counter dead_band digital_misfit events_left_in float_step "
     "frequency_mean held_values high_passed hump misfit missing_mark missing_samples motion moves_throughout "
     "much_saturated no_value not_gravity not_stationary outliers_in_n phase_wraps power_law quantization_limited "
     "rail saturated simulation_disagrees spikes_kept spiky staircase strength_change stuck"),
    ("model", ("text",), "the table of a model does not print its findings",
     "allan_disagrees backward_timestamp bursts checksum clock_change coarse_resolution contradicted dead_band "
     "definition_changed digital_misfit drift dropout duplicate_timestamp events_left_in flicker_or_walk float_step "
     "frequency_mean gauss_markov_or_terms held_values high_passed hump looks_transposed lowest_left_out misfit "
     "missing_mark missing_samples motion much_saturated not_gravity not_stationary outliers_in_n phase_wraps "
     "power_law quantization_limited rail rate_change saturated simulation_disagrees slow_channel spikes_kept spiky "
     "staircase strength_change stuck two_scales undetermined uneven_sampling unknown_unit wild_stamp"),
    ("model file", ("YAML",), "what the reader found does not reach the model",
     "backward_timestamp bursts checksum clock_change definition_changed dropout duplicate_timestamp "
     "looks_transposed rate_change two_scales uneven_sampling unknown_unit wild_stamp"),
    ("plot", ("text",), "plot says nothing of what it draws",
     "allan_disagrees backward_timestamp bursts checksum clock_change coarse_resolution constant counter dead_band "
     "digital_misfit dropout duplicate_timestamp events_left_in float_step frequency_mean held_values high_passed "
     "hump implausible_magnitude looks_transposed misfit missing_mark missing_samples motion moves_throughout "
     "much_saturated no_value not_gravity not_stationary outliers_in_n phase_wraps power_law quantization_limited "
     "rail rate_change saturated simulation_disagrees slow_channel spikes_kept spiky staircase strength_change stuck "
     "uneven_sampling wild_stamp"),
    ("psd", ("JSON", "text"), "psd does not look at the quality of the samples",
     "coarse_resolution constant counter dead_band float_step missing_mark much_saturated no_value not_gravity "
     "phase_wraps saturated spiky stuck"),
    ("remedy", ("label of inspect",), "inspect calls every finding of a reader a warning",
     "array_length blank_line broken_index carriage_return_line_ends clock_rollover coarse_stamps comment_line "
     "control_in_name definition_changed formula_name gap jitter late_stamp missing_cell missing_value "
     "mixed_line_ends no_final_newline no_header number_too_small own_rows packets repeated_header rounded_integer "
     "stated_rate too_many_topics trailing_bytes trailing_delimiter two_scales uneven_stamps unknown_message "
     "unknown_unit unnamed_column unused_option zero_stamp"),
    ("remedy", ("beside misfit",), "the judge adds that no coefficient is borne out, though N is",
     "power_law"),
    ("remedy", ("next",), "the next line does not run",
     "looks_transposed slow_channel"),
    ("remedy", ("next of inspect",), "the next line does not run",
     "constant implausible_magnitude looks_transposed phase_wraps"),
    ("remedy", ("remedy of inspect", "remedy of fit", "remedy"), "--channel NAME is printed as it stands",
     "slow_channel"),
    ("remedy", ("remedy of psd",), "--channel NAME as it stands; a rate that leaves no samples together",
     "slow_channel uneven_stamps"),
    ("replay", ("text",), "what an algorithm remarks is in its part of the document and on the page alone",
     "channel_without_signal fault_watch_stood_down faults_ambiguous faults_not_watched input_repeats not_calibrated "
     "variances_not_identifiable"),
    ("sentence", ("text",), "a number with an exponent",
     "frequency_mean implausible_magnitude"),
    ("simulate", ("JSON",), "the findings of the scene are not in the document",
     "recorded_signal_short"),
    ("simulate", ("text",), "simulate says nothing of its model",
     "allan_disagrees backward_timestamp bursts checksum clock_change coarse_resolution dead_band digital_misfit "
     "dropout duplicate_timestamp events_left_in float_step frequency_mean held_values high_passed hump "
     "looks_transposed misfit missing_mark missing_samples motion much_saturated not_gravity not_stationary "
     "outliers_in_n phase_wraps power_law quantization_limited rail rate_change saturated simulation_disagrees "
     "slow_channel spikes_kept spiky staircase strength_change stuck uneven_sampling wild_stamp"),
]


def text_of(code, verb, how):
    """Why this cell fails; "" where it has to hold."""
    for verb_, how_, text, codes in KNOWN:
        if verb == verb_ and how in how_ and code in codes.split():
            return text
    return ""
