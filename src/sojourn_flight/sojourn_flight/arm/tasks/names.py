"""Names of the arm's tasks, for those who only name them; `requests` has what each asks for."""

TASK_NAMES = (
    "unfold", "stow", "place", "tare", "guarded_move", "hold_force", "dig", "dump", "weigh", "pause", "resume", "drill",
    "pick", "release",
)  # fmt: skip
