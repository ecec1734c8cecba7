"""A picture is read back from its file."""

from io import BytesIO

import matplotlib.image
import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from ictamp_drake.viz.png import png


@given(hnp.arrays(np.uint8, st.tuples(st.integers(1, 9), st.integers(1, 9), st.just(3))))
def test_a_picture_is_read_back(image: np.ndarray) -> None:
    read = matplotlib.image.imread(BytesIO(png(image)), format="png")
    np.testing.assert_array_equal(np.round(255 * read).astype(np.uint8), image)
