"""Tests of the page in a browser: it sorts, compares and opens cells, and runs no code from
rows."""

from __future__ import annotations

import json

import pytest

from mitigate.evaluation.grid import FRAMES
from mitigate.evaluation.page import document
from mitigate.evaluation.page.document import report as report_of
from tests.evaluation.made_rows import cell, column, row
from tests.evaluation.page.chromium import PROGRAM, Page

pytestmark = pytest.mark.skipif(PROGRAM is None, reason="no Chromium: apt-get install chromium")

EVIL = "<img src=x onerror=\"document.title='bad'\"></script><script>document.title='bad'</script>"


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    page_shown = Page(tmp_path_factory.mktemp("profile"))
    yield page_shown
    page_shown.close()


def made_rows() -> list[dict]:
    """Return rows of two agents. ``base`` succeeds in 8 of 10 clean episodes and in 2 of 10 under
    spatter; the agent ``hard`` succeeds in 6 of 10 in both conditions."""
    rows = column(8, {"spatter": 2, "gaussian_noise": 7}, steps=41)
    return rows + column(6, {"spatter": 6, "gaussian_noise": 5}, name="hard", agent="ba9876543210")


def made_walk(rows: list[dict]) -> dict:
    """Return the page's data of one episode that ``base`` ran clean and under spatter."""
    walk = {
        "episode": "0",
        "instruction": EVIL,
        "heard": EVIL,
        "corruption": "spatter",
        "title": "Spatter",
        "severity": 0.6,
        "split": rows[0]["split"],
        "rule": rows[0]["rule"],
        "seed": 0,
        "kind": "won by both",
        "picture": "data:image/png;base64,",
    }
    one = {"agent": "base", "clean": True, "won": True, "left": 0.5, "steps": 9, "agrees": True}
    one["hash"] = rows[0]["agent"]
    walk["walks"] = [one, one | {"clean": False}]
    return walk


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    rows, out = made_rows(), tmp_path_factory.mktemp("report") / "report.html"
    return document.write(report_of(rows, walks=[made_walk(rows)]), out)


def agents(page: Page) -> list[str]:
    return page.ask(
        "[...document.querySelectorAll('.agents tbody .agent')].map(e => e.textContent)"
    )


def lines(page: Page) -> list[list[str]]:
    matches = "[...document.querySelectorAll('dialog tbody tr')]"
    return page.ask(f"{matches}.map(r => [...r.children].map(c => c.textContent))")


def test_table_sorts_and_shows_differences(page, report):
    page.open(report)
    assert agents(page) == ["base", "hard"] and page.errors == []
    page.click(".agents .sort", "Clean SR")
    page.click(".agents .sort", "Clean SR")
    assert agents(page) == ["hard", "base"]
    page.ask(
        "(s => { s.value = 0; s.dispatchEvent(new Event('change')); })"
        "([...document.querySelectorAll('select')].find(s => s.value === '-1'))"
    )
    displayed = page.ask("document.querySelector('.agents .change').textContent")
    assert displayed.startswith("\u221220.0 [\u2212")
    assert "baseline=0" in page.ask("location.hash")


def test_difference_over_fewer_corruptions_is_marked(page, tmp_path):
    rows = column(8, dict.fromkeys(FRAMES, 2)) + column(6, {"spatter": 6}, name="hard", agent="b")
    page.open(document.write(report_of(rows), tmp_path / "page.html"), "#section=0&baseline=1")
    line = "[...document.querySelectorAll('.agents tbody tr')][0]"
    values, changes = (
        page.ask(f"[...{line}.querySelectorAll('{part}')].map(one => one.textContent)")
        for part in (".value", ".change")
    )
    assert values[2] == "20.0" and changes[2].endswith("] \u2020 1/12")
    assert not any("\u2020" in change for change in changes[:2])


