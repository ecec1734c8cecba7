"""The page of results: the runs, what they show, and the tables and pictures behind it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from urllib.parse import quote

from ictamp_drake.reports import results_table, search_tables, verdicts
from ictamp_drake.reports.comparison import Comparison, adjust_for_multiplicity, compare_strategies
from ictamp_drake.reports.headroom import headroom, quickest_executions, virtual_best
from ictamp_drake.reports.markdown import table
from ictamp_drake.reports.published import TIME_LIMIT
from ictamp_drake.reports.regime import Regime

TABLE_1 = (
    "Means and medians are over the solved runs, as in the paper. Times are processor times where the records have "
    "them, and wall-clock times otherwise. Here and below they are divided by the `pace ratio` of strategy and level, "
    "where that is known. `share`: with Wilson's interval; further seeds of a problem do not narrow it. `mean time, "
    "all`: over all runs, solved or not. `plans`: high-level plans opened. `steps`: low-level steps, each one run of a "
    "skill, kinematics and physics together. `duration`: how long the plan takes the arm. Also as [LaTeX]({latex}) and "
    "[CSV]({csv})."
)

PAPER = (
    f"Within {TIME_LIMIT:,.0f} s a problem. Scenes, simulator, arm, skills, limits and machine differ from ours, so "
    "rows of this table cannot be compared with rows of those above; rows of one table can. The intervals are ours."
)

PAIRED = (
    "Each pair has the same problem and the same seed. `p`: McNemar's exact test of the runs that only one of the two "
    "solved; the seeds of a problem are kept together. `p (Holm)`: corrected for all tests of the table; a difference "
    f"counts as shown below {verdicts.SIGNIFICANT}. Ratios: the strategy's figure as a multiple of the reference's, "
    "median over the problems that both solved, with a 95 % bootstrap interval over problems; a difference counts as "
    "shown when 1 is outside. The intervals are not corrected: where nothing differs, 1 in 20 would still exclude 1. "
    "Problems that one of the two left unsolved are not in the ratios. `pace ratio`, where it is known of three in "
    "four runs or more: the computing time for a second of the plan that was found, as a ratio; 1 when the machine "
    "was equally fast for both. There, each run's time is divided by it before `time ratio` is computed."
)

HEADROOM = (
    "Two bounds, each as a multiple of a strategy's time: median over the problems that both solved, with an interval "
    "as above. Where one is near 1, little is left to gain. The virtual best knows beforehand which strategy of the "
    "regime is the quickest on each problem and seed, so no choice among them gains more. It is optimistic: every time "
    "is partly luck, and it takes the least of several. The second bound is the execution of the plan, which no search "
    "saves (two executions in runs by earlier versions, which verified it once more): here, of the plan that is the "
    "quickest to execute of all that were found for the problem and seed."
)

SEARCH = (
    "The tree of one search after each quarter of its plans and steps (paper, Figure 1). A disc is a node, in the "
    "color of the plan that led to it; a cross is a failed step; what is new since the last picture is dark; the way "
    "to the goal is green. `ictamp_drake.experiments.packing` writes the same for every problem as `search.html`, to "
    "step through and with replays."
)

EFFORT = (
    "Means over all runs, solved or not. `failed steps`: share of the low-level steps. Medians of the solved runs: "
    "`steps / skill`, low-level steps per skill of the plan, at best 1; `overhead`, the run's time as a multiple of "
    "the computing time of one execution of its plan."
)

STAGES = "Mean seconds of a run by stage."

DEPTHS = (
    "Mean low-level steps of a run by the depth of the node from which they start; the darker, the larger their share. "
    "A search in which nothing fails takes one at each depth of its plan."
)

SCENES = "A problem of each level, and one of each kind of interference (paper, Figure 2)."

INTERFERENCE = (
    "Solved runs and their median time, by what is done to the boxes outside the goal. A problem with several kinds of "
    "interference is in several rows. Levels without interference are left out."
)


@dataclass(frozen=True, eq=False)
class Chapter:
    """A regime with its comparisons.

    Attributes:
        regime: Runs under equal conditions.
        reference: Strategy with which all others are compared.
        comparisons: Comparisons of all other strategies with the reference, strategy by strategy and level by level.
        p: Probabilities of the comparisons, adjusted for the number of tests; only those with common runs are tested.
        pictures: Paths of the pictures relative to the page, by what they show.
    """

    regime: Regime
    reference: str
    comparisons: Sequence[Comparison]
    p: Sequence[float]
    pictures: Mapping[str, str]

    @classmethod
    def create(cls, regime: Regime, reference: str, pictures: Mapping[str, str]) -> "Chapter":
        """Compare every strategy of the regime with the reference."""
        rivals = (name for name in regime.strategies if name != reference)
        comparisons = [each for name in rivals for each in compare_strategies(regime.runs, name, reference)]
        raised = iter(adjust_for_multiplicity([each.p for each in comparisons if each.pairs]))
        p = [next(raised) if each.pairs else each.p for each in comparisons]
        return cls(regime, reference, comparisons, p, pictures)

    def picture(self, what: str) -> list[str]:
        """Lines that show a picture; none when it was not drawn."""
        return [_image(f"{what}, {self.regime.name}", self.pictures[what])] if what in self.pictures else []


def page(chapters: Sequence[Chapter], typed: str, files: Mapping[str, str]) -> str:
    """Write the page in Markdown.

    Args:
        chapters: Chapters of the page, one per regime.
        typed: Command that made the page.
        files: Paths relative to the page of figure_2, table_1.tex, table_1.csv and, if there are any, figure_1 and
            figure_3.
    """
    about = TABLE_1.format(latex=files["table_1.tex"], csv=files["table_1.csv"])
    parts = [
        ["# Results", "", "This command made the page, its tables and its pictures:", "", "```", typed, "```", ""],
        [*_conditions_table(chapters), ""],
        _section("What is and is not significant", PAIRED, chapters, _significance),
        _figure("Scenes", SCENES, "Figure 2", files["figure_2"]),
        _section("Table 1", about, chapters, _table_1),
        ["### The paper's own", "", PAPER, "", *results_table.markdown(results_table.published_rows()), ""],
        _section("Success over time and steps", "", chapters, lambda of: of.picture("success")),
        _section("Paired comparisons", "", chapters, _paired_table),
        _section("What is left to gain", HEADROOM, chapters, _headroom),
        _figure("A search over time", SEARCH, "Figure 1", files.get("figure_1")),
        _section("Search behaviour", EFFORT, chapters, lambda of: search_tables.effort(of.regime.runs)),
        _section("Where the time goes", STAGES, chapters, _stages),
        _section("Where in the tree the steps go", DEPTHS, chapters, lambda of: of.picture("depths")),
        _section("Why steps fail", "", chapters, lambda of: search_tables.failures(of.regime.runs)),
        _section("Interference", INTERFERENCE, chapters, lambda of: search_tables.interference(of.regime.runs)),
        _figure("How close P and Q are to counted success", "", "Figure 3", files.get("figure_3")),
    ]
    return "\n".join(line for part in parts for line in part).rstrip() + "\n"


def _section(title: str, text: str, chapters: Sequence[Chapter], of: Callable[[Chapter], Sequence[str]]) -> list[str]:
    """Section with the lines of every regime below its name; empty when no regime has any."""
    found = {chapter.regime.name: of(chapter) for chapter in chapters}
    if not any(found.values()):
        return []
    parts = [line for name, lines in found.items() if lines for line in (f"### {name}", "", *lines, "")]
    return [f"## {title}", "", *([text, ""] if text else []), *parts]


def _figure(title: str, text: str, what: str, link: str | None) -> list[str]:
    """Section of one picture; empty when there is none."""
    return [f"## {title}", "", *([text, ""] if text else []), _image(what, link), ""] if link else []


def _image(what: str, link: str) -> str:
    return f"![{what}]({quote(link)})"


def _conditions_table(chapters: Sequence[Chapter]) -> list[str]:
    """Table of the conditions of the runs, one column per regime."""
    what = dict.fromkeys(name for chapter in chapters for name in chapter.regime.about)
    rows = [[name, *(chapter.regime.about.get(name, "-") for chapter in chapters)] for name in what]
    return table(["regime", *(chapter.regime.name for chapter in chapters)], rows)


def _significance(chapter: Chapter) -> list[str]:
    if not chapter.comparisons:
        return [f"`{chapter.reference}` is the only strategy: there is nothing to compare."]
    return verdicts.summary(chapter.comparisons, chapter.p)


def _table_1(chapter: Chapter) -> list[str]:
    limit = chapter.regime.time_limit
    counted = "the time that it took, as limits differ" if limit is None else f"the limit of {limit:g} s"
    rows = results_table.table_1(chapter.regime.name, chapter.regime.runs)
    return [f"In `mean time, all`, an unsolved run counts as {counted}.", "", *results_table.markdown(rows)]


def _paired_table(chapter: Chapter) -> list[str]:
    if not chapter.comparisons:
        return []
    return [f"Reference: `{chapter.reference}`.", "", *verdicts.rows(chapter.comparisons, chapter.p)]


def _stages(chapter: Chapter) -> list[str]:
    return [*chapter.picture("stages"), "", *search_tables.stages(chapter.regime.runs)]


def _headroom(chapter: Chapter) -> list[str]:
    bounds = {"Virtual best": virtual_best, "Plan executed": quickest_executions}
    found = {name: headroom(chapter.regime.runs, bound) for name, bound in bounds.items()}
    return [line for name, rows in found.items() if rows for line in (f"**{name}**", "", *rows, "")][:-1]
