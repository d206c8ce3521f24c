"""An input for every code of libchar/core/findings.tsv: the record and the command that raise it.

tests/cli/finding_travels.py runs them."""
import pathlib
import sys

sys.dont_write_bytecode = True

from . import arrays, binaries, documents, fits, flight, ros, samples, stamps, tables  # noqa: E402

PARTS = {"tables": tables.INPUTS, "stamps": stamps.INPUTS, "recorders": ros.INPUTS | flight.INPUTS | binaries.INPUTS,
         "samples": samples.INPUTS,
         "fits": fits.INPUTS, "arrays": arrays.INPUTS | documents.INPUTS}
ALL = {code: made for part in PARTS.values() for code, made in part.items()}

# For which no input can be made, each with its reason.
WITHOUT = {
    "not_converged": "no record is known for which the search stops early",
}


def table(root):
    """code: severity, effects (quantity names) of every row."""
    lines = (pathlib.Path(root) / "libchar/core/findings.tsv").read_text().splitlines()
    rows = [line.split("\t") for line in lines if not line.startswith("#")]
    return {row[0]: (row[1], {effect.split(":")[0] for effect in row[5].split(", ") if effect}) for row in rows}


def unmatched(codes):
    """What is wrong with the inputs of these codes: none, or for a code that is not there."""
    here = "tests/cli/finding_inputs"
    faults = [f"{here}: no input raises `{code}`" for code in codes if code not in ALL and code not in WITHOUT]
    faults += [f"{here}: `{code}` is no code" for code in [*ALL, *WITHOUT] if code not in codes]
    return faults + [f"{here}: `{code}` has an input and a reason for none" for code in ALL if code in WITHOUT]
