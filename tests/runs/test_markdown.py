"""Tables in Markdown."""

from ictamp_drake.runs.markdown import table


def test_a_table_is_a_heading_a_rule_and_its_rows() -> None:
    assert table(["level", "solved"], [["easy", 55], ["hard", 17]]) == [
        "| level | solved |",
        "| --- | ---: |",
        "| easy | 55 |",
        "| hard | 17 |",
    ]
