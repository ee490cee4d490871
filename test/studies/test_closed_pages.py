"""Every page of ours says what a browser may do for it, and asks for nothing beyond that."""

import base64
import hashlib
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from sojourn_analysis.datasheet.figures import Curve, Figure, Section
from sojourn_analysis.datasheet.sheet import Datasheet
from sojourn_bags.page.html import PageSection, document
from sojourn_config.scenario import load_scenario
from sojourn_contract.conformance.machine import JudgedMachine
from sojourn_contract.page import contract_page
from sojourn_studies import datasheet_page
from sojourn_studies.campaign.findings import CampaignFindings
from sojourn_studies.campaign.page import write_page
from sojourn_studies.campaign.row import FIGURES

HOSTILE = '<script>alert(1)</script><img src="http://x/y" onerror="alert(1)">'
LOADING = {"src", "srcset", "data", "poster", "action", "formaction", "background"}


class PageReader(HTMLParser):
    """What a page asks a browser for."""

    def __init__(self) -> None:
        super().__init__()
        self.policy = ""
        self.before_policy: list[str] = []
        self.loads: list[str] = []
        self.handlers: list[str] = []
        self.scripts: list[str] = []
        self._in_script = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        if tag == "meta" and given.get("http-equiv") == "Content-Security-Policy":
            self.policy = given["content"]
        elif not self.policy:
            self.before_policy.append(tag)
        self.loads += [value for name, value in given.items() if name in LOADING]
        self.loads += [given["href"]] if tag in ("link", "base") else []
        self.handlers += [name for name in given if name.startswith("on")]
        if tag == "script":
            self._in_script = True
            self.scripts.append("")

    def handle_endtag(self, tag: str) -> None:
        if tag == "script":
            self._in_script = False

    def handle_data(self, data: str) -> None:
        if self._in_script:
            self.scripts[-1] += data


def campaign_page(tmp_path: Path) -> str:
    row = {name: 1.0 for name in FIGURES} | {"result": "not met", "reason": HOSTILE, "goals": 1, "goals_met": 0}
    rows = [{**row, "run": number, "scenario": HOSTILE, "soil.n": float(number)} for number in range(9)]
    write_page(tmp_path / "p.html", CampaignFindings(rows, ["soil.n"], 9), {"name": HOSTILE}, {0: HOSTILE})
    return (tmp_path / "p.html").read_text(encoding="utf-8")


def run_page(_folder: Path) -> str:
    return document(HOSTILE, "<p>1</p>", [PageSection("a", HOSTILE, "")], "const a = 1 < 2 && 'é';")


def sheet_page(_folder: Path) -> str:
    x = np.linspace(0.0, 1.0, 5)
    curve = Curve(HOSTILE, HOSTILE, "y", {HOSTILE: (x, x)}, {"p": (0.5, 0.5)})
    sheet = Datasheet((Section(HOSTILE, (Figure("k", HOSTILE, HOSTILE, HOSTILE, HOSTILE),), (curve,), HOSTILE),), ())
    return datasheet_page.page(sheet, HOSTILE, [HOSTILE], HOSTILE)


def page_of_contract(_folder: Path) -> str:
    return contract_page(JudgedMachine.of_scenario(load_scenario("flat_drive")))


@pytest.mark.parametrize("make", [run_page, sheet_page, page_of_contract, campaign_page])
def test_it_runs_its_own_script_alone_and_loads_nothing(make: Callable[[Path], str], tmp_path: Path) -> None:
    text = make(tmp_path)
    reader = PageReader()
    reader.feed(text)
    assert reader.before_policy in (["html", "head"], ["head"]), "the policy holds for what comes after it"
    rules = dict(rule.strip().partition(" ")[::2] for rule in reader.policy.split(";"))
    assert rules["default-src"] == rules["base-uri"] == rules["form-action"] == "'none'"
    assert rules["img-src"] == "data:" and rules["style-src"] == "'unsafe-inline'"
    digests = [base64.b64encode(hashlib.sha256(one.encode()).digest()).decode() for one in reader.scripts]
    assert rules.get("script-src", "").split() == [f"'sha256-{one}'" for one in digests]
    assert set(rules) <= {"default-src", "base-uri", "form-action", "img-src", "style-src", "script-src"}
    assert all(one.startswith("data:image/") for one in reader.loads), reader.loads
    assert not reader.handlers
