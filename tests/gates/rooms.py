"""Which headers are public: those of a floor and of its rooms, but for the folders that belong to their floor alone:
`detail`, and the rooms of one kind each behind the table of a floor. libchar/CMakeLists.txt installs the same."""
import re

PRIVATE = re.compile(r"^libchar/(?:.*/detail|log/(?:arrays|binary|csv|flight|ros|tables|time|topics|write)"
                     r"|fusion/algorithms"
                     r"|export/targets|fleet/engines)/")


def is_public(path):
    return path.startswith("libchar/") and not PRIVATE.match(path)
