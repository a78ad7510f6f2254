"""Negative controls of the check of array shapes: wrong shapes fail in product code."""

from typing import Any

import numpy as np
import pytest
from beartype.roar import BeartypeCallHintViolation
from jaxtyping import Float

from planner.independent_errors.affine import AffineForm

from .shapes import MOST_CALLS, checked

Column = Float[np.ndarray, "n"]


def added(left: Column, right: Column) -> Column:
    return np.asarray(left + right)


def doubled(column: Column) -> Column:
    return np.concatenate([column, column])


@pytest.mark.parametrize(
    ("left", "right"),
    [
        (np.zeros(3), np.zeros(1)),
        (np.zeros(3), np.zeros((3, 1))),
        (np.zeros(3), np.zeros(3, dtype=int)),
        (np.zeros(3), 0.0),
    ],
    ids=["two sizes", "two dimensions", "integers", "a number"],
)
def test_an_array_of_another_shape_or_kind_fails(left: Column, right: Any) -> None:
    with pytest.raises(BeartypeCallHintViolation, match="right"):
        checked(added)(left, right)
    assert checked(added)(left, left).shape == left.shape


def test_a_result_of_another_shape_fails() -> None:
    with pytest.raises(BeartypeCallHintViolation, match="return"):
        checked(doubled)(np.zeros(3))


def test_functions_classes_and_properties_of_the_product_are_checked() -> None:
    with pytest.raises(BeartypeCallHintViolation, match="slope"):
        AffineForm(np.zeros(3), np.zeros((2, 4)), np.zeros(3))
    with pytest.raises(BeartypeCallHintViolation, match="slope"):
        AffineForm.exact(np.zeros(3), np.zeros((2, 4)))
    form = AffineForm.exact(np.zeros(3), np.zeros((3, 4)))
    object.__setattr__(form, "radius", np.zeros((1, 3)))
    with pytest.raises(BeartypeCallHintViolation, match="return"):
        _ = form.high


def test_the_first_calls_of_each_test_are_checked() -> None:
    function = checked(added)
    for _ in range(MOST_CALLS - 1):
        function(np.zeros(3), np.zeros(3))
    with pytest.raises(BeartypeCallHintViolation):
        function(np.zeros(3), np.zeros(1))
    assert function(np.zeros(3), np.zeros(1)).shape == (3,)
