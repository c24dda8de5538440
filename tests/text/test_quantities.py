import math

import pytest

from fissura.text import quantities as text


@pytest.mark.parametrize(
    ("made", "expected"),
    [
        (text.length(12.34e-6), "12.3 µm"),
        (text.length(1e-4), "100 µm"),
        (text.length(2.5e-3), "2.50 mm"),
        (text.length(0.0), "0 µm"),
        (text.force(953.2), "953 N"),
        (text.force(1200.0), "1.20 kN"),
        (text.force(-1200.0), "-1.20 kN"),
        (text.force(3.4e6), "3.40 MN"),
        (text.energy(0.0123), "12.3 mJ"),
        (text.energy(4.0), "4.00 J"),
        (text.stiffness(1.5e8), "150 kN/mm"),
        (text.seconds(1234.5), "1234 s"),
        (text.per_cent(0.0123), "1.23 %"),
        (text.per_cent(0.0123, signed=True), "+1.23 %"),
        (text.count(1390), "1390"),
        (text.count(12345), "12 345"),
        (text.ratio(5.304), "5.30"),
    ],
)
def test_text(made, expected):
    assert made == expected


@pytest.mark.parametrize(
    "show", [text.length, text.force, text.energy, text.stiffness, text.per_cent, text.count, text.ratio]
)
def test_unknown_is_a_dash(show):
    assert show(math.nan) == "-"