def test_interval_without_width_is_hidden(page, tmp_path):
    rows = [row(0, 1), row(0, 0, name="hard", agent="ba9876543210")]
    rows += [{**one, "corruption": "spatter", "severity": 0.6} for one in rows]
    page.open(document.write(report_of(rows), tmp_path / "page.html"), "#section=0&baseline=0")
    result = page.ask("document.querySelector('.agents .change').textContent")
    assert result.strip() == "\u2212100.0 [\u2013]"
    assert page.ask("document.querySelector('.agents .change').className") == "change same"
    assert page.errors == []


def test_any_agent_can_be_the_baseline(page, report):
    page.open(report, "#baseline=1")
    chosen = "[...document.querySelectorAll('.choose select')].map(s => [s.value, s.textContent])"
    assert page.ask(chosen) == [["1", "nonebasehard"]]
    assert page.ask("document.querySelector('.base .agent').textContent") == "hard"
    page.open(report, "#baseline=2")
    assert page.ask(chosen)[0][0] == "-1"


def test_cell_opens_and_filters_episodes(page, report):
    page.open(report, "#baseline=0")
    page.click('[data-at="1/1"]')
    assert len(lines(page)) == 10 and "SR 60.0 %" in page.ask(
        "document.querySelector('dialog').textContent"
    )
    page.click("dialog .chip", "lost (")
    assert [line[0] for line in lines(page)] == ["6", "7", "8", "9"]
    page.click("dialog .chip", "won, lost by base")
    assert [line[0] for line in lines(page)] == ["2", "3", "4", "5"]
    page.click("dialog .chip", "both")
    page.click("dialog .sort", "Result")
    assert [line[0] for line in lines(page)][:2] == ["0", "1"]
    page.click("dialog .close")
    page.until("!document.querySelector('dialog')")
    page.click('[data-at="0/1"]')
    assert lines(page)[0][3] == "41"  # steps


@pytest.mark.parametrize("severity", [1 / 3, 1e-5, 1.0])
def test_cells_open_at_any_severity(page, tmp_path, severity):
    rows = column(8, {"spatter": 2}, severity)
    page.open(document.write(report_of(rows), tmp_path / "page.html"))
    page.click('[data-at="0/1"]')
    assert len(lines(page)) == 10


def test_cell_summary_averages_seeds_per_episode(page, tmp_path):
    """The last episode has no row for seed 1, so the mean also excludes its row for seed 0."""
    first = column(10, {"spatter": 10})
    second = column(10, {"spatter": 0}, seed=1)
    rows = first + [r for r in second if r["episode_id"] != "9"]
    page.open(
        document.write(report_of(rows), tmp_path / "page.html"), "#agent=0&corruption=spatter"
    )
    displayed = page.ask("document.querySelector('[data-at=\"0/1\"]').textContent")
    message = page.ask("document.querySelector('dialog .readout').textContent")
    assert displayed == "50.0*"
    assert message == (
        "19 walks of 10 episodes: SR 50.0 %, SPL 0.25, over the 9 that each seed has"
    )


def test_ties_are_rounded_as_the_table_rounds_them(page, tmp_path):
    rows = cell(5, 16) + cell(3, 16, corruption="spatter", severity=0.6)
    page.open(document.write(report_of(rows), tmp_path / "page.html"))
    values = page.ask("[...document.querySelectorAll('.agents .value')].map(v => v.textContent)")
    # the exact values are 31.25, 0.15625 and 18.75
    assert values[:3] == ["31.2", "0.16", "18.8 \u2020 1/8"]
    displayed = page.ask("[...document.querySelectorAll('[data-at]')].map(v => v.textContent)")
    assert displayed == ["31.2", "18.8"]
    assert [f"{100 * wins / 16:.1f}" for wins in (5, 3)] == displayed


def test_share_uses_common_episodes(page, tmp_path):
    rows = [r for r in column(9, {"spatter": 9}) if (r["episode_id"], r["severity"]) != ("9", 0.6)]
    page.open(document.write(report_of(rows), tmp_path / "page.html"))
    page.click(".chip", "share of own clean")
    displayed = page.ask("[...document.querySelectorAll('[data-at]')].map(v => v.textContent)")
    assert displayed == ["1.00", "1.00*"]  # not 1.0 / 0.9


