"""The report of a comparison: the page as text, and in a real browser."""

from __future__ import annotations

from html.parser import HTMLParser

import numpy as np
import pytest
from PIL import Image
from softcradle.sandbox.draw.number_format import number_text
from softcradle.sandbox.studies.compare.report import ComparisonReport, FilmSettings
from softcradle.sandbox.studies.compare.results import solve_sides
from softcradle.sandbox.studies.compare.sides import comparison_of

from tests.helpers.browser import Browser, found


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """A report as a file, its text, and its results."""
    comparison = comparison_of(["draft-gear-one-on-three"], ["power_law(16, 1/10)", "hertz(1e6)"])
    results = solve_sides(comparison)
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(ComparisonReport(comparison, results, FilmSettings(slow=20.0)).html(), encoding="utf-8")
    return path, path.read_text(encoding="utf-8"), results


class TagChecker(HTMLParser):
    """Checks that every tag is closed, and collects what the page would load."""

    VOID = frozenset({"meta", "link", "img", "br", "path", "rect", "input"})

    def __init__(self) -> None:
        super().__init__()
        self.stack: list[str] = []
        self.links: list[str] = []

    def handle_starttag(self, tag, attrs):
        self.links += [value for name, value in attrs if name in ("src", "href", "poster")]
        if tag not in self.VOID:
            self.stack.append(tag)

    def handle_endtag(self, tag):
        if tag not in self.VOID:
            assert self.stack.pop() == tag


def test_page_closes_its_tags_loads_nothing_and_has_every_number(page):
    _, text, results = page
    checker = TagChecker()
    checker.feed(text)
    assert checker.stack == []
    assert checker.links
    assert all(link.startswith("data:") for link in checker.links)
    for result in results:
        for value in result.measures.final_velocity:
            assert number_text(value) in text
        assert number_text(result.measures.restitution) in text


def test_labels_of_users_are_text_not_markup(tmp_path):
    (tmp_path / "x.toml").write_text(
        'title = "<b>&x"\n[[lanes]]\nlabel="<script>alert(1)</script>"\nbeads=[1,1]\nvelocity=1.0\n'
        'contact={law="hertz",stiffness=1.0}\n'
        + '[[lanes]]\nlabel="b"\nbeads=[1,1]\nvelocity=1.0\ncontact={law="hertz",stiffness=2.0}\n'
    )
    comparison = comparison_of([str(tmp_path / "x.toml")], [])
    text = ComparisonReport(comparison, solve_sides(comparison)).html()
    assert "<script>alert" not in text
    assert "<b>" not in text


@pytest.mark.slow
@pytest.mark.skipif(found() is None, reason="there is no browser")
def test_page_in_a_browser(page, tmp_path):
    path, _, results = page
    with Browser(tmp_path / "profile") as browser:
        moment = 0.05
        browser.visit(path, "")
        browser.run(f"page.pause(), page.go({moment})")
        assert browser.run("page.source.slow") == 20.0
        lanes = browser.run("page.specs.map((_, lane) => Array.from(page.source.values(lane).velocity))")
        for shown, result in zip(lanes, results, strict=True):
            rows = [np.interp(moment, result.trajectory.time, column) for column in result.trajectory.velocity.T]
            np.testing.assert_allclose(shown, rows, atol=2e-3)
        times = browser.run("page.charts.map((chart) => chart.timeAt(chart.across(page.source.time)))")
        assert times == pytest.approx([moment] * 2 * len(results))  # velocities and forces of each lane
        tables = browser.run("[...document.querySelectorAll('table')].map((t) => t.rows.length)")
        assert tables == [1 + 14 + 5, 4, 4, 4]  # four velocities, and how well they are known
        fits = "document.documentElement.scrollWidth <= document.documentElement.clientWidth"
        assert browser.run(fits)
        backgrounds = []
        for scheme in ("light", "dark"):
            browser.media("screen", scheme)
            browser.picture(tmp_path / f"{scheme}.png", whole=True)
            with Image.open(tmp_path / f"{scheme}.png") as opened:
                picture = np.asarray(opened.convert("L"), dtype=float)
            backgrounds.append(float(np.median(picture)))
            assert picture.std() > 5.0  # not an empty page
        assert backgrounds[0] > 200.0
        assert backgrounds[1] < 60.0
        browser.device(390, 844)
        assert browser.run(fits)
        assert browser.complaints == []


@pytest.mark.slow
@pytest.mark.skipif(found() is None, reason="there is no browser")
def test_the_browser_reports_mistakes(tmp_path):
    """The test above can fail: a mistake in a page is reported."""
    (tmp_path / "bad.html").write_text("<!doctype html><link rel=icon href='data:,'><script>nothing.there()</script>")
    with Browser(tmp_path / "profile") as browser:
        browser.open(tmp_path / "bad.html")
        assert any("nothing is not defined" in complaint for complaint in browser.complaints)
