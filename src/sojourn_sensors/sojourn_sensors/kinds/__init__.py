"""The kinds of sensors that come with Sojourn, one a module."""
