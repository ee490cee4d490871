"""Texts that somebody else has said, as they may be shown on a terminal."""

REPLACED = "\N{REPLACEMENT CHARACTER}"


def shown(text: str) -> str:
    """The text without control characters, which would command the terminal: a heartbeat that anybody may send could
    clear the screen, or write over what stands there. Ends of lines stay.
    """
    if text.isprintable():
        return text
    return "".join(each if each.isprintable() or each == "\n" else REPLACED for each in text)
