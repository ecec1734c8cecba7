"""Tables in Markdown."""

from ictamp_drake.reports.markdown import drop_empty_columns, table


def test_a_table_is_a_heading_a_rule_and_its_rows() -> None:
    assert table(["level", "solved"], [["easy", 55], ["hard", 17]]) == [
        "| level | solved |",
        "| --- | ---: |",
        "| easy | 55 |",
        "| hard | 17 |",
    ]


def test_more_columns_can_stand_on_the_left() -> None:
    assert table(["a", "b", "c"], [], left=2)[1] == "| --- | --- | ---: |"


def test_columns_that_hold_nothing_are_left_out() -> None:
    assert drop_empty_columns(["a", "b", "c"], [["1", "-", "-"], ["-", "-", "2"]]) == (
        ["a", "c"],
        [["1", "-"], ["-", "2"]],
    )
    assert drop_empty_columns(["a"], []) == ([], [])