def test_episodes_are_searched_as_they_are_typed(page, tmp_path):
    rows = [
        records | {"episode_id": f"1{records['episode_id']}"}
        for records in column(8, {"spatter": 2})
    ]
    page.open(
        document.write(report_of(rows), tmp_path / "page.html"), "#agent=0&corruption=spatter"
    )
    page.ask("document.querySelector('dialog input').focus()")
    page.type("12")
    assert page.ask("document.activeElement.value") == "12"
    assert [line[0] for line in lines(page)] == ["12"]
    page.click("dialog .chip", "lost (")
    assert page.ask("document.querySelector('dialog input').value") == "12"


def test_address_opens_a_cell(page, report):
    page.open(report, "#section=0&agent=0&corruption=spatter")
    assert "base" in page.ask("document.querySelector('dialog h2').textContent")
    page.press("Escape")
    page.until("!document.querySelector('dialog')")
    page.press("ArrowRight")
    page.press("ArrowDown")
    assert page.ask("document.activeElement.dataset.at") == "1/2"
    page.press("Enter")
    page.until("document.querySelector('dialog') !== null")
    assert "hard" in page.ask("document.querySelector('dialog h2').textContent")


def test_address_change_opens_another_cell(page, report):
    page.open(report, "#section=0&agent=0&corruption=spatter")
    page.ask("location.hash = '#section=0&baseline=1&agent=1&corruption=clean'")
    page.until("document.querySelector('dialog h2').textContent === 'hard \u00b7 Clean'")
    assert page.ask("document.querySelectorAll('dialog').length") == 1
    assert page.ask("document.querySelector('.base .agent').textContent") == "hard"
    page.press("Escape")
    page.until("!document.querySelector('dialog')")
    assert page.ask("location.hash") == "#section=0&baseline=1"
    page.click(".skip")
    page.until("location.hash === '#main'")
    assert page.ask("document.querySelector('.base .agent').textContent") == "hard"


def test_click_outside_closes_the_dialog(page, report):
    page.open(report, "#agent=0&corruption=spatter")
    box = page.ask(
        "(b => [b.left, b.top])(document.querySelector('dialog').getBoundingClientRect())"
    )

    def click(x: float, y: float) -> None:
        for kind in ("mousePressed", "mouseReleased"):
            at = {"x": x, "y": y, "button": "left", "clickCount": 1}
            page.call("Input.dispatchMouseEvent", type=kind, **at)

    click(box[0] + 8, box[1] + 8)
    assert page.ask("document.querySelector('dialog').open")
    click(box[0] - 8, box[1] + 8)
    page.until("!document.querySelector('dialog')")


def test_chip_hides_a_line_in_all_curves(page, tmp_path):
    rows = column(8, {"spatter": 2}, 0.3) + column(8, {"spatter": 1})
    rows += [r | {"split": "val_seen"} for r in rows]
    page.open(document.write(report_of(rows), tmp_path / "page.html"))
    key = "[...document.querySelectorAll('[aria-label=\"Severity curves\"] .chip')]"
    assert page.ask("document.querySelectorAll('.panel polyline').length") == 2
    page.ask(f"{key}[0].click()")
    assert page.ask(f"{key}.map(one => one.ariaPressed)") == ["false", "false"]
    assert page.ask("document.querySelectorAll('.panel polyline').length") == 0


def test_details_stay_open(page, report):
    page.open(report)
    page.click(".agents summary")
    page.until("document.querySelector('.agents details').open")
    page.click(".agents .sort", "Clean SR")
    page.click(".agents .sort", "Clean SR")
    assert agents(page) == ["hard", "base"]
    opened = "[...document.querySelectorAll('.agents details')].map(one => one.open)"
    page.until(f"String({opened}) === 'false,true'")


