"""A scene of one's own, from a file and in Python: `python docs/examples/own_scene.py`."""

from dataclasses import replace
from pathlib import Path

from ictamp_drake.scenes.spec import BoxSpec, load_scene
from ictamp_drake.tamp.artefacts import write_artefacts
from ictamp_drake.tamp.method import Method
from ictamp_drake.tamp.solve import solve
from ictamp_drake.tamp.task import load


def main() -> None:
    spec = load_scene(Path(__file__).with_name("own_scene.yaml"))

    # The same with one box more, which stands on the red one and is in the way.
    green = BoxSpec(size=(0.05, 0.05, 0.06), position=(0.45, 0.1, 0.13), color=(0.3, 0.65, 0.35))
    spec = replace(spec, boxes={**spec.boxes, "green_box": green}, goal="(on red_box rack)")

    method = Method(sampler="optimization", estimator="constant", seed=1, time_limit=250)
    task = load(spec, method)  # from a file: load(path, method)
    solution = solve(task, method)

    assert solution.result.plan is not None, solution.result.stop_reason
    for attempt in solution.result.plan:
        print(attempt.action)
    assert solution.result.plan[0].action.args == ("green_box", "red_box"), "what is in the way goes first"
    end = solution.result.plan[-1].successor
    assert end is not None
    assert task.goal <= task.abstraction(end), "H of where physics ended holds the goal"

    folder = Path("runs/own_scene")
    write_artefacts(solution, folder, "all")
    print("Open", folder / "replay.html", "in a browser, and search.html beside it. The scene is in scene.yaml.")


if __name__ == "__main__":
    main()
