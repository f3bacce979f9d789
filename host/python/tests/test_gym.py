"""The environment of Gymnasium."""

import importlib
import re
import sys
import warnings
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import pneudrive.gym
from pneudrive import Rig

NAME = "pneudrive/Positioning-v0"
ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize(
    "options", [{}, {"rig": "press", "spread": 0.05}, {"rig": Rig("servo-b", sensors__pressure=False)}]
)
def test_the_checker_of_gymnasium_finds_nothing(options: dict[str, Any]) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(NAME, **options).unwrapped)


def episode(seed: int, **options: Any) -> list[Any]:
    environment = gymnasium.make(NAME, **options)
    seen, _ = environment.reset(seed=seed)
    actions = np.random.default_rng(seed).uniform(-1, 1, (20, 1)).astype(np.float32)
    return [seen, *(environment.step(action)[:2] for action in actions)]


@pytest.mark.parametrize("spread", [0.0, 0.05])
def test_a_seed_repeats_an_episode(spread: float) -> None:
    assert repr(episode(1, spread=spread)) == repr(episode(1, spread=spread))
    assert repr(episode(1, spread=spread)) != repr(episode(2, spread=spread))


def test_what_is_seen_is_the_plant() -> None:
    environment = gymnasium.make(NAME)
    seen, info = environment.reset(seed=0, options={"target_m": 0.2})
    for _ in range(10):
        before = info["position_m"]
        seen, reward, ended, truncated, info = environment.step(np.array([0.5], np.float32))
    stroke_m = Rig("servo-b-tuned").actuator.stroke_m
    assert info["target_m"] == 0.2
    assert info["position_m"] > before
    assert seen[0] == pytest.approx((0.2 - info["position_m"]) / stroke_m, abs=1e-4)
    assert seen[1] == pytest.approx(2 * info["position_m"] / stroke_m - 1, abs=1e-4)
    assert seen[2] == pytest.approx((info["position_m"] - before) / (8 * 0.0013) / 5, abs=1e-3)
    assert seen[3:5] == pytest.approx([2e-6 * info[name] - 1 for name in ("pressure_1_pa", "pressure_2_pa")], abs=1e-3)
    assert reward == pytest.approx(-abs(0.2 - info["position_m"]) / stroke_m)
    assert (ended, truncated) == (False, False)


def test_an_episode_has_its_length() -> None:
    environment = gymnasium.make(NAME, max_episode_steps=3)
    environment.reset(seed=0)
    assert [environment.step(np.zeros(1, np.float32))[3] for _ in range(3)] == [False, False, True]


def test_what_the_environment_cannot_be_made_of_is_refused() -> None:
    with pytest.raises(ValueError, match="a stepper takes pulses"):
        pneudrive.gym.Positioning("servo-a-tuned")
    with pytest.raises(ValueError, match="at least 1 sample, not 0"):
        pneudrive.gym.Positioning(samples=0)


def test_without_gymnasium_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    with pytest.raises(ModuleNotFoundError, match=r"pip install 'pneudrive\[gym\]' brings it"):
        importlib.reload(pneudrive.gym)


def test_the_training_of_the_documentation_learns() -> None:
    page = (ROOT / "docs" / "howto" / "python.md").read_text()
    block = re.search(r"```python\n(import gymnasium.*?)```", page, re.DOTALL)
    assert block is not None
    names: dict[str, Any] = {}
    exec(block[1], names)
    policies = (names["mean"], np.zeros(6))
    trained, untrained = (sum(names["returns"](policy, seed) for seed in range(100, 105)) for policy in policies)
    assert trained > 0.5 * untrained
