"""Small stages that show everything the engine does. Only running them needs numpy."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

from pydantic import BaseModel, Field

from pipeline.nodes import StageRun, stage

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

POINTS = 7
FRAMES = 150  # two whole chunks of 64 frames and a part of a third


class MeshConfig(BaseModel):
    height: float = 1.0
    label: str = "flat"


class WaveConfig(BaseModel):
    gain: float = 1.0
    frames: int = FRAMES
    fail_at: int = -1
    ends_at: int = -1
    pause: float = Field(default=0.0, json_schema_extra={"keyed": False})


@dataclass(frozen=True)
class Surface:
    points: NDArray[np.float64] = field(metadata={"unit": "mm", "axes": ("point", "xyz")})
    heights: tuple[float, ...] = ()


@dataclass(frozen=True)
class Label:
    text: str


@dataclass(frozen=True)
class Film:
    surface: Surface
    label: Label


@dataclass(frozen=True)
class Wave:
    stored_as: ClassVar[str] = "zarr"

    potential: NDArray[np.float64] = field(
        metadata={"unit": "mV", "axes": ("time", "point"), "stored": "float32"}
    )
    energy: NDArray[np.float64] = field(metadata={"unit": "1", "axes": ("time",)})
    time: NDArray[np.float64] = field(metadata={"unit": "ms", "axes": ("time",)})
    resumed: bool = False


@dataclass(frozen=True)
class Peak:
    value: float


class WaveError(ArithmeticError):
    """What a failing stage raises."""

    remedy = "choose another gain"


@stage
def mesh(config: MeshConfig) -> Film:
    """Film of two parts."""
    import numpy as np

    points = np.arange(3.0 * POINTS).reshape(POINTS, 3) * config.height
    return Film(Surface(points, (config.height,)), Label(config.label))


@stage
def wave(config: WaveConfig, surface: Surface, *, run: StageRun) -> Wave:
    """History that depends on all of its past, so that a wrong resume is seen."""
    import numpy as np

    history = run.stream(
        Wave,
        frames=config.frames,
        shapes={"potential": (POINTS,), "energy": ()},
        fewer=config.ends_at >= 0,
    )
    state = run.resume()
    v = surface.points[:, 0].copy() if state is None else state["v"]
    frames = config.frames if config.ends_at < 0 else config.ends_at
    for frame in range(history.frames_done, frames):
        if frame == config.fail_at:
            raise WaveError(f"no convergence in frame {frame}")
        np.add(v, config.gain * np.sin(v + frame), out=v)  # in place, as compiled kernels do
        time.sleep(config.pause)
        history.append(potential=v, energy=np.sum(v**2))
        run.checkpoint(lambda: {"v": v})
        run.progress(frame + 1, config.frames)
    run.note("norm", np.sqrt(np.sum(v**2)))
    return history.finish(time=np.arange(float(frames)), resumed=False)


@stage
def peak(config: MeshConfig, history: Wave) -> Peak:
    """Largest potential; a rounding, so that other histories may have the same one."""
    import numpy as np

    return Peak(round(float(np.max(np.asarray(history.potential[...]))), -3))


@stage
def report(config: MeshConfig, peak: Peak) -> Label:
    """Something that depends on the peak alone."""
    return Label(f"{config.label}: {peak.value}")
