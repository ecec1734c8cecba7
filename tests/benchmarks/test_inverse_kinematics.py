from benchmarks.inverse_kinematics import Options, lines


def test_the_table_has_a_line_for_each_kind() -> None:
    table = [*lines(Options(arms=("panda",), kinds=("auto", "closed-form", "numeric"), poses=5))][2:]
    assert [line.split(" | ")[2] for line in table] == ["panda", "panda", "numeric"]
