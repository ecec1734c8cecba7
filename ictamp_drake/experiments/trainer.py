"""Common part of the training programs: command line, run folder, progress, checkpoint, exit code."""

import dataclasses
import json
import shlex
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import Any, Protocol, TypeVar

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from ictamp_drake.core.checks import check_choice
from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.learning.batches import Split, batch, join_batches, split
from ictamp_drake.learning.checkpoint import SKILLS
from ictamp_drake.learning.dataset import Attempts, fingerprint, load
from ictamp_drake.learning.objectives import Objective
from ictamp_drake.learning.training import Data, Figures, Fit, FitConfig, start
from ictamp_drake.runs.command import COMPLETE, INTERRUPTED, command
from ictamp_drake.runs.folder import RUNS
from ictamp_drake.runs.provenance import provenance


class Options(Protocol):
    """Common options of all training programs."""

    @property
    def data(self) -> Path:
        """Folder of recorded attempts."""

    @property
    def out(self) -> Path | None:
        """Folder of the run."""

    @property
    def skills(self) -> tuple[str, ...]:
        """Skills to train."""

    @property
    def sampler(self) -> str | None:
        """Sampler that k must come from; None for any."""

    @property
    def fit(self) -> FitConfig:
        """Options of the training."""


T = TypeVar("T", bound=Options)


@dataclass(frozen=True)
class Course:
    """Training of one skill.

    Attributes:
        skill: Name of the skill, pick or place.
        parts: Attempts at the skill, split for training, validation and test.
        folder: Folder of the run, which gets the checkpoint.
        about: Provenance for the checkpoint.
        progress: Progress display of the epochs.
    """

    skill: str
    parts: Split
    folder: Path
    about: Mapping[str, Any]
    progress: Progress

    def with_added_data(self, *folders: Path) -> "Course":
        """Return a copy with all attempts of further folders added to the training part."""
        more = [batch(load(folder, self.skill)) for folder in folders]
        training = join_batches(self.parts.training, *more)
        about = {**self.about, "also": [fingerprint(folder) for folder in folders]}
        return replace(self, parts=self.parts._replace(training=training), about=about)

    def fit(self, name: str, objective: Objective, config: FitConfig, bootstraps: int = 1) -> bool:
        """Train to the end. Return False when Ctrl-C interrupts the training.

        Args:
            name: Name of the network that is trained, and of its folder.
            objective: Objective to minimize.
            config: Options of the training.
            bootstraps: Number of ensemble members that each see their own bootstrap sample. 1 for no sampling.
        """
        training = self.parts.training
        if bootstraps > 1:
            training = training.with_bootstrap_weights(bootstraps, generator(Stream.TRAINING, config.seed, bootstraps))
        data = Data(training, self.parts.validation)
        purpose = {key: self.about.get(key) for key in ("options", "data", "also")}
        fit = Fit(objective, data, config, folder=self.folder / self.skill / name, purpose=purpose)
        task = self.progress.add_task(f"{self.skill} {name}", total=config.epochs)

        def report(figures: Figures) -> None:
            best = fit.history[fit.best_epoch]
            sentence = f"{self.skill} {name}: loss {figures['loss']:.4f}, best {best['loss']:.4f} ({best['epoch']:.0f})"
            self.progress.update(task, completed=len(fit.history), description=sentence)

        complete = fit.run(report)
        self.progress.update(task, completed=len(fit.history), total=len(fit.history))
        return complete


def main(
    name: str, options: type[T], train: Callable[[T, Course], bool], arguments: Sequence[str] | None = None
) -> int:
    """Run a training program and return its exit code.

    Args:
        name: Name of the program's module.
        options: Dataclass that defines the command line.
        train: Function that trains one skill and writes its checkpoint. It returns False when interrupted.
        arguments: Command line, by default that of the process.
    """
    given = sys.argv[1:] if arguments is None else list(arguments)
    typed = shlex.join(["python", "-m", name, *given])

    def act(chosen: T, console: Console) -> int:
        folder = chosen.out or RUNS / f"{name.rpartition('.')[2]}-{datetime.now():%Y%m%d-%H%M%S}"
        for skill in chosen.skills:
            check_choice("skills", skill, SKILLS)
            console.print(f"{folder}: training {skill}", soft_wrap=True)
            parts, about = _prepare_parts(chosen, skill, typed)
            with _progress(console) as progress:
                complete = train(chosen, Course(skill, parts, folder, about, progress))
            if not complete:
                console.print(f"Interrupted; the same command with --out {folder} goes on.", soft_wrap=True)
                return INTERRUPTED
        console.print(f"Checkpoints: {folder}", soft_wrap=True)
        return COMPLETE

    return command(name, options, act, "Interrupted; the same command with --out goes on.", given)


def _prepare_parts(options: Options, skill: str, command: str) -> tuple[Split, dict[str, Any]]:
    """Return the split attempts at a skill, and the provenance of the checkpoint."""
    attempts = _select_by_sampler(load(options.data, skill), options.sampler)
    start(options.fit.seed)
    plain = json.loads(json.dumps(dataclasses.asdict(options), default=str))  # type: ignore[call-overload]
    kept = {key: value for key, value in plain.items() if key not in ("data", "out", "skills")}
    about = {
        "command": command,
        "options": kept,
        "data": {"fingerprint": fingerprint(options.data), "attempts": len(attempts)},
        **{key: value for key, value in provenance().items() if key != "host"},
    }
    return split(attempts), about


def _select_by_sampler(attempts: Attempts, sampler: str | None) -> Attempts:
    return attempts if sampler is None else attempts.select(attempts.sampler == sampler)


def _progress(console: Console) -> Progress:
    return Progress(TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn(), console=console)