@pytest.mark.parametrize("width", [400, 1300])
def test_long_names_do_not_scroll_the_page(page, tmp_path, width):
    names = {"name": "n" * 190, "split": "s" * 190, "rule": "r" * 190}
    rows = [r | names for r in made_rows()] + made_rows()
    rows += [r | {"severity": 0.3} for r in rows if r["severity"]]
    walk = made_walk(rows[:1]) | {"episode": "e" * 190, "kind": "k" * 100}
    walk["walks"] = [one | {"agent": "n" * 190} for one in walk["walks"]]
    out = document.write(report_of(rows, title="t" * 190, walks=[walk]), tmp_path / "page.html")
    size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
    page.call("Emulation.setDeviceMetricsOverride", **size)
    for n in range(2):
        page.open(out, f"#section={n}&baseline=0&agent=1&corruption=spatter")
        assert page.ask("document.documentElement.scrollWidth") <= width
        assert (
            page.ask("(d => d.scrollWidth - d.clientWidth)(document.querySelector('dialog'))") <= 0
        )
    page.call("Emulation.clearDeviceMetricsOverride")


def test_page_shows_walks_and_filters_them(page, report):
    page.open(report)
    assert page.ask("document.querySelectorAll('.walk .plan').length") == 1
    assert page.ask("document.querySelectorAll('.walk .ends li').length") == 2
    page.click("#walks .chip", "won by both (1)")
    assert page.ask("document.querySelectorAll('.walk').length") == 1


def test_see_leads_from_a_row_to_its_walk(page, report):
    page.open(report, "#agent=0&corruption=spatter")
    page.click("dialog .link", "see")
    page.until("!document.querySelector('dialog') && document.activeElement.id === 'walk-0'")
    box = "document.getElementById('walk-0').getBoundingClientRect()"
    page.until(f"{box}.top < innerHeight && {box}.bottom > 0")
    page.until("!location.hash.includes('agent')")
    assert page.ask("document.activeElement.id") == "walk-0"


@pytest.mark.slow
@pytest.mark.parametrize(
    "other",
    [{"severity": 0.3}, {"seed": 1}, {"split": "val_seen"}, {"rule": "view points"}, {"hash": "c"}],
    ids=lambda other: [*other][0],
)
def test_see_links_only_walks_of_the_row(page, tmp_path, other):
    rows = made_rows()
    walk = made_walk(rows) | other
    walk["walks"] = [one | {"hash": other.get("hash", one["hash"])} for one in walk["walks"]]
    out = document.write(report_of(rows, walks=[walk]), tmp_path / "page.html")
    page.open(out, "#agent=0&corruption=spatter")
    assert len(lines(page)) == 10
    assert page.ask("document.querySelector('dialog .link')") is None
    page.open(out, "#agent=0&corruption=clean")
    seen = page.ask("document.querySelectorAll('dialog .link').length")
    # clean episodes have no link to an episode under corruption
    assert seen == ("severity" in other)


def test_names_and_ids_of_strangers_do_nothing(page, tmp_path):
    rows = column(5, {"spatter": 3}, name=EVIL)
    rows = [row | {"episode_id": f"{EVIL}{row['episode_id']}", "split": EVIL} for row in rows]
    out = document.write(report_of(rows, title=EVIL), tmp_path / "evil.html")
    page.open(out, "#agent=0&corruption=spatter")
    assert page.errors == [] and page.ask("document.title") == EVIL
    assert page.ask("document.querySelectorAll('img, script[src]').length") == 0
    assert page.ask("document.querySelector('.agents .agent').textContent") == EVIL
    assert EVIL in json.dumps(lines(page), ensure_ascii=False).replace('\\"', '"')


def _addresses(page):
    """Return the URLs that the page requested, except those of embedded pictures."""
    return [url for url in page.requests.values() if not url.startswith("data:image")]


def test_page_requests_nothing_and_its_policy_blocks_scripts(page, report, tmp_path):
    page.open(report)
    assert _addresses(page) == [report.as_uri()]
    text = report.read_text(encoding="utf-8")
    spoiled = tmp_path / "spoiled.html"
    inside = "<script>document.title='bad'</script><img src='http://127.0.0.1:9/x.png'>"
    spoiled.write_text(text.replace("<noscript>", f"{inside}<noscript>"), encoding="utf-8")
    page.open(spoiled)
    page.until("document.title === 'Results'")
    assert _addresses(page) == [spoiled.as_uri()]
    assert len(page.errors) == 2, page.errors
