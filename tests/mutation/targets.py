"""Who else should notice a broken floor: the floors whose tests run after its own, in order."""
USERS = {
    "core": ["model", "log", "fusion"],
    "export": ["model"],
    "fit": ["characterize"],
    "log": ["characterize"],
    "lot": ["fleet"],
    "model": ["export"],
    "scene": ["replay"],
    "simulate": ["scene"],
}
