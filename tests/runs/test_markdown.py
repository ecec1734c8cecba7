"""Tables in Markdown."""

from ictamp_drake.runs.markdown import table


def test_a_table_is_a_heading_a_rule_and_its_rows() -> None:
    assert table(["level", "solved"], [["easy", 55], ["hard", 17]]) == [
        "| level | solved |",
        "| --- | ---: |",
        "| easy | 55 |",
        "| hard | 17 |",
    ]


def test_more_columns_can_stand_on_the_left() -> None:
    assert table(["a", "b", "c"], [], left=2)[1] == "| --- | --- | ---: |"
