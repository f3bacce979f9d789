"""The plant as an environment of Gymnasium: `gymnasium.make("pneudrive/Positioning-v0", rig="servo-b-tuned")`.

An agent moves the load to a target. It sees what the controller of a drive sees, the readings of the sensors, and sets the
valve's command, which is held for some samples.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._pneudrive import Command, Plant, Rig, Sample, Units
from .frames import _needs

_needs("gymnasium", "gym")
import gymnasium

__all__ = ["Positioning"]

Observation = NDArray[np.float32]
Action = NDArray[np.float32]

_FASTEST_M_S = 5.0


class Positioning(gymnasium.Env[Observation, Action]):
    """Positioning: the load has to move to a target and stay there.

    An observation has six numbers from -1 to 1: the signed distance to the target over the stroke, twice the position
    over the stroke less 1, the velocity over 5 m/s, and both pressures and the spool over the ranges of their sensors. A
    quantity that is not measured is 0, and one beyond its range is clipped. The velocity is the difference of two
    positions over the time between them.

    An action is a number from -1 to 1: the command over its largest; positive extends.

    The reward of a step is minus the distance to the target over the stroke: an episode at its target throughout has 0.
    Only its length ends an episode (`max_episode_steps` of `gymnasium.make`).

    `info` has `target_m` and the true state of the plant (`Plant.state`).
    """

    def __init__(self, rig: Any = "servo-b-tuned", *, samples: int = 8, spread: float = 0.0) -> None:
        """Makes the environment of a rig whose valve takes counts.

        An action is held for `samples` samples. With a spread each episode has another rig, whose physical values are drawn
        within this fraction of those of `rig` (`Rig.spread`).

        `ValueError`: the rig has a stepper, or `samples` is less than 1.
        """
        # The plant has no law: a rig that is drawn need not suit that of the file.
        self.rig = Rig(rig, controller__law="gain-profile")
        if self.rig.operator.model == "stepper":
            raise ValueError("a stepper takes pulses; the environment needs a valve that takes counts")
        if samples < 1:
            raise ValueError(f"an action lasts for at least 1 sample, not {samples}")
        self._samples, self._spread = samples, spread
        self._units, self._zero_m = Units(self.rig), 1e-3 * self.rig.encoder.zero_mm
        self._stroke_m = self.rig.actuator.stroke_m
        self._largest = self.rig.operator.max_command_counts
        self._full_scale = 2**self.rig.sensors.bits - 1
        self._plant = Plant(self.rig)
        self._target_m = 0.5 * self._stroke_m
        self.observation_space = gymnasium.spaces.Box(-1.0, 1.0, (6,), np.float32)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (1,), np.float32)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begins an episode in the initial state of the rig's test.

        The target is drawn between a tenth and nine tenths of the stroke; `options={"target_m": 0.1}` sets it, m.
        """
        super().reset(seed=seed)
        drawn = self.np_random.uniform(0.1, 0.9) * self._stroke_m
        self._target_m = float((options or {}).get("target_m", drawn))
        seeds = self.np_random.integers(2**31, size=2)
        if self._spread:
            self._plant = Plant(self.rig.spread(self._spread, seed=int(seeds[0])), seed=int(seeds[1]))
            sample = self._plant.sample()
        else:
            sample = self._plant.reset(seed=int(seeds[1]))
        return self._seen(sample, sample), self._info()

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Holds a command for the samples of an action.

        `SimulationError`: the plant cannot go on.
        """
        counts = round(float(np.clip(action, -1.0, 1.0)[0]) * self._largest)
        command, before = Command(counts), self._plant.sample()
        for _ in range(self._samples):
            sample = self._plant.advance(command)
        seen, info = self._seen(before, sample), self._info()
        reward = -abs(self._target_m - info["position_m"]) / self._stroke_m
        return seen, reward, False, False, info

    def _seen(self, before: Sample, now: Sample) -> Observation:
        position_m = self._zero_m + self._units.position_m(now.position)
        travel_m = self._units.position_m(now.position - before.position)
        raw = np.array([now.pressure_1, now.pressure_2, now.spool]) / self._full_scale
        measured = [self.rig.sensors.pressure, self.rig.sensors.pressure, True]
        seen = [
            (self._target_m - position_m) / self._stroke_m,
            2 * position_m / self._stroke_m - 1,
            travel_m / self._units.time_s(self._samples) / _FASTEST_M_S,
            *np.where(measured, 2 * raw - 1, 0.0),
        ]
        observation: Observation = np.clip(seen, -1.0, 1.0).astype(np.float32)
        return observation

    def _info(self) -> dict[str, Any]:
        return {"target_m": self._target_m, **self._plant.state}


gymnasium.register("pneudrive/Positioning-v0", entry_point="pneudrive.gym:Positioning", max_episode_steps=200)
