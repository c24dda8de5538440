"""Random field of strength and fracture energy: covariance, expansion, marginal distribution, realisation."""

from fissura.material.field.covariance import covariance_named
from fissura.material.field.field import RandomField, field_from_case
from fissura.material.field.marginal import MARGINALS, Marginal, marginal_named

__all__ = [
    "MARGINALS",
    "Marginal",
    "RandomField",
    "covariance_named",
    "field_from_case",
    "marginal_named",
]
