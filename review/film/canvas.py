"""Off-screen rendering of a MuJoCo scene."""

import os
import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any

import mujoco
import numpy as np
from jaxtyping import UInt8

from flight.errors import FlightError

# Largest number of geoms in a scene: the vehicle's, the lines and the marks.
_MOST_GEOMS = 20_000


class NoCanvasError(FlightError):
    """No OpenGL context can be opened."""

    def __init__(self, tried: list[str]) -> None:
        super().__init__(
            "cannot render: expected off-screen OpenGL (EGL or OSMesa) or a display (GLFW); tried "
            + "; ".join(tried)
        )


class Canvas:
    """Off-screen renderer of a model's scene; the caller closes it.

    Args:
        model: the model to render.
        width: picture width, pixels.
        height: picture height, pixels.

    Raises:
        NoCanvasError: no OpenGL context can be opened.
    """

    def __init__(self, model: mujoco.MjModel, *, width: int, height: int) -> None:
        model.vis.global_.offwidth, model.vis.global_.offheight = width, height
        self._context = _open_context(width, height)
        self._context.make_current()
        self._drawing = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._drawing)
        self._view = mujoco.MjrRect(0, 0, width, height)
        self._model, self._option = model, mujoco.MjvOption()
        self.scene = mujoco.MjvScene(model, _MOST_GEOMS)
        self.scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        self.scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = False

    def draw(
        self, data: mujoco.MjData, camera: mujoco.MjvCamera, decorate: Callable[[mujoco.MjvScene], None]
    ) -> UInt8[np.ndarray, "height width 3"]:
        """Renders a picture, rows from the top.

        Args:
            data: the model's configuration.
            camera: the point of view.
            decorate: adds lines and marks to the scene.
        """
        every = mujoco.mjtCatBit.mjCAT_ALL
        mujoco.mjv_updateScene(self._model, data, self._option, None, camera, every, self.scene)
        decorate(self.scene)
        mujoco.mjr_render(self._view, self.scene, self._drawing)
        picture = np.empty((self._view.height, self._view.width, 3), dtype=np.uint8)
        mujoco.mjr_readPixels(picture, None, self._view, self._drawing)
        return picture[::-1]

    def close(self) -> None:
        """Frees the graphics memory."""
        self._drawing.free()
        self._context.free()


def check_canvas() -> None:
    """Checks that an OpenGL context can be opened.

    Raises:
        NoCanvasError: none can be opened.
    """
    _open_context(64, 64).free()


def _open_context(width: int, height: int) -> Any:
    """Opens the backend that MUJOCO_GL names, or the first that works."""
    named = os.environ.get("MUJOCO_GL", "").lower()
    usual = ("cgl", "glfw") if sys.platform == "darwin" else ("egl", "osmesa", "glfw")
    tried = []
    for name in (named,) if named else usual:
        try:
            return import_module(f"mujoco.{name}").GLContext(width, height)
        # Drivers raise many kinds of errors; the next backend may still work.
        except Exception as error:
            tried.append(f"{name}: {str(error).splitlines()[0] if str(error) else type(error).__name__}")
    raise NoCanvasError(tried)
