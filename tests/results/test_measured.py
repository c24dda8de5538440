import numpy as np
import pytest

from fissura.errors import InputError
from fissura.results.measured import read_measured


def test_columns_in_si(tmp_path):
    path = tmp_path / "band.csv"
    path.write_text("# cmod_mm,min_N,max_N\n0.003,200,300\n\n0.001,90,110\n")
    band = read_measured(path)
    np.testing.assert_allclose(band.gauge, [1e-6, 3e-6])
    np.testing.assert_allclose(band.lower, [90, 200])
    np.testing.assert_allclose(band.upper, [110, 300])


@pytest.mark.parametrize(
    ("content", "message"),
    [("# nothing\n", "holds no numbers"), ("1,2\n", "line 1"), ("# a\n1,2,x\n", "line 2")],
)
def test_broken_files(tmp_path, content, message):
    path = tmp_path / "band.csv"
    path.write_text(content)
    with pytest.raises(InputError, match=message) as caught:
        read_measured(path)
    assert caught.value.key == "output.measured"


def test_missing_file(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_measured(tmp_path / "none.csv")
