"""The page of a run, in a real browser without network."""

import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from urllib.parse import quote, unquote, urlparse

import pytest
from PIL import Image

from ictamp_drake.viz.index_page import Entry, index_html
from tests.viz.chromium import Chromium

ODD = "50 % $HOME #1? \"a\" 'ü' &lt; <script>alert(1)<"
"""A name that a file can have."""

ENTRIES = (
    Entry(problem="easy-010", level="easy", strategy="els", solved=True, seconds=4.0, skills=6, steps=9),
    Entry(problem="easy-9", level="easy", strategy="paper", solved=True, seconds=30.0, skills=10, steps=12),
    Entry(
        problem=ODD, level="hard", strategy="els", reason="out of time", details=("red_box: </script>",), seconds=7.5
    ),
    Entry(problem="hard-1", level="hard", strategy="paper", error="Traceback\n  here\nOSError: <b>full</b>\n"),
)


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Page with a picture and a replay of each problem."""
    folder = tmp_path_factory.mktemp("run $1")
    entries = []
    for entry in ENTRIES:
        name = f"{entry.strategy}/0/{entry.problem}"
        (folder / name).mkdir(parents=True)
        Image.new("RGB", (8, 6)).save(folder / name / "scene.png")
        (folder / name / "replay.html").write_text("replay")
        address = quote(name)
        links = {"replay": f"{address}/replay.html"}
        entries.append(replace(entry, picture=f"{address}/scene.png", links=links))
    index_html("</script> run", entries, 3, folder / "index.html")
    return folder / "index.html"


@pytest.fixture(scope="module")
def browser(chromium: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Chromium]:
    with Chromium(chromium, tmp_path_factory.mktemp("profile")) as browser:
        yield browser


def read(browser: Chromium, url: str) -> None:
    """Open a page like a first-time visitor."""
    browser.open("about:blank")
    browser.open(url)
    browser.wait_until(f"location.href === {url!r} && document.readyState === 'complete'")


def choose(browser: Chromium, name: str, value: str) -> None:
    browser.run(f"by_id('{name}').value = {value!r}; by_id('{name}').dispatchEvent(new Event('input')); null")


def sort(browser: Chromium, column: str) -> None:
    browser.run(f"[...document.querySelectorAll('th button')].find(b => b.textContent === '{column}').click()")


def shown(browser: Chromium) -> list[str]:
    rows = "[...document.querySelectorAll('tbody tr')].filter(row => row.getClientRects().length)"
    return list(browser.run(f"{rows}.map(row => row.querySelector('.name').textContent)"))


def test_every_problem_is_there_by_its_name(browser: Chromium, page: Path) -> None:
    read(browser, page.as_uri())
    assert shown(browser) == [ODD, "easy-9", "easy-010", "hard-1"]
    assert browser.run("document.querySelector('h1').textContent") == "</script> run"
    assert browser.run("document.querySelector('.detail').textContent") == "red_box: </script>"
    assert "OSError: <b>full</b>" in browser.run("document.querySelector('summary').textContent")
    assert "2 of 4 solved" in browser.run("by_id('summary').textContent")
    assert "3 to do" in browser.run("by_id('summary').textContent")


def test_links_and_pictures_lead_to_files(browser: Chromium, page: Path) -> None:
    read(browser, page.as_uri())
    links = browser.run("[...document.querySelectorAll('.links a')].map(a => a.href)")
    assert len(links) == len(ENTRIES)
    for link in links:
        assert Path(unquote(urlparse(link).path)).read_text() == "replay"
    browser.wait_until("[...document.images].every(image => image.naturalWidth === 8)")
    browser.run("document.querySelector('.links a').click()")
    deadline = time.monotonic() + 60
    while browser.run("document.body?.textContent") != "replay":  # a promise would end with the page that it began on
        assert time.monotonic() < deadline
        time.sleep(0.02)


@pytest.mark.parametrize(
    ("filters", "names"),
    [
        ({"text": "HARD"}, [ODD, "hard-1"]),
        ({"text": "els easy"}, ["easy-010"]),
        ({"text": "$HOME"}, [ODD]),
        ({"text": "nothing like it"}, []),
        ({"level": "easy"}, ["easy-9", "easy-010"]),
        ({"strategy": "paper", "result": "solved"}, ["easy-9"]),
        ({"result": "unsolved"}, [ODD, "hard-1"]),
    ],
)
def test_filters_leave_what_fits(browser: Chromium, page: Path, filters: dict[str, str], names: list[str]) -> None:
    read(browser, page.as_uri())
    for name, value in filters.items():
        choose(browser, name, value)
    assert shown(browser) == names
    assert browser.run("by_id('none').getClientRects().length > 0") == (not names)


def test_columns_sort_both_ways(browser: Chromium, page: Path) -> None:
    read(browser, page.as_uri())
    sort(browser, "Time")
    assert shown(browser) == ["hard-1", "easy-010", ODD, "easy-9"]
    sort(browser, "Time")
    assert shown(browser) == ["easy-9", ODD, "easy-010", "hard-1"]
    sort(browser, "Skills")
    assert shown(browser)[:2] == ["easy-010", "easy-9"], "what has no value comes last"
    sort(browser, "Skills")
    assert shown(browser)[:2] == ["easy-9", "easy-010"]


def test_a_page_that_is_read_again_shows_the_same(browser: Chromium, page: Path) -> None:
    read(browser, page.as_uri())
    choose(browser, "level", "hard")
    choose(browser, "text", "$")
    sort(browser, "Steps")
    read(browser, browser.run("location.href"))
    assert shown(browser) == [ODD]
    assert browser.run("document.querySelector('th[aria-sort]').textContent") == "Steps"


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_texts_can_be_read(browser: Chromium, page: Path, scheme: str) -> None:
    browser.prefer(scheme)
    read(browser, page.as_uri())
    luminance = (
        "(color => color.match(/[\\d.]+/g).slice(0, 3).map(v => v / 255)"
        ".map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)"
        ".reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0))"
    )
    paper = browser.run(f"{luminance}(getComputedStyle(document.body).backgroundColor)")
    assert (paper > 0.5) == (scheme == "light")
    for selector in (".name", ".solved", ".unsolved", ".detail", ".links a", "th button", "#summary"):
        ink = browser.run(f"{luminance}(getComputedStyle(document.querySelector('{selector}')).color)")
        assert (max(ink, paper) + 0.05) / (min(ink, paper) + 0.05) >= 4.5, selector


def test_a_single_problem_needs_few_columns(browser: Chromium, tmp_path: Path) -> None:
    index_html("one", [Entry(problem="scene", level="own scenes")], 0, tmp_path / "index.html")
    read(browser, (tmp_path / "index.html").as_uri())
    assert shown(browser) == ["scene"]
    columns = browser.run("[...document.querySelectorAll('th')].map(th => th.textContent)")
    assert columns == ["Problem", "Result", "Time", "Skills", "Steps"]
    assert browser.run("by_id('level').getClientRects().length") == 0


def test_a_run_that_has_just_begun_has_a_page(browser: Chromium, tmp_path: Path) -> None:
    index_html("none", [], 7, tmp_path / "index.html")
    read(browser, (tmp_path / "index.html").as_uri())
    assert shown(browser) == []
    assert "7 to do" in browser.run("by_id('summary').textContent")
    assert browser.run("by_id('none').getClientRects().length") == 1


def test_many_problems_open_at_once_and_pictures_only_when_they_are_seen(browser: Chromium, tmp_path: Path) -> None:
    Image.new("RGB", (8, 6)).save(tmp_path / "scene.png")
    entries = [
        Entry(
            problem=f"easy-{i:03}", level="easy", strategy=strategy, seed=seed, picture="scene.png", solved=i % 2 == 0
        )
        for strategy in ("els", "paper")
        for seed in range(5)
        for i in range(70)
    ]
    index_html("many", entries, 0, tmp_path / "index.html")
    read(browser, (tmp_path / "index.html").as_uri())
    assert len(shown(browser)) == 700
    assert browser.run("performance.getEntriesByType('navigation')[0].domContentLoadedEventEnd") < 5000
    choose(browser, "seed", "3")
    choose(browser, "result", "solved")
    assert len(shown(browser)) == 70
    loaded = browser.run("[...document.images].filter(image => image.complete && image.naturalWidth).length")
    assert loaded < 350


def test_nothing_was_missing_on_the_pages(browser: Chromium) -> None:
    assert browser.problems == []
