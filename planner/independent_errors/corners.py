"""Signs of planar moves with the largest resulting distance."""

import numpy as np
from jaxtyping import Complex, Float


def furthest_corner(
    off: Complex[np.ndarray, "n"], moves: Complex[np.ndarray, "n variables"]
) -> tuple[Float[np.ndarray, "n variables"], Float[np.ndarray, "n"]]:
    """Returns signs that maximise `|off + signs @ moves|`, and the maximum.

    The sums fill a polygon whose sides are the moves: a corner is one side's two ends, all other moves on one
    side of its direction.
    """
    side = np.sign((np.conj(moves)[:, :, None] * moves[:, None, :]).imag)
    side = np.where(side == 0, 1.0, side)
    count = moves.shape[1]
    side[:, np.arange(count), np.arange(count)] = 1.0
    other = side.copy()
    other[:, np.arange(count), np.arange(count)] = -1.0
    corners = np.concatenate([side, other, -side, -other], axis=1)
    reach = np.abs(off[:, None] + np.einsum("nkv,nv->nk", corners, moves))
    best = reach.argmax(axis=1)
    rows = np.arange(len(off))
    return corners[rows, best], reach[rows, best]
