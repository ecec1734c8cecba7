"""Your own scene, from a file and in Python: `python docs/examples/own_scene.py`."""

from dataclasses import replace
from pathlib import Path

import ictamp_drake as ict


def main() -> None:
    scene = ict.load(Path(__file__).with_name("own_scene.yaml")).spec

    # The same with one box more, which stands on the red one and is in the way.
    green = ict.Box(size=(0.05, 0.05, 0.06), position=(0.45, 0.1, 0.13), color=(0.3, 0.65, 0.35))
    scene = replace(scene, boxes={**scene.boxes, "green_box": green}, goal="(on red_box rack)")

    task = ict.load(scene)
    solution = ict.solve(task, sampler="optimization", estimator="constant", seed=1, time_limit=250)

    plan = solution.plan
    assert plan is not None, solution.explain()
    for action in plan.actions:
        print(action)
    assert plan.actions[0].args == ("green_box", "red_box"), "what is in the way goes first"
    end = plan.attempts[-1].successor
    assert end is not None
    assert task.goal.holds(task.abstraction(end)), "H of where physics ended holds the goal"

    folder = Path("runs/own_scene")
    folder.mkdir(parents=True, exist_ok=True)
    plan.save(folder / "plan.yaml")
    plan.show(folder / "replay.html", browser=False)
    print("Open", folder / "replay.html", "in a browser. The plan is in plan.yaml, with its scene.")


if __name__ == "__main__":
    main()
