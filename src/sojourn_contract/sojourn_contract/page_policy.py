"""The content-security policy of our pages: what a browser may do for them, whatever has come into them.

A page of ours shows texts from bags, files and nodes of others. They are escaped; should one slip through all the same,
the browser runs no script of it and loads nothing, so that nothing leaves the machine (W3C, Content Security Policy
Level 3).
"""

import base64
import hashlib


def policy_tag(script: str = "") -> str:
    """The tag that carries the policy; it has to come first in the head.

    Args:
        script: text of the one script that the page may run, between its tags; none: it runs none.

    Nothing is loaded from anywhere but pictures that are within the page; no form is sent; styles are those of the page
    and of its drawings.
    """
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    scripts = f"script-src 'sha256-{digest}'; " if script else ""
    policy = (
        f"default-src 'none'; {scripts}style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'"
    )
    return f'<meta http-equiv="Content-Security-Policy" content="{policy}">'
