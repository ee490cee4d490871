"""What keeps band and buttons in sight: the page's own style, brought by an element without words.

viser puts all of a page into one area that scrolls, and has no place of its own beside it. So band and buttons stick to
the upper edge of that area while the rest passes under them. They are found by marks, elements without words
beside them: what viser calls its elements changes with its version. Each sticks where those above it end, so that
their heights are said here.
"""

PAGE_MARK = "sojourn-page"
BAND_MARK = "sojourn-band"
BUTTONS_MARK = "sojourn-buttons"
BUTTONS_HTML = f'<i class="{BUTTONS_MARK}"></i>'
"""Stands right before STOP and the row of buttons."""
_BAND_REM, _STOP_REM, _ROW_REM = 1.9, 2.3, 2.3
ONE_LINE = "overflow:hidden;text-overflow:ellipsis;white-space:nowrap;line-height:1.9"
_NARROW_PX = 480
"""A telephone held upright: beside the panel nothing of the scene is worth seeing there."""
_STUCK = "position:sticky;z-index:20;box-sizing:border-box;background:var(--mantine-color-body)"
_BUTTON = f"{_STUCK};margin-inline:0!important;padding:.15rem var(--mantine-spacing-xs)!important"

PAGE_STYLE = (
    # An element that cuts off what hangs over holds what sticks, unless it does so by "clip".
    f"div:has(>div>div>div>.{PAGE_MARK}){{overflow:clip!important}}"
    f"div:has(>div>.{PAGE_MARK}){{--band:0rem}}"
    f"div:has(>div>.{BAND_MARK}){{--band:{_BAND_REM}rem}}"
    f"div:has(>.{BAND_MARK}){{{_STUCK};top:0;height:{_BAND_REM}rem;padding-top:.2rem}}"
    f"div:has(>.{BUTTONS_MARK})+div{{{_BUTTON};top:var(--band);height:{_STOP_REM}rem}}"
    f"div:has(>.{BUTTONS_MARK})+div+div{{{_BUTTON};top:calc(var(--band) + {_STOP_REM}rem);height:{_ROW_REM}rem}}"
    f"@media(max-width:{_NARROW_PX}px){{"
    f'.mantine-Paper-root[style*="fixed"]:has(.{PAGE_MARK}),'
    f'.mantine-Paper-root[style*="fixed"] div:has(>div>div>div>div>div>div>.{PAGE_MARK}){{width:100%!important}}}}'
)
PAGE_HTML = f'<style>{PAGE_STYLE}</style><i class="{PAGE_MARK}"></i>'
"""First of a page."""
