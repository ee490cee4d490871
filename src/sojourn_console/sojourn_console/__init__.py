import sojourn_machine  # noqa: F401 - holds the arithmetic before numpy is loaded
